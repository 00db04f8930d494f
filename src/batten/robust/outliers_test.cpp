// Outliers that were planted are found, and nothing else is, whichever way the samples are given.
#include "problems.hpp"

#include <batten/robust/sequence_outliers.hpp>

#include <algorithm>
#include <numbers>

namespace batten {
namespace {

/// A curve with samples moved off it.
struct Planted {
    PointSet points;
    Closure closure = Closure::open;
    double size = 0;
    std::vector<Index> outliers;
};

enum class Kind { wave, oval, helix, polygon };

PointSet clean(Kind kind, const std::vector<double>& t) {
    const auto m = static_cast<Index>(t.size());
    PointSet q(m, kind == Kind::helix ? 3 : 2);
    for (Index i = 0; i < m; ++i) {
        const double x = t[static_cast<std::size_t>(i)];
        const double a = 2 * std::numbers::pi * x;
        switch (kind) {
        case Kind::wave:
            q(i, 0) = 3 * x;
            q(i, 1) = std::sin(7 * x) + 0.2 * std::sin(11 * x);
            break;
        case Kind::oval:
            q(i, 0) = (1 + 0.2 * std::cos(3 * a)) * std::cos(a);
            q(i, 1) = 0.7 * (1 + 0.2 * std::cos(3 * a)) * std::sin(a);
            break;
        case Kind::helix:
            q(i, 0) = std::cos(1.5 * a);
            q(i, 1) = std::sin(1.5 * a);
            q(i, 2) = 1.5 * x + 0.2 * x * x;
            break;
        case Kind::polygon: // an L of three legs
            q(i, 0) = x < 0.4 ? 5 * x : 2;
            q(i, 1) = x < 0.4 ? 0 : 5 * (x - 0.4);
            if (x > 0.7) {
                q(i, 0) = 2 + 4 * (x - 0.7);
                q(i, 1) = 1.5 + 3 * (x - 0.7);
            }
            break;
        }
    }
    return q;
}

/// `noise` in parts of the size; every tenth sample on the mean goes 15 to 100 times as far, or of
/// clean samples 2 % to 50 % of the size; across the plane of the curve, where it shows.
Planted planted(Kind kind, Index m, double noise, double part, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> even(0, 1);
    std::vector<double> t;
    const bool closed = kind == Kind::oval;
    for (Index i = 0; i < m; ++i) {
        const double jitter = i == 0 || i == m - 1 ? 0 : 0.6 * (even(random) - 0.5);
        t.push_back((static_cast<double>(i) + jitter) / static_cast<double>(closed ? m : m - 1));
    }
    Planted result{clean(kind, t), closed ? Closure::closed : Closure::open, 0, {}};
    PointSet& q = result.points;
    result.size = diagonal(q);
    const PointSet exact = q;
    for (double& x : q.values()) x += noise * result.size * normal(random);
    for (Index i = 0; i < m; ++i) {
        if (even(random) >= part) continue;
        result.outliers.push_back(i);
        const double least = noise > 0 ? 15 * noise : 0.02;
        const double most = noise > 0 ? 100 * noise : 0.5;
        const double off = result.size * least * std::pow(most / least, even(random));
        const Index before = closed ? (i + m - 1) % m : std::max<Index>(i - 1, 0);
        const Index behind = closed ? (i + 1) % m : std::min(i + 1, m - 1);
        const double x = exact(behind, 0) - exact(before, 0);
        const double y = exact(behind, 1) - exact(before, 1);
        const double side = (even(random) < 0.5 ? -off : off) / std::hypot(x, y);
        q(i, 0) -= side * y;
        q(i, 1) += side * x;
    }
    return result;
}

std::vector<Index> found(const PointSet& q, Closure closure) {
    const std::vector<double> least(static_cast<std::size_t>(q.size()), 1e-4 * diagonal(q));
    return sequence_outliers(q, closure, least);
}

std::vector<Index> found(const Planted& planted) {
    return found(planted.points, planted.closure);
}

PointSet reversed(const PointSet& q) {
    PointSet result(q.size(), q.dim());
    for (Index i = 0; i < q.size(); ++i) std::ranges::copy(q[q.size() - 1 - i], result[i].begin());
    return result;
}

std::vector<Index> from_the_end(std::vector<Index> samples, Index m) {
    for (Index& i : samples) i = m - 1 - i;
    std::ranges::reverse(samples);
    return samples;
}

constexpr std::array kinds{Kind::wave, Kind::oval, Kind::helix, Kind::polygon};

TEST(Outliers, planted_ones_are_found_and_others_are_not) {
    for (double noise : {0.0, 1e-4, 1e-2}) {
        std::size_t there = 0;
        std::size_t hit = 0;
        std::size_t wrong = 0;
        std::size_t samples = 0;
        unsigned seed = 1;
        for (Kind kind : kinds)
            for (Index m : {200, 700, 3000})
                for (double part : {0.0, 0.01, 0.05, 0.1}) {
                    const Planted curve = planted(kind, m, noise, part, seed++);
                    const std::vector<Index> now = found(curve);
                    std::vector<Index> both;
                    std::ranges::set_intersection(now, curve.outliers, std::back_inserter(both));
                    there += curve.outliers.size();
                    hit += both.size();
                    wrong += now.size() - both.size();
                    samples += static_cast<std::size_t>(m);
                }
        // at 10 % a third of the samples have another outlier within two: some hide each other, and
        // of 200 samples with little noise some are not beyond what the curve may do between them
        EXPECT_GE(static_cast<double>(hit), 0.92 * static_cast<double>(there)) << noise;
        // normal noise beyond five and a half deviations: one sample in 10^7 along a line, more
        // where the corners of few samples leave room
        EXPECT_LE(static_cast<double>(wrong), 2e-4 * static_cast<double>(samples)) << noise;
    }
}

TEST(Outliers, first_and_last_samples_are_judged_from_one_side) {
    for (Kind kind : {Kind::wave, Kind::helix})
        for (double noise : {0.0, 1e-4})
            for (Index end : {0, 1, 198, 199}) {
                Planted curve = planted(kind, 200, noise, 0, 5);
                curve.points(end, 1) += 0.1 * curve.size;
                EXPECT_EQ(found(curve), std::vector<Index>{end}) << noise;
            }
}

TEST(Outliers, direction_unit_place_and_rotation_do_not_count) {
    for (Kind kind : kinds)
        for (double noise : {0.0, 1e-4, 1e-2}) {
            const Planted curve = planted(kind, 400, noise, 0.05, 7);
            const PointSet& q = curve.points;
            const std::vector<Index> usual = found(curve);
            EXPECT_FALSE(usual.empty());
            EXPECT_EQ(from_the_end(found(reversed(q), curve.closure), 400), usual);
            for (double unit : {3.0, 25.4, 1e9, 1e-9}) {
                PointSet other = q;
                for (double& x : other.values()) x *= unit;
                EXPECT_EQ(found(other, curve.closure), usual) << unit;
            }
            PointSet other = q;
            for (Index i = 0; i < q.size(); ++i) {
                other(i, 0) = 0.8 * q(i, 0) - 0.6 * q(i, 1) + 1e3;
                other(i, 1) = 0.6 * q(i, 0) + 0.8 * q(i, 1) - 1e3;
            }
            EXPECT_EQ(found(other, curve.closure), usual);
        }
}

TEST(Outliers, a_run_that_agrees_with_itself_stays) {
    for (Index length : {4, 6, 20}) {
        Planted curve = planted(Kind::wave, 400, 0, 0, 3);
        for (Index i = 150; i < 150 + length; ++i) curve.points(i, 1) += 0.05 * curve.size;
        EXPECT_EQ(found(curve), std::vector<Index>{}) << length;
    }
    Planted pair = planted(Kind::wave, 400, 0, 0, 3);
    for (Index i : {150, 151}) pair.points(i, 1) += 0.05 * pair.size;
    EXPECT_EQ(found(pair), (std::vector<Index>{150, 151}));
}

TEST(Outliers, a_clean_section_has_none_either_way) {
    BATTEN_NEEDS_SHARED("profile205.csv")
    const Samples section = read_points(testing::shared("profile205.csv"));
    Samples back = section;
    back.points = Points(reversed(PointSet(section.points)));
    Index counts[2];
    for (Closure closure : {Closure::open, Closure::closed})
        EXPECT_EQ(found(PointSet(section.points), closure), std::vector<Index>{});
    int k = 0;
    for (const Samples& samples : {section, back}) {
        FitOptions options;
        options.tolerance.value = 1e-3;
        options.outliers = Outliers::set_aside;
        const FitResult result = fit(samples, options);
        EXPECT_TRUE(result.report.set_aside.empty());
        counts[k++] = result.spline.control_points().size();
    }
    EXPECT_EQ(counts[0], counts[1]);
}

TEST(Outliers, of_a_grid_do_not_depend_on_its_axes) {
    const Index m = 40;
    const Index n = 50;
    PointSet q(m * n, 3);
    const PointSet noise = testing::random_points(m * n, 1, 9);
    for (Index i = 0; i < q.size(); ++i) {
        const double u = static_cast<double>(i / n) / static_cast<double>(m - 1);
        const double v = static_cast<double>(i % n) / static_cast<double>(n - 1);
        q(i, 0) = u;
        q(i, 1) = v;
        q(i, 2) = std::sin(3 * u) * std::cos(4 * v) + std::max(0.0, u + v - 1) + 1e-3 * noise(i, 0);
    }
    const std::vector<Index> planted{0, 20, 1033, 1271, 1999}; // corners, an edge, the middle
    for (Index i : planted) q(i, 2) += 0.3;
    const auto set_aside = [&](const PointSet& points, Index first, Index second) {
        Samples samples;
        samples.points = Points(points);
        samples.grid = {first, second};
        FitOptions options;
        options.shape.control_points = {8, 8};
        options.outliers = Outliers::set_aside;
        return fit(samples, options).report.set_aside;
    };
    EXPECT_EQ(set_aside(q, m, n), planted);
    EXPECT_EQ(from_the_end(set_aside(reversed(q), m, n), m * n), planted);
    PointSet across(m * n, 3);
    for (Index i = 0; i < q.size(); ++i)
        std::ranges::copy(q[i], across[(i % n) * m + i / n].begin());
    std::vector<Index> back = set_aside(across, n, m);
    for (Index& i : back) i = (i % m) * n + i / m;
    std::ranges::sort(back);
    EXPECT_EQ(back, planted);
}

} // namespace
} // namespace batten
