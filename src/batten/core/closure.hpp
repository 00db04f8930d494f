#pragma once

namespace batten {

/// Whether a parametric axis ends, or comes back to its start.
enum class Closure { open, closed };

} // namespace batten
