#pragma once

#include <batten/problem/report.hpp>
#include <batten/search/curve_refining.hpp>
#include <batten/search/verdict_words.hpp>

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

/// What a search came to.
struct CurveOutcome {
    CurveWithin found;
    double noise = 0;             ///< the samples' level; 0: unknown, or not asked
    NotMet why = NotMet::crowded; ///< where it is not met
};

/// The account of a search: the certificate, the verdict and the ending; `allowed`: control points,
/// where a limit was stated; `deviation`: the largest of a sample.
FitReport judged(const CurveTask& task, const CurveOutcome& outcome, Index allowed,
                 double deviation);

} // namespace batten
