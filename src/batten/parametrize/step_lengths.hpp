#pragma once

#include <batten/core/index.hpp>
#include <batten/parametrize/parametrize.hpp>

#include <span>

namespace batten {

/// Lengths of the steps along points (count x dim), by chord or their roots (centripetal),
/// accumulated into `t`: the way to each point from `before`, or where that is null from the first
/// point. Returns the whole way.
double accumulate_steps(const double* points, Index count, Index dim, const double* before,
                        Parametrization rule, double* t);

/// Equal neighbours among ascending parameters that pass by in pieces.
class EqualRuns {
  public:
    void add(std::span<const double> t) {
        if (!t.empty()) add(t, joins(t.front()));
    }
    /// `joined`: the first is the same as the last before.
    void add(std::span<const double> t, bool joined);
    /// Whether the next parameter is the same as the last before.
    bool joins(double t) const { return any_ && t == last_; }
    Index equal() const { return equal_; }     ///< that are the same as the one before
    Index longest() const { return longest_; } ///< number of parameters that are the same

  private:
    double last_ = 0;
    bool any_ = false;
    Index equal_ = 0;
    Index run_ = 0;
    Index longest_ = 0;
};

} // namespace batten
