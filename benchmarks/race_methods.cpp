// The methods against each other at equal residual: iterations and milliseconds until the gradient
// is 1e-8 of its first value, set-up (eigenvalues, factorisations) included, assembly not; direct
// stands for the same answer.
#include <batten/batten.hpp>

#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace {

using namespace batten;

struct Case {
    std::string name;
    std::unique_ptr<NormalSystem> system;
};

Case problem(const std::string& name, const Samples& samples, std::vector<Index> n) {
    const Parameters t =
        parametrize(samples, Parametrization::chord, std::vector<Closure>(n.size(), Closure::open));
    std::vector<KnotVector> axes;
    for (std::size_t k = 0; k < n.size(); ++k)
        axes.push_back(knots_from_parameters(t.axes[k], 3, n[k]));
    return {name, assemble(axes, samples, t)};
}

template <class Work>
double median_milliseconds(Work work) {
    std::vector<double> times;
    for (int round = 0; round < 7; ++round) {
        const auto start = std::chrono::steady_clock::now();
        work();
        times.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count());
    }
    std::nth_element(times.begin(), times.begin() + 3, times.end());
    return times[3];
}

} // namespace

int main() {
    std::vector<Case> problems;
    problems.push_back(problem("rose 501, 50", generate("rose", {501}), {50}));
    problems.push_back(problem("rose 10^6, 1000", generate("rose", {1000000}), {1000}));
    problems.push_back(
        problem("peaks 121 x 121, 41 x 41", generate("peaks", {121, 121}), {41, 41}));
    for (const Case& p : problems) {
        fmt::print("{}\n  {:<18}{:>12}{:>12}\n", p.name, "method", "iterations", "ms");
        fmt::print("  {:<18}{:>12}{:>12.3f}\n", "direct", "-",
                   median_milliseconds([&] { solve_direct(*p.system); }));
        for (const char* method :
             {"cg", "chebyshev", "nesterov", "barzilai-borwein", "mlspia", "lspia"}) {
            Summary summary;
            const double time = median_milliseconds([&] {
                PointSet control(p.system->size(), p.system->dim());
                summary = iterate(*make_method(method, *p.system, {}), control,
                                  {.max_iterations = 100000, .relative_gradient = 1e-8});
            });
            fmt::print("  {:<18}{:>12}{:>12.3f}\n", method, summary.iterations, time);
        }
    }
}
