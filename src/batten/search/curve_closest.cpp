#include <batten/search/curve_closest.hpp>

#include <batten/core/vectors.hpp>
#include <batten/search/curve_knots.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

CurveTrial rescaled(CurveTrial trial, double looser) {
    trial.worst *= looser;
    scale(trial.ratio, looser);
    return trial;
}

CurveTrial rescaled(CurveTrial trial, const std::vector<double>& before,
                    const std::vector<double>& now) {
    trial.worst = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        trial.ratio[i] *= before[i] / now[i];
        trial.worst = std::max(trial.worst, trial.ratio[i]);
    }
    return trial;
}

BetweenSamples check_reached(const CurveTask& task, const CurveTrial& trial) {
    std::vector<double> reached = task.tolerance;
    scale(reached, std::max(1.0, trial.worst));
    return check_between(spline_of(trial), task.samples.points, trial.parameters, reached);
}

bool acceptable(const CurveTask& task, const CurveTrial& trial) {
    if (trial.control.empty() || !std::isfinite(trial.worst) || !shape_kept(task, trial))
        return false;
    return !is_wild(task, trial, std::max(1.0, trial.worst));
}

void ClosestSeen::see(const CurveTask& task, const CurveTrial& trial) {
    if (trial.worst < worst() && acceptable(task, trial)) trial_ = trial;
}

void ClosestSeen::see(const CurveTask& task, const ClosestSeen& other, double looser) {
    if (!(other.worst() * looser < worst())) return;
    see(task,
        rescaled(*other.trial_, looser)); // it may have been acceptable for looser tolerances alone
}

double ClosestSeen::worst() const {
    return trial_ ? trial_->worst : std::numeric_limits<double>::infinity();
}

} // namespace batten
