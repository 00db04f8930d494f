#pragma once

#include <batten/parametrize/parametrize.hpp>
#include <batten/solve/axis_rows.hpp>
#include <batten/solve/factorization.hpp>

namespace batten {

/// What a fit of a sequence, or of a grid of unit weights, minimises, as rows in place of their
/// normal equations.
struct SampleRows {
    const Samples& samples;
    const Parameters& parameters;
    double lambda = 0; ///< factor of the roughness, as NormalSystem::add_roughness takes it
    int order = 2;
};

/// Orthogonal factors of the rows, axis by axis.
class RowFactorization : public Factorization {
  public:
    /// Coordinates are relative to `centre`.
    RowFactorization(const std::vector<KnotVector>& axes, const SampleRows& rows,
                     const std::vector<double>& centre);

    /// The least-squares control points (N x dim). Throws SolverError where rows do not determine
    /// them.
    PointSet solution() const;
    PointSet solve(PointSet b) const override;
    std::unique_ptr<BandedSaddle> bordered(const Constraints& constraints) const override;

    const std::vector<AxisRows>& rows() const { return rows_; }
    const std::vector<BandedQr>& axes() const { return axes_; }
    const GridIndex& controls() const { return controls_; }
    Index dim() const { return dim_; }
    /// The samples' rotated coordinates, (N x dim), and the sum of the squares that no control
    /// points take away.
    const std::vector<Extended>& rotated() const { return rotated_; }
    Extended left_over() const { return left_over_; }

  private:
    void reduce(std::size_t axis, double factor, const SampleRows& rows,
                const std::vector<double>& centre);

    std::vector<AxisRows> rows_;
    std::vector<BandedQr> axes_;
    GridIndex controls_;
    Index dim_;
    std::vector<Extended> rotated_; // reduced along the axes so far
    Extended left_over_ = 0;
};

} // namespace batten
