#pragma once

#include <batten/robust/neighbours.hpp>

#include <array>

namespace batten {

/// The stencils that samples are judged by: to both sides alike, to both sides in need, and to one
/// side where the curve breaks or ends.
inline constexpr Stencil closest{2, 2, 3};
inline constexpr std::array central{closest, Stencil{4, 4, 3}};
inline constexpr std::array lopsided{Stencil{1, 2, 2}, Stencil{2, 1, 2}, Stencil{1, 4, 3},
                                     Stencil{4, 1, 3}};
inline constexpr std::array one_sided{Stencil{3, 0, 2}, Stencil{0, 3, 2}, Stencil{2, 0, 1},
                                      Stencil{0, 2, 1}, Stencil{5, 0, 2}, Stencil{0, 5, 2},
                                      Stencil{4, 0, 1}, Stencil{0, 4, 1}};

/// Residuals of the trusted samples, in their order.
std::vector<double> residuals(const Trusted& trusted, const Stencil& stencil);

/// Median of the finite values up to ten strides from a place, its own included.
double median_around(const std::vector<double>& values, const Trusted& trusted, Index place);

/// The median of the values that are finite.
double finite_median(std::vector<double> values);

/// What residuals are among trusted samples.
class Scale {
  public:
    explicit Scale(const Trusted& trusted);

    /// The largest residual of a usual sample at a gap.
    double usual(const Trusted& trusted, const Gap& gap) const;
    /// Median residual by the closest neighbours.
    double noise() const { return noise_; }

  private:
    std::vector<double> around_;
    double usual_ = 0;
    double noise_ = 0;
};

/// Says whether trusted neighbours explain a sample.
class Judge {
  public:
    /// `usual`: the residual that each sample may have in any case.
    Judge(const Trusted& trusted, const std::vector<double>& usual, double noise)
        : trusted_(trusted), usual_(usual), noise_(noise) {}

    /// Its residual by the stencil that explains it best, as a part of what it may be.
    double part(Index sample) const;

    /// Whether a sample that nothing explains may be a bend's own: its neighbours are as badly
    /// predicted without it, or, at an end, it is off by less than a third of a step.
    bool unresolved(Index sample) const;

  private:
    double by_stencil(Index sample, const Gap& gap, const Stencil& stencil) const;
    double smooth_residual(const Gap& gap, const Stencil& stencil, double reach) const;
    bool at_end(const Gap& gap) const;
    bool breaks(const Gap& gap, double usual) const;
    double step(const Gap& gap) const;

    const Trusted& trusted_;
    const std::vector<double>& usual_;
    double noise_;
};

} // namespace batten
