#pragma once

#include <batten/core/core.hpp>

#include <string>

namespace batten {

/// Why a search has not met its tolerance.
enum class NotMet {
    limited, ///< the stated number of control points does not suffice
    noise,   ///< only what follows the samples' noise would meet it
    held,    ///< what must hold keeps the spline from some samples
    wild,    ///< what meets it is wild between samples
    crowded, ///< more control points would be needed than samples can determine
};

/// What is said of a tolerance that was not met.
struct Shortfall {
    NotMet why = NotMet::crowded;
    Index allowed = 0;        ///< control points, where a limit was stated
    double noise = 0;         ///< the samples' level; 0: unknown
    Index control_points = 0; ///< of the spline handed out in place of one that meets it
    double deviation = 0;     ///< its largest
    double unit = 1;          ///< FitOptions::unit, of both lengths
};

/// The verdict in words: why, and what the spline is.
std::string not_met_words(const Shortfall& shortfall);

/// For splines with so many control points that they follow each sample, with the samples' level of
/// noise (0: unknown); empty for others.
std::string near_interpolation_words(Index control_points, Index samples, double noise,
                                     double unit);

} // namespace batten
