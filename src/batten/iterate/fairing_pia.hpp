#pragma once

#include <batten/iterate/lin2018.hpp>

#include <memory>
#include <optional>

namespace batten {

/// Fairing-PIA of data [JiangLin2022] with one weight w for all control points: P_i <- P_i + mu_i
/// ((1 - w) A^T D (Q - A P) - w R P)_i, R the roughness (NormalSystem::add_roughness; of a sequence
/// the integrals of products of derivatives), mu_i one over the row sum of the matrix, D as if the
/// samples' mean weight were one. Divided by 1 - w that is lin2018 with w / (1 - w) R added to A^T
/// D A, and so it is computed.
class FairingPia : public Method {
  public:
    /// 0 < weight < 1, order 2 or 3 of the derivatives.
    explicit FairingPia(const NormalSystem& system, double weight = 1e-4, int order = 2);

    std::string_view name() const override { return "fairing-pia"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override { return faired_->propose(control); }
    void accept(const PointSet& moves) override { faired_->accept(moves); }
    double gradient_norm() const override { return faired_->gradient_norm(); }
    Settings settings() const override { return {{"weight", weight_}, {"smoothing", lambda_}}; }

  private:
    const NormalSystem& system_;
    double weight_;
    int order_;
    double lambda_ = 0; ///< the same as FitOptions::smooth counts it
    std::unique_ptr<NormalSystem> smoothed_;
    std::optional<Lin2018> faired_;
};

} // namespace batten
