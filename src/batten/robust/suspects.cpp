#include <batten/robust/suspects.hpp>

#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// The first of these that there is.
using Stencils = std::array<Stencil, 5>;
constexpr Stencils nearest{closest, Stencil{1, 2, 2}, Stencil{2, 1, 2}, Stencil{3, 0, 2},
                           Stencil{0, 3, 2}};
/// Beyond the other ones of a pair or run.
constexpr Stencils next_nearest{Stencil{2, 2, 3, 1}, Stencil{1, 2, 2, 1}, Stencil{2, 1, 2, 1},
                                Stencil{3, 0, 2}, Stencil{0, 3, 2}};

struct Residuals {
    std::vector<double> plain;
    std::vector<double> normal; ///< in units of a sample's noise; infinite of samples left out
};

Residuals residuals(const Trusted& trusted, std::size_t axis, const Stencils& stencils) {
    const auto m = static_cast<std::size_t>(trusted.size());
    constexpr double none = std::numeric_limits<double>::infinity();
    Residuals result{std::vector<double>(m, none), std::vector<double>(m, none)};
    for_each_block(trusted.size(), 4096, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i) {
            if (!trusted.trusts(i)) continue;
            Prediction here;
            for (std::size_t s = 0; s < stencils.size() && !here.exists(); ++s)
                here = trusted.predict(i, axis, stencils[s]);
            result.plain[static_cast<std::size_t>(i)] = here.residual;
            result.normal[static_cast<std::size_t>(i)] = here.normal();
        }
    });
    return result;
}

/// The largest usual residual if only the smallest quarter are: those of noise along a line, the
/// least of all beside their largest.
double largest_of_few(std::vector<double> normal) {
    std::erase_if(normal, [](double x) { return !std::isfinite(x); });
    if (normal.empty()) return std::numeric_limits<double>::infinity();
    const auto quarter = normal.begin() + std::ssize(normal) / 4;
    std::ranges::nth_element(normal, quarter);
    return 16 * *quarter;
}

constexpr Index half_window = 32;

/// Whether most values up to half a window from one, every second of them, are below a bound: then
/// their median is. Values that are not finite do not count.
bool most_below(const std::vector<double>& values, const Trusted& trusted, std::size_t axis,
                Index place, double bound) {
    int below = 0;
    int count = 0;
    const auto add = [&](Index at) {
        const double value = values[static_cast<std::size_t>(at)];
        below += value < bound ? 1 : 0;
        count += value < std::numeric_limits<double>::infinity() ? 1 : 0;
    };
    const Index stride = trusted.grid().stride(axis);
    const Index position = place / stride % trusted.grid().length(axis);
    if (position >= half_window && position + half_window < trusted.grid().length(axis)) {
        for (Index k = -half_window; k <= half_window; k += 2) add(place + k * stride);
    } else {
        for (Index k = -half_window; k <= half_window; k += 2)
            if (const Index at = trusted.beside(place, axis, k); at >= 0) add(at);
    }
    return 2 * below > count;
}

/// Marks samples whose residual is large; again without what was marked, for outliers hide each
/// other.
void mark(std::vector<char>& marked, Residuals residuals, const Trusted& trusted, std::size_t axis,
          const std::vector<double>& least) {
    constexpr int rounds = 2;
    const double part = 0.67 * UsualResidual(residuals.normal).ratio();
    const auto m = static_cast<Index>(marked.size());
    std::vector<char> next(marked.size(), 0);
    std::vector<char> stale(marked.size(), 1);
    for (int round = 0; round < rounds; ++round) {
        for_each_block(m, 4096, [&](const Block& block) {
            for (Index i = block.begin; i < block.end; ++i) {
                const auto k = static_cast<std::size_t>(i);
                const double here = residuals.plain[k];
                next[k] = stale[k] && std::isfinite(here) && here > least[k] / 3 &&
                          most_below(residuals.plain, trusted, axis, i, here / part);
            }
        });
        std::ranges::fill(stale, 0);
        for (Index i = 0; i < m; ++i) {
            if (!next[static_cast<std::size_t>(i)]) continue;
            marked[static_cast<std::size_t>(i)] = 1;
            residuals.plain[static_cast<std::size_t>(i)] = std::numeric_limits<double>::infinity();
            for (Index k = -half_window; k <= half_window; ++k)
                if (const Index at = trusted.beside(i, axis, k); at >= 0)
                    stale[static_cast<std::size_t>(at)] = 1;
        }
    }
}

/// Marks the samples next to marked ones along an axis, and what is between two of them or between
/// one and an end, up to three in a row.
void close_gaps(std::vector<char>& marked, const Trusted& trusted, std::size_t axis) {
    constexpr Index most = 5; // with those next to marked ones
    const std::vector<char> before = marked;
    for (Index i = 0; i < trusted.size(); ++i) {
        if (!before[static_cast<std::size_t>(i)]) continue;
        for (Index side : {-1, 1}) {
            Index far = 1;
            Index at = trusted.beside(i, axis, side);
            while (at >= 0 && far <= most && !before[static_cast<std::size_t>(at)])
                at = trusted.beside(i, axis, side * ++far);
            for (Index k = far > most ? 1 : far - 1; k > 0; --k)
                marked[static_cast<std::size_t>(trusted.beside(i, axis, side * k))] = 1;
        }
    }
}

/// Leaves out, round by round, the samples that are furthest off among those next to them, and
/// marks them: where outliers are many every residual knows of one, but the largest are theirs.
std::vector<char> farthest(Trusted trusted, std::size_t axis, const std::vector<double>& least) {
    constexpr int most_rounds = 40;
    std::vector<char> marked(static_cast<std::size_t>(trusted.size()), 0);
    for (int round = 0; round < most_rounds; ++round) {
        const Residuals here = residuals(trusted, axis, nearest);
        const double large = 0.67 * largest_of_few(here.normal);
        std::vector<Index> now;
        for (Index i = 0; i < trusted.size(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            if (!std::isfinite(here.normal[k]) || here.normal[k] <= large ||
                here.plain[k] <= least[k] / 3)
                continue;
            bool most = true;
            for (Index side : {-1, 1}) {
                std::array<Index, 2> found{};
                const Index count = trusted.nearest(i, axis, side, found);
                for (Index j = 0; j < count; ++j)
                    most =
                        most &&
                        here.normal[static_cast<std::size_t>(found[static_cast<std::size_t>(j)])] <=
                            here.normal[k];
            }
            if (most) now.push_back(i);
        }
        if (now.empty()) break;
        trusted.leave_out(now);
        for (Index i : now) marked[static_cast<std::size_t>(i)] = 1;
    }
    return marked;
}

/// Median distance of samples a few apart along an axis, per sample: noise adds little to it.
double usual_step(const Trusted& trusted, std::size_t axis) {
    const Index apart = std::clamp<Index>(trusted.grid().length(axis) / 20, 1, 16);
    std::vector<double> steps;
    for (Index i = 0; i < trusted.size(); ++i)
        if (const Index to = trusted.beside(i, axis, apart); to >= 0)
            steps.push_back(distance(trusted.points()[i], trusted.points()[to]) /
                            static_cast<double>(apart));
    return median(std::move(steps));
}

bool most(const std::vector<char>& marked) {
    return 2 * std::ranges::count(marked, 1) > std::ssize(marked);
}

} // namespace

std::vector<double> normal_residuals(const Trusted& trusted, std::size_t axis) {
    return residuals(trusted, axis, nearest).normal;
}

std::vector<double> counted(Index count) {
    std::vector<double> result(static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i)
        result[static_cast<std::size_t>(i)] = static_cast<double>(i) / static_cast<double>(count);
    return result;
}

Suspects suspects(const Trusted& trusted, const std::vector<double>& least) {
    Suspects result{std::vector<Index>(), std::vector<double>(trusted.axis_count(), 0)};
    std::vector<char> all(static_cast<std::size_t>(trusted.size()), 1);
    for (std::size_t axis = 0; axis < trusted.axis_count(); ++axis) {
        std::vector<char> marked(all.size(), 0);
        Residuals here = residuals(trusted, axis, nearest);
        Trusted even = trusted;
        if (trusted.by_chords(axis)) {
            even.place_along(axis, counted(trusted.grid().length(axis)));
            Residuals there = residuals(even, axis, nearest);
            const double noise =
                std::min(UsualResidual(here.normal).median, UsualResidual(there.normal).median);
            const double step = usual_step(trusted, axis);
            result.noise[axis] = step > 0 ? noise / step : 0;
            mark(marked, std::move(there), trusted, axis, least);
        }
        mark(marked, residuals(even, axis, next_nearest), trusted, axis, least);
        if (!result.noisy(axis)) mark(marked, std::move(here), trusted, axis, least);
        close_gaps(marked, trusted, axis);
        if (most(marked)) {
            marked = farthest(even, axis, least);
            close_gaps(marked, trusted, axis);
        }
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = all[i] && marked[i];
    }
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i]) result.samples.push_back(static_cast<Index>(i));
    return result;
}

} // namespace batten
