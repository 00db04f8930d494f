#include <batten/iterate/setting.hpp>

#include <cmath>
#include <fmt/format.h>

namespace batten {

bool SettingRange::contains(double value) const {
    const bool above = low_end == RangeEnd::closed ? value >= low : value > low;
    const bool below = high_end == RangeEnd::closed ? value <= high : value < high;
    return above && below && (numbers == Numbers::real || value == std::round(value));
}

std::string SettingRange::words(std::string_view name) const {
    const auto sign = [](RangeEnd end) { return end == RangeEnd::closed ? "<=" : "<"; };
    if (!std::isfinite(low) && !std::isfinite(high)) return "any number";
    std::string result = numbers == Numbers::whole ? "the whole numbers " : "";
    if (std::isfinite(low)) result += fmt::format("{:.10g} {} ", low, sign(low_end));
    result += name;
    if (std::isfinite(high)) result += fmt::format(" {} {:.10g}", sign(high_end), high);
    return result;
}

std::string MethodSetting::default_words() const {
    if (const double* number = std::get_if<double>(&otherwise)) return fmt::format("{}", *number);
    return std::string(std::get<std::string_view>(otherwise));
}

void check_setting(std::string_view method, std::string_view name, double value,
                   const SettingRange& range, std::string_view which) {
    if (!std::isfinite(value))
        throw InvalidInput(
            fmt::format("setting {} = {} of method {} is not finite", name, value, method));
    if (!range.contains(value))
        throw InvalidInput(fmt::format("setting {} = {} of method {} is outside {}{}{}", name,
                                       value, method, range.words(name), which.empty() ? "" : ", ",
                                       which));
}

} // namespace batten
