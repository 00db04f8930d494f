// Figures that the later literature prints or that follow from its stated problems: helix and
// peaks, iterations and residuals.
#include "problems.hpp"

#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/lspia.hpp>
#include <batten/iterate/mlspia.hpp>
#include <batten/solve/factorization.hpp>
#include <numbers>

namespace batten {
namespace {

constexpr double exact = 1e-12;

TEST(Literature, helix_of_10001_samples) {
    PointSet q(10001, 3);
    for (Index i = 0; i < q.size(); ++i) {
        const double theta = 2 * std::numbers::pi * static_cast<double>(i) / 10000;
        const double a = theta * std::numbers::pi / 3;
        q(i, 0) = 10 * std::cos(a);
        q(i, 1) = 10 * std::sin(a);
        q(i, 2) = a;
    }
    FitOptions options;
    options.shape.control_points = {2001};
    options.stop.relative_gradient = 1e-3;
    for (const auto& [method, iterations] : {std::pair{"lspia", 77}, std::pair{"mlspia", 25}}) {
        options.method = {.name = method, .settings = {{"eigenvalue_tolerance", exact}}};
        EXPECT_EQ(fit(testing::sequence(q), options).report.iterations, iterations) << method;
    }
    const Parameters t = parametrize(testing::sequence(q), Parametrization::chord, {Closure::open});
    const auto system =
        assemble({knots_from_parameters(t.axes[0], 3, 2001)}, testing::sequence(q), t);
    const ExtremeEigenvalues e = extreme_eigenvalues(*system, exact);
    EXPECT_NEAR(std::sqrt(e.largest / e.smallest), 4.72285705767, 5e-12);
}

struct Peaks {
    Samples samples = generate("peaks", {121, 121});
    FitOptions options;
    Peaks() {
        options.shape.control_points = {41, 41};
        options.shape.parametrization = Parametrization::uniform;
        options.shape.placement = KnotPlacement::uniform;
        options.stop.relative_gradient = 1e-3;
        // initial control points: data rows round(linspace(0, 120, 41)) = every third
        options.method.initial = Initial::given;
        options.method.control = PointSet(41 * 41, 3);
        for (Index i = 0; i < 41; ++i)
            for (Index j = 0; j < 41; ++j)
                std::ranges::copy(samples.points[3 * i * 121 + 3 * j],
                                  options.method.control[i * 41 + j].begin());
    }
};

TEST(Literature, peaks_121_x_121) {
    Peaks peaks;
    const struct {
        const char* method;
        Index iterations;
        double rms;
    } expected[] = {{"lspia", 1091, 3.40750945245e-4}, {"mlspia", 109, 3.24762082138e-4}};
    for (const auto& [method, iterations, rms] : expected) {
        peaks.options.method.name = method;
        peaks.options.method.settings = {{"eigenvalue_tolerance", exact}};
        const FitReport report = fit(peaks.samples, peaks.options).report;
        EXPECT_EQ(report.iterations, iterations) << method;
        EXPECT_NEAR(report.deviation.rms / rms, 1, 1e-10) << method;
    }
    peaks.options.method = {.name = "direct"};
    EXPECT_NEAR(fit(peaks.samples, peaks.options).report.deviation.rms, 2.18286703e-4, 5e-13);
    const Parameters t =
        parametrize(peaks.samples, Parametrization::uniform, {Closure::open, Closure::open});
    const auto system =
        assemble({uniform_knots(3, 41, 0, 1), uniform_knots(3, 41, 0, 1)}, peaks.samples, t);
    const ExtremeEigenvalues e = extreme_eigenvalues(*system, exact);
    EXPECT_NEAR(std::sqrt(e.largest / e.smallest), 21.2208659316, 5e-11);
}

TEST(Literature, random_starts_of_huang_and_wang_table_3) {
    const Samples rose = generate("rose", {501});
    for (unsigned seed = 0; seed < 10; ++seed) {
        FitOptions options;
        options.shape.control_points = {50};
        options.method = {.name = "mlspia",
                          .settings = {{"eigenvalue_tolerance", exact}},
                          .initial = Initial::given,
                          .control = testing::random_points(50, 2, seed)};
        for (double& x : options.method.control.values()) x *= 200000;
        options.stop = {.gradient = 1e-8, .relative_gradient = 0};
        const FitReport report = fit(rose, options).report;
        EXPECT_GE(report.iterations, 82) << seed;
        EXPECT_LE(report.iterations, 87) << seed;
    }
}

/// The peaks grid as a cloud with four holes each over four knot spans wide.
Samples peaks_with_holes(Parameters& parameters, bool holes) {
    const Samples whole = generate("peaks", {121, 121});
    constexpr double half = 2.2 / 17; // of a hole: 4.4 of the 17 knot spans in all
    std::vector<double> points;
    std::vector<double> uv;
    for (Index i = 0; i < 121; ++i)
        for (Index j = 0; j < 121; ++j) {
            const double u = static_cast<double>(i) / 120;
            const double v = static_cast<double>(j) / 120;
            const auto in_hole = [&](double x) {
                return std::abs(x - 0.26) < half || std::abs(x - 0.72) < half;
            };
            if (holes && in_hole(u) && in_hole(v)) continue;
            const auto p = whole.points[i * 121 + j];
            points.insert(points.end(), p.begin(), p.end());
            uv.insert(uv.end(), {u, v});
        }
    parameters.scattered = PointSet(std::move(uv), 2);
    return testing::sequence(PointSet(std::move(points), 3));
}

TEST(Literature, rank_deficient_peaks_with_four_holes) {
    Parameters t;
    const Samples samples = peaks_with_holes(t, true);
    const std::vector<KnotVector> axes{uniform_knots(3, 20, 0, 1), uniform_knots(3, 20, 0, 1)};
    const auto system = assemble(axes, samples, t);
    EXPECT_THROW(factorize(*system), SolverError);
    const reference::Matrix a = reference::scattered_collocation(axes, t.scattered);
    const reference::Matrix q = reference::matrix(samples.points);
    const auto rms = [&](const PointSet& control) {
        return static_cast<double>(std::sqrt(
            (q - reference::product(a, reference::matrix(uncentred(control, system->centre()))))
                .squaredNorm() /
            static_cast<reference::Long>(samples.size())));
    };
    // the minimum residual: a dense solution, the four undetermined directions held by a weight
    // that moves it by less than the last digit asked for
    reference::Matrix gram = reference::transposed_product(a, a);
    const reference::Matrix right = reference::transposed_product(a, q);
    gram.diagonal().array() += 1e-14L;
    const reference::Matrix best = reference::solve_definite(gram, right);
    const double minimum =
        static_cast<double>(std::sqrt((q - reference::product(a, best)).squaredNorm() /
                                      static_cast<reference::Long>(samples.size())));
    PointSet control(400, 3);
    ConjugateGradients cg(*system);
    iterate(cg, control, {.max_iterations = 500, .relative_gradient = 0});
    EXPECT_NEAR(rms(control) / minimum, 1, 1e-9);
    // A^T A has row sums sum_j A_ij, as B-splines sum to one: LSPIA's step from the largest
    PointSet ones(400, 1);
    ones.fill(1);
    PointSet sums(400, 1);
    system->apply(ones, sums);
    const double largest = *std::max_element(sums.values().begin(), sums.values().end());
    Lspia lspia(*system, 1 / largest);
    control = centred(PointSet(400, 3), system->centre()); // from zero
    double last = std::numeric_limits<double>::infinity();
    iterate(lspia, control, {.max_iterations = 20000, .relative_gradient = 0},
            {[&](const Iteration& now) {
                 const double energy = system->energy(now.control);
                 EXPECT_LE(
                     energy,
                     last + 1e-9 * std::abs(energy)); // rounding of a difference of large numbers
                 last = energy;
                 return Continue::yes;
             },
             {},
             {}});
    EXPECT_LT(rms(control) / minimum, 1.01);
    Mlspia mlspia(*system);
    control = PointSet(400, 3);
    mlspia.start(control);
    EXPECT_TRUE(mlspia.note().starts_with("ill-determined: 1 control points without samples, which "
                                          "stay where they start, and 3 hardly reached by any"))
        << mlspia.note();
    iterate(mlspia, control, {.max_iterations = 20000, .relative_gradient = 0});
    EXPECT_LT(rms(control) / minimum, 1.01);
}

TEST(Literature, scattered_lspia_equals_the_gridded_one) {
    Parameters t;
    const Samples samples = peaks_with_holes(t, false);
    FitOptions options;
    options.shape.control_points = {20, 22};
    options.shape.placement = KnotPlacement::uniform;
    options.shape.parametrization = Parametrization::uniform;
    const reference::Matrix grid = [&] {
        std::vector<double> even;
        for (int i = 0; i <= 120; ++i) even.push_back(i / 120.0);
        const reference::Matrix u = reference::collocation(uniform_knots(3, 20, 0, 1), even);
        const reference::Matrix v = reference::collocation(uniform_knots(3, 22, 0, 1), even);
        const reference::Matrix all = reference::matrix(generate("peaks", {121, 121}).points);
        reference::Matrix control(20 * 22, 3);
        for (Index d = 0; d < 3; ++d) {
            const reference::Matrix column = all.col(d);
            const reference::Matrix half = reference::least_squares(
                u, reference::Matrix(column.reshaped<Eigen::RowMajor>(121, 121)));
            const reference::Matrix whole =
                reference::least_squares(v, half.transpose()).transpose();
            control.col(d) = whole.reshaped<Eigen::RowMajor>();
        }
        return control;
    }();
    EXPECT_LT(reference::difference(
                  grid, fit(generate("peaks", {121, 121}), options).spline.control_points()),
              1e-11);
    options.shape.parametrization.reset();
    options.shape.parameters = t;
    for (const char* method : {"direct", "mlspia", "cg"}) {
        options.method.name = method;
        options.stop.relative_gradient = 1e-13;
        EXPECT_LT(reference::difference(grid, fit(samples, options).spline.control_points()), 1e-9)
            << method;
    }
}

TEST(Literature, mlspia_carries_its_memory_through_refined_knots) {
    const Samples rose = generate("rose", {501});
    const Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    const KnotVector k = knots_from_parameters(t.axes[0], 3, 50);
    const auto coarse = assemble({k}, rose, t);
    Mlspia first(*coarse);
    PointSet control(50, 2);
    iterate(first, control, {.max_iterations = 20, .relative_gradient = 0});
    const auto refined = [&](const PointSet& p) {
        return insert_knot(insert_knot(Spline({k}, p), 0, 0.31), 0, 0.62);
    };
    const Spline moved = refined(control);
    const auto fine = assemble(moved.axes(), rose, t);
    Mlspia second(*fine, {}, 1e-2);
    second.resume(refined(first.last_moves()).control_points());
    PointSet warm = moved.control_points();
    const Summary with_memory = iterate(second, warm, {.gradient = 1e-8, .relative_gradient = 0});
    EXPECT_LT(reference::difference(
                  reference::least_squares(reference::collocation(moved.axis(0), t.axes[0]),
                                           reference::matrix(rose.points)),
                  uncentred(warm, fine->centre())),
              1e-6);
    PointSet cold(52, 2);
    Mlspia fresh(*fine);
    EXPECT_LT(with_memory.iterations,
              iterate(fresh, cold, {.gradient = 1e-8, .relative_gradient = 0}).iterations);
}

} // namespace
} // namespace batten
