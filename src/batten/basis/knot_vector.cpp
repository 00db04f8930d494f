#include <batten/basis/knot_vector.hpp>

#include <batten/core/distinct.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

void check_ascending(const std::vector<double>& knots) {
    for (std::size_t i = 0; i < knots.size(); ++i) {
        if (!std::isfinite(knots[i]))
            throw InvalidInput(fmt::format("knot {} is not a finite number", i));
        if (i > 0 && knots[i] < knots[i - 1])
            throw InvalidInput(
                fmt::format("knots must ascend: knot {} = {} is less than knot {} = {}", i,
                            knots[i], i - 1, knots[i - 1]));
    }
}

void check_multiplicities(const KnotVector& k) {
    for (Index i = k.degree() + 1; i < k.control_count(); ++i) {
        const bool inside = k[i] > k.begin() && k[i] < k.end();
        if (inside && i + k.degree() < k.control_count() && k[i + k.degree()] == k[i])
            throw InvalidInput(fmt::format(
                "knot {} = {} has a multiplicity above the degree {}: the spline would break there",
                i, k[i], k.degree()));
    }
}

void check_periodic(const KnotVector& k) {
    const Index n = k.free_count();
    for (Index i = 0; i + n < static_cast<Index>(k.knots().size()); ++i)
        if (std::abs(k[i + n] - k[i] - k.length()) > 1e-12 * k.length())
            throw InvalidInput(
                fmt::format("closed axis: knot {} = {} must be knot {} + the period = {}", i + n,
                            k[i + n], i, k[i] + k.length()));
}

} // namespace

KnotVector::KnotVector(int degree, std::vector<double> knots, Closure closure)
    : degree_(degree), knots_(std::move(knots)), closure_(closure) {
    if (degree < 1 || degree > max_degree)
        throw InvalidInput(fmt::format("degree {} is outside 1 to {}", degree, max_degree));
    if (free_count() < degree + 1)
        throw InvalidInput(
            fmt::format("degree {} needs at least {} control points, {} knots make {}", degree,
                        degree + 1, knots_.size(), std::max<Index>(0, free_count())));
    check_ascending(knots_);
    if (!(length() > 0))
        throw InvalidInput(fmt::format("the knots' domain [{}, {}] has no length", begin(), end()));
    check_multiplicities(*this);
    if (closed()) check_periodic(*this);
}

Index KnotVector::span(double t) const {
    const auto first = knots_.begin() + degree_;
    const auto last = knots_.begin() + control_count();
    auto it = std::upper_bound(first, last, t);
    if (it == first) ++it; // t before the domain
    // at the domain's end step back over the end knot's copies, so that the span has length
    while (it != first && *(it - 1) >= *last) --it;
    return static_cast<Index>(it - knots_.begin()) - 1;
}

double KnotVector::wrapped(double t) const {
    if (!closed() || contains(t)) return t;
    const double turns = std::floor((t - begin()) / length());
    return std::clamp(t - turns * length(), begin(), end());
}

std::vector<double> KnotVector::breakpoints() const {
    return without_repeats(
        std::vector(knots_.begin() + degree_, knots_.begin() + control_count() + 1));
}

InvalidInput outside_domain(const KnotVector& knots, std::string_view what) {
    return InvalidInput(
        fmt::format("{} is outside the knots' domain [{}, {}]", what, knots.begin(), knots.end()));
}

} // namespace batten
