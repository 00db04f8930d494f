#pragma once

#include <batten/core/core.hpp>

#include <span>
#include <string_view>
#include <vector>

namespace batten {

inline constexpr int max_degree = 9;

/// A degree and its knots t_0 <= ... <= t_{N+p} along one axis: N B-splines of degree p on the
/// domain [t_p, t_N].
///
/// A closed axis has periodic knots, t_{i+n} = t_i + period with n = N - p, and its last p control
/// points repeat its first p; the n others are free.
class KnotVector {
  public:
    KnotVector() = default;
    /// Throws InvalidInput unless degree is 1 to 9, there are at least 2 (degree + 1) knots
    /// (closed: a period of at least degree + 1 spans), all finite and ascending, the domain has
    /// length, no knot inside the domain has a multiplicity above the degree, and closed knots are
    /// periodic to 1e-12 of the period.
    KnotVector(int degree, std::vector<double> knots, Closure closure = Closure::open);

    int degree() const { return degree_; }
    Closure closure() const { return closure_; }
    bool closed() const { return closure_ == Closure::closed; }
    std::span<const double> knots() const { return knots_; }
    double operator[](Index i) const { return knots_[static_cast<std::size_t>(i)]; }

    /// Number N of B-splines, and of control points as stored.
    Index control_count() const { return static_cast<Index>(knots_.size()) - degree_ - 1; }
    /// Number of free control points: N, or N - p on a closed axis.
    Index free_count() const { return closed() ? control_count() - degree_ : control_count(); }

    double begin() const { return (*this)[degree_]; }
    double end() const { return (*this)[control_count()]; }
    double length() const { return end() - begin(); }

    /// The k with t_k <= t < t_{k+1} inside the domain; the last such k at the domain's end.
    /// Parameters outside the domain get the first or last span.
    Index span(double t) const;

    /// Whether t is in the domain, its ends included.
    bool contains(double t) const { return t >= begin() && t <= end(); }

    /// t moved by whole periods into the domain of a closed axis; unchanged on an open one.
    double wrapped(double t) const;

    /// The distinct knots inside the closed domain, ascending: the breakpoints of the polynomial
    /// pieces.
    std::vector<double> breakpoints() const;

    bool operator==(const KnotVector&) const = default;

  private:
    int degree_ = 0;
    std::vector<double> knots_;
    Closure closure_ = Closure::open;
};

/// What to throw for a parameter outside the domain, which `what` names with its value.
InvalidInput outside_domain(const KnotVector& knots, std::string_view what);

} // namespace batten
