#pragma once

#include <batten/core/core.hpp>
#include <batten/iterate/method.hpp>

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace batten::command {

/// `30`, `20x30` or `8x8x8`; throws InvalidInput naming the option.
std::vector<Index> parse_shape(std::string_view option, std::string_view text);

/// `DX,DY`.
std::array<double, 2> parse_spacing(std::string_view text);

/// One finite number; throws InvalidInput naming the option.
double parse_number(std::string_view option, std::string_view text);

/// Bytes: a whole number, or one with K, M or G (powers of 1024) after it; throws InvalidInput
/// naming the option.
Index parse_bytes(std::string_view option, std::string_view text);

/// Whether it is a list of whole numbers (empty: of none), and no file's name.
bool is_list(std::string_view text);

/// `0,20,40`, or the whole numbers of a file; throws InvalidInput naming the option.
std::vector<Index> index_list(std::string_view option, const std::string& text);

/// Checks of a flag's number: finite and above 0, or 0 as well.
CLI::Validator positive();
CLI::Validator not_negative();

/// `name=value` for each entry.
Settings parse_settings(const std::vector<std::string>& entries);

/// Position of `text` in `choices`; throws InvalidInput with the nearest when it is none of them.
std::size_t parse_choice(std::string_view option, std::string_view text,
                         std::span<const std::string_view> choices);

/// Makes every flag that may be repeated take one value each time: a file name that follows is not
/// swallowed.
void one_value_each(CLI::App& app);

} // namespace batten::command
