#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/normal_system.hpp>

#include <optional>
#include <vector>

namespace batten {

/// Projected LSPIA for monotone curves [LiChe2026]: P <- Proj(P + mu A^T D (Q - A P)), Proj the
/// nearest control points whose coordinates do not turn back, by pooling adjacent violators
/// [AyerBrunkEwingReidSilverman1955]. The limit is the least-squares spline among those with
/// monotone control points: enough for a monotone curve, more than it needs. Of points (x, y) it is
/// the graph of a monotone function.
class MonotoneLspia : public Method {
  public:
    /// What is kept monotone, and how; what is absent is chosen.
    struct Choice {
        std::optional<double> mu{}; ///< step; absent: 0.99 of 2 over the largest row sum of A^T D A
        std::optional<Index> coordinate{}; ///< from 0; absent: all of them
        int direction = 0; ///< 1: rising, -1: falling, 0: as a line through the samples does
    };

    /// `system` of an open sequence without roughness.
    MonotoneLspia(const NormalSystem& system, Choice choice);

    std::string_view name() const override { return "monotone-lspia"; }
    /// Throws InvalidInput when there is no such coordinate, or mu is not below 2 over the largest
    /// row sum, which the largest eigenvalue is not above. Makes the start monotone.
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    /// |Proj(P + mu r) - P| / mu: 0 where, and only where, the limit is reached.
    double gradient_norm() const override { return norm_; }
    Settings settings() const override { return {{"mu", mu_}}; }

  private:
    void project(PointSet& control) const;

    const NormalSystem& system_;
    Choice choice_;
    double mu_ = 0;
    std::vector<int> directions_; ///< of each coordinate: 1, -1, 0: free
    double norm_ = 0;
    PointSet moves_;
};

} // namespace batten
