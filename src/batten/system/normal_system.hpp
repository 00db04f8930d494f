#pragma once

#include <batten/core/function_ref.hpp>
#include <batten/parametrize/parametrize.hpp>
#include <batten/spline/spline.hpp>
#include <batten/system/banded_matrix.hpp>

#include <memory>
#include <vector>

namespace batten {

struct SystemSums;

/// The normal equations A^T D A P = A^T D Q of a weighted least-squares fit, D the sample weights.
///
/// Built in one pass over the samples; afterwards everything costs O(control points). Coordinates
/// are relative to centre(), as B-splines sum to one a shift of data and control points changes
/// nothing else.
class NormalSystem {
  public:
    /// What is called with the row, column and value of an entry.
    using EntryVisitor = FunctionRef<void(Index row, Index column, double value)>;

    virtual ~NormalSystem() = default;
    NormalSystem& operator=(const NormalSystem&) = delete;
    /// An independent copy, to add roughness to.
    virtual std::unique_ptr<NormalSystem> clone() const = 0;
    /// The sums over the samples that it consists of (system/system_sums.hpp), without their box.
    /// Throws InvalidInput for a system that is not one of samples.
    virtual SystemSums sums() const;

    /// Free control points N of the spline.
    Index size() const { return controls_.size(); }
    /// How they lie over the axes.
    const GridIndex& controls() const { return controls_; }
    Index dim() const { return rhs_.dim(); }
    /// A^T D (Q - centre): (N x dim).
    const PointSet& rhs() const { return rhs_; }
    const std::vector<double>& centre() const { return centre_; }
    const std::vector<KnotVector>& axes() const { return axes_; }

    /// y = A^T D A x; x and y (N x dim) for any dim.
    virtual void apply(const PointSet& x, PointSet& y) const = 0;
    /// Diagonal of A^T D A.
    virtual std::vector<double> diagonal() const = 0;
    /// Calls `visit` for the entries of A^T D A that may differ from zero, those above the diagonal
    /// and those below; entries told for one place add up to the matrix's.
    virtual void for_each_entry(EntryVisitor visit) const = 0;
    /// The banded factors whose Kronecker product A^T D A is, one per axis; none where it is not
    /// such a product.
    virtual std::vector<const BandedMatrix*> factors() const { return {}; }
    /// Of a system without factors: banded matrices, one per axis, whose Kronecker product comes
    /// near A^T D A, to precondition with; empty where none are known.
    virtual std::vector<BandedMatrix> nearby_factors() const { return {}; }

    /// Whether the samples are a grid's, whose roughness is a product.
    virtual bool of_grid() const { return false; }

    /// Adds lambda times the roughness to what is minimised, the mean of the weighted squares, so
    /// that A^T D A gets lambda W R for the total weight W. Of a sequence or cloud it is the
    /// integral of the squared derivatives of the given order along each axis. Of a grid it is the
    /// sandwich smoother's [XiaoLiRuppert2013], a Kronecker product where the weights are one: for
    /// every choice of axes lambda to the power of their number times the squared derivative along
    /// all of them, integrated along them and averaged over the samples' parameters along the
    /// others. Every axis counts as stretched to [0, 1].
    virtual void add_roughness(double lambda, int order) = 0;

    /// The gradient A^T D (Q - A P) at control points relative to the centre.
    PointSet gradient(const PointSet& control) const;
    /// Sum over the samples of weight |Q - A P|^2, up to the sum of weight |Q - centre|^2 that
    /// `data_energy` is. It cancels for a close fit: for a reported residual measure the deviation
    /// of the data instead.
    double energy(const PointSet& control) const;
    double data_energy() const { return data_energy_; }
    /// Samples added so far.
    Index sample_count() const { return sample_count_; }

  protected:
    NormalSystem(const NormalSystem&) = default;
    NormalSystem(std::vector<KnotVector> axes, std::vector<double> centre);
    /// Takes what every system has out of the sums; the matrix's are left in them.
    explicit NormalSystem(SystemSums&& sums);
    /// The sums that every system has.
    SystemSums common_sums() const;

    std::vector<KnotVector> axes_;
    GridIndex controls_;
    std::vector<double> centre_;
    PointSet rhs_;
    double data_energy_ = 0;
    Index sample_count_ = 0;
};

/// Assembles the normal system of the samples in one pass; the centre is the first sample.
/// Sequences and grids of unit weights give the Kronecker product of banded matrices, all else the
/// stencil form. Throws InvalidInput when a parameter is outside the knots' domain.
std::unique_ptr<NormalSystem> assemble(const std::vector<KnotVector>& axes, const Samples& samples,
                                       const Parameters& parameters);

/// Control points relative to `centre`, and back.
PointSet centred(const PointSet& control, const std::vector<double>& centre);
PointSet uncentred(const PointSet& control, const std::vector<double>& centre);

/// Whether the samples hardly reach a control point: its entry of the diagonal beside the largest.
inline bool hardly_reached(double entry, double largest) {
    return entry <= 1e-6 * largest;
}

} // namespace batten
