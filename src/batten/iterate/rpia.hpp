#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/normal_system.hpp>

#include <cstdint>
#include <random>
#include <vector>

namespace batten {

/// Randomised PIA, after the abstract of [WuLiu2022]: of the blocks of consecutive control points
/// one is drawn, as often as its part of the trace of A^T D A says, and moved by its part of r =
/// A^T D (Q - A P), each control point over its row sum: block coordinate descent, which no step
/// takes uphill. A block whose moves are next to nothing leaves its turn to the one after it. The
/// same seed draws the same blocks.
class Rpia : public Method {
  public:
    /// `block`: control points in a block, at most all; 0: a quarter of them.
    explicit Rpia(const NormalSystem& system, Index block = 0, std::uint64_t seed = 1);

    std::string_view name() const override { return "rpia"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    double gradient_norm() const override { return norm_; }
    Settings settings() const override;

  private:
    std::size_t drawn();
    double longest_in(std::size_t block) const;

    const NormalSystem& system_;
    Index block_;
    std::uint64_t seed_;
    std::mt19937_64 random_;
    std::vector<double> steps_;
    std::vector<double> traces_; ///< of the blocks up to and with each
    double norm_ = 0;
    PointSet moves_;
};

} // namespace batten
