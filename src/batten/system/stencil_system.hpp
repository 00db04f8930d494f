#pragma once

#include <batten/system/normal_system.hpp>

namespace batten {

/// The normal system of scattered samples over 1 to 3 axes: every control point couples with those
/// up to degree places away along each axis. Stored as half a stencil per control point.
class StencilSystem : public NormalSystem {
  public:
    StencilSystem(std::vector<KnotVector> axes, std::vector<double> centre);

    /// Adds samples with their parameters (m x axes), in any order, and weights (one each, or
    /// none). Over two axes the samples are sorted by cell and each cell is taken from its moments.
    /// Throws InvalidInput when a parameter is outside the knots' domain.
    void add(const Points& points, const Points& parameters, std::span<const double> weights);

    void apply(const PointSet& x, PointSet& y) const override;
    std::vector<double> diagonal() const override;
    void add_roughness(double lambda, int order) override;

    /// Per axis the matrix sum of w b b^T of the samples' B-splines on that axis alone: their
    /// Kronecker product over total_weight() comes near A^T D A when the samples are spread evenly.
    const std::vector<BandedMatrix>& axis_grams() const { return axis_grams_; }
    double total_weight() const { return total_weight_; }

    /// Calls `entry(row, column, value)` for the entries of the matrix; entries for one place add
    /// up.
    template <class Entry>
    void for_each_entry(Entry entry) const;

  private:
    struct CellSums;
    /// Row of control point `control` moved by stencil place `place`.
    Index neighbour(Index control, Index place) const;
    double& at(Index place, Index control) {
        return stencil_[static_cast<std::size_t>(place * size() + control)];
    }
    void add_sample(std::span<const double> point, const double* parameter, double weight);
    void add_cells(const Points& points, const Points& parameters, std::span<const double> weights);
    void add_product(double factor, const std::vector<BandedMatrix>& matrices);
    void merge(const CellSums& sums);
    void apply_plane(const double* x, double* y) const;

    std::vector<Index> shape_;
    Index width_ = 1;      // places of the half stencil: (p_0 + 1) (2 p_1 + 1) (2 p_2 + 1)
    Index same_slice_ = 1; // places whose offset along axis 0 is zero; they hold both directions
    std::vector<double> stencil_; // (width x N)
    std::vector<std::array<Index, 3>> offsets_;
    std::vector<Index> flat_offsets_; // of the neighbours when no axis is closed
    bool any_closed_ = false;
    std::vector<BandedMatrix> axis_grams_;
    double total_weight_ = 0;
};

template <class Entry>
void StencilSystem::for_each_entry(Entry entry) const {
    for (Index place = 0; place < width_; ++place)
        for (Index i = 0; i < size(); ++i) {
            const double value = stencil_[static_cast<std::size_t>(place * size() + i)];
            if (value == 0) continue;
            const Index j = any_closed_ ? neighbour(i, place)
                                        : i + flat_offsets_[static_cast<std::size_t>(place)];
            entry(i, j, value);
            if (place >= same_slice_) entry(j, i, value);
        }
}

} // namespace batten
