#include <batten/robust/outliers.hpp>

#include <batten/measure/deviation.hpp>
#include <batten/problem/subset.hpp>
#include <batten/robust/neighbour_outliers.hpp>
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

/// What three quarters of the samples in the same cell of the knots have at most.
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

/// Where samples are along an axis, if that does not depend on the samples; of numbers without
/// stated parameters evenly, for they have no lengths.
std::vector<double> known_places(const Problem& problem, std::size_t axis) {
    const ShapeOptions& shape = problem.options.shape;
    if (shape.parameters || shape.parametrization == Parametrization::uniform ||
        problem.samples.spacing == Spacing::even)
        return problem.parameters.axes[axis];
    if (problem.samples.dim() > 1) return {};
    const Index m = problem.samples.shape()[axis];
    std::vector<double> even;
    for (Index i = 0; i < m; ++i) even.push_back(static_cast<double>(i) / static_cast<double>(m));
    return even;
}

/// A robust fit, its values at the samples, and which samples are far from it.
struct Judgement {
    Spline spline;
    double usual; ///< six times the residuals' scale
    std::vector<Index> outliers;
};

Judgement judge(const Problem& problem) {
    const Samples& samples = problem.samples;
    const Parameters& parameters = problem.parameters;
    const std::vector<double> least = least_residuals(problem);
    const std::vector<KnotVector> knots = robust_knots(problem, parameters);
    Judgement result{
        robust_spline(samples, parameters, knots, *std::ranges::min_element(least)), 0, {}};
    const PointSet fitted = evaluate(result.spline, parameters.scattered);
    std::vector<double> residual;
    for (Index i = 0; i < samples.size(); ++i)
        residual.push_back(distance(samples.points[i], fitted[i]));
    const std::vector<double> near = around(parameters, knots, residual);
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

/// The grid's problem with what neighbours predict in the place of outliers.
Problem with_values(Problem problem, const NeighbourOutliers& outliers) {
    PointSet points(problem.samples.points);
    for (std::size_t k = 0; k < outliers.samples.size(); ++k) {
        const Index i = outliers.samples[k];
        std::ranges::copy(outliers.predicted[static_cast<Index>(k)], points[i].begin());
        if (!problem.tolerance.empty())
            problem.tolerance[static_cast<std::size_t>(i)] =
                std::numeric_limits<double>::infinity();
    }
    problem.samples.points = std::move(points);
    problem.samples.notes.emplace_back(
        "samples set aside count as what their neighbours predict in the grid's equations");
    return problem;
}

NeighbourOutliers of_grid(const Problem& problem) {
    std::vector<std::vector<double>> along;
    for (std::size_t k = 0; k < problem.axes.count(); ++k)
        along.push_back(known_places(problem, k));
    return neighbour_outliers(Trusted(problem.samples.points, GridIndex(problem.samples.shape()),
                                      problem.axes.closures, std::move(along)),
                              least_residuals(problem));
}

} // namespace

WithoutOutliers without_outliers(const Problem& problem) {
    if (problem.kind == SampleKind::grid) {
        NeighbourOutliers outliers = of_grid(problem);
        if (outliers.samples.empty()) return {problem, {}};
        return {with_values(problem, outliers), std::move(outliers.samples)};
    }
    std::vector<Index> outliers =
        problem.kind == SampleKind::sequence
            ? sequence_outliers(problem.samples.points, problem.axes.closures[0],
                                least_residuals(problem), known_places(problem, 0))
            : confirmed(judge(problem).outliers, problem);
    if (outliers.empty()) return {problem, {}};
    const Subset kept = Subset::without(outliers, problem.samples.size());
    return {problem_of(kept.of(problem.samples), kept.of(problem.options)), std::move(outliers)};
}

} // namespace batten
