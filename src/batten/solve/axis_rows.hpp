#pragma once

#include <batten/core/function_ref.hpp>
#include <batten/solve/banded_qr.hpp>

#include <span>
#include <vector>

namespace batten {

/// The rows of a smoothing problem along one axis: of each sample its B-splines times the root of
/// its weight, of the roughness its derivatives at the nodes of a quadrature that is exact.
class AxisRows {
  public:
    /// Writes the right-hand sides of a sample, not yet weighted.
    using Values = FunctionRef<void(Index sample, Extended* values)>;

    /// `weights` has one entry per sample or none; the parameters are any, in any order. Throws
    /// InvalidInput when one is outside an open domain.
    AxisRows(KnotVector knots, std::span<const double> parameters, std::span<const double> weights,
             int order);

    /// Sum of the weights.
    double total_weight() const { return total_weight_; }
    /// R of the samples' rows, of right-hand sides with so many columns.
    BandedQr reduced(Index columns, Values values) const;
    /// The same with the roughness's rows, times the root of `factor`, added to the samples'.
    BandedQr smoothed(const BandedQr& samples, double factor) const;

  private:
    struct Rough {
        ActiveFunctions derivatives;
        double weight; ///< of the node
    };
    BandedQr empty(Index columns) const;
    /// Rotates in the samples at places [begin, end) of the order.
    void add_samples(BandedQr& qr, std::size_t begin, std::size_t end, Values values) const;

    KnotVector knots_;
    std::span<const double> parameters_;
    std::span<const double> weights_;
    double total_weight_ = 0;
    std::vector<Index> order_; ///< the samples in the order of their rows' leading columns
    std::vector<Rough> rough_; ///< in the same order
};

} // namespace batten
