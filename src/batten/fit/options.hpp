#pragma once

#include <batten/basis/place_knots.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/parametrize/parametrize.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace batten {

/// The spline space: one entry per axis, or a single one for all axes.
struct ShapeOptions {
    std::vector<int> degree{3};
    /// Free control points per axis.
    std::vector<Index> control_points{};
    std::vector<Closure> closures{Closure::open};
    Parametrization parametrization = Parametrization::chord;
    /// Given parameters, in place of `parametrization`.
    std::optional<Parameters> parameters{};
    KnotPlacement placement = KnotPlacement::data;
    /// Given knots per axis, in place of `placement` and `control_points`.
    std::vector<std::vector<double>> knots{};
};

/// Where an iteration starts.
enum class Initial {
    data,  ///< samples picked evenly by index [HuangWang2020, eq. 38]
    zero,  ///< all control points zero
    given, ///< FitOptions' own
};

struct MethodOptions {
    /// One of methods().
    std::string name = "auto";
    /// The method's own numbers.
    Settings settings{};
    Initial initial = Initial::data;
    /// (N x dim) free control points, for Initial::given.
    PointSet control{};
    /// Local PIA: only these control points move; empty: all.
    std::vector<Index> moving{};
};

/// What of the initial polygon's shape a planar curve's iteration keeps at every step.
enum class Preserve {
    nothing,
    convexity,   ///< a convex polygon stays convex
    inflections, ///< no turn changes its sign, so no inflection comes or goes
};

/// What must hold exactly.
struct HoldOptions {
    /// Samples that the spline must pass through at their parameters.
    std::vector<Index> interpolate{};
    Preserve preserve = Preserve::nothing;
};

/// Where a curve may have corners: knots of full multiplicity.
enum class Corners {
    automatic, ///< where the samples turn sharply, if that takes fewer control points
    none,
    given, ///< ToleranceOptions::corner_samples
};

/// A distance that no sample may be from the spline; then the number of control points is found.
struct ToleranceOptions {
    /// For all samples, in their unit; 0: the number of control points is stated instead.
    double value = 0;
    /// One per sample, in place of `value`; all positive.
    std::vector<double> per_sample{};
    /// Not more control points than this in all; 0: nine tenths of the samples.
    Index max_control_points = 0;
    Corners corners = Corners::automatic;
    std::vector<Index> corner_samples{};

    bool stated() const { return value != 0 || !per_sample.empty(); }
};

/// Everything a fit can be told; the defaults are what `batten fit` does.
struct FitOptions {
    ShapeOptions shape{};
    ToleranceOptions tolerance{};
    MethodOptions method{};
    HoldOptions hold{};
    StopRule stop{};
    /// Keep an entry per iteration in the report.
    bool keep_history = false;
    /// Threads for all passes; 0 takes every core. Results do not depend on it.
    int threads = 0;
    /// Asked now and then; true ends the fit with Cancelled, or inside an iteration as
    /// Termination::cancelled.
    std::function<bool()> cancelled{};
    Observer observer{};
};

} // namespace batten
