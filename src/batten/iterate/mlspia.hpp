#pragma once

#include <batten/iterate/step_gradient.hpp>

#include <optional>

namespace batten {

/// The three weights of MLSPIA; an absent one is the best [HuangWang2020, eq. 27; for grids eq.
/// 37], but nu is shorter where the other two lie outside its region of convergence [eq. 11].
struct MlspiaWeights {
    std::optional<double> omega{};
    std::optional<double> gamma{};
    std::optional<double> nu{};
    /// Lambda^0 in parts of Q - A P^0; omega where it is absent, which is what both kinds of
    /// initial control points in section 6.2 come to.
    std::optional<double> lambda{};

    bool stated() const { return omega || gamma || nu; }
};

/// Least-squares PIA with memory [HuangWang2020, eq. 1 to 3]:
/// Delta^k = (1 - omega) Delta^{k-1} + gamma delta^k + (omega - gamma) delta^{k-1}, delta^k = nu
/// A^T (Q - A P^k). With the best weights gamma = omega, and it is Polyak's method of the heavy
/// ball [Polyak1964], known here as PmLSPIA too [LiuWuLiHu2024].
class Mlspia : public Method {
  public:
    /// Stated weights multiply gradients as they are unless row sums are asked for.
    explicit Mlspia(const NormalSystem& system, MlspiaWeights weights = {},
                    double eigenvalue_tolerance = default_eigenvalue_tolerance,
                    std::optional<RowSums> row_sums = {}, std::string_view name = "mlspia");

    /// Makes Delta^0 = nu A^T Lambda^0 for any Lambda^0 of the caller's: `moves` (N x dim) is A^T
    /// Lambda^0.
    void set_first_moves(PointSet moves) { first_ = std::move(moves); }

    std::string_view name() const override { return name_; }
    /// Throws InvalidInput when the weights are outside the convergence region [eq. 11].
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    bool rests() const override { return last_.empty() && given_.lambda == 0.0; }
    double gradient_norm() const override { return gradient_.norm(); }
    Settings settings() const override;
    double predicted_rate() const override { return rate_; }
    std::string note() const override { return gradient_.note(); }

    /// Delta^{k-1}: the moves that led to the present control points; empty before the first.
    const PointSet& last_moves() const { return last_; }
    void resume(PointSet last_moves) override { last_ = std::move(last_moves); }

  private:
    void choose_weights(const ExtremeEigenvalues& sigma2);
    double root_modulus(double sigma2) const;

    StepGradient gradient_;
    MlspiaWeights given_;
    double omega_ = 0;
    double gamma_ = 0;
    double nu_ = 0;
    std::string_view name_;
    double rate_ = 0;
    PointSet first_;
    PointSet last_;
    PointSet last_delta_;
    PointSet delta_;
    PointSet moves_;
};

} // namespace batten
