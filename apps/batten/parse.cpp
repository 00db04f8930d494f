#include "parse.hpp"

#include <batten/core/names.hpp>
#include <batten/io/output_file.hpp>
#include <batten/io/points_file.hpp>

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten::command {

namespace {

template <class Number>
bool parsed(std::string_view text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return !text.empty() && error == std::errc() && end == text.data() + text.size();
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t at = text.find(separator);
        parts.push_back(text.substr(0, at));
        if (at == std::string_view::npos) return parts;
        text.remove_prefix(at + 1);
    }
}

/// CLI's own ranges end at the largest number, whose 309 digits they print, and let nan through.
CLI::Validator finite(std::string name, std::string rule, bool (*inside)(double)) {
    return {[rule = std::move(rule), inside](std::string& text) {
                double value = 0;
                return CLI::detail::lexical_cast(text, value) && std::isfinite(value) &&
                               inside(value)
                           ? std::string()
                           : fmt::format("{} is not a finite number{}", text, rule);
            },
            std::move(name)};
}

} // namespace

std::vector<Index> parse_shape(std::string_view option, std::string_view text) {
    std::vector<Index> shape;
    for (std::string_view part : split(text, 'x')) {
        Index n = 0;
        if (!parsed(part, n) || n < 1)
            throw InvalidInput(
                fmt::format("{} {}: counts like 30, 20x30 or 8x8x8 are needed", option, text));
        shape.push_back(n);
    }
    if (shape.size() > 3)
        throw InvalidInput(fmt::format("{} {}: at most 3 axes are possible", option, text));
    return shape;
}

std::array<double, 2> parse_spacing(std::string_view text) {
    const auto parts = split(text, ',');
    if (parts.size() != 2)
        throw InvalidInput(fmt::format("--spacing {}: two numbers like 60,60 are needed", text));
    return {parse_number("--spacing", parts[0]), parse_number("--spacing", parts[1])};
}

double parse_number(std::string_view option, std::string_view text) {
    double value = 0;
    if (!parsed(text, value) || !std::isfinite(value))
        throw InvalidInput(fmt::format("{} {}: a finite number is needed", option, text));
    return value;
}

Index parse_bytes(std::string_view option, std::string_view text) {
    constexpr std::string_view units = "KMG";
    const std::string_view digits = text.substr(0, text.find_first_of(units));
    const std::size_t unit = units.find(text.empty() ? ' ' : text.back());
    const int doublings = unit == std::string_view::npos ? 0 : 10 * (static_cast<int>(unit) + 1);
    Index count = 0;
    const bool whole = digits.size() + (doublings > 0 ? 1 : 0) == text.size();
    if (!whole || !parsed(digits, count) || count < 1 ||
        count > (std::numeric_limits<Index>::max() >> doublings))
        throw InvalidInput(
            fmt::format("{} {}: bytes like 800M are needed, K, M or G after them", option, text));
    return count << doublings;
}

bool is_list(std::string_view text) {
    return text.find_first_not_of("0123456789,") == std::string_view::npos;
}

std::vector<Index> index_list(std::string_view option, const std::string& text) {
    std::vector<double> numbers;
    if (!is_list(text)) {
        if (extension(text).empty())
            throw InvalidInput(
                fmt::format("{} {}: a list like 0,20,40 or a file is needed", option, text));
        numbers = read_table(text).values();
    } else
        for (std::size_t at = 0; at <= text.size();) {
            const std::size_t end = std::min(text.find(',', at), text.size());
            numbers.push_back(parse_number(option, text.substr(at, end - at)));
            at = end + 1;
        }
    std::vector<Index> result;
    for (double x : numbers) {
        if (x != std::floor(x) || x < 0)
            throw InvalidInput(fmt::format("{}: {} is not an index", option, x));
        result.push_back(static_cast<Index>(x));
    }
    return result;
}

CLI::Validator positive() {
    return finite("POSITIVE", " above 0", [](double value) { return value > 0; });
}

CLI::Validator not_negative() {
    return finite("NONNEGATIVE", ", 0 or more", [](double value) { return value >= 0; });
}

Settings parse_settings(const std::vector<std::string>& entries) {
    Settings settings;
    for (const std::string& entry : entries) {
        const std::size_t equals = entry.find('=');
        if (equals == std::string::npos || equals == 0)
            throw InvalidInput(fmt::format("--set {}: name=value is needed", entry));
        settings[entry.substr(0, equals)] =
            parse_number("--set " + entry.substr(0, equals + 1), entry.substr(equals + 1));
    }
    return settings;
}

std::size_t parse_choice(std::string_view option, std::string_view text,
                         std::span<const std::string_view> choices) {
    for (std::size_t k = 0; k < choices.size(); ++k)
        if (choices[k] == text) return k;
    throw InvalidInput(unknown_name(fmt::format("value of {}", option), text, choices));
}

void one_value_each(CLI::App& app) {
    for (CLI::Option* option : app.get_options())
        if (!option->get_positional() && option->get_items_expected_max() > 1)
            option->allow_extra_args(false);
}

} // namespace batten::command
