#pragma once

#include <batten/solve/factorization.hpp>

namespace batten {

/// Cholesky's factor of a system's entries by nested dissection of its net, each part dense
/// [DuffReid1983]. Throws SolverError where a pivot is below 1e-14 of its diagonal entry.
std::unique_ptr<Factorization> factorize_nested(const NormalSystem& system);

} // namespace batten
