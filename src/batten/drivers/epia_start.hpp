#pragma once

#include <batten/drivers/epia_axis.hpp>
#include <batten/problem/problem.hpp>

#include <string>
#include <vector>

namespace batten {

/// The method's own numbers.
struct EpiaSettings {
    double eta;
    double t_c;
    Index rounds;
    Index smoothing;
    bool exact;
    bool screen;
};

/// Where the incremental fit starts [LinZhang2011, Algorithm 1, lines 2 to 4].
struct EpiaStart {
    std::vector<EpiaAxis> axes;
    Index rounds = 0; ///< of the validation check, that split a group
    std::vector<std::string> notes{};
};

/// The samples of largest curvature as control points' own, and those that the validation check
/// adds, for a sequence or a grid of 2 axes whose consecutive samples are distinct.
///
/// With EpiaSettings::screen what noise makes is neither: maxima of the curvature that do not rise
/// above its noise, bends that rounding makes, groups whose residuals are no larger than the
/// samples' white noise; and the check takes no more control points than are stated, nor on a grid
/// than an eighth of the samples: where that is too few for detail every maximum is dominant. A
/// stated number without a precision to reach is that of the start. Without, every maximum and
/// every group counts, as in the paper.
EpiaStart epia_start(const Problem& problem, const EpiaSettings& settings);

} // namespace batten
