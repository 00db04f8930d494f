#pragma once

#include <batten/robust/judge.hpp>

namespace batten {

/// Residuals of the trusted samples along an axis in units of a sample's noise, by the closest
/// neighbours or, at an end, by what there is; infinite of others.
std::vector<double> normal_residuals(const Trusted& trusted, std::size_t axis);

/// Places along an axis by counting, over one period.
std::vector<double> counted(Index count);

/// Samples to be judged, ascending, and the noise along each axis in steps.
struct Suspects {
    std::vector<Index> samples;
    std::vector<double> noise;

    /// Whether chords between samples say little.
    bool noisy(std::size_t axis) const { return noise[axis] > 0.5; }
};

/// What the nearest neighbours of a suspect predict along an axis, by chords or by counting, is
/// further away than two thirds of the largest usual residual around it. Neighbours of outliers
/// are among them, and what is between them, up to three in a row.
Suspects suspects(const Trusted& trusted, const std::vector<double>& least);

} // namespace batten
