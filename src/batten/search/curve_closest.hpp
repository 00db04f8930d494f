#pragma once

#include <batten/measure/between_samples.hpp>
#include <batten/search/curve_trial.hpp>

#include <optional>

namespace batten {

/// A trial for tolerances that were `looser` times those that it is now judged by.
CurveTrial rescaled(CurveTrial trial, double looser);

/// A trial for other tolerances, one per sample, than those that it is judged by from now on.
CurveTrial rescaled(CurveTrial trial, const std::vector<double>& before,
                    const std::vector<double>& now);

/// What the trial does between samples, judged as if its tolerances were as loose as it is far from
/// the samples.
BetweenSamples check_reached(const CurveTask& task, const CurveTrial& trial);

/// Whether a trial may be handed out though it misses the tolerance: finite, its shape kept, and no
/// wilder between the samples than a curve as far from them as it is may be (wild_part).
bool acceptable(const CurveTask& task, const CurveTrial& trial);

/// The closest acceptable trial that a search has seen on its way.
class ClosestSeen {
  public:
    /// Takes the trial when it is acceptable and closer than what was seen before.
    void see(const CurveTask& task, const CurveTrial& trial);
    /// The same of what another search saw, whose tolerances were `looser` times these.
    void see(const CurveTask& task, const ClosestSeen& other, double looser = 1);

    const std::optional<CurveTrial>& trial() const { return trial_; }
    /// Its largest distance over tolerance; infinite while there is none.
    double worst() const;

  private:
    std::optional<CurveTrial> trial_;
};

} // namespace batten
