#include <batten/drivers/epia_course.hpp>

#include <batten/core/vectors.hpp>
#include <batten/drivers/iteration.hpp>
#include <batten/problem/held.hpp>

#include <algorithm>

namespace batten {

namespace {

/// Ends at no stop before the interpolated samples are hit.
class HittingPia : public Pia {
  public:
    HittingPia(const DataSide& data, const Problem& problem)
        : Pia(data, 1, problem.options.method.moving,
              Divergence::unasked), // a growing error inserts a knot
          held_(problem.options.hold.interpolate),
          least_(exactness * problem.size) {}

    bool constraints_hold() const override {
        return std::ranges::all_of(held_, [&](Index i) { return norm(residual()[i]) <= least_; });
    }

  private:
    const std::vector<Index>& held_;
    double least_;
};

} // namespace

EpiaCourse::EpiaCourse(const Problem& problem, double t_c)
    : problem_(problem), t_c_(t_c), left_(problem.options.stop.max_iterations) {
    if (!problem.tolerance.empty()) tightest_ = std::ranges::min(problem.tolerance);
}

double EpiaCourse::far(const PointSet& residual, Index sample) const {
    const double length = norm(residual[sample]);
    if (problem_.tolerance.empty()) return length;
    return length * (tightest_ / problem_.tolerance[static_cast<std::size_t>(sample)]);
}

double EpiaCourse::farthest(const PointSet& residual) const {
    if (problem_.tolerance.empty()) return largest_length(residual); // e_d [eq. 25]
    double worst = 0;
    for (Index j = 0; j < residual.size(); ++j) worst = std::max(worst, far(residual, j));
    return worst;
}

EpiaCourse::Run EpiaCourse::run(const DataSide& data, PointSet start, bool full) {
    const FitOptions& given = problem_.options;
    HittingPia pia(data, problem_);
    FitOptions options = given;
    options.most_frames = 0; // their polygons would be of several sizes
    options.stop.max_iterations = left_;
    options.stop.relative_gradient = full && runs_ == 0 ? given.stop.relative_gradient : 0;
    if (full && runs_ > 0)
        options.stop.gradient = std::max(given.stop.gradient, given.stop.relative_gradient *
                                                                  entries_.front().gradient_norm);
    if (runs_ > 0) entries_.pop_back(); // the same iteration before the insertion
    bool due = false;
    bool insert = false;
    bool within = false;
    double error = 0;
    options.observer = [&](const Iteration& now) {
        const double e_c = largest_length(pia.data_means());
        entries_.push_back({now.gradient_norm, e_c, now.control.size()});
        if (given.observer && given.observer(now) == Continue::no) return Continue::no;
        error = farthest(pia.residual());
        const double precision = std::max(given.stop.deviation, tightest_);
        const bool close = precision > 0 && error <= precision; // but for interpolated samples
        within = tightest_ > 0 && close && pia.constraints_hold();
        insert = due; // the moves after which the insertion is due have been made
        if (insert || within) return Continue::no;
        due = !full && !close && (e_c < t_c_ || error > last_error_);
        last_error_ = error;
        return Continue::yes;
    };
    Course course = iterated(pia, {std::move(start)}, data.axes(), options,
                             [&](const PointSet&) { return largest_length(pia.residual()); });
    enter(std::move(course.report));
    // what moves no more is due, too, but for a shape that holds it
    const bool still = report_.termination == Termination::stalled && report_.held_back == 0;
    const bool balanced = report_.termination == Termination::converged &&
                          report_.gradient_norm == 0 &&
                          error > std::max(given.stop.deviation, tightest_);
    if (!full && (still || balanced)) insert = true;
    if (within) {
        insert = false;
        report_.termination = Termination::tolerance_met;
    }
    if (insert) last_error_ = std::numeric_limits<double>::infinity();
    if (insert && left_ == 0) report_.termination = Termination::iteration_limit;
    return {std::move(course.control), pia.residual(), insert && left_ > 0};
}

void EpiaCourse::enter(FitReport run) {
    const Index done = problem_.options.stop.max_iterations - left_;
    left_ -= run.iterations;
    for (HistoryEntry& entry : run.history) entry.iteration += done;
    if (!report_.history.empty() && !run.history.empty()) report_.history.pop_back();
    report_.history.insert(report_.history.end(), run.history.begin(), run.history.end());
    run.history = std::move(report_.history);
    if (runs_++ > 0) {
        run.first_gradient_norm = report_.first_gradient_norm;
        run.allowed_inflections = report_.allowed_inflections;
    }
    report_ = std::move(run);
}

FitReport EpiaCourse::report(const DataSide& last, PointSet control) {
    Pia pia(last, 1, problem_.options.method.moving, Divergence::allowed);
    pia.start(control);
    report_.predicted_rate = pia.predicted_rate();
    if (const std::string note = pia.note(); !note.empty()) report_.notes.push_back(note);
    report_.iterations = problem_.options.stop.max_iterations - left_;
    std::vector<double> norms;
    for (const Entry& entry : entries_) norms.push_back(entry.gradient_norm);
    report_.observed_rate = observed_rate(norms);
    const std::size_t kept = std::min(report_.history.size(), entries_.size()); // unless cancelled
    for (std::size_t k = 0; k < kept; ++k) {
        report_.history[k].control_points = entries_[k].controls;
        report_.history[k].largest_mean = entries_[k].largest_mean;
    }
    return std::move(report_);
}

} // namespace batten
