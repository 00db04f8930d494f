#pragma once

#include <batten/iterate/method.hpp>
#include <batten/solve/extreme_eigenvalues.hpp>
#include <batten/system/normal_system.hpp>

#include <optional>

namespace batten {

/// The three weights of MLSPIA; an absent one is the best [HuangWang2020, eq. 27; for grids eq.
/// 37], but nu is shorter where the other two lie outside its region of convergence [eq. 11].
struct MlspiaWeights {
    std::optional<double> omega{};
    std::optional<double> gamma{};
    std::optional<double> nu{};
};

/// Least-squares PIA with memory [HuangWang2020, eq. 1 to 3]:
/// Delta^k = (1 - omega) Delta^{k-1} + gamma delta^k + (omega - gamma) delta^{k-1}, delta^k = nu
/// A^T (Q - A P^k).
class Mlspia : public Method {
  public:
    explicit Mlspia(const NormalSystem& system, MlspiaWeights weights = {},
                    double eigenvalue_tolerance = default_eigenvalue_tolerance);

    /// Replaces Delta^0 = omega nu A^T (Q - A P^0) (both kinds of initial control points in
    /// section 6.2) by nu A^T Lambda^0 for a Lambda^0 of the caller's: `moves` (N x dim) is A^T
    /// Lambda^0.
    void set_first_moves(PointSet moves) { first_ = std::move(moves); }

    std::string_view name() const override { return "mlspia"; }
    /// Throws InvalidInput when the weights are outside the convergence region [eq. 11].
    void start(PointSet& control) override;
    const PointSet& propose(const PointSet& control) override;
    void accept(const PointSet& moves) override;
    double gradient_norm() const override { return norm_; }
    Settings settings() const override;
    double predicted_rate() const override { return rate_; }
    std::string note() const override { return note_; }

    /// Delta^{k-1}: the moves that led to the present control points; empty before the first.
    const PointSet& last_moves() const { return last_; }
    /// Continues with the memory of an earlier run instead of a fresh start, also after its knots
    /// were refined: `last_moves` (N x dim) are the moves that led to the control points given to
    /// start(), both refined alike.
    void resume(PointSet last_moves) { last_ = std::move(last_moves); }

  private:
    void choose_weights(const ExtremeEigenvalues& sigma2);
    double root_modulus(double sigma2) const;

    const NormalSystem& system_;
    MlspiaWeights given_;
    double omega_ = 0;
    double gamma_ = 0;
    double nu_ = 0;
    double eigenvalue_tolerance_;
    double rate_ = 0;
    std::string note_;
    double norm_ = 0;
    PointSet first_;
    PointSet last_;
    PointSet last_delta_;
    PointSet delta_;
    PointSet moves_;
};

} // namespace batten
