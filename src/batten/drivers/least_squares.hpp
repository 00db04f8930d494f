#pragma once

#include <batten/problem/problem.hpp>
#include <batten/problem/result.hpp>

namespace batten {

/// The least-squares fit over fixed knots, directly, by CLSPIA or by an iteration on the normal
/// equations: `method` is `direct`, `clspia` or one of make_method's. Throws SolverError when the
/// samples do not determine every control point and the method needs them to.
Fitted fit_least_squares(const Problem& problem, std::string_view method);

} // namespace batten
