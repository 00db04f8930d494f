#pragma once

namespace batten {

/// Whether a parametric axis ends, or comes back to its start.
enum class Closure { open, closed };

/// Which end of an axis.
enum class AxisEnd { begin, end };

} // namespace batten
