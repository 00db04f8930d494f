#pragma once

#include <batten/problem/options.hpp>
#include <batten/system/system_sums.hpp>

#include <array>

namespace batten {

/// What a system to be saved is assembled over.
struct AssembleOptions {
    /// As of a fit of a stated size or knots, `control_points` or `knots`.
    ShapeOptions shape{};
    /// Where the axes' parameters begin and end, one entry per axis or a single one for all: the
    /// knots are evenly spaced over it; empty: they lie as in a fit. So that systems can be merged,
    /// a cloud's parameters are its coordinates in the plane as they stand where a domain or knots
    /// are stated, and stretched to [0, 1] where they are not.
    std::vector<std::array<double, 2>> domain{};
};

/// The sums over the samples that their least-squares fit needs, to be saved (io/system_file.hpp),
/// merged and solved later. Throws InvalidInput as fit() does, when neither size nor knots are
/// stated, a domain has no length, a parameter is outside it, or the squares of coordinates or
/// weights leave the range of numbers (2^-200 to 2^200).
SystemSums assemble_system(const Samples& samples, const AssembleOptions& options);

} // namespace batten
