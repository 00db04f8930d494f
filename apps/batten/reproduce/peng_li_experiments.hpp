#pragma once

#include <batten/fit/fit.hpp>

#include <functional>
#include <span>

namespace batten::command {

/// Samples, the space and the start of an experiment; what was taken away.
struct Experiment {
    Samples samples;
    FitOptions options;
    Samples hole{};
    Parameters hole_parameters{};
};

Samples blob(Index count);
/// Over t from 0 to `last`.
Samples helix(double last, Index count);
Samples dini();
Samples peaks_over_8();
Samples franke();
/// Heights (rows x columns) over [0, 865] x [0, 605].
Samples mount_eden(const PointSet& heights);

/// Curves: chord-length parameters, knots between them, samples picked evenly as the start.
Experiment along_curve(Samples samples, Index n);
/// Surfaces: everything evenly, the start at the nearest samples.
Experiment over_grid(Samples samples, Index n);

/// Takes the samples away whose parameters `gone` says so of, after everything was chosen by all of
/// them.
void take_away(Experiment& from, const std::function<bool(std::span<const double>)>& gone);

/// Franke's function with four elliptic holes, where the start is linear over a Delaunay
/// triangulation of what is left.
Experiment franke_with_holes();

} // namespace batten::command
