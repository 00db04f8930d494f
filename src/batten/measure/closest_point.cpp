#include <batten/measure/closest_search.hpp>
#include <batten/measure/deviation.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

// samples that follow one another through one search, each from where the one before ended: fixed,
// so that the number of threads changes nothing
constexpr Index chunk_size = 512;

bool is_finite(double x) {
    return std::isfinite(x);
}

void check(const Spline& spline, const Points& points) {
    if (points.dim() != spline.dim())
        throw InvalidInput(fmt::format("the points have dimension {}, the spline has {}",
                                       points.dim(), spline.dim()));
    for (Index i = 0; i < points.size(); ++i)
        if (!std::ranges::all_of(points[i], is_finite))
            throw InvalidInput(fmt::format("point {} has a coordinate that is not finite", i));
    for (Index i = 0; i < spline.control_points().size(); ++i)
        if (!std::ranges::all_of(spline.control_points()[i], is_finite))
            throw InvalidInput(
                fmt::format("control point {} has a coordinate that is not finite", i));
}

/// Calls take(pieces, i, found) for every point; start(pieces, i) is where its search begins.
template <class Start, class Take>
void search_all(const Spline& spline, const Points& points, const Start& start, const Take& take) {
    check(spline, points);
    const BezierPieces pieces(spline);
    const PieceTree tree(pieces);
    for_each_chunk((points.size() + chunk_size - 1) / chunk_size, [&](Index chunk) {
        ClosestSearch search(pieces, tree);
        const Index end = std::min(points.size(), (chunk + 1) * chunk_size);
        for (Index i = chunk * chunk_size; i < end; ++i)
            take(pieces, i, search(points[i], start(pieces, i)));
    });
}

std::optional<PlaceInPiece> where_the_last_ended(const BezierPieces&, Index) {
    return std::nullopt;
}

/// The parameters of sample i of a sequence, a grid or a cloud.
std::array<double, 3> own_parameter(const Parameters& parameters, Index i) {
    std::array<double, 3> t{};
    if (parameters.is_scattered()) {
        std::ranges::copy(parameters.scattered[i], t.begin());
        return t;
    }
    for (std::size_t a = parameters.axes.size(); a-- > 0;) {
        const auto m = static_cast<Index>(parameters.axes[a].size());
        t[a] = parameters.axes[a][static_cast<std::size_t>(i % m)];
        i /= m;
    }
    return t;
}

Index count_of(const Parameters& parameters) {
    return parameters.is_scattered() ? parameters.scattered.size() : parameters.grid().size();
}

} // namespace

std::vector<ClosestPoint> closest_points(const Spline& spline, const Points& points) {
    std::vector<ClosestPoint> result(static_cast<std::size_t>(points.size()));
    search_all(
        spline, points, where_the_last_ended,
        [&](const BezierPieces& pieces, Index i, const ClosestSearch::Found& found) {
            result[static_cast<std::size_t>(i)] = {pieces.parameter(found.place), found.distance};
        });
    return result;
}

std::vector<double> closest_distances(const Spline& spline, const Points& points) {
    std::vector<double> result(static_cast<std::size_t>(points.size()));
    search_all(spline, points, where_the_last_ended,
               [&](const BezierPieces&, Index i, const ClosestSearch::Found& found) {
                   result[static_cast<std::size_t>(i)] = found.distance;
               });
    return result;
}

std::vector<double> closest_distances(const Spline& spline, const Samples& samples,
                                      const Parameters& starts) {
    if (starts.axis_count() != spline.axis_count() || count_of(starts) != samples.size())
        throw InvalidInput(fmt::format("{} parameters of {} axes given for {} samples and {} axes",
                                       count_of(starts), starts.axis_count(), samples.size(),
                                       spline.axis_count()));
    std::vector<double> result(static_cast<std::size_t>(samples.size()));
    search_all(
        spline, samples.points,
        [&](const BezierPieces& pieces, Index i) {
            const std::array<double, 3> t = own_parameter(starts, i);
            return std::optional(
                pieces.place({t.data(), static_cast<std::size_t>(spline.axis_count())}));
        },
        [&](const BezierPieces&, Index i, const ClosestSearch::Found& found) {
            result[static_cast<std::size_t>(i)] = found.distance;
        });
    return result;
}

} // namespace batten
