#pragma once

#include <batten/fit/curve_trial.hpp>

#include <string>
#include <utility>
#include <vector>

namespace batten {

/// A curve fitted to a tolerance, and the count of control points after each stage.
struct CurveWithin {
    CurveTrial trial;
    bool met = false;
    std::vector<std::pair<std::string, Index>> stages;
};

/// The search for few knots: refine where the error is until every sample is within tolerance, then
/// take out what is not needed. `most_control_points`: not more than that. Bounded in rounds and
/// trials.
CurveWithin few_knots(const CurveTask& task, Index most_control_points);

} // namespace batten
