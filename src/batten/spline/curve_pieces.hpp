#pragma once

#include <batten/spline/spline.hpp>

#include <array>
#include <vector>

namespace batten {

/// A curve's point and first two derivatives.
struct CurvePoint {
    std::array<double, 16> point;
    std::array<double, 16> first;
    std::array<double, 16> second;
};

/// A curve as polynomial pieces in powers of the distance from the piece's begin: many evaluations
/// at little cost.
class CurvePieces {
  public:
    CurvePieces(const KnotVector& knots, const PointSet& free_control);
    CurvePoint operator()(double t) const;

  private:
    int degree_;
    Index dim_;
    std::vector<double> breaks_;
    std::vector<double> coefficients_; // per piece (degree + 1) x dim
};

} // namespace batten
