#pragma once

#include <batten/solve/smoothing_quality.hpp>

#include <map>

namespace batten {

/// The search for the factor of the roughness with the least V = (RSS / m) / (1 - trace / m)^2.
/// Factors are told as doublings of one that balances the traces of the roughness and of the
/// normal equations; each is judged once.
class FactorSearch {
  public:
    /// The arguments must outlive it.
    FactorSearch(const NormalSystem& system, const Samples& samples, const Parameters& parameters,
                 int order);

    double factor(double doublings) const;
    double doublings(double factor) const;
    /// An infinite sum of squares where the factor does not determine every control point.
    Quality quality(double doublings);
    double score(double doublings);

    /// The best of steps to both sides, until all freedom is there or none but the polynomials'.
    double scanned();
    /// The best that steps from a start lead to, until then, too.
    double descended(double start);
    /// Of a cloud: where V is level, from the nearest place to a start that is.
    double settled(double start);
    /// The first of steps to larger factors from where the freedom depends on the factor: below
    /// that the net is too coarse to tell.
    double telling(double doublings);
    /// Near the best of steps, where V is level: alike to both sides, found by the Illinois variant
    /// of false position.
    double levelled(double best);
    /// Near the best of steps, the lowest place of the parabola through it and those beside it.
    double lowest(double best);

  private:
    /// Whether a smaller factor leaves more freedom, or a larger one less.
    bool has_less(double doublings);
    bool has_more(double doublings);
    /// The logarithm of the growth of RSS over that of (1 - trace / m)^2, relative to these: more
    /// than 0 where V grows with the factor, and nearly linear.
    double tilt(double doublings);
    double step() const { return quality_->estimated() ? 4 : 2; }

    std::unique_ptr<SmoothingQuality> quality_;
    double balance_;
    double m_;
    double size_;
    double polynomials_ = 1; ///< that no roughness sees
    std::map<double, Quality> seen_;
};

/// What a solution works on: the normal equations' entries, or the samples' rows.
enum class Solution { entries, rows };

/// The largest factor of the roughness beside which a system keeps six digits of what no
/// roughness sees, as polynomials.
double largest_factor(const NormalSystem& system, int order, Solution solution);

/// Sum of the weights of a system's samples.
double total_weight(const NormalSystem& system);

} // namespace batten
