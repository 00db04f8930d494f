#pragma once

#include <batten/system/stencil_system.hpp>

namespace batten {

/// The equations of a fairing [LinHuangZhangLin2026]: for the moves X = P - P^0 of a spline's
/// control points the minimum of sum of (1 - w_i) / w_i |X_i|^2 + <P, D P>, D the thin-plate
/// roughness. Divided by w_i row by row that is the paper's (I - W + W D) P = (I - W) P^0, and the
/// paper's iteration is lin2018's on it. First D alone; weigh() adds the weights.
class FairingSystem : public StencilSystem {
  public:
    /// `order` 1 to 3 of the derivatives, over axes stretched to [0, 1].
    FairingSystem(const Spline& spline, int order);

    std::unique_ptr<NormalSystem> clone() const override {
        return std::make_unique<FairingSystem>(*this);
    }
    std::vector<BandedMatrix> nearby_factors() const override { return {}; }

    /// <P^0, D P^0>.
    double energy() const { return energy_; }
    /// The same of P^0 + X, once weighed.
    double energy(const PointSet& moves) const;
    /// By how much the energy falls, per control point, when it alone moves to where that is least;
    /// before weigh().
    std::vector<double> gains() const;
    /// Adds weights w_i, one per control point, from 0 to below 1; those of 0 stay.
    void weigh(const std::vector<double>& weights);

  private:
    double energy_ = 0;
    PointSet pull_;               ///< D P^0
    std::vector<double> anchors_; ///< (1 - w_i) / w_i; 0 where held
};

} // namespace batten
