#pragma once

#include <batten/problem/report.hpp>
#include <batten/search/curve_refining.hpp>

namespace batten {

/// Whether inflections of curve and samples can be told: in the plane, of not too many samples.
bool can_show_inflections(const CurveTask& task);

/// Height of the turns that count as inflections: those that a kept shape may not have, or smaller
/// ones that would still be seen.
double visible_height(const CurveTask& task, double tolerance);

/// Inflections that the samples show, turns smaller than `height` left out.
Index shown_inflections(const CurveTask& task, double height);

/// The same of the planar curve.
Index curve_inflections(const CurveTrial& trial, double height);

/// Whether there are so many control points that the curve follows the samples' noise.
bool near_interpolation(const CurveTask& task, const CurveWithin& found);

/// Enters the certificate and the verdict in the report, whose tolerance and termination stand:
/// `noise` the samples' level, `why_not` the words for a tolerance that was not met.
void judge(const CurveTask& task, const CurveWithin& found, double noise,
           const std::string& why_not, FitReport& report);

} // namespace batten
