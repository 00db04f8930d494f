#include <batten/drivers/choose.hpp>

#include <batten/problem/plan.hpp>
#include <batten/system/collocation.hpp>

#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

/// Words for what the samples leave undetermined, axis by axis; nothing when all is determined or
/// nobody can tell cheaply.
std::string gap_of(const Problem& problem) {
    // a smooth spline is determined where there are no samples, too
    if (problem.options.smooth.wanted || problem.kind == SampleKind::cloud || !problem.sized())
        return {};
    const std::vector<KnotVector> axes = fixed_knots(problem);
    for (std::size_t k = 0; k < axes.size(); ++k)
        if (const auto words = undetermined(axes[k], problem.parameters.axes[k]))
            return fmt::format("axis {}: {}", k, *words);
    return {};
}

/// Why a driver that nobody named is the one.
std::string reason_for(std::string_view name, SampleKind kind, Requests asked,
                       const std::string& gap) {
    if (name == "search") return "knots where the error is, then as few as hold it";
    if (name == "pia") return "only some control points move";
    if (!gap.empty())
        return gap + (asked.has(Request::shape)
                          ? ": the shape is kept step by step"
                          : ": an iteration leaves what no sample determines where it starts");
    if (name == "cg" && kind == SampleKind::cloud)
        return "a cloud: conjugate gradients, preconditioned axis by axis, cost less than a sparse "
               "factorisation";
    if (name == "direct" && kind == SampleKind::cloud && asked.has(Request::smoothing) &&
        !asked.has(Request::samples))
        return "a smooth cloud: one sparse factorisation costs less than conjugate gradients";
    if (name != "direct") return "the fastest iteration that takes what is asked";
    return asked.has(Request::shape)     ? "the shape is kept by quadratic programs"
           : asked.has(Request::samples) ? "exact samples: one saddle-point solve"
                                         : "fixed knots and enough samples: one solve is exact and "
                                           "fastest";
}

/// Whether the driver can answer at all where samples leave control points undetermined.
bool determines(std::string_view name, const std::string& gap) {
    return gap.empty() || (name != "direct" && name != "clspia");
}

/// Whether roughness along several axes, which no product of matrices per axis comes near, makes
/// conjugate gradients dearer than a sparse factorisation.
bool smooth_and_small(const Problem& problem) {
    constexpr Index most = 1 << 16; // control points whose factors memory surely holds
    if (!problem.options.smooth.wanted || problem.axes.control_points.empty()) return false;
    Index size = 1;
    for (const Index n : problem.axes.control_points) size = size > most ? size : size * n;
    return size <= most;
}

Choice automatic(const Problem& problem, Requests asked) {
    const SampleKind kind = problem.kind;
    const std::string gap = gap_of(problem);
    const bool shape = asked.has(Request::shape);
    // of a cloud the sparse factorisation is dear, and limited steps break conjugate gradients
    std::vector<std::string_view> order{"search", "direct", "cg",  "mlspia",
                                        "clspia", "pia",    "epia"};
    if (kind == SampleKind::cloud) order = {"search", "cg", "direct", "clspia", "epia"};
    if (kind == SampleKind::cloud && smooth_and_small(problem)) std::swap(order[1], order[2]);
    if (shape) order = {"search", "direct", "mlspia", "clspia", "pia"};
    for (std::string_view name : order) {
        const Driver& candidate = driver(name);
        const auto& column = candidate.takes(kind);
        const bool sized = problem.sized() || name == "search" || name == "pia" || name == "epia";
        if (column && column->covers(asked) && sized && determines(name, gap) &&
            (name != "search" || asked.has(Request::tolerance)))
            return {&candidate, reason_for(name, kind, asked, gap)};
    }
    if (!gap.empty() && driver("direct").takes(kind)->covers(asked))
        throw InvalidInput(
            gap +
            ": samples cannot be held exactly while others leave control points undetermined");
    check_column(driver(asked.has(Request::tolerance) ? "search" : "direct"), kind, asked);
    throw InvalidInput("the number of control points is not stated");
}

} // namespace

std::optional<Choice> chosen_in_passes(const FitOptions& options, SampleKind kind, Requests asked) {
    const Driver& direct = driver("direct");
    const bool automatic = options.method.name == "auto";
    const bool sized = asked.has(Request::size) || asked.has(Request::knots);
    if (kind != SampleKind::sequence || !sized || !direct.passes->covers(asked)) return {};
    if (automatic) return Choice{&direct, reason_for(direct.name, kind, asked, {})};
    if (options.method.name == direct.name) return Choice{&direct, {}};
    return {};
}

Choice choose(const Problem& problem) {
    const Requests asked = requests_of(problem);
    const std::string& name = problem.options.method.name;
    if (name == "auto") return automatic(problem, asked);
    const Driver& named = driver(name);
    check_column(named, problem.kind, asked);
    if (name != "direct") return {&named, {}};
    if (const std::string gap = gap_of(problem); !gap.empty())
        throw InvalidInput(fmt::format(
            "{}: the direct solver cannot determine every control point (Schoenberg-Whitney); use "
            "an iterative method such as cg, or smoothing",
            gap));
    return {&named, {}};
}

} // namespace batten
