#include <batten/drivers/curve_passes.hpp>

#include <batten/core/stopwatch.hpp>
#include <batten/drivers/choose.hpp>
#include <batten/drivers/picked_knots.hpp>
#include <batten/measure/curve_deviation.hpp>
#include <batten/parametrize/sequence_parameters.hpp>
#include <batten/parametrize/step_lengths.hpp>
#include <batten/problem/plan.hpp>
#include <batten/samples/sample_scan.hpp>
#include <batten/solve/direct.hpp>
#include <batten/system/factored_system.hpp>

#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// What is known of the samples before they are read.
Samples outline(const SampleSource& source) {
    return {.points = {},
            .grid = source.grid(),
            .weights = {},
            .order = source.order(),
            .spacing = source.spacing()};
}

SequenceParameters parameters_for(const SampleSource& source, const FitOptions& options,
                                  const AxisPlan& plan) {
    const ShapeOptions& shape = options.shape;
    if (shape.parameters) {
        if (shape.parameters->axes.size() != 1)
            throw InvalidInput(fmt::format("parameters: given for {} axes, the samples have 1",
                                           shape.parameters->axes.size()));
        return SequenceParameters(shape.parameters->axes[0]);
    }
    return {rule_of(shape, source.spacing()), plan.closures[0], source.dim()};
}

/// The passes of one fit and what each leaves to the next.
class CurvePasses {
  public:
    CurvePasses(SampleSource& source, const FitOptions& options, AxisPlan plan)
        : options_(options),
          plan_(std::move(plan)),
          passes_(source, options.cancelled),
          parameters_(parameters_for(source, options, plan_)),
          seen_(source.dim()),
          rooms_(passes_.places(), Room(source.dim())) {}

    /// The stages; false where the samples are needed in memory.
    bool assemble();
    bool solve();
    Passed measured(const Choice& choice);

  private:
    /// Memory of one chunk, used chunk after chunk.
    struct Room {
        explicit Room(Index dim) : box(dim) {}
        PointScan box;
        std::vector<double> parameters;
        std::span<const double> t; ///< there or elsewhere
        SpanSums sums;
        std::vector<double> distances;
        DeviationPart part;
    };

    void find_places();
    void pick_again();
    bool place_knots(bool picked);
    void see(const SampleChunk& chunk, Room& room) const;
    void note_seen(const SampleChunk& chunk, const Room& room);
    void sum(const SampleChunk& chunk, Room& room) const;
    void add_sums(const Room& room);
    bool scan(bool& summed);
    /// Whether so many parameters are the same that knots placed among all would meet.
    bool meet(const EqualRuns& runs) const {
        return knots_meet(runs.longest(), passes_.samples(), placed_count(options_, plan_, 0),
                          plan_.degree[0]);
    }
    void note(const char* stage);

    const FitOptions& options_;
    AxisPlan plan_;
    SamplePasses passes_;
    SequenceParameters parameters_;
    SampleScan seen_;
    std::vector<Room> rooms_;
    std::vector<double> centre_;
    EqualRuns equal_lengths_; // of the ways to the samples
    EqualRuns equal_;         // of parameters
    std::optional<PickedKnots> picked_;
    bool at_parameters_ = false; // knots are to be at all of them
    std::vector<KnotVector> axes_;
    std::optional<BandedSystem> system_;
    std::vector<double> telling_;
    std::optional<PointSet> control_;
    Passed passed_;
    Stopwatch watch_;
    double reading_ = 0;
    std::vector<std::pair<std::string, double>> seconds_;
};

void CurvePasses::note(const char* stage) {
    const double reading = passes_.reading_lap();
    reading_ += reading;
    seconds_.emplace_back(stage, std::max(0.0, watch_.lap() - reading));
}

/// Where the rule puts knots, once the number of samples is known.
void CurvePasses::find_places() {
    const Index samples = passes_.samples();
    const KnotPlacement rule = placement_of(options_, SampleKind::sequence);
    if (!options_.shape.knots.empty() || rule == KnotPlacement::uniform) return;
    const Index n = placed_count(options_, plan_, 0);
    const Closure closure = plan_.closures[0];
    at_parameters_ = closure == Closure::closed && rule == KnotPlacement::both_ends && n == samples;
    if (n <= samples && !at_parameters_)
        picked_.emplace(samples, plan_.degree[0], n, closure, rule);
}

/// Of a source that did not say how many samples it has.
void CurvePasses::pick_again() {
    passes_.run(
        [&](const SampleChunk& chunk, std::size_t place) {
            rooms_[place].t = parameters_.of(chunk, rooms_[place].parameters);
        },
        [&](const SampleChunk& chunk, std::size_t place) {
            picked_->take(chunk.first, rooms_[place].t, 0);
        });
}

/// Knots, once the number of samples is known, and the lengths of their way where these count.
/// `picked`: what they need was picked while the samples passed by.
bool CurvePasses::place_knots(bool picked) {
    parameters_.finish(passes_.samples());
    if (picked_ && !parameters_.by_length())
        for (const Index i : picked_->needed()) picked_->take(parameters_.of(i));
    else if (picked_ && picked)
        picked_->divide(parameters_.whole());
    else if (picked_)
        pick_again();
    if (at_parameters_ || (picked_ && (meet(equal_lengths_) || meet(equal_)))) return false;
    const double front = parameters_.front();
    const double back = parameters_.back();
    axes_ = {axis_knots(
        options_, plan_, 0, placement_of(options_, SampleKind::sequence), {front, back},
        [&](Index) -> std::optional<KnotVector> { return picked_->knots(front, back); })};
    return true;
}

void CurvePasses::see(const SampleChunk& chunk, Room& room) const {
    room.box.clear();
    room.box.add(chunk.points, chunk.count);
    room.t = parameters_.begin(chunk, room.parameters);
}

void CurvePasses::note_seen(const SampleChunk& chunk, const Room& room) {
    seen_.add(chunk, room.box);
    if (!parameters_.by_length()) return;
    parameters_.add(chunk, room.t);
    equal_lengths_.add(room.t, chunk.first > 0 && room.t.front() == 0);
    if (picked_) picked_->take(chunk.first, room.t, parameters_.way());
}

void CurvePasses::sum(const SampleChunk& chunk, Room& room) const {
    room.t = parameters_.of(chunk, room.parameters);
    system_->sum(room.t, chunk.points, seen_.weighted() ? chunk.weights : nullptr, room.sums);
}

void CurvePasses::add_sums(const Room& room) {
    system_->add(room.sums);
    telling_.insert(telling_.end(), room.sums.telling.begin(), room.sums.telling.end());
    if (parameters_.given().empty()) equal_.add(room.t);
    if (!options_.keep_per_sample) return;
    std::vector<std::vector<double>>& kept = passed_.fitted.parameters.axes;
    if (kept.empty()) kept.emplace_back().reserve(static_cast<std::size_t>(passes_.samples()));
    kept[0].insert(kept[0].end(), room.t.begin(), room.t.end());
}

/// What the samples are, by their first pass. Where the knots are known before it, the samples are
/// `summed` in the same one, unless they have weights, whose range is to be known first.
bool CurvePasses::scan(bool& summed) {
    parameters_.check_given();
    if (!parameters_.given().empty()) equal_.add(parameters_.given());
    const bool counted = passes_.samples() > 0;
    const bool by_length = parameters_.by_length();
    if (counted) find_places();
    if (counted && !by_length && !place_knots(false)) return false;
    summed = !axes_.empty();
    passes_.run(
        [&](const SampleChunk& chunk, std::size_t place) {
            see(chunk, rooms_[place]);
            if (summed) sum(chunk, rooms_[place]);
        },
        [&](const SampleChunk& chunk, std::size_t place) {
            note_seen(chunk, rooms_[place]);
            if (summed) add_sums(rooms_[place]);
        },
        [&](const SampleChunk& first) {
            centre_.assign(first.points, first.points + passes_.dim());
            if (first.weights != nullptr) summed = false;
            if (summed) system_.emplace(axes_[0], centre_);
        });
    seen_.check(passes_.samples());
    if (!seen_.usual_numbers()) return false;
    if (!counted) {
        planned(options_, SampleKind::sequence, {passes_.samples()}, passes_.dim(), 1);
        find_places();
    }
    return !axes_.empty() || place_knots(counted);
}

bool CurvePasses::assemble() {
    bool summed = false;
    if (!scan(summed)) return false;
    if (!summed) {
        note("scan");
        system_.emplace(axes_[0], centre_);
        passes_.run([&](const SampleChunk& chunk, std::size_t place) { sum(chunk, rooms_[place]); },
                    [&](const SampleChunk&, std::size_t place) { add_sums(rooms_[place]); });
    }
    passed_.equal = equal_.equal();
    const bool determined = !undetermined(axes_[0], telling_);
    note("assemble");
    return determined && !(picked_ && meet(equal_));
}

bool CurvePasses::solve() {
    control_ = solve_direct_without_rows(*system_, seen_.weighted());
    note("solve");
    return control_.has_value();
}

Passed CurvePasses::measured(const Choice& choice) {
    Fitted& fitted = passed_.fitted;
    FitReport& report = fitted.report;
    report.method = choice.driver->name;
    report.method_reason = choice.reason;
    report.gradient_norm = seen_.weight() * frobenius_norm(system_->gradient(*control_));
    fitted.spline = Spline::from_free(axes_, uncentred(*control_, centre_));
    const bool keep = options_.keep_per_sample;
    if (keep) fitted.deviations.reserve(static_cast<std::size_t>(passes_.samples()));
    DeviationSum sum;
    passes_.run(
        [&](const SampleChunk& chunk, std::size_t place) {
            Room& room = rooms_[place];
            room.t = parameters_.of(chunk, room.parameters);
            room.distances.resize(room.t.size());
            curve_deviations(fitted.spline, chunk.points, room.t, room.distances.data());
            room.part = batten::measured(room.distances);
        },
        [&](const SampleChunk&, std::size_t place) {
            const Room& room = rooms_[place];
            sum.add(room.part, room.distances);
            if (keep)
                fitted.deviations.insert(fitted.deviations.end(), room.distances.begin(),
                                         room.distances.end());
        });
    passed_.samples = passes_.samples();
    passed_.size = seen_.size();
    passed_.deviation = sum.deviation(fitted.judged_by);
    note("deviation");
    if (passes_.bytes() > 0) {
        report.passes = passes_.count();
        report.bytes_read = passes_.bytes();
        seconds_.insert(seconds_.begin(), {"reading", reading_});
    }
    report.seconds = std::move(seconds_);
    return std::move(passed_);
}

} // namespace

std::optional<Passed> fit_in_passes(SampleSource& source, const FitOptions& options) {
    check_extent(source.size(), source.dim());
    check(options);
    const Samples samples = outline(source);
    const SampleKind kind = kind_of(samples, options.shape);
    if (kind != SampleKind::sequence) return {};
    AxisPlan plan = planned(options, kind, {source.size()}, source.dim(), 1);
    const auto choice = chosen_in_passes(options, kind, requests_of(options, plan, kind, false));
    if (!choice) return {};
    CurvePasses passes(source, options, std::move(plan));
    if (passes.assemble() && passes.solve()) return passes.measured(*choice);
    return {};
}

} // namespace batten
