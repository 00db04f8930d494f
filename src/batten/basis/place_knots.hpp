#pragma once

#include <batten/basis/knot_vector.hpp>

namespace batten {

/// Where knots go for a stated number of control points.
enum class KnotPlacement {
    data, ///< between the parameters, every span holding some [PieglTiller1997, eq. 9.68 and 9.69]
    both_ends, ///< the same, counted from the middle: reversed parameters give reversed knots, on a
               ///< closed axis those reversed about the first one
    uniform,   ///< evenly over the domain
};

/// Knots of degree p for n free control points over [parameters.front(), parameters.back()]
/// (closed: one period from 0 to 1), placed between the ascending `parameters` by `rule`, data or
/// both_ends (as many control points as closed parameters: knots_at_parameters). Throws
/// InvalidInput when n < p + 1, or n exceeds the number of parameters.
KnotVector knots_from_parameters(std::span<const double> parameters, int degree, Index n,
                                 Closure closure = Closure::open,
                                 KnotPlacement rule = KnotPlacement::data);

/// An interior knot among ascending parameters: `part` of the way from number `before` (0, 1, ...)
/// to the next; 1 comes after the last.
struct KnotPlace {
    Index before;
    double part;
};

/// Where that rule puts the interior knots among `count` parameters. Throws the same. Not for as
/// many control points as closed parameters by both_ends.
std::vector<KnotPlace> knot_places(Index count, int degree, Index n, Closure closure,
                                   KnotPlacement rule);

/// Clamped knots for as many control points as parameters, interior knots the means of degree
/// consecutive parameters [PieglTiller1997, eq. 9.8; LinZhang2011, eq. 38]: for interpolation and
/// for EPIA.
KnotVector averaged_knots(std::span<const double> parameters, int degree);

/// Periodic knots of period 1 for as many free control points as parameters: at the parameters for
/// an odd degree, midway between them for an even one, so that every B-spline peaks near a
/// parameter of its own. For interpolation on a closed axis; on even parameters no other places
/// make the collocation matrix symmetric.
KnotVector knots_at_parameters(std::span<const double> parameters, int degree);

/// Evenly spaced knots for n free control points over [begin, end]; clamped, or periodic when
/// closed.
KnotVector uniform_knots(int degree, Index n, double begin, double end,
                         Closure closure = Closure::open);

/// Knots with the given ascending interior ones over [begin, end]: clamped, or periodic when closed
/// (then `begin` is a breakpoint too).
KnotVector knots_around(int degree, std::span<const double> interior, double begin, double end,
                        Closure closure = Closure::open);

} // namespace batten
