#include <batten/solve/factorization.hpp>

#include <batten/solve/banded_cholesky.hpp>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

namespace batten {

namespace {

/// One banded factor per axis.
class AxisFactorization : public Factorization {
  public:
    AxisFactorization(const std::vector<const BandedMatrix*>& factors, const GridIndex& controls)
        : controls_(controls) {
        for (const BandedMatrix* factor : factors) axes_.emplace_back(*factor);
    }
    PointSet solve(PointSet b) const override {
        for (std::size_t k = axes_.size(); k-- > 0;)
            axes_[k].solve(b.data(), along(controls_, k, b.dim()));
        return b;
    }

  private:
    std::vector<BandedCholesky> axes_;
    GridIndex controls_;
};

class SparseFactorization : public Factorization {
  public:
    explicit SparseFactorization(const NormalSystem& system) {
        std::vector<Eigen::Triplet<double>> entries;
        system.for_each_entry([&](Index i, Index j, double value) {
            if (i >= j) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
        });
        Eigen::SparseMatrix<double> matrix(system.size(), system.size());
        matrix.setFromTriplets(entries.begin(), entries.end());
        solver_.compute(matrix);
        const bool good = solver_.info() == Eigen::Success;
        const auto& pivots = solver_.vectorD();
        if (!good || !(pivots.minCoeff() > 1e-14 * pivots.maxCoeff()))
            throw SolverError("the normal equations are singular: some control points are not "
                              "determined by the samples");
    }
    PointSet solve(PointSet b) const override {
        using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        Eigen::Map<Rows> rows(b.data(), b.size(), b.dim());
        rows = solver_.solve(Eigen::MatrixXd(rows));
        return b;
    }

  private:
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

} // namespace

std::unique_ptr<Factorization> factorize(const NormalSystem& system) {
    const auto factors = system.factors();
    if (!factors.empty()) return std::make_unique<AxisFactorization>(factors, system.controls());
    return std::make_unique<SparseFactorization>(system);
}

std::unique_ptr<Factorization> factorize_axes(const NormalSystem& system) {
    const std::vector<BandedMatrix> nearby = system.nearby_factors();
    if (nearby.empty()) return nullptr;
    std::vector<const BandedMatrix*> factors;
    for (const BandedMatrix& factor : nearby) factors.push_back(&factor);
    try {
        return std::make_unique<AxisFactorization>(factors, system.controls());
    } catch (const SolverError&) {
        return nullptr;
    }
}

} // namespace batten
