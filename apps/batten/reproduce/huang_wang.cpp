#include "papers.hpp"

#include <batten/samples/generate.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <random>

namespace batten::command {

namespace {

constexpr double printed_digits = 1e-12; // accuracy of the eigenvalues behind the printed weights

FitOptions example_3(const char* method, Index n, Initial initial) {
    FitOptions options;
    options.shape.control_points = {n};
    options.method = {
        .name = method, .settings = {{"eigenvalue_tolerance", printed_digits}}, .initial = initial};
    options.stop = {.gradient = 1e-8, .relative_gradient = 0};
    return options;
}

double iterations(const FitResult& result) {
    return static_cast<double>(result.report.iterations);
}

/// Iterations from zero (I) and from samples (II) for numbers of control points.
Table table_1(const Samples& rose) {
    constexpr struct {
        Index n;
        const char *zero, *data;
    } printed[] = {{501 / 12, "56", "49"},     {501 / 10, "55", "47"}, {501 / 8, "55", "48"},
                   {501 / 6, "55", "48"},      {501 / 4, "55", "49"},  {501 / 2, "85", "74"},
                   {2 * 501 / 3, "696", "570"}};
    Table table{"Table 1, Example 3", {}};
    for (const auto& [n, zero, data] : printed) {
        table.rows.push_back({fmt::format("{} control points, I", n), zero,
                              iterations(fit(rose, example_3("mlspia", n, Initial::zero)))});
        table.rows.push_back({fmt::format("{} control points, II", n), data,
                              iterations(fit(rose, example_3("mlspia", n, Initial::data)))});
    }
    return table;
}

Table table_2(const Samples& rose, Workshop& workshop) {
    const FitReport fast = drawn_fit(rose, example_3("mlspia", 50, Initial::data), workshop,
                                     "mlspia_example3", {0, 5, 10})
                               .report;
    const FitReport slow =
        drawn_fit(rose, example_3("lspia", 50, Initial::data), workshop, "lspia_example3", {})
            .report;
    return {"Table 2, Example 3",
            {{"omega*", "0.589932226424", fast.settings.at("omega")},
             {"nu*", "0.418520492365", fast.settings.at("nu")},
             {"mu* of LSPIA", "0.175097063057", slow.settings.at("mu")},
             {"iterations of MLSPIA", "47", static_cast<double>(fast.iterations)},
             {"iterations of LSPIA (paper: 2-norm)", "156", static_cast<double>(slow.iterations)}}};
}

/// The fewest and most iterations of ten random starts.
Table table_3(const Samples& rose) {
    Index least = std::numeric_limits<Index>::max();
    Index most = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        FitOptions options = example_3("mlspia", 50, Initial::given);
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> value(-200000, 200000);
        options.method.control = PointSet(50, 2);
        for (double& x : options.method.control.values()) x = value(random);
        const Index count = fit(rose, options).report.iterations;
        least = std::min(least, count);
        most = std::max(most, count);
    }
    return {"Table 3, Example 3, random starts",
            {{"fewest iterations", "82", static_cast<double>(least)},
             {"most iterations", "87", static_cast<double>(most)}}};
}

} // namespace

std::vector<Table> huang_wang(Workshop& workshop) {
    const Samples rose = generate("rose", {501});
    return {table_1(rose), table_2(rose, workshop), table_3(rose)};
}

} // namespace batten::command
