#pragma once

#include <batten/system/normal_system.hpp>
#include <batten/system/system_sums.hpp>

namespace batten {

/// The normal system of scattered samples over 1 to 3 axes: every control point couples with those
/// up to degree places away along each axis. Stored as half a stencil per control point.
class StencilSystem : public NormalSystem {
  public:
    StencilSystem(std::vector<KnotVector> axes, std::vector<double> centre);
    /// The one that these sums belong to; a product of factors is spelled out.
    explicit StencilSystem(SystemSums sums);

    /// Adds samples with their parameters (m x axes), in any order, and weights (one each, or
    /// none). Over two axes the samples are sorted by cell and each cell is taken from its moments.
    /// Throws InvalidInput when a parameter is outside the knots' domain.
    void add(const Points& points, const Points& parameters, std::span<const double> weights);

    /// Makes the samples those of a grid with these parameters, whose roughness is a grid's.
    void set_grid(const Parameters& grid);

    std::unique_ptr<NormalSystem> clone() const override {
        return std::make_unique<StencilSystem>(*this);
    }
    SystemSums sums() const override;
    void apply(const PointSet& x, PointSet& y) const override;
    std::vector<double> diagonal() const override;
    void for_each_entry(EntryVisitor visit) const override;
    /// Per axis the matrix of the samples' B-splines on that axis alone, all but the first over the
    /// total weight: their product comes near A^T D A when the samples are spread evenly.
    std::vector<BandedMatrix> nearby_factors() const override;
    bool of_grid() const override { return !grid_means_.empty(); }
    void add_roughness(double lambda, int order) override;
    /// Adds the thin-plate roughness, the integral over the axes' unit intervals of the squared
    /// derivatives of total order `order`, mixed ones as often as they have orders: of two axes and
    /// order 2 |S_uu|^2 + 2 |S_uv|^2 + |S_vv|^2.
    void add_thin_plate(int order);
    /// Adds to the diagonal, one number per control point; those marked (not 0) in `held` are
    /// decoupled from all others, with 1 on the diagonal.
    void add_diagonal(const std::vector<double>& values, const std::vector<char>& held);

  private:
    struct CellSums;
    /// for_each_entry without a call per entry.
    template <class Visit>
    void visit_entries(Visit visit) const;
    /// Row of control point `control` moved by stencil place `place`.
    Index neighbour(Index control, Index place) const;
    double& at(Index place, Index control) {
        return stencil_[static_cast<std::size_t>(place * size() + control)];
    }
    void add_sample(std::span<const double> point, const double* parameter, double weight);
    void add_cells(const Points& points, const Points& parameters, std::span<const double> weights);
    void add_product(double factor, const std::vector<BandedMatrix>& matrices);
    Index coupled(Index control, Index place) const {
        return any_closed_ ? neighbour(control, place)
                           : control + flat_offsets_[static_cast<std::size_t>(place)];
    }
    void merge(const CellSums& sums);
    void apply_plane(const double* x, double* y) const;

    GridIndex places_; // of the half stencil: (p_0 + 1) x (2 p_1 + 1) x (2 p_2 + 1)
    Index same_slice_; // places whose offset along axis 0 is zero; they hold both directions
    std::vector<double> stencil_; // (places x N)
    std::vector<GridIndex::Place> offsets_;
    std::vector<Index> flat_offsets_; // of the neighbours when no axis is closed
    std::vector<Index>
        active_places_; // of a sample's active functions, the first of them at place 0
    bool any_closed_ = false;
    std::vector<BandedMatrix> axis_grams_;
    std::vector<BandedMatrix> grid_means_; // of products of B-splines at a grid's parameters
    double total_weight_ = 0;
};

template <class Visit>
void StencilSystem::visit_entries(Visit visit) const {
    for (Index place = 0; place < places_.size(); ++place)
        for (Index i = 0; i < size(); ++i) {
            const double value = stencil_[static_cast<std::size_t>(place * size() + i)];
            if (value == 0) continue;
            const Index j = coupled(i, place);
            visit(i, j, value);
            if (place >= same_slice_) visit(j, i, value);
        }
}

} // namespace batten
