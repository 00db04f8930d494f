#include <batten/robust/outliers.hpp>

#include <batten/problem/subset.hpp>
#include <batten/robust/cloud_outliers.hpp>
#include <batten/robust/neighbour_outliers.hpp>
#include <batten/robust/sequence_outliers.hpp>
#include <batten/robust/suspects.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <limits>

namespace batten {

namespace {

/// What a sample may be off in any case: its tolerance, or a small part of the data's size, of a
/// cloud a larger one, for scattered neighbours tell less; anything where something is to hold.
std::vector<double> least_residuals(const Problem& problem) {
    std::vector<double> least = problem.tolerance;
    if (least.empty())
        least.assign(static_cast<std::size_t>(problem.samples.size()),
                     (problem.kind == SampleKind::cloud ? 1e-5 : 1e-9) * problem.size);
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
    return counted(problem.samples.shape()[axis]);
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

/// Steps along an axis of a grid of points: the medians of their lengths, summed up, so that no
/// outlier counts.
std::vector<double> median_lengths(const Problem& problem, std::size_t axis) {
    const Points& points = problem.samples.points;
    const GridIndex grid(problem.samples.shape());
    const Index stride = grid.stride(axis);
    std::vector<std::vector<double>> steps(static_cast<std::size_t>(grid.length(axis)));
    for (Index i = 0; i < points.size(); ++i)
        if (const Index k = i / stride % grid.length(axis); k > 0)
            steps[static_cast<std::size_t>(k)].push_back(distance(points[i], points[i - stride]));
    std::vector<double> along{0};
    for (std::size_t k = 1; k < steps.size(); ++k)
        along.push_back(along.back() + median(std::move(steps[k])));
    return along;
}

/// The parameters of a grid's samples (m x axes), each by itself.
PointSet places_of_grid(const Problem& problem) {
    const GridIndex grid(problem.samples.shape());
    PointSet places(problem.samples.size(), static_cast<Index>(grid.axis_count()));
    for (std::size_t axis = 0; axis < grid.axis_count(); ++axis) {
        std::vector<double> along = known_places(problem, axis);
        if (along.empty()) along = median_lengths(problem, axis);
        for (Index i = 0; i < places.size(); ++i)
            places(i, static_cast<Index>(axis)) =
                along[static_cast<std::size_t>(i / grid.stride(axis) % grid.length(axis))];
    }
    return places;
}

/// Of a small grid as of a cloud, for what is all around a sample knows more of it than a line; a
/// larger one's lines know enough.
NeighbourOutliers of_grid(const Problem& problem) {
    constexpr Index small = 5000;
    if (problem.samples.size() <= small)
        return cloud_outliers(problem.samples.points, places_of_grid(problem),
                              least_residuals(problem));
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
            : cloud_outliers(problem.samples.points, problem.parameters.scattered,
                             least_residuals(problem))
                  .samples;
    if (outliers.empty()) return {problem, {}};
    const Subset kept = Subset::without(outliers, problem.samples.size());
    return {problem_of(kept.of(problem.samples), kept.of(problem.options)), std::move(outliers)};
}

} // namespace batten
