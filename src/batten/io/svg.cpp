#include <batten/io/svg.hpp>

#include <batten/io/graph_scene.hpp>
#include <batten/io/sampling.hpp>
#include <batten/io/svg_parts.hpp>
#include <batten/spline/graph.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr double picture_size = 900; // pixels of the longer side, margin apart
constexpr double margin = 36;

/// Data coordinates to pixels, y upwards.
struct Frame {
    double left, top, scale;
    double width, height;
    double head; ///< pixels above, for the legend
    std::string at(double x, double y) const {
        return fmt::format("{:.3f} {:.3f}", margin + (x - left) * scale,
                           margin + head + (top - y) * scale);
    }
};

Frame frame_around(const PointSet& box, double head) {
    const double w = box(1, 0) - box(0, 0);
    const double h = box(1, 1) - box(0, 1);
    const double size = std::max({w, h, 1e-300});
    const double scale = picture_size / size;
    return {box(0, 0), box(1, 1), scale, w * scale + 2 * margin, h * scale + 2 * margin + head,
            head};
}

/// The four cubic Bezier points of the piece over a span, exact for degrees 1 to 3.
std::array<std::vector<double>, 4> bezier(const Spline& curve, Index span) {
    const KnotVector& k = curve.axis(0);
    const int p = k.degree();
    const double a = k[span];
    const double b = k[span + 1];
    std::vector<std::vector<double>> own; // the piece's own Bezier points
    for (int i = 0; i <= p; ++i) {
        std::vector<double> arguments(static_cast<std::size_t>(p), a);
        std::fill(arguments.end() - i, arguments.end(), b);
        own.push_back(blossom(k, curve.control_points(), span, arguments));
    }
    while (own.size() < 4) { // degree elevation
        const std::size_t n = own.size();
        std::vector<std::vector<double>> higher(n + 1, own[0]);
        higher[n] = own[n - 1];
        for (std::size_t i = 1; i < n; ++i)
            for (std::size_t d = 0; d < 2; ++d) {
                const double f = static_cast<double>(i) / static_cast<double>(n);
                higher[i][d] = f * own[i - 1][d] + (1 - f) * own[i][d];
            }
        own = std::move(higher);
    }
    return {own[0], own[1], own[2], own[3]};
}

/// Chords within a twentieth of a pixel of the curve.
std::string polyline(const Spline& curve, const Frame& frame) {
    const PointSet points =
        evaluate_grid(curve, sampling(curve, picture_chord(curve, 20 * picture_size)));
    std::string path = "M " + frame.at(points(0, 0), points(0, 1));
    for (Index i = points.size() > 1 ? 1 : 0; i < points.size(); ++i)
        path += " L " + frame.at(points(i, 0), points(i, 1));
    return path;
}

std::string curve_path(const Spline& curve, const Frame& frame) {
    const KnotVector& k = curve.axis(0);
    if (k.degree() > 3) return polyline(curve, frame);
    std::string path;
    for (Index span = k.degree(); span < k.control_count(); ++span) {
        if (!(k[span + 1] > k[span])) continue;
        const auto b = bezier(curve, span);
        if (path.empty()) path = "M " + frame.at(b[0][0], b[0][1]);
        path += fmt::format(" C {}, {}, {}", frame.at(b[1][0], b[1][1]), frame.at(b[2][0], b[2][1]),
                            frame.at(b[3][0], b[3][1]));
    }
    return path;
}

/// A normal of the curve: foot and tip.
struct Tooth {
    std::array<double, 2> foot;
    std::array<double, 2> tip;
};

/// Normals of the curve as long as its curvature, the longest an eighth of `size`.
std::vector<Tooth> comb_of(const Spline& curve, double size) {
    constexpr int per_span = 10;
    const std::vector<double> breaks = curve.axis(0).breakpoints();
    std::vector<Tooth> teeth; // the tip at first curvature times normal from the foot
    double longest = 1e-300;
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
        for (int s = 0; s < per_span; ++s) {
            const std::array t{breaks[b] + (breaks[b + 1] - breaks[b]) * (s + 0.5) / per_span};
            const auto p = curve(t);
            auto d1 = curve(t, std::array{1});
            auto d2 = curve(t, std::array{2});
            for (std::size_t d = 0; d < 2; ++d) { // in sizes: cubes of any unit would overflow
                d1[d] /= size;
                d2[d] /= size;
            }
            const double speed = std::hypot(d1[0], d1[1]);
            if (!(speed > 0)) continue;
            const double curvature = (d1[0] * d2[1] - d1[1] * d2[0]) / (speed * speed * speed);
            longest = std::max(longest, std::abs(curvature));
            teeth.push_back(
                {{p[0], p[1]}, {curvature * d1[1] / speed, -curvature * d1[0] / speed}});
        }
    const double scale = size / 8 / longest;
    for (Tooth& tooth : teeth)
        for (std::size_t d = 0; d < 2; ++d) tooth.tip[d] = tooth.foot[d] + scale * tooth.tip[d];
    return teeth;
}

/// The normals and the line along their tips.
std::string comb_svg(const std::vector<Tooth>& teeth, const Frame& frame) {
    std::string path;
    std::string tips;
    for (const Tooth& tooth : teeth) {
        const std::string tip = frame.at(tooth.tip[0], tooth.tip[1]);
        path += fmt::format("M {} L {} ", frame.at(tooth.foot[0], tooth.foot[1]), tip);
        tips += (tips.empty() ? "M " : " L ") + tip;
    }
    return fmt::format("  <path class=\"comb\" d=\"{}{}\"/>\n", path, tips);
}

/// The samples, coloured by their deviation where it is known, over the curve they lie on.
std::string sample_dots(const Scene& scene, const Frame& frame) {
    if (scene.samples == nullptr || scene.samples->dim() != 2) return {};
    const Points& points = scene.samples->points;
    std::vector<std::string> places;
    for (Index i = 0; i < points.size(); ++i)
        places.push_back(frame.at(points(i, 0), points(i, 1)));
    const double largest =
        scene.deviations == nullptr ? 0 : *std::ranges::max_element(*scene.deviations);
    const double radius = std::clamp(40 / std::sqrt(static_cast<double>(points.size())), 0.8, 2.4);
    std::string svg = coloured_dots(places, scene.deviations, largest, radius);
    if (scene.deviations != nullptr) svg += deviation_legend(largest, 12, 8);
    return svg;
}

PointSet box_around(const Scene& scene, const std::vector<Tooth>& comb) {
    PointSet box = bounding_box(scene.spline.control_points());
    const auto include = [&](std::span<const double> point) {
        for (Index d = 0; d < 2; ++d) {
            box(0, d) = std::min(box(0, d), point[static_cast<std::size_t>(d)]);
            box(1, d) = std::max(box(1, d), point[static_cast<std::size_t>(d)]);
        }
    };
    for (const Tooth& tooth : comb) include(tooth.tip);
    if (scene.samples == nullptr || scene.samples->dim() != 2) return box;
    const PointSet other = bounding_box(scene.samples->points);
    include(other[0]);
    include(other[1]);
    return box;
}

} // namespace

std::string svg_picture(const Scene& scene) {
    const Spline& curve = scene.spline;
    check(svg_limits, curve.axis_count(), curve.dim());
    if (is_function(curve)) return svg_picture(GraphScene(scene).scene());
    if (curve.axis_count() != 1 || curve.dim() != 2) return svg_projection(scene);
    const std::vector<Tooth> comb = scene.curvature_comb
                                        ? comb_of(curve, diagonal(curve.control_points()))
                                        : std::vector<Tooth>();
    const Frame frame = frame_around(box_around(scene, comb), scene.deviations == nullptr ? 0 : 28);
    std::string svg = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.1f} "
                                  "{:.1f}\" width=\"{:.0f}\" height=\"{:.0f}\">\n",
                                  frame.width, frame.height, frame.width, frame.height);
    svg +=
        "  <style>\n"
        "    .samples { stroke: #e07b39; stroke-linecap: round; fill: none; }\n"
        "    .curve { stroke: #1f4e79; stroke-width: 1.8; fill: none; stroke-linejoin: round; "
        "stroke-linecap: round; }\n"
        "    .polygon { stroke: #9aa5b1; stroke-width: 0.8; fill: none; stroke-dasharray: 4 3; }\n"
        "    .comb { stroke: #5a9367; stroke-width: 0.6; fill: none; }\n"
        "    .control { fill: #ffffff; stroke: #5c6b7a; stroke-width: 1; }\n"
        "  </style>\n"
        "  <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
    if (!scene.title.empty()) svg += fmt::format("  <title>{}</title>\n", svg_escaped(scene.title));
    const PointSet& control = curve.control_points();
    std::string polygon;
    for (Index i = 0; i < control.size(); ++i)
        polygon += (i == 0 ? "M " : " L ") + frame.at(control(i, 0), control(i, 1));
    svg += fmt::format("  <path class=\"polygon\" d=\"{}\"/>\n", polygon);
    if (scene.curvature_comb) svg += comb_svg(comb, frame);
    svg += fmt::format("  <path class=\"curve\" d=\"{}{}\"/>\n", curve_path(curve, frame),
                       curve.axis(0).closed() ? " Z" : "");
    svg += sample_dots(scene, frame);
    const double mark = control.size() > 150 ? 1.6 : 2.6;
    for (Index i = 0; i < control.size(); ++i) {
        const std::string at = frame.at(control(i, 0), control(i, 1));
        const std::size_t gap = at.find(' ');
        svg += fmt::format("  <circle class=\"control\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n",
                           at.substr(0, gap), at.substr(gap + 1), mark);
    }
    return svg + "</svg>\n";
}

} // namespace batten
