#include <batten/basis/place_knots.hpp>

#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

void check_count(int degree, Index n) {
    if (degree < 1 || degree > max_degree)
        throw InvalidInput(fmt::format("degree {} is outside 1 to {}", degree, max_degree));
    if (n < degree + 1)
        throw InvalidInput(fmt::format("degree {} needs at least {} control points, got {}", degree,
                                       degree + 1, n));
}

/// Interior breakpoints for n control points: n - p - 1 of an open axis, n - 1 of a closed one.
Index interior_count(int degree, Index n, Closure closure) {
    return closure == Closure::closed ? n - 1 : n - degree - 1;
}

} // namespace

std::vector<KnotPlace> knot_places(Index count, int degree, Index n, Closure closure,
                                   KnotPlacement rule) {
    check_count(degree, n);
    if (n > count)
        throw InvalidInput(
            fmt::format("{} control points need at least as many samples, got {}", n, count));
    const bool closed = closure == Closure::closed;
    const Index knots = interior_count(degree, n, closure);
    const double d = static_cast<double>(count) / static_cast<double>(knots + 1);
    // eq. 9.69 puts knot j at place j d - 1 among the samples; its mirror image is at j d, on a
    // closed axis, whose first sample stays, at j d + 1
    const double shift = rule != KnotPlacement::both_ends ? 0 : closed ? 1 : 0.5;
    std::vector<KnotPlace> places;
    for (Index j = 1; j <= knots; ++j) {
        const double jd = static_cast<double>(j) * d + shift;
        const auto i = static_cast<Index>(std::floor(jd));
        places.push_back({i - 1, jd - static_cast<double>(i)});
    }
    return places;
}

KnotVector knots_from_parameters(std::span<const double> parameters, int degree, Index n,
                                 Closure closure, KnotPlacement rule) {
    const auto m = static_cast<Index>(parameters.size());
    const bool closed = closure == Closure::closed;
    if (closed && rule == KnotPlacement::both_ends && n == m)
        return knots_at_parameters(parameters, degree);
    std::vector<double> interior;
    for (const auto& [before, part] : knot_places(m, degree, n, closure, rule)) {
        const auto i = static_cast<std::size_t>(before);
        const double next = before + 1 < m ? parameters[i + 1] : 1;
        interior.push_back(std::lerp(parameters[i], next, part));
    }
    if (closed) return knots_around(degree, interior, 0, 1, closure);
    return knots_around(degree, interior, parameters.front(), parameters.back(), closure);
}

KnotVector averaged_knots(std::span<const double> parameters, int degree) {
    const auto n = static_cast<Index>(parameters.size());
    check_count(degree, n);
    std::vector<double> interior;
    for (Index k = 1; k < n - degree; ++k) {
        double sum = 0;
        for (Index i = k; i < k + degree; ++i) sum += parameters[static_cast<std::size_t>(i)];
        interior.push_back(sum / degree);
    }
    return knots_around(degree, interior, parameters.front(), parameters.back());
}

KnotVector knots_at_parameters(std::span<const double> parameters, int degree) {
    check_count(degree, static_cast<Index>(parameters.size()));
    std::vector<double> cycle(parameters.begin(), parameters.end());
    if (degree % 2 == 0) {
        double before = parameters.back() - 1;
        for (double& t : cycle) {
            const double middle = (before + t) / 2;
            before = t;
            t = middle;
        }
    }
    return knots_around(degree, std::span(cycle).subspan(1), cycle.front(), cycle.front() + 1,
                        Closure::closed);
}

KnotVector uniform_knots(int degree, Index n, double begin, double end, Closure closure) {
    check_count(degree, n);
    const Index count = interior_count(degree, n, closure);
    std::vector<double> interior;
    for (Index j = 1; j <= count; ++j)
        interior.push_back(begin +
                           (end - begin) * static_cast<double>(j) / static_cast<double>(count + 1));
    return knots_around(degree, interior, begin, end, closure);
}

KnotVector knots_around(int degree, std::span<const double> interior, double begin, double end,
                        Closure closure) {
    const auto p = static_cast<std::size_t>(degree);
    std::vector<double> knots;
    if (closure == Closure::open) {
        knots.assign(p + 1, begin);
        knots.insert(knots.end(), interior.begin(), interior.end());
        knots.insert(knots.end(), p + 1, end);
        return {degree, std::move(knots), closure};
    }
    std::vector<double> cycle{begin};
    cycle.insert(cycle.end(), interior.begin(), interior.end());
    const auto n = static_cast<Index>(cycle.size());
    const double period = end - begin;
    for (Index i = -degree; i <= n + degree; ++i) {
        const Index turn = i >= 0 ? i / n : -((-i + n - 1) / n);
        knots.push_back(cycle[static_cast<std::size_t>(i - turn * n)] +
                        static_cast<double>(turn) * period);
    }
    return {degree, std::move(knots), closure};
}

} // namespace batten
