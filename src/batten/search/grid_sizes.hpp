#pragma once

#include <batten/measure/between_samples.hpp>
#include <batten/problem/options.hpp>
#include <batten/search/spread_knots.hpp>
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
    Index searched = 0;       ///< samples that the search went by where it was not all
    Index full_checks = 0;    ///< candidates that were then checked by all
    BetweenSamples between{}; ///< as check_reached finds it, where it was asked
};

/// What a surface or volume must reach.
struct GridTask {
    const Samples& samples;
    const Parameters& parameters;
    const std::vector<double>& tolerance; ///< one per sample, positive
    std::vector<int> degree;
    std::vector<Closure> closures;
    std::vector<Index> most; ///< control points per axis
    const HoldOptions& hold;
    const std::function<bool()>& cancelled;
    /// Per axis how knots follow the samples' bends (bend_spread), where more samples than these
    /// show it; empty: these do.
    std::vector<Spread> bends{};
    /// Whether what the spline does between a grid's samples counts; each trial then takes longer.
    enum class Between { left_aside, counted } between = Between::left_aside;
};

/// What the spline does between a grid's samples, judged as if the tolerances were as loose as the
/// spline is far from them: `worst` times.
BetweenSamples check_reached(const GridTask& task, const Spline& spline, double worst);

/// Searches the numbers of control points per axis: grows the axis that helps more until every
/// sample is within tolerance, then shrinks each as far as that holds; knots evenly, or denser
/// where the data bend more along the axis, whichever takes fewer. Where what lies between samples
/// counts, nothing wild is taken. The spline has no axes when nothing was found.
GridWithin fewest_sizes(const GridTask& task);

} // namespace batten
