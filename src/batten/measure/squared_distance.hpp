#pragma once

#include <batten/measure/bezier_net.hpp>

#include <optional>

namespace batten {

/// The squared length of a net's points as a polynomial in Bernstein form: its coefficients bound
/// it, their differences its slopes, so that what they show holds everywhere on the net.
class SquaredDistance {
  public:
    /// Takes the net's squared distance from the origin.
    void assign(const BezierNet& net, Index dim);

    /// Lower bound on the net.
    double least() const { return least_ - allowance_; }
    /// Where the smallest coefficient stands, 0 to 1 along each axis.
    PerAxis<double> least_at() const;
    /// Smallest value at a corner of the net, and the corner.
    double least_corner() const { return least_corner_; }
    const PerAxis<double>& corner() const { return corner_; }
    /// A face that holds the minimum because there is a direction that leads down to it
    /// everywhere.
    std::optional<Face> downhill_face() const;
    /// Whether it is strictly convex, with one local minimum at most: its Hessian is a mean of
    /// matrices that are all positive definite.
    bool is_convex();

  private:
    void square_points(const BezierNet& net, Index dim);
    void multiply(const BezierNet& net, Index dim);
    double least_curvature(std::size_t axis) const;
    void find_hessian();
    Index stride(std::size_t axis) const;

    PerAxis<Index> order_{}; // coefficients per axis
    std::vector<double> coefficients_;
    std::vector<double> scaled_; // control points times binomials
    std::vector<double> slope_;
    PerAxis<PerAxis<std::vector<double>>> hessian_; // its coefficients, on and above the diagonal
    double least_ = 0;
    Index least_index_ = 0;
    double allowance_ = 0; // bound of the rounding error of a coefficient
    double least_corner_ = 0;
    PerAxis<double> corner_{};
};

} // namespace batten
