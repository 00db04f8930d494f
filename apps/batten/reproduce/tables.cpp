#include "tables.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace batten::command {

namespace {

double number(const std::string& printed) {
    double value = 0;
    std::from_chars(printed.data(), printed.data() + printed.size(), value);
    return value;
}

/// Digits from the first that is not 0, "1.50e-3" has three.
int significant_digits(const std::string& printed) {
    int digits = 0;
    for (const char c : printed) {
        if (c == 'e' || c == 'E') break;
        const bool digit = c >= '0' && c <= '9';
        if (digit && (c != '0' || digits > 0)) ++digits;
    }
    return std::max(digits, 1);
}

/// "within 3 %", or by which factor.
std::string how_far(double factor) {
    return factor < 1.5 ? fmt::format("within {:.2g} %", 100 * (factor - 1))
                        : fmt::format("within a factor of {:.2g}", factor);
}

} // namespace

bool to_the_digit(const std::string& printed, double computed) {
    const double published = number(printed);
    if (published == 0 || computed == 0) return published == computed;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(published))) -
                                           (significant_digits(printed) - 1));
    const double off = (computed - published) / unit; // rounded: half at most; cut: below one
    return std::abs(off) <= 0.5 + 1e-6 || (std::abs(off) < 1 && off * published > 0);
}

std::string verdict(const Table& table) {
    if (table.data == Data::none) return "not run: " + table.why;
    if (table.data == Data::stand_in) return "stand-in: " + table.why;
    int printed = 0;
    int same = 0;
    double furthest = 1;
    for (const Row& row : table.rows) {
        if (row.printed.empty()) continue;
        ++printed;
        const double ratio = std::abs(row.computed / number(row.printed));
        if (to_the_digit(row.printed, row.computed) || (row.less_is_right && ratio <= 1))
            ++same;
        else
            furthest = std::max({furthest, ratio, 1 / ratio});
    }
    if (printed == 0) return table.pictures.empty() ? "ours alone" : "drawn";
    if (same == printed) return fmt::format("to the digit, {} figures", printed);
    if (same == 0) return fmt::format("{} figures, {}", printed, how_far(furthest));
    return fmt::format("{} of {} figures to the digit, the rest {}", same, printed,
                       how_far(furthest));
}

std::string in_words(const Table& table) {
    std::string text = fmt::format("  {}: {}\n", table.name, verdict(table));
    if (!table.pictures.empty()) text += fmt::format("    pictures: {}\n", table.pictures);
    if (!table.rows.empty())
        text +=
            fmt::format("    {:<56} {:>14} {:>14} {:>9}\n", "", "published", "computed", "ratio");
    for (const Row& row : table.rows) {
        const double published = number(row.printed);
        text += fmt::format("    {:<56} {:>14} {:>14.7g} {:>9}\n", row.what,
                            row.printed.empty() ? "-" : row.printed, row.computed,
                            row.printed.empty() || published == 0
                                ? "-"
                                : fmt::format("{:.5g}", row.computed / published));
    }
    return text + "\n";
}

} // namespace batten::command
