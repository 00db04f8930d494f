#include "lin_wang_dong_data.hpp"
#include "papers.hpp"

#include <batten/samples/generate.hpp>
#include <batten/shape/polygon.hpp>

#include <array>
#include <fmt/format.h>

namespace batten::command {

namespace {

FitOptions pia_options() {
    FitOptions options;
    options.method.name = "pia";
    options.stop = {.max_iterations = 30, .relative_gradient = 0};
    return options;
}

/// A line of Table 1: the largest deviation after 0, 2, 4, 15 and 30 steps.
std::vector<Row> line(const FitResult& result, const std::array<const char*, 5>& printed) {
    constexpr std::array<std::size_t, 5> steps{0, 2, 4, 15, 30};
    std::vector<Row> rows;
    for (std::size_t k = 0; k < steps.size(); ++k)
        rows.push_back({fmt::format("error after {} steps", steps[k]), printed[k],
                        result.report.history[steps[k]].max_deviation});
    return rows;
}

} // namespace

std::vector<Table> lin_wang_dong(Workshop& workshop) {
    FitOptions options = pia_options();
    const FitResult helix = drawn_fit(paper_helix(), options, workshop, "pia_helix", {0, 4, 15});
    const FitResult peaks =
        drawn_fit(generate("peaks", {30, 30}), options, workshop, "pia_peaks", {0, 3, 15});
    const Samples polygon = convex_polygon(0);
    const auto inflections = [](const FitResult& r) {
        return static_cast<double>(inflection_count(r.spline.control_points()));
    };
    const FitResult plain = drawn_fit(polygon, options, workshop, "pia_plain", {0, 4});
    options.hold.preserve = Preserve::convexity;
    const FitResult convex = drawn_fit(polygon, options, workshop, "pia_convex", {0, 4});
    std::vector<Row> fifth =
        line(convex, {"3.7003e-1", "6.7963e-2", "4.9086e-2", "2.0160e-4", "8.3892e-8"});
    fifth.push_back({"inflections of the polygon, plain PIA", "", inflections(plain)});
    fifth.push_back({"the same, convexity preserved", "0", inflections(convex)});
    return {
        {"Table 1, Fig. 3, helix",
         line(helix, {"1.9603", "2.8645e-1", "6.6263e-3", "3.7651e-5", "2.1624e-7"}),
         Data::stand_in, "the helix (6 cos t, 6 sin t, 2 t), t on [0, 8 pi], 20 points",
         "pia_helix_*.svg"},
        {"Table 1, Fig. 4", {}, Data::none, "a free curve whose points are not printed"},
        {"Table 1, Fig. 5, and the figure", fifth, Data::stand_in, "12 uneven points on an ellipse",
         "pia_plain_*.svg, pia_convex_*.svg"},
        {"Table 1, Fig. 6, peaks",
         line(peaks, {"33.628", "3.5526e-1", "1.7233e-1", "1.5282e-2", "1.2695e-3"}),
         Data::stand_in, "peaks over [-3, 3] x [-4, 4], 30 x 30 points", "pia_peaks_*.svg"},
    };
}

} // namespace batten::command
