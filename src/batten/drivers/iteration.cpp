#include <batten/drivers/iteration.hpp>

#include <batten/iterate/methods.hpp>
#include <batten/system/normal_system.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

/// Keeps the polygon of every `stride`-th iteration; once there are twice too many, of every other
/// of these.
class FrameRecorder {
  public:
    explicit FrameRecorder(Index most) : most_(most) {}
    void record(const Iteration& now, std::vector<Frame>& frames) {
        if (most_ == 0 || now.number % stride_ != 0) return;
        frames.push_back({now.number, now.control});
        if (static_cast<Index>(frames.size()) < 2 * most_) return;
        stride_ *= 2;
        std::erase_if(frames, [&](const Frame& frame) { return frame.iteration % stride_ != 0; });
    }

  private:
    Index most_;
    Index stride_ = 1;
};

Observer recording(const FitOptions& options, const DeviationMeasure& deviation,
                   FitReport& report) {
    return [&, frames = FrameRecorder(options.most_frames)](const Iteration& now) mutable {
        frames.record(now, report.frames);
        if (options.keep_history)
            report.history.push_back({now.number, now.gradient_norm, now.largest_move,
                                      deviation(now.control), now.constraint_error});
        if (options.cancelled && options.cancelled()) return Continue::no;
        return options.observer ? options.observer(now) : Continue::yes;
    };
}

bool convex(const PointSet& control, Closure closure) {
    const std::vector<int> signs = turn_signs(control, closure, kept_roundings);
    const bool left = std::ranges::all_of(signs, [](int s) { return s >= 0; });
    return left || std::ranges::all_of(signs, [](int s) { return s <= 0; });
}

/// Throws InvalidInput where settings of a shape's limit are given and nothing takes them.
void check_limit_settings(const FitOptions& options, bool by_one_factor) {
    for (const char* name : {"alpha", "rays"}) {
        if (!setting(options.method.settings, name)) continue;
        if (options.hold.preserve == Preserve::nothing)
            throw InvalidInput(fmt::format("setting {}: no shape is to be kept (preserve)", name));
        if (by_one_factor)
            throw InvalidInput(
                fmt::format("setting {}: pia keeps convexity by one factor for all moves", name));
    }
}

/// The step limit that keeps what the options want kept, none for nothing; `kept`, which must
/// outlive it, is told what keep_turns has done.
StepLimit shape_limit(const FitOptions& options, Closure closure, const Departure& start,
                      std::string_view method, KeptTurns& kept) {
    const bool by_one_factor = method == "pia" && options.hold.preserve == Preserve::convexity;
    check_limit_settings(options, by_one_factor);
    if (options.hold.preserve == Preserve::nothing) return {};
    if (by_one_factor) {
        const double threshold =
            setting(options.method.settings, "threshold").value_or(default_turn_threshold);
        return [closure, threshold, &kept](const PointSet& polygon, PointSet& moves) {
            keep_turns(polygon, moves, closure, threshold, &kept);
        };
    }
    const MethodEntry& entry = method_entry(method);
    const Settings& given = options.method.settings;
    const InflectionLimit limit{setting(entry, given, "alpha"),
                                setting(entry, given, "rays") == 1 ? Barrier::rays : Barrier::lines,
                                start.centre};
    return [closure, limit](const PointSet& polygon, PointSet& moves) {
        keep_inflections(polygon, moves, closure, limit);
    };
}

} // namespace

void check_shape(Preserve preserve, const std::vector<KnotVector>& axes, const PointSet& control,
                 std::string_view method) {
    if (preserve == Preserve::nothing) return;
    if (axes.size() != 1 || control.dim() != 2)
        throw InvalidInput(fmt::format(
            "preserve: shape is kept for curves in the plane, not for {} in dimension {}",
            axes.size() == 1 ? "a curve" : "a surface or volume", control.dim()));
    if (preserve == Preserve::convexity && method != "pia" && !convex(control, axes[0].closure()))
        throw InvalidInput("preserve convexity: the initial control polygon is not convex");
}

namespace {

constexpr double next_to_nothing = 1e-6; ///< of the moves that were wanted

/// What stopped Algorithm 1 of [LinWangDong2004] short; nothing where it did not.
std::string stop_of_turns(const KeptTurns& kept, const PointSet& polygon, Closure closure) {
    if (kept.steps == 0 || !kept.held_by || kept.last > next_to_nothing) return {};
    const Index n = polygon.size();
    const Index at = *kept.held_by;
    const Index before = (at + n - 1) % n;
    const Index after = (at + 1) % n;
    const bool inside = closure == Closure::closed || (at > 0 && at + 1 < n);
    const bool straight =
        inside && turn_sign(polygon[before], polygon[at], polygon[after], kept_roundings) == 0;
    const std::string where =
        straight ? fmt::format("control points {}, {} and {} are collinear", before, at, after)
                 : fmt::format("the turn at control point {} would change its sign", at);
    return fmt::format("the moves are held: {}; the factors of Algorithm 1 have come to {:.2g}, "
                       "their sum over {} steps is {:.6g}, which Theorem 2 of Lin, Wang, Dong 2004 "
                       "takes for infinite",
                       where, kept.last, kept.steps, kept.sum);
}

} // namespace

Course iterated(Method& method, Departure start, const std::vector<KnotVector>& axes,
                const FitOptions& options, const DeviationMeasure& deviation) {
    check_shape(options.hold.preserve, axes,
                start.centre.empty() ? start.control : uncentred(start.control, start.centre),
                method.name());
    const Closure closure = axes[0].closure();
    KeptTurns kept;
    const StepLimit limit = shape_limit(options, closure, start, method.name(), kept);
    Course course{std::move(start.control), {}};
    FitReport& report = course.report;
    StepLimit watched;
    double wanted = 0;
    double made = 0;
    if (limit) {
        report.allowed_inflections =
            inflection_count(course.control, closure, {kept_roundings, start.centre});
        watched = [&](const PointSet& polygon, PointSet& moves) {
            wanted = largest_length(moves);
            limit(polygon, moves);
            made = largest_length(moves);
        };
    }
    const Summary summary =
        iterate(method, course.control, options.stop,
                {recording(options, deviation, report), watched, deviation, start.centre});
    report.method = method.name();
    report.termination = summary.termination;
    report.iterations = summary.iterations;
    report.gradient_norm = summary.gradient_norm;
    report.first_gradient_norm = summary.first_gradient_norm;
    report.observed_rate = summary.observed_rate;
    report.predicted_rate = method.predicted_rate();
    report.settings = method.account();
    if (const std::string note = method.note(); !note.empty()) report.notes.push_back(note);
    if (const std::string stopped = stop_of_turns(kept, course.control, closure); !stopped.empty())
        report.notes.push_back(stopped);
    const double rounding = std::numeric_limits<double>::epsilon() * largest_length(course.control);
    const bool held =
        summary.termination == Termination::stalled ||
        (summary.termination == Termination::iteration_limit && made <= next_to_nothing * wanted);
    if (held && wanted > rounding) report.held_back = wanted;
    return course;
}

} // namespace batten
