#pragma once

#include <batten/search/curve_refining.hpp>

namespace batten {

/// Rivals of a met fit, which rise from the fewest knots upwards: the fit with the fewest control
/// points. Bounded in trials.
void rise_below(const CurveTask& task, CurveWithin& best);

/// Where the fit missed the tolerance or is wild, one that rises from the fewest knots to at most
/// `most` control points, if there is one. Bounded in trials.
void rise_instead(const CurveTask& task, Index most, CurveWithin& best);

/// Takes out knots as long as the rest, spread anew or shifted, still meets the tolerance and does
/// nothing odd. Bounded in trials.
void squeeze(const CurveTask& task, CurveWithin& fit);

} // namespace batten
