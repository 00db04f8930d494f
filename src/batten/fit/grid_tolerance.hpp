#pragma once

#include <batten/fit/options.hpp>
#include <batten/spline/spline.hpp>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace batten {

/// A surface or volume fitted to a grid within a tolerance.
struct GridWithin {
    Spline spline;
    bool met = false;
    double worst = 0; ///< largest distance of a sample over its tolerance, at its own parameters
    std::vector<std::pair<std::string, Index>> stages;
};

/// Searches the numbers of control points per axis: grows the axis that helps more until every
/// sample is within tolerance, then shrinks each as far as that holds; knots evenly, or denser
/// where the data bend more along the axis, whichever takes fewer. `most`: at most that many
/// control points per axis.
GridWithin few_knots(const Samples& samples, const Parameters& parameters,
                     const std::vector<double>& tolerance, const std::vector<int>& degree,
                     const std::vector<Closure>& closures, const std::vector<Index>& most,
                     const std::function<bool()>& cancelled = {});

} // namespace batten
