#include <batten/problem/requests.hpp>

#include <algorithm>
#include <array>

namespace batten {

std::string_view to_string(Request request) {
    constexpr std::array<std::string_view, request_count> words{
        "take a number of control points",
        "take given knots",
        "take a rule for knots",
        "take given parameters",
        "weigh samples",
        "fit to a tolerance",
        "limit the number of control points of a tolerance",
        "take corners",
        "close an axis",
        "bend at a seam",
        "pass through samples exactly",
        "hold tangents",
        "hold boundaries",
        "keep a shape",
        "smooth",
        "set outliers aside",
        "start from stated control points",
        "move only some control points",
        "record a history",
        "stop by iterations or gradient",
        "go on from the iteration before",
    };
    return words[static_cast<std::size_t>(request)];
}

std::vector<Request> Requests::list() const {
    std::vector<Request> result;
    for (std::size_t k = 0; k < request_count; ++k)
        if (has(static_cast<Request>(k))) result.push_back(static_cast<Request>(k));
    return result;
}

Requests requests_of(const Problem& problem) {
    return requests_of(problem.options, problem.axes, problem.kind,
                       !problem.samples.weights.empty());
}

Requests requests_of(const FitOptions& options, const AxisPlan& axes, SampleKind kind,
                     bool weighted) {
    const ShapeOptions& shape = options.shape;
    const StopRule usual;
    Requests result;
    const auto ask = [&](Request request, bool asked) {
        if (asked) result = result | Requests{request};
    };
    ask(Request::size, !axes.control_points.empty());
    ask(Request::knots, !shape.knots.empty());
    // of a cloud knots are even anyway
    const bool even = kind == SampleKind::cloud && shape.placement == KnotPlacement::uniform;
    ask(Request::placement, shape.placement.has_value() && !even);
    ask(Request::parameters, kind != SampleKind::cloud && shape.parameters.has_value());
    ask(Request::weights, weighted);
    ask(Request::tolerance, options.tolerance.stated());
    ask(Request::limit, options.tolerance.max_control_points > 0);
    ask(Request::corners, options.tolerance.corners != Corners::automatic);
    ask(Request::closed, std::ranges::count(axes.closures, Closure::closed) > 0);
    ask(Request::seam, shape.seam_continuity >= 0);
    ask(Request::samples, !options.hold.interpolate.empty());
    ask(Request::tangents, !options.hold.tangents.empty());
    ask(Request::boundaries, !options.hold.boundaries.empty());
    ask(Request::shape, options.hold.preserve != Preserve::nothing);
    ask(Request::smoothing, options.smooth.wanted);
    ask(Request::outliers, options.outliers == Outliers::set_aside);
    ask(Request::start, options.method.initial != Initial::data);
    ask(Request::local, !options.method.moving.empty());
    ask(Request::history, options.keep_history);
    ask(Request::stop, options.stop.max_iterations != usual.max_iterations ||
                           options.stop.gradient > 0 ||
                           options.stop.relative_gradient != usual.relative_gradient ||
                           options.stop.deviation > 0);
    ask(Request::memory, options.method.before.size() > 0);
    return result;
}

} // namespace batten
