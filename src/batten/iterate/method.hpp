#pragma once

#include <batten/core/core.hpp>

#include <map>
#include <string>
#include <string_view>

namespace batten {

/// Named numbers of a method: the weights that it was given or chose; what is absent is chosen.
using Settings = std::map<std::string, double>;

/// Relative accuracy of the extreme eigenvalues that step factors are chosen by.
inline constexpr double default_eigenvalue_tolerance = 1e-2;

/// One geometric iteration P <- P + M(W(Q - A P)): proposes moves of the control points (N x dim).
///
/// The loop calls start(P^0) once, then per iteration propose(P^k) and, with the moves that were
/// really made, accept(). A method with memory must remember those, not the ones it proposed.
class Method {
  public:
    virtual ~Method() = default;
    Method() = default;
    Method(const Method&) = delete;
    Method& operator=(const Method&) = delete;

    virtual std::string_view name() const = 0;
    /// Prepares for the control points P^0, which it may move first; throws InvalidInput when a
    /// setting forbids convergence.
    virtual void start(PointSet& control) = 0;
    /// Goes on with the memory of an earlier run instead of a fresh start, also after its knots
    /// were refined: `last_moves` (N x dim) led to the control points that start() is given, both
    /// refined alike. A method without memory has no use for them.
    virtual void resume(PointSet /*last_moves*/) {}
    /// The moves that the method wants at P^k.
    virtual const PointSet& propose(const PointSet& control) = 0;
    /// The moves made from P^k to P^{k+1}.
    virtual void accept(const PointSet& moves) = 0;
    /// The norm that the stop rule tests, at the control points of the last propose():
    /// the Frobenius norm of A^T(Q - AP), or of the method's own W(Q - AP) before step factors.
    virtual double gradient_norm() const = 0;
    /// What StopRule::relative_gradient is relative to, asked once after the first propose(): the
    /// gradient's own size at P^0, free of whatever else the norm holds.
    virtual double reference_norm() const { return gradient_norm(); }
    /// Sum of squared lengths of what the constraints lack at the last propose(); 0 without
    /// constraints.
    virtual double constraint_error() const { return 0; }
    /// Whether the constraints are met closely enough at the last propose() to end there.
    virtual bool constraints_hold() const { return true; }
    /// Whether the last propose() moves nothing for now, which is no end: there is a memory to
    /// fill.
    virtual bool rests() const { return false; }
    /// The weights in use, known after start().
    virtual Settings settings() const { return {}; }
    /// Those and, where the spectrum took any, `setup_products`.
    Settings account() const {
        Settings result = settings();
        if (setup_products_ > 0) result["setup_products"] = static_cast<double>(setup_products_);
        return result;
    }
    /// What the user should know of the problem, found at start(): a sentence, or nothing.
    virtual std::string note() const { return {}; }
    /// Predicted factor by which the error falls per iteration, 0 when the theory gives none.
    virtual double predicted_rate() const { return 0; }

  protected:
    /// Products with A^T D A, or solves in its place, that the spectrum took at start(): each costs
    /// about a step; 0 where no eigenvalues are needed.
    Index setup_products_ = 0;
};

} // namespace batten
