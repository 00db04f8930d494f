#pragma once

#include <batten/io/spline_file.hpp>
#include <batten/problem/result.hpp>

#include <string>

namespace batten {

/// What the page shows beside the scene's spline, samples and deviations.
struct PageOptions {
    /// Command line that repeats the fit.
    std::string command{};
    /// Unit of the coordinates in words; empty: none is named.
    std::string unit{};
    /// Samples beyond this number are thinned evenly, and the page says so.
    Index most_samples = 100000;
};

/// The HTML report as one self-contained page. Texts appear as texts, whatever is in them.
/// `scene` must have samples and deviations; throws InvalidInput otherwise, and for dimensions
/// above 3.
std::string html_page(const FitReport& report, const Scene& scene, const PageOptions& options);

} // namespace batten
