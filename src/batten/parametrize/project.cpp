#include <batten/parametrize/project.hpp>

#include <Eigen/Dense>
#include <array>
#include <fmt/format.h>

namespace batten {

namespace {

using Direction = std::array<double, 3>;

/// Two axes of the points' best plane: the directions of greatest spread.
std::array<Direction, 2> best_plane(const Points& points) {
    const auto m = static_cast<double>(points.size());
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (Index i = 0; i < points.size(); ++i)
        for (Index d = 0; d < 3; ++d) mean[d] += points(i, d) / m;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (Index i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d p(points(i, 0) - mean[0], points(i, 1) - mean[1],
                                points(i, 2) - mean[2]);
        spread += p * p.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    std::array<Direction, 2> axes;
    for (int k = 0; k < 2; ++k) {
        Eigen::Vector3d v = solver.eigenvectors().col(2 - k);
        Index largest = 0;
        v.cwiseAbs().maxCoeff(&largest);
        if (v[largest] < 0) v = -v; // the same sign on every machine
        axes[static_cast<std::size_t>(k)] = {v[0], v[1], v[2]};
    }
    return axes;
}

} // namespace

PointSet plane_coordinates(const Samples& samples, Projection projection) {
    const Points& points = samples.points;
    const Index needed = projection == Projection::xy ? 2 : 3;
    if (points.dim() < needed || (projection == Projection::plane && points.dim() != 3))
        throw InvalidInput(fmt::format("project: points of dimension {} are needed, got {}", needed,
                                       points.dim()));
    constexpr Direction x{1, 0, 0};
    constexpr Direction y{0, 1, 0};
    constexpr Direction z{0, 0, 1};
    std::array<Direction, 2> axes{x, y};
    if (projection == Projection::xz) axes = {x, z};
    if (projection == Projection::yz) axes = {y, z};
    if (projection == Projection::plane) axes = best_plane(points);
    PointSet result(points.size(), 2);
    for (Index i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < 2; ++k)
            for (Index d = 0; d < std::min<Index>(points.dim(), 3); ++d)
                result(i, static_cast<Index>(k)) +=
                    axes[k][static_cast<std::size_t>(d)] * points(i, d);
    return result;
}

Parameters projected(const Samples& samples, Projection projection) {
    Parameters result;
    result.scattered = plane_coordinates(samples, projection);
    const PointSet box = bounding_box(result.scattered);
    for (Index k = 0; k < 2; ++k) {
        const double length = box(1, k) - box(0, k);
        if (!(length > 0))
            throw InvalidInput(
                fmt::format("project: the points have no extent along axis {} of the plane", k));
        for (Index i = 0; i < samples.size(); ++i)
            result.scattered(i, k) = (result.scattered(i, k) - box(0, k)) / length;
    }
    return result;
}

} // namespace batten
