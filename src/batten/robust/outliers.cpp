#include <batten/robust/outliers.hpp>

#include <batten/measure/deviation.hpp>
#include <batten/problem/subset.hpp>
#include <batten/robust/robust_fit.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace batten {

namespace {

/// Median residual of the samples around each one: up to 4 places away along a sequence, 2 along
/// a grid's axes.
std::vector<double> around(const Samples& samples, const std::vector<double>& residual) {
    const GridIndex grid(samples.shape());
    const Index reach = grid.axis_count() == 1 ? 4 : 2;
    std::vector<double> result(residual.size());
    for_each_chunk(samples.size(), [&](Index i) {
        const GridIndex::Place here = grid.place(i);
        GridIndex::Place low{};
        std::vector<Index> window;
        for (std::size_t k = 0; k < grid.axis_count(); ++k) {
            low[k] = std::max<Index>(0, here[k] - reach);
            window.push_back(std::min(grid.length(k), here[k] + reach + 1) - low[k]);
        }
        const Index first = grid.at(low);
        std::vector<double> values;
        GridIndex(window).for_each([&](const GridIndex::Place& place, Index) {
            const Index j = first + grid.at(place);
            if (j != i) values.push_back(residual[static_cast<std::size_t>(j)]);
        });
        result[static_cast<std::size_t>(i)] = median(std::move(values));
    });
    return result;
}

/// The same for a cloud: of the samples in the same cell of the knots.
std::vector<double> around(const Parameters& parameters, const std::vector<KnotVector>& axes,
                           const std::vector<double>& residual) {
    std::map<std::array<Index, 3>, std::vector<double>> cells;
    const auto cell_of = [&](Index i) {
        std::array<Index, 3> cell{};
        for (std::size_t k = 0; k < axes.size(); ++k)
            cell[k] = axes[k].span(axes[k].wrapped(parameters.scattered(i, static_cast<Index>(k))));
        return cell;
    };
    const auto m = static_cast<Index>(residual.size());
    for (Index i = 0; i < m; ++i)
        cells[cell_of(i)].push_back(residual[static_cast<std::size_t>(i)]);
    std::map<std::array<Index, 3>, double> medians;
    for (auto& [cell, values] : cells) medians[cell] = median(std::move(values));
    std::vector<double> result;
    for (Index i = 0; i < m; ++i) result.push_back(medians[cell_of(i)]);
    return result;
}

std::vector<bool> protected_samples(const Samples& samples, const HoldOptions& hold) {
    std::vector<bool> result(static_cast<std::size_t>(samples.size()), false);
    for (Index i : hold.interpolate) result[static_cast<std::size_t>(i)] = true;
    for (const HeldTangent& tangent : hold.tangents)
        result[static_cast<std::size_t>(tangent.sample)] = true;
    return result;
}

/// The residual that a sample may have in any case: its tolerance, or a small part of the data's
/// size.
std::vector<double> least_residuals(const Problem& problem) {
    if (!problem.tolerance.empty()) return problem.tolerance;
    return std::vector<double>(static_cast<std::size_t>(problem.samples.size()),
                               1e-4 * problem.size);
}

/// A robust fit, its values at the samples, and which samples are far from it.
struct Judgement {
    Spline spline;
    PointSet fitted;
    double usual; ///< six times the residuals' scale
    std::vector<Index> outliers;
};

Judgement judge(const Problem& problem) {
    const Samples& samples = problem.samples;
    const Parameters parameters = robust_parameters(problem);
    const std::vector<double> least = least_residuals(problem);
    const std::vector<KnotVector> knots = robust_knots(problem, parameters);
    Judgement result{
        robust_spline(samples, parameters, knots, *std::ranges::min_element(least)), {}, 0, {}};
    result.fitted = fitted_values(result.spline, parameters);
    std::vector<double> residual;
    for (Index i = 0; i < samples.size(); ++i)
        residual.push_back(distance(samples.points[i], result.fitted[i]));
    const std::vector<double> near = problem.kind == SampleKind::cloud
                                         ? around(parameters, knots, residual)
                                         : around(samples, residual);
    result.usual = 6 * 1.4826 * median(residual);
    const std::vector<bool> held = protected_samples(samples, problem.options.hold);
    for (std::size_t i = 0; i < residual.size(); ++i)
        if (!held[i] && residual[i] > std::max({least[i], result.usual, 5 * near[i]}))
            result.outliers.push_back(static_cast<Index>(i));
    return result;
}

/// Far samples stretch the chords that parameters come from, and take neighbours along: fits
/// without those judged first tell which of all samples are far indeed.
std::vector<Index> confirmed(std::vector<Index> outliers, const Problem& problem) {
    const std::vector<double> least = least_residuals(problem);
    constexpr int most_rounds = 5;
    for (int round = 0; round < most_rounds && !outliers.empty(); ++round) {
        const Subset rest = Subset::without(outliers, problem.samples.size());
        if (rest.size() < 8) break;
        const Judgement now = judge(rest.of(problem));
        std::vector<Index> next;
        for (Index i : now.outliers) next.push_back(rest.original(i));
        if (now.spline.axis_count() < 3) {
            const Samples far =
                Subset::without(rest.kept(), problem.samples.size()).of(problem.samples);
            const std::vector<ClosestPoint> closest = closest_points(now.spline, far.points);
            for (std::size_t k = 0; k < outliers.size(); ++k)
                if (closest[k].distance >
                    std::max(least[static_cast<std::size_t>(outliers[k])], now.usual))
                    next.push_back(outliers[k]);
        }
        std::ranges::sort(next);
        if (next == outliers) break;
        outliers = std::move(next);
    }
    return outliers;
}

/// The grid's problem with the robust fit's values in the place of outliers.
Problem with_values(Problem problem, const std::vector<Index>& outliers, const PointSet& fitted) {
    PointSet points(problem.samples.points);
    for (Index i : outliers) {
        std::ranges::copy(fitted[i], points[i].begin());
        if (!problem.tolerance.empty())
            problem.tolerance[static_cast<std::size_t>(i)] =
                std::numeric_limits<double>::infinity();
    }
    problem.samples.points = std::move(points);
    problem.samples.notes.emplace_back(
        "samples set aside count as the robust fit's values in the grid's equations");
    return problem;
}

} // namespace

WithoutOutliers without_outliers(const Problem& problem) {
    Judgement first = judge(problem);
    const bool grid = problem.kind == SampleKind::grid;
    std::vector<Index> outliers =
        grid ? std::move(first.outliers) : confirmed(std::move(first.outliers), problem);
    if (outliers.empty()) return {problem, {}};
    if (grid) return {with_values(problem, outliers, first.fitted), std::move(outliers)};
    const Subset kept = Subset::without(outliers, problem.samples.size());
    return {problem_of(kept.of(problem.samples), kept.of(problem.options)), std::move(outliers)};
}

} // namespace batten
