#include <batten/robust/cloud_lengths.hpp>

#include <batten/core/vectors.hpp>
#include <batten/samples/samples.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>

namespace batten {

namespace {

std::vector<double> mean_of(const Points& points) {
    std::vector<double> sum(static_cast<std::size_t>(points.dim()), 0);
    for (Index i = 0; i < points.size(); ++i)
        add_scaled(sum.data(), 1, points[i].data(), points.dim());
    for (double& x : sum) x /= static_cast<double>(points.size());
    return sum;
}

/// By how much points change with each parameter: (axes x dim), by least squares.
Eigen::MatrixXd slopes(const Points& points, const Points& places) {
    const std::vector<double> mean = mean_of(points);
    const std::vector<double> centre = mean_of(places);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(places.dim(), places.dim());
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(places.dim(), points.dim());
    for (Index i = 0; i < points.size(); ++i)
        for (Index a = 0; a < places.dim(); ++a) {
            const double x = places(i, a) - centre[static_cast<std::size_t>(a)];
            for (Index b = 0; b < places.dim(); ++b)
                normal(a, b) += x * (places(i, b) - centre[static_cast<std::size_t>(b)]);
            for (Index d = 0; d < points.dim(); ++d)
                right(a, d) += x * (points(i, d) - mean[static_cast<std::size_t>(d)]);
        }
    return normal.ldlt().solve(right);
}

/// Length of the data along a parameter, in parts of its own: of the polyline through the means of
/// what is in each of its sixteenths, without what changes with the other parameters.
double length_along(const Points& points, const Points& places, Index axis, const PointSet& box,
                    const Eigen::MatrixXd& slope) {
    constexpr Index parts = 16;
    const double low = box(0, axis);
    const double high = box(1, axis);
    if (!(high > low)) return 0;
    PointSet mean(parts, points.dim());
    std::array<double, parts> count{};
    for (Index i = 0; i < places.size(); ++i) {
        const Index k =
            std::min(parts - 1, static_cast<Index>((places(i, axis) - low) / (high - low) * parts));
        ++count[static_cast<std::size_t>(k)];
        for (Index d = 0; d < points.dim(); ++d) {
            double value = points(i, d);
            for (Index other = 0; other < places.dim(); ++other)
                if (other != axis) value -= slope(other, d) * places(i, other);
            mean(k, d) += value;
        }
    }
    Index last = -1;
    double length = 0;
    for (Index k = 0; k < parts; ++k) {
        if (!(count[static_cast<std::size_t>(k)] > 0)) continue;
        for (double& x : mean[k]) x /= count[static_cast<std::size_t>(k)];
        if (last >= 0) length += distance(std::as_const(mean)[k], std::as_const(mean)[last]);
        last = k;
    }
    return length / (high - low);
}

} // namespace

Points places_in_lengths(const Points& points, const Points& places) {
    if (points.dim() < std::max<Index>(2, places.dim())) return places;
    const Eigen::MatrixXd slope = slopes(points, places);
    if (!slope.allFinite()) return places;
    const PointSet box = bounding_box(places);
    PointSet result(places);
    for (Index axis = 0; axis < places.dim(); ++axis) {
        const double length = length_along(points, places, axis, box, slope);
        if (!(length > 0)) return places;
        for (Index i = 0; i < places.size(); ++i) result(i, axis) *= length;
    }
    return result;
}

} // namespace batten
