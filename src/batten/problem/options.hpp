#pragma once

#include <batten/basis/place_knots.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/parametrize/project.hpp>
#include <batten/spline/spline.hpp>

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
    /// Highest derivative of a closed curve that is continuous at its first sample: 0 lets it bend
    /// there; degree - 1 (-1 stands for it) is as smooth as elsewhere.
    int seam_continuity = -1;
    /// How parameters follow from the points; where it is left open by chord length, of a table of
    /// heights evenly.
    std::optional<Parametrization> parametrization{};
    /// Given parameters, in place of `parametrization`; (m x axes) for a cloud.
    std::optional<Parameters> parameters{};
    /// Makes the samples a cloud whose parameters are its points' coordinates in this plane.
    std::optional<Projection> projection{};
    /// Where knots go; where it is left open evenly between the parameters, from both ends alike,
    /// or by the papers' rule (KnotPlacement::data) when a method is named.
    std::optional<KnotPlacement> placement{};
    /// Given knots per axis, in place of `placement` and `control_points`.
    std::vector<std::vector<double>> knots{};
};

/// Where an iteration starts.
enum class Initial {
    data,  ///< samples picked evenly by index [HuangWang2020, eq. 38]
    zero,  ///< all control points zero
    given, ///< MethodOptions::control
};

struct MethodOptions {
    /// One of drivers(), or `auto`: the fastest that takes what is asked.
    std::string name = "auto";
    /// The method's own numbers.
    Settings settings{};
    Initial initial = Initial::data;
    /// (N x dim) free control points, for Initial::given.
    PointSet control{};
    /// The axes that these stand over, refined to the fit's own, which must contain their knots;
    /// empty: the fit's own.
    std::vector<KnotVector> control_axes{};
    /// Free control points (N x dim) over the same axes one iteration before `control`, so that a
    /// method with memory goes on where an earlier run ended; empty: it starts afresh.
    PointSet before{};
    /// Local PIA: only these control points move; empty: all.
    std::vector<Index> moving{};
};

/// What of its shape a planar curve's control polygon keeps: in an iteration at every step, that
/// of the initial polygon; within a tolerance, that of the samples.
enum class Preserve {
    nothing,
    convexity,   ///< a convex polygon stays convex
    inflections, ///< no turn changes its sign, so no inflection comes or goes
};

/// What a first derivative at a sample must be.
enum class TangentKind {
    direction,  ///< parallel to the value, of any length
    derivative, ///< equal to the value, for parameters over [0, 1]
};

/// A first derivative along `axis` that the spline must have at a sample's parameter.
struct HeldTangent {
    Index sample = 0;
    std::vector<double> value{}; ///< (dim)
    int axis = 0;
    TangentKind kind = TangentKind::direction;
};

/// A curve that a surface (or a surface that a volume) must have as its boundary at one end of an
/// axis: a spline over the other axes, whose domain is stretched to theirs.
struct HeldBoundary {
    int axis = 0;
    AxisEnd end = AxisEnd::begin;
    Spline spline{};
};

/// What must hold exactly.
struct HoldOptions {
    /// Samples that the spline must pass through at their parameters.
    std::vector<Index> interpolate{};
    std::vector<HeldTangent> tangents{};
    std::vector<HeldBoundary> boundaries{};
    Preserve preserve = Preserve::nothing;

    /// Whether any equality is asked for.
    bool equalities() const {
        return !interpolate.empty() || !tangents.empty() || !boundaries.empty();
    }
};

/// Where a curve may have corners: knots of full multiplicity.
enum class Corners {
    automatic, ///< where the samples turn sharply, if that takes fewer control points
    none,
    given, ///< ToleranceOptions::corner_samples
};

/// A distance that no sample may be from the spline; then the number of control points is found.
struct ToleranceOptions {
    /// For all samples, in their unit; 0: not stated. Where no size is stated either it is a
    /// thousandth of the diagonal of the samples' box.
    double value = 0;
    /// One per sample, all positive; where `value` is stated too, the smaller of both holds.
    std::vector<double> per_sample{};
    /// Not more control points than this in all; 0: nine tenths of the samples, and for a curve all
    /// of them where nothing else is within the tolerance.
    Index max_control_points = 0;
    Corners corners = Corners::automatic;
    std::vector<Index> corner_samples{};

    bool stated() const { return value != 0 || !per_sample.empty(); }
};

/// Smoothness traded against closeness: what is minimised is the mean of the weighted squares plus
/// lambda times the integral of the squared derivatives of `order` for parameters over [0, 1].
struct SmoothOptions {
    bool wanted = false;
    /// 0: by generalised cross-validation.
    double lambda = 0;
    /// 2 or 3.
    int order = 2;
};

/// What samples far from all others may do.
enum class Outliers {
    count,     ///< they count like any other
    set_aside, ///< they are found (robust/outliers.hpp), listed, and not fitted
};

/// Everything a fit can be told; the defaults are what `batten fit` does.
struct FitOptions {
    ShapeOptions shape{};
    ToleranceOptions tolerance{};
    MethodOptions method{};
    HoldOptions hold{};
    SmoothOptions smooth{};
    Outliers outliers = Outliers::count;
    StopRule stop{};
    /// Keep an entry per iteration in the report.
    bool keep_history = false;
    /// Fill FitResult::parameters and FitResult::deviations: two numbers per sample and axis, whose
    /// memory may take longer than a fit that works in passes.
    bool keep_per_sample = true;
    /// Keep about this many polygons of the iterations in the report; 0: none.
    Index most_frames = 0;
    /// Threads for all passes; 0 takes every core. Results do not depend on it.
    int threads = 0;
    /// Asked now and then; true ends the fit with Cancelled, or inside an iteration as
    /// Termination::cancelled.
    std::function<bool()> cancelled{};
    Observer observer{};
    /// Lengths are given in this unit's parts: words multiply them by its inverse. Set by fit() for
    /// coordinates whose squares leave the range of numbers.
    double unit = 1;
};

} // namespace batten
