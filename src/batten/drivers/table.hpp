#pragma once

#include <batten/iterate/methods.hpp>
#include <batten/problem/requests.hpp>
#include <batten/problem/result.hpp>

#include <optional>
#include <span>
#include <string>

namespace batten {

/// Something that answers a problem: a direct solution, an iteration, a search.
struct Driver : MethodEntry {
    /// What it can be asked for, for each kind of samples that it fits.
    std::optional<Requests> sequence;
    std::optional<Requests> grid;
    std::optional<Requests> cloud;
    /// Answers the problem; the method is named, as some drivers serve several.
    Fitted (*fit)(const Problem& problem, std::string_view method);
    /// What of a sequence's column needs no more than passes over the samples
    /// (drivers/curve_passes.hpp); nothing where the driver knows none.
    std::optional<Requests> passes{};

    const std::optional<Requests>& takes(SampleKind kind) const {
        return kind == SampleKind::sequence ? sequence : kind == SampleKind::grid ? grid : cloud;
    }
};

/// Every driver, in the order of the documentation.
std::span<const Driver> drivers();

/// The driver of that name; throws InvalidInput for an unknown one (the nearest is suggested).
const Driver& driver(std::string_view name);

/// Throws InvalidInput when a driver's column lacks what is asked: the one place and the one
/// wording for every option that a method does not know. Names a driver that can.
void check_column(const Driver& driver, SampleKind kind, Requests asked);

/// The table in words: a row per request, a column per driver, a letter per kind of samples for
/// which both go together (s: sequence, g: grid, c: cloud), - for none.
std::string driver_table();

} // namespace batten
