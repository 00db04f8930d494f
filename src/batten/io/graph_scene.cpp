#include <batten/io/graph_scene.hpp>

#include <batten/spline/graph.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

void stretch_by(const std::vector<double>& factors, PointSet& points) {
    for (Index i = 0; i < points.size(); ++i)
        for (std::size_t d = 0; d < factors.size(); ++d)
            points(i, static_cast<Index>(d)) *= factors[d];
}

} // namespace

PointSet drawn_samples(const Scene& scene) {
    const Index axes = scene.spline.axis_count();
    const bool function = is_function(scene.spline);
    if (scene.samples == nullptr) return {0, function ? axes + 1 : scene.spline.dim()};
    if (!function) return PointSet(scene.samples->points);
    const PointSet at =
        scene.parameters == nullptr ? PointSet() : parameter_rows(*scene.parameters);
    if (at.size() != scene.samples->size()) return {0, axes + 1};
    PointSet points(at.size(), axes + 1);
    for (Index i = 0; i < points.size(); ++i) {
        std::ranges::copy(at[i], points[i].begin());
        points(i, axes) = scene.samples->points(i, 0);
    }
    return points;
}

std::vector<double> picture_stretch(const Spline& graph) {
    const PointSet box = bounding_box(graph.control_points());
    std::vector<double> factors;
    for (Index d = 0; d < graph.dim(); ++d) {
        const double extent = box(1, d) - box(0, d);
        const double factor = (d < graph.axis_count() ? 1 : 0.6) / extent;
        factors.push_back(extent > 0 && std::isfinite(factor) ? factor : 1);
    }
    return factors;
}

GraphScene::GraphScene(const Scene& function) : spline_(graph(function.spline)) {
    const std::vector<double> factors = picture_stretch(spline_);
    PointSet control = spline_.control_points();
    stretch_by(factors, control);
    spline_ = Spline(spline_.axes(), std::move(control));
    PointSet points = drawn_samples(function);
    stretch_by(factors, points);
    const bool shown = !points.empty();
    samples_.points = Points(std::move(points));
    scene_.emplace(Scene{.spline = spline_,
                         .samples = shown ? &samples_ : nullptr,
                         .title = function.title,
                         .deviations = shown ? function.deviations : nullptr});
}

} // namespace batten
