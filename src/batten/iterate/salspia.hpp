#pragma once

#include <batten/iterate/method.hpp>
#include <batten/iterate/nonmonotone_search.hpp>
#include <batten/system/normal_system.hpp>

namespace batten {

/// Which step the gradients at hand suggest.
enum class SpectralStep {
    blended, ///< between the two others, by where the last gradient lies in the spectrum
    longer,  ///< Barzilai and Borwein's first, <g, g> / <g, H g>
    shorter, ///< their second, <g, H g> / <H g, H g>
};

/// LSPIA whose steps adapt to the spectrum [PengLi2026]: P <- P + alpha r, r = A^T D (Q - A P),
/// halved until the functional is below the largest of the last ones. Needs no eigenvalues: the
/// first step is one over the largest row sum of H = A^T D A.
class Salspia : public Method {
  public:
    explicit Salspia(const NormalSystem& system, int memory = 10,
                     SpectralStep kind = SpectralStep::blended);

    std::string_view name() const override { return "salspia"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    double gradient_norm() const override;
    Settings settings() const override;

  private:
    double trial(double zeta) const;
    double searched(double step);

    const NormalSystem& system_;
    NonmonotoneSearch search_;
    SpectralStep kind_;
    double bound_ = 0; ///< C_H, at least the largest eigenvalue
    double step_ = 0;  ///< alpha, the last one taken; 0: none to go by
    double rho_ = 0;   ///< <r, r>
    double last_rho_ = 0;
    PointSet gradient_; ///< r
    PointSet last_gradient_;
    PointSet image_; ///< H r
    PointSet moves_;
};

} // namespace batten
