#include <batten/iterate/iterate.hpp>

#include <cmath>
#include <fmt/format.h>
#include <limits>

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

void check(const StopRule& stop) {
    const auto refuse = [](std::string_view name, double value) {
        throw InvalidInput(
            fmt::format("stop rule: {} = {} must be a finite number, 0 or more", name, value));
    };
    if (stop.max_iterations < 0) refuse("max_iterations", static_cast<double>(stop.max_iterations));
    for (const auto& [name, value] : {std::pair("gradient", stop.gradient),
                                      std::pair("relative_gradient", stop.relative_gradient),
                                      std::pair("deviation", stop.deviation)})
        if (!std::isfinite(value) || value < 0) refuse(name, value);
}

double observed_rate(const std::vector<double>& norms) {
    const std::size_t half = norms.size() / 2;
    if (norms.size() < 4 || !(norms[half] > 0) || !(norms.back() > 0)) return 0;
    return std::pow(norms.back() / norms[half], 1.0 / static_cast<double>(norms.size() - 1 - half));
}

namespace {

/// The absolute control points, computed where they are looked at.
class AbsoluteControl {
  public:
    explicit AbsoluteControl(const std::vector<double>& centre) : centre_(centre) {}

    const PointSet& of(const PointSet& control) {
        if (centre_.empty()) return control;
        absolute_ = control;
        for (Index i = 0; i < absolute_.size(); ++i)
            for (std::size_t d = 0; d < centre_.size(); ++d) absolute_[i][d] += centre_[d];
        return absolute_;
    }

  private:
    const std::vector<double>& centre_;
    PointSet absolute_;
};

StopTests tests(const StopRule& stop, const Summary& now) {
    return {.gradient = now.gradient_norm <= stop.gradient,
            .relative_gradient = stop.relative_gradient > 0 &&
                                 now.gradient_norm <= stop.relative_gradient * now.reference_norm,
            .deviation = now.deviation && *now.deviation <= stop.deviation};
}

bool vanish(double largest_move, const PointSet& control) {
    return largest_move <= std::numeric_limits<double>::epsilon() / 2 * largest_length(control);
}

} // namespace

Summary iterate(Method& method, PointSet& control, const StopRule& stop,
                const IterateHooks& hooks) {
    check(stop);
    if (stop.deviation > 0 && !hooks.deviation)
        throw InvalidInput("stop rule: a deviation is stated, but nothing measures it");
    Summary now;
    std::vector<double> norms;
    AbsoluteControl absolute(hooks.centre);
    const bool looked_at = hooks.observer || stop.deviation > 0;
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
        if (now.iterations == 0) {
            now.first_gradient_norm = now.gradient_norm;
            now.reference_norm = method.reference_norm();
        }
        norms.push_back(now.gradient_norm);
        now.held = {};
        if (!std::isfinite(now.gradient_norm)) return ended(Termination::breakdown);
        const PointSet& seen = looked_at ? absolute.of(control) : control;
        if (stop.deviation > 0) now.deviation = hooks.deviation(seen);
        now.held = tests(stop, now);
        if (hooks.observer && hooks.observer({now.iterations, seen, now.gradient_norm, largest_move,
                                              method.constraint_error()}) == Continue::no)
            return ended(Termination::cancelled);
        if (now.held.any() && method.constraints_hold()) return ended(Termination::converged);
        if (now.iterations >= stop.max_iterations) return ended(Termination::iteration_limit);
        if (hooks.limit) hooks.limit(control, moves);
        largest_move = largest_length(moves);
        if (vanish(largest_move, control) && !method.rests()) return ended(Termination::stalled);
        add_scaled(control, 1.0, moves);
        method.accept(moves);
    }
}

} // namespace batten
