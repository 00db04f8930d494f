#pragma once

#include <batten/system/collocation.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// A normal system that is the Kronecker product of one banded matrix per axis: sequences (one
/// factor, with weights) and full grids of 2 or 3 axes (without).
class FactoredSystem : public NormalSystem {
  public:
    /// `parameters` of the whole data; samples follow through add().
    FactoredSystem(std::vector<KnotVector> axes, std::vector<double> centre,
                   const Parameters& parameters);

    /// Adds consecutive slices along axis 0, the first having index `first`: single samples of a
    /// sequence, rows or layers of a grid. `weights`: one per sample or none.
    void add(Index first, const Points& slices, std::span<const double> weights);
    /// Completes the right-hand side once all slices are in.
    void finish();

    void apply(const PointSet& x, PointSet& y) const override;
    std::vector<double> diagonal() const override;
    std::vector<const BandedMatrix*> factors() const override;

  private:
    std::vector<Collocation> collocations_;
    std::vector<BandedMatrix> grams_;
    Index slice_values_;             // doubles in one slice along axis 0
    std::vector<double> slices_sum_; // (n_0 x slice_values): A_0^T Q
};

} // namespace batten
