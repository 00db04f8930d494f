#include <batten/iterate/iterate.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace batten {

std::string_view to_string(Termination termination) {
    switch (termination) {
    case Termination::converged:
        return "converged";
    case Termination::iteration_limit:
        return "iteration_limit";
    case Termination::tolerance_met:
        return "tolerance_met";
    case Termination::tolerance_not_met:
        return "tolerance_not_met";
    case Termination::stalled:
        return "stalled";
    case Termination::breakdown:
        return "breakdown";
    case Termination::cancelled:
        return "cancelled";
    }
    return "";
}

namespace {

bool holds(const StopRule& stop, const Summary& now, const PointSet& control,
           const IterateHooks& hooks) {
    if (now.gradient_norm <= stop.gradient) return true; // a gradient of exactly 0 always ends
    if (now.gradient_norm <= stop.relative_gradient * now.first_gradient_norm) return true;
    return stop.deviation > 0 && hooks.deviation && hooks.deviation(control) <= stop.deviation;
}

double observed_rate(const std::vector<double>& norms) {
    const std::size_t half = norms.size() / 2;
    if (norms.size() < 4 || !(norms[half] > 0) || !(norms.back() > 0)) return 0;
    return std::pow(norms.back() / norms[half], 1.0 / static_cast<double>(norms.size() - 1 - half));
}

} // namespace

Summary iterate(Method& method, PointSet& control, const StopRule& stop,
                const IterateHooks& hooks) {
    Summary now;
    std::vector<double> norms;
    double largest_move = 0;
    PointSet moves;
    const auto ended = [&](Termination how) {
        now.termination = how;
        now.observed_rate = observed_rate(norms);
        return now;
    };
    method.start(control);
    for (;; ++now.iterations) {
        moves = method.propose(control);
        now.gradient_norm = method.gradient_norm();
        if (now.iterations == 0) now.first_gradient_norm = now.gradient_norm;
        norms.push_back(now.gradient_norm);
        if (!std::isfinite(now.gradient_norm)) return ended(Termination::breakdown);
        const Iteration seen{now.iterations, control, now.gradient_norm, largest_move,
                             method.constraint_error()};
        if (hooks.observer && hooks.observer(seen) == Continue::no)
            return ended(Termination::cancelled);
        if (holds(stop, now, control, hooks)) return ended(Termination::converged);
        if (now.iterations >= stop.max_iterations) return ended(Termination::iteration_limit);
        if (hooks.limit) hooks.limit(control, moves);
        largest_move = largest_length(moves);
        if (largest_move <= std::numeric_limits<double>::epsilon() / 2 * largest_length(control))
            return ended(Termination::stalled);
        add_scaled(control, 1.0, moves);
        method.accept(moves);
    }
}

} // namespace batten
