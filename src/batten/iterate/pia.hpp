#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/sample_groups.hpp>

namespace batten {

/// Progressive-iterative approximation: every control point moves by the residual of its own sample
/// [LinWangDong2004, eq. 4 and 5; surfaces eq. 16 and 17], times a factor (weighted PIA), or by the
/// mean residual of its group (EPIA [LinZhang2011, eq. 8 to 10; patches eq. 20 to 23]). Which of
/// them the DataSide's groups decide.
class Pia : public Method {
  public:
    /// `chosen`: only these control points move (local PIA); empty: all.
    explicit Pia(const DataSide& data, double weight = 1, std::vector<Index> chosen = {});

    std::string_view name() const override { return "pia"; }
    void start(const PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet&) override {}
    /// Frobenius norm of W(Q - AP) over the control points that move.
    double gradient_norm() const override { return norm_; }
    Settings settings() const override { return {{"weight", weight_}}; }
    /// Spectral radius of I - weight W A, by power iteration [LinWangDong2004, section 3].
    double predicted_rate() const override { return rate_; }

    /// Residuals Q - A P of the last propose(), (m x dim): e_d is the longest [LinZhang2011, eq.
    /// 25].
    const PointSet& residual() const { return residual_; }
    /// Means over the groups of those, before the weight: e_c is the longest [LinZhang2011, eq.
    /// 26].
    const PointSet& data_means() const { return means_; }
    /// Whether the validation condition holds for each control point at the last propose()
    /// [LinZhang2011, eq. 47].
    std::vector<bool> valid(double eta) const;

  private:
    void keep_chosen(PointSet& moves) const;

    const DataSide& data_;
    double weight_;
    std::vector<bool> moves_allowed_; // empty: all
    PointSet residual_;
    PointSet means_;
    PointSet moves_;
    double norm_ = 0;
    double rate_ = 0;
};

} // namespace batten
