#pragma once

#include <batten/drivers/table.hpp>

namespace batten {

/// A driver for a problem that leaves the method open, or the one that it names.
struct Choice {
    const Driver* driver;
    std::string reason; ///< empty when the caller named it
};

/// The first driver, fastest first, whose column has all that is asked and that can determine the
/// control points. Throws InvalidInput when there is none, or the named one's column lacks
/// something.
Choice choose(const Problem& problem);

/// The driver that answers what is asked in passes over a sequence's samples, as long as these
/// determine every control point: the one that `choose` would name. Nothing where it needs them in
/// memory.
std::optional<Choice> chosen_in_passes(const FitOptions& options, SampleKind kind, Requests asked);

} // namespace batten
