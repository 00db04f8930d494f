#pragma once

#include <batten/search/curve_closest.hpp>

#include <string>
#include <utility>
#include <vector>

namespace batten {

/// A curve fitted to a tolerance, and the count of control points after each stage.
struct CurveWithin {
    CurveTrial trial;
    bool met = false;
    ClosestSeen closest; ///< on the way there
    std::vector<std::pair<std::string, Index>> stages;
    Index searched = 0;    ///< samples that the search went by where it was not all
    Index full_checks = 0; ///< candidates that were then checked by all
};

/// Free control points of a fit.
inline Index controls(const CurveWithin& fit) {
    return fit.trial.knots.free_count();
}

/// First half of the search for few knots: refines where the error is until every sample is within
/// tolerance and the curve does nothing odd between them. `most_control_points`: not more than
/// that. Bounded in rounds.
CurveWithin refined(const CurveTask& task, Index most_control_points);

/// A fit whose task has got a limit on inflections since: refined from where it stands until it is
/// within tolerance under the limit, too. Bounded in rounds.
CurveWithin refined_further(const CurveTask& task, const CurveWithin& fit,
                            Index most_control_points);

/// Takes out knots one by one, the least significant first; one that cannot go is not tried again
/// until a neighbour has gone. Bounded in trials.
void thin_one_by_one(const CurveTask& task, CurveTrial& trial);

/// Second half: spreads fewer knots anew, then takes out those that are not needed, batch by batch
/// and one by one. Bounded in trials.
void thin_out(const CurveTask& task, CurveWithin& fit);

} // namespace batten
