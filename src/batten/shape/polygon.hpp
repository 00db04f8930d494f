#pragma once

#include <batten/core/core.hpp>

#include <optional>
#include <vector>

namespace batten {

/// Twice the signed area of the triangle a b c in the plane: positive for a turn to the left at b.
double turn(std::span<const double> a, std::span<const double> b, std::span<const double> c);

/// What a turn must be to be certain, in units of what rounding the coordinates to the nearest
/// doubles can change at most.
inline constexpr double certain_roundings = 2;
/// To keep its sign when the polygon is shifted, too: the shift rounds once, the first place may be
/// rounded itself.
inline constexpr double kept_roundings = 4;
/// To be none that the roundings of an iteration add up to.
inline constexpr double distinct_roundings = 1e6;

/// Which turns count: those of more than so many roundings of the coordinates where the polygon
/// will be written, at `centre` more than its own (dim; empty: where it is). With 0 roundings every
/// turn counts that the doubles have, and its sign is exact.
struct TurnMargin {
    TurnMargin(double roundings_ = certain_roundings, std::span<const double> centre_ = {})
        : roundings(roundings_), centre(centre_) {}

    double roundings;
    std::span<const double> centre;
};

/// The margin without a turn that is none: signs as the doubles stand.
inline constexpr double exactly = 0;

/// Sign (-1, 1) of the turn at b, or 0 where it does not count.
int turn_sign(std::span<const double> a, std::span<const double> b, std::span<const double> c,
              const TurnMargin& margin = {});

/// Whether three points of a line do not follow each other along it: c is back from b, or one is a
/// thousand times nearer to b than the other is, where a little turn at b would not be seen.
bool crowded(std::span<const double> a, std::span<const double> b, std::span<const double> c);

/// Signs (-1, 1, or 0 where a turn does not count) of the turns of a planar polygon, after
/// consecutive equal points are taken as one: the directional angles of [LinWangDong2004, section
/// 1.3]. Closed: the turns over the seam count.
std::vector<int> turn_signs(const PointSet& polygon, Closure closure = Closure::open,
                            const TurnMargin& margin = {});

/// Changes of the turns' sign along a planar polygon, straight places left out.
Index inflection_count(const PointSet& polygon, Closure closure = Closure::open,
                       const TurnMargin& margin = {});

/// Sum of the sizes of a planar polygon's turns, in radians: what a curve with this control polygon
/// turns at most.
double total_turning(const PointSet& polygon, Closure closure = Closure::open);

/// The first point at which a polygon whose points have moved has lost its shape, none where it has
/// it still: turns that count have their signs, what was straight is so and is not crowded, or
/// bends by more than `bend` roundings, and there are no more inflections than before.
std::optional<Index> lost_turn(const PointSet& polygon, const PointSet& moved, Closure closure,
                               const TurnMargin& margin, double bend);

/// Whether there is no such point.
bool keeps_shape(const PointSet& polygon, const PointSet& moved, Closure closure,
                 const TurnMargin& margin, double bend);

} // namespace batten
