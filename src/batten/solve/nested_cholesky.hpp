#pragma once

#include <batten/solve/factorization.hpp>
#include <batten/solve/net_dissection.hpp>

#include <vector>

namespace batten {

class OrderedEntries;

/// The most control points of a net, for so many axes, whose factor by nested dissection nobody has
/// to ask for: about a second's work, of surfaces a third of that of conjugate gradients (0.3 GB).
/// From there work grows as n^1.5 of surfaces, as n^2 of volumes.
inline Index most_dissected(std::size_t axes) {
    return axes > 2 ? 4000 : 1 << 16;
}

/// Cholesky's factor of a system's entries by nested dissection of its net, each part dense
/// [DuffReid1983].
class NestedCholesky : public Factorization {
  public:
    explicit NestedCholesky(const std::vector<KnotVector>& axes);
    /// The system is one over these axes, any number of them one after the other. Throws
    /// SolverError where a pivot is below 1e-14 of its diagonal entry.
    void factor(const NormalSystem& system);
    /// With the last system.
    PointSet solve(PointSet b) const override;

  private:
    NetDissection net_;
    /// Of each part: L of itself, then of its border, column by column.
    std::vector<std::vector<double>> columns_;
};

} // namespace batten
