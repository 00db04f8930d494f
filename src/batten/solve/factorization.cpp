#include <batten/solve/factorization.hpp>

#include <batten/solve/banded_cholesky.hpp>
#include <batten/solve/nested_cholesky.hpp>

namespace batten {

namespace {

/// One banded factor per axis.
class AxisFactorization : public Factorization {
  public:
    AxisFactorization(const std::vector<const BandedMatrix*>& factors, const GridIndex& controls)
        : controls_(controls) {
        for (const BandedMatrix* factor : factors) axes_.emplace_back(*factor);
        if (factors.size() == 1) band_ = *factors[0];
    }
    PointSet solve(PointSet b) const override {
        for (std::size_t k = axes_.size(); k-- > 0;)
            axes_[k].solve(b.data(), along(controls_, k, b.dim()));
        return b;
    }
    std::unique_ptr<BandedSaddle> bordered(const Constraints& constraints) const override {
        if (axes_.size() != 1) return nullptr;
        return std::make_unique<BandedSaddle>(
            band_.size(), band_.closure(),
            [&](BandedSaddle::Visit visit) { band_.for_each_entry(visit); }, constraints);
    }

  private:
    std::vector<BandedCholesky> axes_;
    BandedMatrix band_; // of the only axis
    GridIndex controls_;
};

} // namespace

std::unique_ptr<BandedSaddle> Factorization::bordered(const Constraints&) const {
    return nullptr;
}

std::unique_ptr<Factorization> factorize(const NormalSystem& system) {
    const auto factors = system.factors();
    if (!factors.empty()) return std::make_unique<AxisFactorization>(factors, system.controls());
    auto nested = std::make_unique<NestedCholesky>(system.axes());
    nested->factor(system);
    return nested;
}

std::unique_ptr<Factorization> factorize_axes(const NormalSystem& system) {
    const std::vector<BandedMatrix> nearby = system.nearby_factors();
    if (nearby.empty()) return nullptr;
    return factorize(nearby, system.controls());
}

std::unique_ptr<Factorization> factorize(const std::vector<BandedMatrix>& bands,
                                         const GridIndex& controls) {
    std::vector<const BandedMatrix*> factors;
    for (const BandedMatrix& band : bands) factors.push_back(&band);
    try {
        return std::make_unique<AxisFactorization>(factors, controls);
    } catch (const SolverError&) {
        return nullptr;
    }
}

} // namespace batten
