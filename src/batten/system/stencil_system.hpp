#pragma once

#include <batten/system/normal_system.hpp>

namespace batten {

/// The normal system of scattered samples over 1 to 3 axes: every control point couples with those
/// up to degree places away along each axis. Stored as half a stencil per control point.
class StencilSystem : public NormalSystem {
  public:
    StencilSystem(std::vector<KnotVector> axes, std::vector<double> centre);

    /// Adds samples with their parameters (m x axes) and weights (one each, or none).
    /// Throws InvalidInput when a parameter is outside the knots' domain.
    void add(const Points& points, const Points& parameters, std::span<const double> weights);

    void apply(const PointSet& x, PointSet& y) const override;
    std::vector<double> diagonal() const override;

    /// Calls `entry(row, column, value)` for the entries of the matrix, each pair of control points
    /// in one order or in both; entries for one place add up.
    template <class Entry>
    void for_each_entry(Entry entry) const;

  private:
    /// Row of control point `control` moved by stencil place `place`.
    Index neighbour(Index control, Index place) const;
    void add_sample(std::span<const double> point, const double* parameter, double weight);

    std::vector<Index> shape_;
    Index width_ = 1;      // places of the half stencil: (p_0 + 1) (2 p_1 + 1) (2 p_2 + 1)
    Index same_slice_ = 1; // places whose offset along axis 0 is zero; they hold both directions
    std::vector<double> stencil_; // (N x width)
    std::vector<std::array<Index, 3>> offsets_;
    std::vector<Index> flat_offsets_; // of the neighbours when no axis is closed
    bool any_closed_ = false;
};

template <class Entry>
void StencilSystem::for_each_entry(Entry entry) const {
    for (Index i = 0; i < size(); ++i)
        for (Index place = 0; place < width_; ++place) {
            const double value = stencil_[static_cast<std::size_t>(i * width_ + place)];
            if (value == 0) continue;
            const Index j = any_closed_ ? neighbour(i, place)
                                        : i + flat_offsets_[static_cast<std::size_t>(place)];
            entry(i, j, value);
            if (place >= same_slice_) entry(j, i, value);
        }
}

} // namespace batten
