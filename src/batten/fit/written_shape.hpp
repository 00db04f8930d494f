#pragma once

#include <batten/problem/result.hpp>

namespace batten {

/// Of a fit that keeps a shape: counts the inflections of the control polygon in its doubles as
/// they are handed out, exactly, and where there are more than allowed bends what is straight but
/// for rounding the way of its neighbours.
void keep_as_written(Fitted& fitted);

} // namespace batten
