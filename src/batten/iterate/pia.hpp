#pragma once

#include <batten/iterate/convergence_rate.hpp>
#include <batten/iterate/method.hpp>
#include <batten/system/sample_groups.hpp>

#include <optional>

namespace batten {

/// What to do when the predicted rate is above 1, so that the iteration grows without bound.
enum class Divergence {
    refused,
    allowed, ///< the caller ends the run before it matters
    unasked, ///< the same, and the rate is not computed
};

/// Progressive-iterative approximation: every control point moves by the residual of its own sample
/// [LinWangDong2004, eq. 4 and 5; surfaces eq. 16 and 17], times a factor [Lu2010], or by the
/// (weighted) mean residual of its group (EPIA [LinZhang2011, eq. 8 to 10; patches eq. 20 to 23]).
/// Which of them the DataSide's groups decide.
class Pia : public Method {
  public:
    /// `weight`: the factor of every move; none: the one of the least rate. `chosen`: only these
    /// control points move (local PIA); empty: all. Throws InvalidInput for a weight outside its
    /// range or a control point that is none.
    explicit Pia(const DataSide& data, std::optional<double> weight = 1,
                 std::vector<Index> chosen = {}, Divergence divergence = Divergence::refused);

    std::string_view name() const override { return "pia"; }
    /// Throws InvalidInput when the iteration would diverge and that is refused.
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    /// Frobenius norm of W(Q - AP) over the control points that move.
    double gradient_norm() const override { return norm_; }
    Settings settings() const override { return {{"weight", weight_}}; }
    /// Spectral radius of I - weight W A [LinWangDong2004, section 3].
    double predicted_rate() const override { return rate_.value; }
    std::string note() const override;

    /// Residuals Q - A P of the last propose(), (m x dim): e_d is the longest [LinZhang2011, eq.
    /// 25].
    const PointSet& residual() const { return residual_; }
    /// Means over the groups of those, before the weight: e_c is the longest [LinZhang2011, eq.
    /// 26].
    const PointSet& data_means() const { return means_; }
    /// Whether the validation condition holds for each control point at the last propose()
    /// [LinZhang2011, eq. 47]; it does where residuals are no longer than `noise` in the mean
    /// square.
    std::vector<bool> valid(double eta, double noise = 0) const;

  private:
    void keep_chosen(PointSet& moves) const;
    /// W A of moves (N x any dim), over the control points that move.
    PointSet image(const PointSet& moves) const;
    /// Whether the moves from `control` really grow, a billionfold: a rate above 1 that is
    /// rounding, or the passing swell of a matrix that is not normal, does not.
    bool diverges(const PointSet& control);

    const DataSide& data_;
    std::optional<double> given_weight_;
    double weight_ = 1;
    Divergence divergence_;
    std::vector<bool> moves_allowed_; // empty: all
    PointSet residual_;
    PointSet means_;
    PointSet moves_;
    double norm_ = 0;
    ConvergenceRate rate_;
};

} // namespace batten
