#include <batten/fit/reweight.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Settings that are steps of gradients, the inverse of one, or a gradient.
void divide_steps(Settings& settings, std::string_view method, double unit) {
    const bool multipliers = method == "clspia"; // these are gradients themselves
    for (const auto& [name, as_gradients] :
         {std::pair{"mu", multipliers}, std::pair{"mu_1", true}, std::pair{"nu", false}})
        if (const auto found = settings.find(name); found != settings.end())
            found->second = as_gradients ? found->second / unit : found->second * unit;
    if (const auto found = settings.find("lambda"); found != settings.end()) found->second /= unit;
}

} // namespace

double usual_weight(const std::vector<double>& weights, const FitOptions& options) {
    constexpr int most = 1022; // the power's inverse is a number, too
    if (weights.empty()) return 1;
    const auto [least, largest] = std::ranges::minmax(weights);
    if (!(least > 0) || !std::isfinite(largest)) return 1;
    if (least == largest) return largest;
    const int exponent = std::ilogb(largest);
    const bool multipliers = options.method.name == "clspia" && options.hold.equalities();
    if (multipliers && std::abs(exponent) <= 200) return 1;
    return std::ldexp(1.0, std::clamp(exponent, -most, most));
}

Samples reweighted(Samples samples, double unit) {
    for (double& weight : samples.weights) weight /= unit;
    return samples;
}

FitOptions reweighted(FitOptions options, double unit) {
    options.stop.gradient /= unit;
    divide_steps(options.method.settings, options.method.name, unit);
    if (options.observer)
        options.observer = [observer = options.observer, unit](const Iteration& now) {
            return observer({now.number, now.control, now.gradient_norm * unit, now.largest_move,
                             now.constraint_error});
        };
    return options;
}

FitResult reweighted(FitResult result, double unit) {
    FitReport& report = result.report;
    report.gradient_norm *= unit;
    report.first_gradient_norm *= unit;
    divide_steps(report.settings, report.method, 1 / unit);
    for (Goal& goal : report.goals)
        if (goal.name == "gradient") {
            goal.stated *= unit;
            goal.reached *= unit;
        }
    for (HistoryEntry& entry : report.history) entry.gradient_norm *= unit;
    return result;
}

} // namespace batten
