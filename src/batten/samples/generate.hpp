#pragma once

#include <batten/samples/samples.hpp>

#include <span>
#include <string_view>

namespace batten {

/// One of the built-in data sets.
struct Generator {
    std::string_view name;
    std::string_view description;
    Samples (*make)(std::vector<Index> size);
    /// Samples per axis when the caller does not say.
    std::vector<Index> default_size;
};

/// All built-in data sets.
std::span<const Generator> generators();

/// Makes the built-in data set `name` with `size` samples per axis (empty: its default).
/// Throws InvalidInput for an unknown name (the nearest is suggested) or a size it cannot have.
Samples generate(std::string_view name, std::vector<Index> size = {});

/// The closed NACA 4-digit section of unit chord, upper side from the trailing edge to the leading
/// edge, then the lower side, `count` points (odd), cosine spacing, blunt trailing edge as defined.
/// `digits` are the section's four digits, for instance "2412".
Samples naca4(std::string_view digits, Index count);

} // namespace batten
