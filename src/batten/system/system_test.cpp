#include "problems.hpp"

#include <batten/iterate/lspia.hpp>
#include <batten/system/factored_system.hpp>
#include <batten/system/roughness.hpp>
#include <batten/system/stencil_system.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <fstream>

namespace batten {
namespace {

using testing::random_parameters;
using testing::random_points;

using reference::collocation;
using reference::least_squares;
using LongMatrix = reference::Matrix;

TEST(OnePass, control_points_agree_with_extended_precision) {
    for (int p : {1, 3, 5}) {
        const auto t = random_parameters(3000, 1);
        const PointSet q = random_points(3000, 3, 2);
        const KnotVector k = knots_from_parameters(t, p, 40);
        const LongMatrix exact = least_squares(collocation(k, t), reference::matrix(q));
        const auto system = assemble({k}, testing::sequence(q), {{t}, {}});
        const PointSet ours = uncentred(solve_direct(*system), system->centre());
        EXPECT_LT(reference::difference(exact, ours),
                  1e-11 * static_cast<double>(exact.cwiseAbs().maxCoeff()))
            << p; // condition of A^T A: 8, 1e3, 1e5
    }
}

TEST(OnePass, a_grids_control_points_agree_with_extended_precision) {
    const Samples peaks = generate("peaks", {400, 300});
    const Parameters t = parametrize(peaks, Parametrization::chord, {Closure::open, Closure::open});
    const std::vector<KnotVector> axes{knots_from_parameters(t.axes[0], 3, 40),
                                       knots_from_parameters(t.axes[1], 3, 35)};
    const LongMatrix a = collocation(axes[0], t.axes[0]);
    const LongMatrix b = collocation(axes[1], t.axes[1]);
    const auto system = assemble(axes, peaks, t);
    const PointSet ours = uncentred(solve_direct(*system), system->centre());
    for (Index d = 0; d < 3; ++d) {
        LongMatrix q(400, 300);
        for (Index i = 0; i < 400; ++i)
            for (Index j = 0; j < 300; ++j) q(i, j) = peaks.points(i * 300 + j, d);
        const LongMatrix half = least_squares(a, q);
        const LongMatrix exact = least_squares(b, half.transpose()).transpose();
        double largest = 0;
        for (Index i = 0; i < 40; ++i)
            for (Index j = 0; j < 35; ++j)
                largest = std::max(
                    largest, static_cast<double>(std::abs(exact(i, j) - ours(i * 35 + j, d))));
        EXPECT_LT(
            largest,
            1e-11 * static_cast<double>(
                        exact.cwiseAbs().maxCoeff())); // condition of each axis's A^T A: about 1e3
    }
}

TEST(OnePass, moments_stay_accurate_up_to_degree_9) {
    for (int p = 1; p <= max_degree; ++p) {
        const auto t = random_parameters(2000, 3);
        const KnotVector k = knots_from_parameters(t, p, p + 12);
        const LongMatrix a = collocation(k, t);
        const LongMatrix gram = reference::transposed_product(a, a);
        const auto system = assemble({k}, testing::sequence(random_points(2000, 1, 4)), {{t}, {}});
        const BandedMatrix& ours = *system->factors()[0];
        for (Index i = 0; i < ours.size(); ++i)
            for (int b = 0; b <= p && i + b < ours.size(); ++b)
                EXPECT_NEAR(ours.at(i, b), static_cast<double>(gram(i, i + b)),
                            1e-13 * static_cast<double>(gram.cwiseAbs().maxCoeff()))
                    << p;
    }
}

TEST(OnePass, chunks_may_come_one_by_one) {
    const auto t = random_parameters(50000, 5);
    const PointSet q = random_points(50000, 2, 6);
    const KnotVector k = uniform_knots(3, 60, 0, 1);
    BandedSystem whole(k, {0, 0});
    whole.add(t, q, {});
    BandedSystem parts(k, {0, 0});
    constexpr Index part =
        1 << 14; // the chunks that the whole is taken in: then the bits are the same
    for (Index first = 0; first < q.size(); first += part) {
        const Index count = std::min(part, q.size() - first);
        parts.add(
            std::span(t).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)),
            Points(q).slice(first, count), {});
    }
    EXPECT_EQ(whole.rhs().values(), parts.rhs().values());
    EXPECT_EQ(whole.sample_count(), parts.sample_count());
    const Samples peaks = generate("peaks", {50, 60});
    const Parameters uv =
        parametrize(peaks, Parametrization::uniform, {Closure::open, Closure::open});
    const std::vector<KnotVector> axes(2, uniform_knots(3, 12, 0, 1));
    KroneckerSystem once(axes, {0, 0, 0}, uv);
    once.add(0, peaks.points);
    once.finish();
    KroneckerSystem twice(axes, {0, 0, 0}, uv);
    twice.add(0, peaks.points.slice(0, 20 * 60));
    twice.add(20, peaks.points.slice(20 * 60, 30 * 60));
    twice.finish();
    EXPECT_LT(testing::largest_difference(once.rhs(), twice.rhs()), 1e-13);
}

TEST(OnePass, cells_and_single_samples_give_one_matrix) {
    // the 3-axis path takes every sample by itself: with one more axis of degree 1 over [0, 1] and
    // all samples at 0 it must agree
    const PointSet q = random_points(4000, 2, 7);
    PointSet uv = random_points(4000, 2, 8);
    PointSet uvw(4000, 3);
    for (Index i = 0; i < 4000; ++i)
        for (Index k = 0; k < 2; ++k) uvw(i, k) = uv(i, k);
    std::vector<double> weights = random_points(4000, 1, 9).values();
    for (double& w : weights) w += 1.5;
    for (Closure closure : {Closure::open, Closure::closed}) {
        const std::vector<KnotVector> axes{uniform_knots(3, 9, -1, 1, closure),
                                           uniform_knots(2, 8, -1, 1)};
        StencilSystem cells(axes, {0.1, 0.2});
        cells.add(q, uv, weights);
        std::vector<KnotVector> three = axes;
        three.push_back(KnotVector(1, {0, 0, 1, 1}));
        StencilSystem single(three, {0.1, 0.2});
        single.add(q, uvw, weights);
        const PointSet x = random_points(cells.size(), 2, 3);
        PointSet wide(single.size(), 2);
        for (Index i = 0; i < x.size(); ++i)
            for (Index d = 0; d < 2; ++d) wide(2 * i, d) = x(i, d);
        PointSet y(cells.size(), 2);
        PointSet z(single.size(), 2);
        cells.apply(x, y);
        single.apply(wide, z);
        for (Index i = 0; i < x.size(); ++i)
            for (Index d = 0; d < 2; ++d) {
                EXPECT_NEAR(y(i, d), z(2 * i, d), 1e-11);
                EXPECT_NEAR(cells.rhs()(i, d), single.rhs()(2 * i, d), 1e-11);
            }
        EXPECT_NEAR(cells.data_energy(), single.data_energy(), 1e-9);
        // and the dense product says the same
        const LongMatrix a = reference::scattered_collocation(axes, uv);
        LongMatrix weighted = a;
        for (Index j = 0; j < a.rows(); ++j)
            weighted.row(j) *= reference::Long(weights[static_cast<std::size_t>(j)]);
        LongMatrix away = reference::matrix(q);
        away.rowwise() -= Eigen::Matrix<reference::Long, 1, 2>(0.1, 0.2);
        const LongMatrix moved = reference::product(a, reference::matrix(x));
        EXPECT_LT(reference::difference(reference::transposed_product(weighted, moved), y), 1e-11);
        EXPECT_LT(reference::difference(reference::transposed_product(weighted, away), cells.rhs()),
                  1e-11);
    }
}

/// A normal system that counts what an iteration asks of it.
class Counting : public NormalSystem {
  public:
    explicit Counting(const NormalSystem& inner)
        : NormalSystem(inner.axes(), inner.centre()), inner_(inner) {
        rhs_ = inner.rhs();
    }
    void apply(const PointSet& x, PointSet& y) const override {
        ++applied;
        inner_.apply(x, y);
    }
    std::unique_ptr<NormalSystem> clone() const override { return inner_.clone(); }
    std::vector<double> diagonal() const override { return inner_.diagonal(); }
    void for_each_entry(EntryVisitor visit) const override { inner_.for_each_entry(visit); }
    std::vector<const BandedMatrix*> factors() const override { return inner_.factors(); }
    void add_roughness(double, int) override { FAIL() << "not used here"; }
    mutable Index applied = 0;

  private:
    const NormalSystem& inner_;
};

TEST(OnePass, iterations_touch_no_sample) {
    // after assembly the samples are overwritten: an iteration that looked at them would go astray
    PointSet q = random_points(10000, 2, 1);
    std::vector<double> t = random_parameters(10000, 2);
    const KnotVector k = uniform_knots(3, 100, 0, 1);
    BandedSystem system(k, {0, 0});
    system.add(t, q, {});
    const LongMatrix exact = least_squares(collocation(k, t), reference::matrix(q));
    q.fill(NAN);
    std::fill(t.begin(), t.end(), NAN);
    const Counting counted(system);
    Lspia lspia(counted);
    PointSet control(100, 2);
    const Summary summary = iterate(lspia, control, {.relative_gradient = 1e-12});
    EXPECT_LT(reference::difference(exact, control), 1e-9);
    EXPECT_EQ(counted.applied,
              summary.iterations + 1); // one product of the control points' size each
}

#ifndef __SANITIZE_ADDRESS__ // the sanitizer's own memory would be counted: the release measures
/// Peak resident memory of this process in bytes, reset first.
std::size_t peak_beyond(const std::function<void()>& work) {
    const auto value = [](const char* key) {
        std::ifstream status("/proc/self/status");
        for (std::string word; status >> word;)
            if (word == key) {
                std::size_t kib = 0;
                status >> kib;
                return kib * 1024;
            }
        return std::size_t{0};
    };
    std::ofstream("/proc/self/clear_refs") << "5";
    const std::size_t before = value("VmRSS:");
    work();
    const std::size_t peak = value("VmHWM:");
    EXPECT_GT(before, 0U); // else nothing was measured
    EXPECT_GE(peak, before);
    return peak - std::min(before, peak);
}

TEST(OnePass, memory_does_not_grow_with_the_samples) {
    const Index m = 10'000'000;
    PointSet q(m, 3);
    std::vector<double> t(static_cast<std::size_t>(m));
    for (Index i = 0; i < m; ++i) {
        t[static_cast<std::size_t>(i)] = static_cast<double>(i) / static_cast<double>(m - 1);
        q(i, 0) = q(i, 1) = q(i, 2) = t[static_cast<std::size_t>(i)];
    }
    const KnotVector k = uniform_knots(3, 10000, 0, 1);
    const std::size_t peak = peak_beyond([&] {
        BandedSystem system(k, {0, 0, 0});
        system.add(t, q, {});
        solve_direct(system);
    });
    EXPECT_LT(peak, std::size_t{16} << 20U) << peak;
}
#endif

TEST(Roughness, is_the_integral_of_the_squared_derivative) {
    for (const KnotVector& knots :
         {knots_from_parameters(random_parameters(40, 3), 4, 12), uniform_knots(3, 9, 0, 1),
          knots_around(3, std::array{0.1, 0.4, 0.45, 0.8, 0.9}, 0, 1, Closure::closed)})
        for (int order : {0, 2, 3}) {
            const PointSet control = random_points(knots.free_count(), 1, 7);
            PointSet image(control.size(), 1);
            roughness_matrix(knots, order).apply(control.data(), image.data(), {1, 1});
            const Spline spline = Spline::from_free({knots}, control);
            // Gauss's rule of five points a piece is exact to degree 9
            constexpr std::array node{0.0, 0.5384693101056831, -0.5384693101056831,
                                      0.9061798459386640, -0.9061798459386640};
            constexpr std::array weight{0.5688888888888889, 0.4786286704993665, 0.4786286704993665,
                                        0.2369268850561891, 0.2369268850561891};
            double integral = 0;
            const std::vector<double> breaks = knots.breakpoints();
            for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
                const double half = (breaks[b + 1] - breaks[b]) / 2;
                for (std::size_t g = 0; g < node.size(); ++g) {
                    const auto d =
                        reference::point(spline, {breaks[b] + half * (1 + node[g])}, {order});
                    integral += half * weight[g] * static_cast<double>(d(0) * d(0));
                }
            }
            EXPECT_NEAR(inner_product(control, image), integral, 1e-12 * integral);
        }
}

TEST(Roughness, a_cloud_and_a_grid_minimise_what_they_say) {
    // the energy of a cloud's system grows by lambda W times the sum over the axes of the integral
    const std::vector<KnotVector> axes{uniform_knots(3, 6, 0, 1), uniform_knots(2, 5, 0, 1)};
    StencilSystem cloud(axes, {0.0});
    const PointSet t = [&] {
        PointSet rows = random_points(200, 2, 9);
        for (double& x : rows.values()) x = (x + 1) / 2;
        return rows;
    }();
    cloud.add(random_points(200, 1, 8), t, {});
    const PointSet control = random_points(30, 1, 10);
    PointSet before(30, 1);
    PointSet after(30, 1);
    cloud.apply(control, before);
    cloud.add_roughness(0.25, 2);
    cloud.apply(control, after);
    // P^T (R0 x M1 + M0 x R1) P by rows and columns
    double expected = 0;
    for (std::size_t rough : {0U, 1U}) {
        PointSet half(30, 1);
        PointSet whole(30, 1);
        roughness_matrix(axes[0], rough == 0 ? 2 : 0).apply(control.data(), half.data(), {1, 5});
        roughness_matrix(axes[1], rough == 1 ? 2 : 0).apply(half.data(), whole.data(), {6, 1});
        expected += inner_product(control, whole);
    }
    EXPECT_NEAR(inner_product(control, after) - inner_product(control, before),
                0.25 * 200 * expected, 1e-9 * std::abs(200 * expected));
}

} // namespace
} // namespace batten
