#include <batten/search/curve_spread.hpp>

#include <batten/search/curve_knots.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace batten {

std::vector<double> spread(const CurveTask& task, const CurveTrial& trial, std::size_t count,
                           int smoothing) {
    if (smoothing == evenly) {
        std::vector<double> interior;
        for (std::size_t k = 1; k <= count; ++k)
            interior.push_back(trial.knots.begin() + trial.knots.length() * static_cast<double>(k) /
                                                         static_cast<double>(count + 1));
        return interior;
    }
    const Spline spline = spline_of(trial);
    const std::vector<double> breaks = trial.knots.breakpoints();
    const std::array order{task.degree};
    std::vector<std::vector<double>> top; // the highest derivative, constant on each span
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
        top.push_back(spline(std::array{(breaks[b] + breaks[b + 1]) / 2}, order));
    std::vector<double> jump(breaks.size(), 0);
    for (std::size_t b = 1; b + 1 < breaks.size(); ++b) {
        jump[b] = distance(top[b - 1], top[b]) / (breaks[b + 1] - breaks[b - 1]);
        const auto at =
            std::ranges::lower_bound(trial.parameters, breaks[b]) - trial.parameters.begin();
        jump[b] /= // bends count in parts of the tolerance there
            task.tolerance[static_cast<std::size_t>(std::min<Index>(at, task.samples.size() - 1))];
    }
    jump.front() = jump[std::min<std::size_t>(1, breaks.size() - 1)];
    jump.back() = jump[breaks.size() - 2];
    for (int pass = 0; pass < smoothing; ++pass) {
        const std::vector<double> before = jump;
        for (std::size_t b = 1; b + 1 < jump.size(); ++b)
            jump[b] = (before[b - 1] + 2 * before[b] + before[b + 1]) / 4;
    }
    std::vector<double> mass{0};
    const double mean = [&] {
        double sum = 0;
        for (double x : jump) sum += x;
        return sum / static_cast<double>(jump.size());
    }();
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
        const double density =
            std::pow((jump[b] + jump[b + 1]) / 2 + 1e-3 * mean, 1.0 / (task.degree + 1));
        mass.push_back(mass.back() + density * (breaks[b + 1] - breaks[b]));
    }
    if (!(mass.back() > 0)) return spread(task, trial, count, evenly); // a single piece
    std::vector<double> interior;
    std::size_t b = 0;
    for (std::size_t k = 1; k <= count; ++k) {
        const double wanted = mass.back() * static_cast<double>(k) / static_cast<double>(count + 1);
        while (b + 2 < breaks.size() && mass[b + 1] < wanted) ++b;
        interior.push_back(breaks[b] + (breaks[b + 1] - breaks[b]) * (wanted - mass[b]) /
                                           (mass[b + 1] - mass[b]));
    }
    return interior;
}

} // namespace batten
