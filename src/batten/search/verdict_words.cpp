#include <batten/search/verdict_words.hpp>

#include <batten/search/search.hpp>

#include <fmt/format.h>

namespace batten {

namespace {

std::string reason(const Shortfall& s) {
    switch (s.why) {
    case NotMet::limited:
        return fmt::format("{} control points are allowed and do not suffice", s.allowed);
    case NotMet::noise:
        return fmt::format("the samples' noise level is {:.3g}, and only a curve through nearly "
                           "every sample would follow it",
                           s.noise / s.unit);
    case NotMet::held:
        return "what must hold keeps the spline from some samples; without it they might be "
               "reached";
    case NotMet::wild:
        return "what is within at every sample is wild between some";
    case NotMet::crowded:
        break;
    }
    return fmt::format(
        "no such fit was found with at most {:.0f} % of the samples as control points",
        100 * most_part);
}

} // namespace

std::string not_met_words(const Shortfall& s) {
    return fmt::format("not met: {}; the {} fit found: {} control points, largest deviation {:.3g}",
                       reason(s), s.why == NotMet::noise ? "best smooth" : "closest smooth",
                       s.control_points, s.deviation / s.unit);
}

std::string near_interpolation_words(Index control_points, Index samples, double noise,
                                     double unit) {
    if (!near_interpolation(control_points, samples)) return {};
    const std::string level = noise > 0
                                  ? fmt::format("noise level seen in them {:.3g}", noise / unit)
                                  : "their noise level is unknown";
    return fmt::format(", but it nearly interpolates: {} control points for {} samples; {}",
                       control_points, samples, level);
}

} // namespace batten
