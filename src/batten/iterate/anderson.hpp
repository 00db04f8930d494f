#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/normal_system.hpp>

#include <vector>

namespace batten {

/// Anderson's acceleration [WalkerNi2011] of the iteration P <- P + D^{-1} r of lin2018, r =
/// A^T D (Q - A P) and D its row sums: what the last moves and changes of r say is combined so that
/// r is least in the norm <r, D^{-1} r>, in which the iteration itself contracts. Needs no
/// eigenvalues; control points without samples stay.
class Anderson : public Method {
  public:
    /// `window`: moves that are looked back on, 1 or more.
    explicit Anderson(const NormalSystem& system, int window = 10);

    std::string_view name() const override { return "anderson"; }
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    double gradient_norm() const override { return norm_; }
    Settings settings() const override { return {{"window", static_cast<double>(window_)}}; }

  private:
    struct Past {
        PointSet move;
        PointSet change; ///< of D^{-1/2} r by that move
    };

    void learn();
    std::vector<double> combination() const;

    const NormalSystem& system_;
    std::size_t window_;
    std::vector<double> scales_; ///< D^{-1/2}
    std::vector<Past> past_;     ///< the newest in place of the oldest
    std::size_t newest_ = 0;
    std::vector<double> products_; ///< of the changes, (window x window)
    PointSet residual_;            ///< D^{-1/2} r
    PointSet last_residual_;
    PointSet moves_;
    double norm_ = 0;
};

} // namespace batten
