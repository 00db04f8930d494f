#include <batten/io/exchange_formats.hpp>
#include <batten/spline/graph.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

/// Control points with the first axis fastest, as both formats want them.
std::vector<Index> first_axis_fastest(const std::vector<Index>& shape) {
    std::vector<Index> order;
    const Index n0 = shape[0];
    const Index n1 = shape.size() > 1 ? shape[1] : 1;
    const Index n2 = shape.size() > 2 ? shape[2] : 1;
    for (Index k = 0; k < n2; ++k)
        for (Index j = 0; j < n1; ++j)
            for (Index i = 0; i < n0; ++i) order.push_back((i * n1 + j) * n2 + k);
    return order;
}

std::string numbers(std::span<const double> values) {
    return fmt::format("{}", fmt::join(values, " "));
}

std::string obj_spline(const Spline& stored, Index& vertices) {
    const Spline spline = drawn(stored);
    check(obj_limits, stored.axis_count(), stored.dim());
    const PointSet& control = spline.control_points();
    std::string text;
    for (Index i : first_axis_fastest(spline.control_shape()))
        text += fmt::format("v {} {} {}\n", control(i, 0), control(i, 1),
                            spline.dim() > 2 ? control(i, 2) : 0.0);
    const bool surface = spline.axis_count() == 2;
    const KnotVector& u = spline.axis(0);
    text += fmt::format("cstype bspline\ndeg {}", u.degree());
    if (surface) text += fmt::format(" {}", spline.axis(1).degree());
    text += surface ? "\nsurf" : "\ncurv";
    text += fmt::format(" {} {}", u.begin(), u.end());
    if (surface) text += fmt::format(" {} {}", spline.axis(1).begin(), spline.axis(1).end());
    for (Index i = 1; i <= control.size(); ++i) text += fmt::format(" {}", vertices + i);
    text += fmt::format("\nparm u {}\n", numbers(u.knots()));
    if (surface) text += fmt::format("parm v {}\n", numbers(spline.axis(1).knots()));
    vertices += control.size();
    return text + "end\n";
}

} // namespace

std::string obj_text(const Scene& scene) {
    std::string text = "# batten\n";
    Index vertices = 0;
    for (const Spline* spline : scene.splines()) text += obj_spline(*spline, vertices);
    return text;
}

std::string g2_text(const Scene& scene) {
    constexpr int kinds[] = {100, 200, 700};
    std::string text;
    for (const Spline* spline : scene.splines()) {
        text += fmt::format("{} 1 0 0\n{} 0\n", kinds[spline->axis_count() - 1], spline->dim());
        for (const KnotVector& axis : spline->axes())
            text += fmt::format("{} {}\n{}\n", axis.control_count(), axis.degree() + 1,
                                numbers(axis.knots()));
        for (Index i : first_axis_fastest(spline->control_shape()))
            text += numbers(spline->control_points()[i]) + "\n";
    }
    return text;
}

} // namespace batten
