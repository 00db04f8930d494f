#pragma once

#include <batten/solve/banded_saddle.hpp>
#include <batten/system/normal_system.hpp>

#include <memory>

namespace batten {

/// A Cholesky factorisation of a normal system, to solve many right-hand sides with.
class Factorization {
  public:
    virtual ~Factorization() = default;
    Factorization() = default;
    Factorization(const Factorization&) = delete;
    Factorization& operator=(const Factorization&) = delete;
    /// (A^T D A)^{-1} b for b (N x dim).
    virtual PointSet solve(PointSet b) const = 0;
    /// The saddle point's equations with these constraints, as one band; null where what is
    /// factored is none along one axis.
    virtual std::unique_ptr<BandedSaddle> bordered(const Constraints& constraints) const;
};

/// Banded Cholesky axis by axis where the system has factors, else by nested dissection of the net.
/// Throws SolverError when the samples do not determine every control point.
std::unique_ptr<Factorization> factorize(const NormalSystem& system);

/// The Kronecker product of the system's nearby factors, axis by axis, as an approximation. Null
/// where it has none, or when one of them is singular.
std::unique_ptr<Factorization> factorize_axes(const NormalSystem& system);

/// That of banded matrices, one per axis of the net `controls`; null when one of them is singular.
std::unique_ptr<Factorization> factorize(const std::vector<BandedMatrix>& bands,
                                         const GridIndex& controls);

} // namespace batten
