#pragma once

#include <batten/system/collocation.hpp>
#include <batten/system/normal_system.hpp>
#include <batten/system/system_sums.hpp>

namespace batten {

/// A normal system whose matrix is the Kronecker product of one banded matrix per axis.
class FactoredSystem : public NormalSystem {
  public:
    /// The one that these sums, which have factors, belong to.
    explicit FactoredSystem(SystemSums sums);

    std::unique_ptr<NormalSystem> clone() const override {
        return std::make_unique<FactoredSystem>(*this);
    }
    SystemSums sums() const override;
    void apply(const PointSet& x, PointSet& y) const override;
    std::vector<double> diagonal() const override;
    void for_each_entry(EntryVisitor visit) const override;
    std::vector<const BandedMatrix*> factors() const override;
    void add_roughness(double lambda, int order) override;

  protected:
    FactoredSystem(std::vector<KnotVector> axes, std::vector<double> centre);

    std::vector<BandedMatrix> grams_; // one per axis
};

/// What a chunk of samples adds to the normal system of a sequence, span by span.
struct SpanSums {
    std::vector<Index> spans;
    std::vector<double> grams; ///< per span the pairs (i, j), i <= j
    std::vector<double> rhs;   ///< per span (p + 1) x dim
    double energy = 0;
    /// Ascending parameters, all that differ or enough of each span: they determine as many control
    /// points as all do (undetermined).
    std::vector<double> telling;
    Index samples = 0;
};

/// The normal system of a sequence: one banded matrix, built in one pass from the moments of each
/// knot span.
class BandedSystem : public FactoredSystem {
  public:
    BandedSystem(const KnotVector& knots, std::vector<double> centre);

    /// Adds samples at ascending parameters, with one weight each or none. Chunks may follow each
    /// other in any number; for equal bits the same data must come in the same chunks. Throws
    /// InvalidInput when a parameter is outside an open domain.
    void add(std::span<const double> parameters, const Points& points,
             std::span<const double> weights);
    /// The same in two steps, so that chunks can be summed on several threads: samples (count x
    /// dim) at so many ascending parameters, `weights` null where all are one; sums to be added in
    /// the samples' order.
    void sum(std::span<const double> parameters, const double* points, const double* weights,
             SpanSums& sums) const;
    void add(const SpanSums& sums);

    std::unique_ptr<NormalSystem> clone() const override {
        return std::make_unique<BandedSystem>(*this);
    }
};

/// The normal system of a full grid of unit weights along 2 or 3 axes: the Kronecker product of one
/// banded matrix per axis.
class KroneckerSystem : public FactoredSystem {
  public:
    /// `parameters` of the whole grid; samples follow through add().
    KroneckerSystem(std::vector<KnotVector> axes, std::vector<double> centre,
                    const Parameters& parameters);

    /// Adds consecutive rows or layers along axis 0, the first having index `first`.
    void add(Index first, const Points& slices);
    /// Completes the right-hand side once all slices are in.
    void finish();

    std::unique_ptr<NormalSystem> clone() const override {
        return std::make_unique<KroneckerSystem>(*this);
    }

  private:
    std::vector<Collocation> collocations_;
    Index slice_values_; // doubles in one slice along axis 0
    std::vector<double> slice_centre_;
    std::vector<double> slices_sum_; // (n_0 x slice_values): A_0^T Q
};

} // namespace batten
