// The passes and kernels one by one; run build/release/benchmarks/benchmark_kernels.
#include <batten/batten.hpp>
#include <batten/system/factored_system.hpp>
#include <batten/system/stencil_system.hpp>

#include <benchmark/benchmark.h>
#include <cmath>
#include <random>

namespace {

using namespace batten;

Samples wave(Index m) {
    PointSet q(m, 3);
    for (Index i = 0; i < m; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(m - 1);
        q(i, 0) = std::cos(50 * t);
        q(i, 1) = std::sin(70 * t);
        q(i, 2) = t;
    }
    Samples samples;
    samples.points = Points(std::move(q));
    return samples;
}

void assemble_curve(benchmark::State& state) {
    const Samples samples = wave(1'000'000);
    const auto t = parametrize(samples, Parametrization::uniform, {Closure::open}).axes[0];
    const KnotVector knots = uniform_knots(static_cast<int>(state.range(0)), state.range(1), 0, 1);
    for (auto _ : state) {
        BandedSystem system(knots, {0, 0, 0});
        system.add(t, samples.points, {});
        benchmark::DoNotOptimize(system.rhs().data());
    }
    state.SetItemsProcessed(state.iterations() * samples.size());
}
BENCHMARK(assemble_curve)
    ->Args({3, 1000})
    ->Args({3, 100000})
    ->Args({1, 1000})
    ->Args({5, 1000})
    ->Args({9, 1000})
    ->Unit(benchmark::kMillisecond);

void parametrize_curve(benchmark::State& state) {
    const Samples samples = wave(1'000'000);
    for (auto _ : state)
        benchmark::DoNotOptimize(parametrize(samples, Parametrization::chord, {Closure::open}));
    state.SetItemsProcessed(state.iterations() * samples.size());
}
BENCHMARK(parametrize_curve)->Unit(benchmark::kMillisecond);

void deviation_of_curve(benchmark::State& state) {
    const Samples samples = wave(1'000'000);
    FitOptions options;
    options.shape.control_points = {1000};
    const FitResult result = fit(samples, options);
    for (auto _ : state)
        benchmark::DoNotOptimize(parametric_deviations(result.spline, samples, result.parameters));
    state.SetItemsProcessed(state.iterations() * samples.size());
}
BENCHMARK(deviation_of_curve)->Unit(benchmark::kMillisecond);

void assemble_cloud(benchmark::State& state) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    PointSet uv(1'000'000, 2);
    PointSet q(1'000'000, 1);
    for (Index i = 0; i < q.size(); ++i) {
        uv(i, 0) = unit(random);
        uv(i, 1) = unit(random);
        q(i, 0) = std::sin(5 * uv(i, 0)) * uv(i, 1);
    }
    const KnotVector knots = uniform_knots(3, state.range(0), 0, 1);
    for (auto _ : state) {
        StencilSystem system({knots, knots}, {0});
        system.add(q, uv, {});
        benchmark::DoNotOptimize(system.rhs().data());
    }
    state.SetItemsProcessed(state.iterations() * q.size());
}
BENCHMARK(assemble_cloud)->Arg(40)->Arg(100)->Unit(benchmark::kMillisecond);

void direct_solve(benchmark::State& state) {
    const Samples samples = wave(1'000'000);
    const Parameters t = parametrize(samples, Parametrization::uniform, {Closure::open});
    const auto system = assemble({uniform_knots(3, state.range(0), 0, 1)}, samples, t);
    for (auto _ : state) benchmark::DoNotOptimize(solve_direct(*system));
    state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(direct_solve)->Arg(1000)->Arg(100000)->Unit(benchmark::kMicrosecond);

void small_fit(benchmark::State& state) {
    const Samples wing = generate("naca2412", {205});
    FitOptions options;
    options.shape.control_points = {20};
    for (auto _ : state) benchmark::DoNotOptimize(fit(wing, options));
}
BENCHMARK(small_fit)->Unit(benchmark::kMicrosecond);

} // namespace
