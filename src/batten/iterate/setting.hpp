#pragma once

#include <batten/core/core.hpp>

#include <limits>
#include <string>
#include <string_view>
#include <variant>

namespace batten {

/// Whether a range holds its own end.
enum class RangeEnd { open, closed };

/// Which numbers of a range count.
enum class Numbers { real, whole };

/// The numbers that a setting may be.
struct SettingRange {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    RangeEnd low_end = RangeEnd::open;
    RangeEnd high_end = RangeEnd::open;
    Numbers numbers = Numbers::real;

    bool contains(double value) const;
    /// The range in words, as `0 < omega < 2` for the name omega.
    std::string words(std::string_view name) const;
};

/// A method's own setting, given as `--set name=value`; what is given is taken as it is.
struct MethodSetting {
    std::string_view name;
    std::string_view meaning;
    /// What holds when it is not given: a number, or how the method chooses it.
    std::variant<double, std::string_view> otherwise;
    SettingRange range;
    /// Where it is defined; empty when it is this program's own.
    std::string_view source{};

    std::string default_words() const;
};

/// Throws InvalidInput unless `range` holds the value, as
/// `setting mu = 3 of method lspia is outside 0 < mu < 0.5, its region of convergence`, where the
/// last part is `which`.
void check_setting(std::string_view method, std::string_view name, double value,
                   const SettingRange& range, std::string_view which = {});

} // namespace batten
