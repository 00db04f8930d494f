#pragma once

#include <span>
#include <string>
#include <string_view>

namespace batten {

/// The candidate that differs least from `word` (edit distance), or an empty view when none is
/// near.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> candidates);

/// `unknown WHAT 'WORD'; did you mean 'X'?`, or the list of candidates when none is near.
std::string unknown_name(std::string_view what, std::string_view word,
                         std::span<const std::string_view> candidates);

} // namespace batten
