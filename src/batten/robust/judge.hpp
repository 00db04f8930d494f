#pragma once

#include <batten/robust/neighbours.hpp>

namespace batten {

/// By the two samples next to it on both sides.
inline constexpr Stencil closest{2, 2, 3};

/// What residuals are where all is usual, of trusted samples by the closest ones, in units of a
/// sample's noise.
struct UsualResidual {
    double median = 0;
    /// The largest one: of normal noise along a line, in a plane or in space 5.1, 5.6 or 5.9
    /// standard deviations.
    double largest = 0;

    /// Of the residuals that exist among these.
    explicit UsualResidual(std::vector<double> residuals);
    double ratio() const { return median > 0 ? largest / median : 1; }
};

/// Says whether trusted neighbours explain a sample.
class Judge {
  public:
    /// `usual`: per axis. `least`: what each sample may be off in any case.
    Judge(const Trusted& trusted, const std::vector<UsualResidual>& usual,
          const std::vector<double>& least)
        : trusted_(trusted), usual_(usual), least_(least) {}

    struct Verdict {
        double part = std::numeric_limits<double>::infinity();  ///< the residual in limits
        double limit = std::numeric_limits<double>::infinity(); ///< how far off it might be
        std::size_t axis = 0;
        Stencil by{};
    };

    /// By the stencil that is most certain, of those along each axis to both sides, before the
    /// sample and behind it; of equal ones by the one that explains it best. Above 1 it is not
    /// explained; a sample without neighbours is.
    Verdict of(Index sample) const;

    /// Whether a sample that nothing explains may be a bend's own: along an axis its neighbours are
    /// about as badly predicted without it, or no noise is to be seen around it and it is off by
    /// less than 0.07 of a step, at an end or in a pair 0.3, in a longer `run` 1.5.
    bool unresolved(Index sample, std::size_t axis, Index run) const;

  private:
    Verdict by_stencil(Index sample, std::size_t axis, const Stencil& stencil, double usual) const;
    double smooth_residual(Index sample, std::size_t axis, const Stencil& stencil,
                           double reach) const;
    double usual_around(Index sample, std::size_t axis) const;
    bool noise_is_seen(Index sample, std::size_t axis) const;
    bool at_end(Index sample, std::size_t axis) const;
    double step(Index sample, std::size_t axis) const;

    const Trusted& trusted_;
    const std::vector<UsualResidual>& usual_;
    const std::vector<double>& least_;
};

} // namespace batten
