#include <batten/robust/outliers.hpp>

#include <batten/measure/deviation.hpp>
#include <batten/problem/subset.hpp>
#include <batten/robust/robust_fit.hpp>
#include <batten/robust/sequence_outliers.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace batten {

namespace {

double upper_quartile(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<Index>(values.size() * 3 / 4);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// What three quarters of the samples around each one have at most: up to 2 places away along a
/// grid's axes. A crease is a quarter of them.
std::vector<double> around(const Samples& samples, const std::vector<double>& residual) {
    const GridIndex grid(samples.shape());
    constexpr Index reach = 2;
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
        result[static_cast<std::size_t>(i)] = upper_quartile(std::move(values));
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
    std::map<std::array<Index, 3>, double> quartile;
    for (auto& [cell, values] : cells) quartile[cell] = upper_quartile(std::move(values));
    std::vector<double> result;
    for (Index i = 0; i < m; ++i) result.push_back(quartile[cell_of(i)]);
    return result;
}

/// What a sample may be off in any case: its tolerance, or a small part of the data's size;
/// anything where something is to hold.
std::vector<double> least_residuals(const Problem& problem) {
    std::vector<double> least = problem.tolerance;
    if (least.empty())
        least.assign(static_cast<std::size_t>(problem.samples.size()), 1e-4 * problem.size);
    constexpr double free = std::numeric_limits<double>::infinity();
    const HoldOptions& hold = problem.options.hold;
    for (Index i : hold.interpolate) least[static_cast<std::size_t>(i)] = free;
    for (const HeldTangent& tangent : hold.tangents)
        least[static_cast<std::size_t>(tangent.sample)] = free;
    return least;
}

/// The samples along an axis; numbers become points over their parameters.
PointSet points_along(const Problem& problem, std::size_t axis, const GridIndex::Strand& strand) {
    const Points& q = problem.samples.points;
    const bool numbers = q.dim() == 1;
    const std::vector<double>& t = problem.parameters.axes[axis];
    PointSet result(strand.count, q.dim() + (numbers ? 1 : 0));
    for (Index j = 0; j < strand.count; ++j) {
        std::ranges::copy(q[strand[j]], result[j].begin());
        if (numbers) result(j, 1) = problem.size * (t[static_cast<std::size_t>(j)] - t.front());
    }
    return result;
}

/// Along how many axes of enough samples each sample of a sequence or grid disagrees with its
/// neighbours.
struct Disagreement {
    std::vector<int> axes;
    int most = 0;
};

Disagreement disagreement(const Problem& problem) {
    const std::vector<double> least = least_residuals(problem);
    const GridIndex grid(problem.samples.shape());
    Disagreement result{std::vector<int>(least.size(), 0)};
    for (std::size_t k = 0; k < grid.axis_count(); ++k) {
        if (grid.length(k) < fewest_in_sequence) continue;
        ++result.most;
        std::vector<GridIndex::Strand> strands;
        grid.for_each_strand(k,
                             [&](const GridIndex::Strand& strand) { strands.push_back(strand); });
        for_each_chunk(static_cast<Index>(strands.size()), [&](Index s) {
            const GridIndex::Strand& strand = strands[static_cast<std::size_t>(s)];
            std::vector<double> theirs;
            for (Index j = 0; j < strand.count; ++j)
                theirs.push_back(least[static_cast<std::size_t>(strand[j])]);
            for (Index j : sequence_outliers(points_along(problem, k, strand),
                                             problem.axes.closures[k], theirs))
                ++result.axes[static_cast<std::size_t>(strand[j])];
        });
    }
    return result;
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
    for (std::size_t i = 0; i < residual.size(); ++i)
        if (residual[i] > std::max({least[i], result.usual, 5 * near[i]}))
            result.outliers.push_back(static_cast<Index>(i));
    return result;
}

/// Far samples of a cloud take neighbours along: fits without those judged first tell which of all
/// samples are far indeed.
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

/// A curve's outliers disagree with their neighbours.
std::vector<Index> of_sequence(const Problem& problem) {
    const Disagreement disagree = disagreement(problem);
    std::vector<Index> result;
    for (std::size_t i = 0; i < disagree.axes.size(); ++i)
        if (disagree.axes[i] > 0) result.push_back(static_cast<Index>(i));
    return result;
}

/// A grid's disagree along all axes, or along one and are far from the robust fit, which bends
/// where outliers are at its edge.
std::vector<Index> of_grid(const Problem& problem, const std::vector<Index>& far) {
    const Disagreement disagree = disagreement(problem);
    if (disagree.most == 0) return far;
    std::vector<Index> result;
    for (std::size_t i = 0; i < disagree.axes.size(); ++i) {
        const int axes = disagree.axes[i];
        if (axes == disagree.most ||
            (axes > 0 && std::ranges::binary_search(far, static_cast<Index>(i))))
            result.push_back(static_cast<Index>(i));
    }
    return result;
}

} // namespace

WithoutOutliers without_outliers(const Problem& problem) {
    if (problem.kind == SampleKind::grid) {
        const Judgement first = judge(problem);
        std::vector<Index> outliers = of_grid(problem, first.outliers);
        if (outliers.empty()) return {problem, {}};
        return {with_values(problem, outliers, first.fitted), std::move(outliers)};
    }
    std::vector<Index> outliers = problem.kind == SampleKind::sequence
                                      ? of_sequence(problem)
                                      : confirmed(judge(problem).outliers, problem);
    if (outliers.empty()) return {problem, {}};
    const Subset kept = Subset::without(outliers, problem.samples.size());
    return {problem_of(kept.of(problem.samples), kept.of(problem.options)), std::move(outliers)};
}

} // namespace batten
