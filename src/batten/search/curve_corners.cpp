#include <batten/search/curve_corners.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

/// Without the corners that have too few samples between them and the one before, or an end (a
/// piece of the curve of its own needs degree + 1), and a seam that is to be smooth.
std::vector<Index> spaced_corners(const std::vector<Index>& corners, const CurveTask& task) {
    const Index m = task.samples.size();
    const bool closed = task.closure == Closure::closed;
    const bool free_seam = closed && task.seam_continuity >= task.degree - 1;
    const auto distinct = [&](Index from, Index to) { // parameters from one sample to the other
        Index count = 1;
        for (Index i = from; i < to; ++i)
            count += task.parameters[static_cast<std::size_t>(i + 1)] >
                             task.parameters[static_cast<std::size_t>(i)]
                         ? 1
                         : 0;
        return count;
    };
    std::vector<Index> kept;
    for (Index i : corners) {
        if (i == 0 && task.seam_stated) continue;
        const Index before = kept.empty() ? 0 : kept.back();
        const bool after_nothing = free_seam && kept.empty();
        if (i > 0 && !after_nothing && distinct(before, i) <= task.degree) continue;
        if (i > 0 && !free_seam && distinct(i, m - 1) <= task.degree) continue;
        kept.push_back(i);
    }
    // round the seam, from the last corner to the first
    if (closed && kept.size() > 1 &&
        distinct(kept.back(), m - 1) + distinct(0, kept.front()) <= task.degree)
        kept.pop_back();
    return kept;
}

std::vector<Index> checked_corners(std::vector<Index> corners, const CurveTask& task) {
    const Index m = task.samples.size();
    const bool closed = task.closure == Closure::closed;
    std::ranges::sort(corners);
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    if (!closed) // the ends are free to have any direction already
        std::erase_if(corners, [&](Index i) { return i == 0 || i == m - 1; });
    if (task.seam_stated && std::ranges::binary_search(corners, Index{0}))
        throw InvalidInput(fmt::format("corner 0: it is the seam, which is asked to be C{}",
                                       task.seam_continuity));
    const std::vector<Index> spaced = spaced_corners(corners, task);
    for (Index i : corners)
        if (!std::ranges::binary_search(spaced, i))
            throw InvalidInput(
                fmt::format("corner {}: too few samples between it and the corner or "
                            "end beside it; a piece of degree {} needs {}",
                            i, task.degree, task.degree + 1));
    return corners;
}

/// Corners, a seam that is held and samples with tangents: their parameters must stay.
std::vector<Index> fixed_samples(const CurveTask& task) {
    std::vector<Index> fixed = task.corners;
    if (task.closure == Closure::closed && task.seam_continuity < task.degree - 1)
        fixed.push_back(0);
    for (const HeldTangent& tangent : task.hold.tangents) fixed.push_back(tangent.sample);
    std::ranges::sort(fixed);
    fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
    return fixed;
}

} // namespace batten
