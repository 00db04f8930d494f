#include "problems.hpp"

namespace batten {
namespace {

using testing::largest_difference;
using testing::message_of;
using testing::random_points;
using testing::sequence;

FitOptions size(std::vector<Index> n) {
    FitOptions options;
    options.shape.control_points = std::move(n);
    return options;
}

TEST(Fit, reproduces_a_spline_of_its_own_space_for_every_degree_and_dimension) {
    for (int p = 1; p <= max_degree; ++p) {
        const Index dim = 1 + (p * 5) % 16;
        const KnotVector k = uniform_knots(p, p + 7, 0, 1);
        const Spline truth({k}, random_points(p + 7, dim, 3));
        Parameters t{{testing::random_parameters(400, 4)}, {}};
        FitOptions options;
        options.shape.degree = {p};
        options.shape.parameters = t;
        options.shape.knots = {{k.knots().begin(), k.knots().end()}};
        const FitResult result =
            fit(sequence(reference::points(reference::curve_points(truth, t.axes[0]))), options);
        EXPECT_LT(largest_difference(result.spline.control_points(), truth.control_points()),
                  1e-6 * std::pow(2.5, p - 5))
            << p; // condition grows with the degree
        EXPECT_LT(result.report.deviation.maximum, 1e-12);
    }
}

/// Root mean square of the samples' distances from the best spline of the fit's knots at its
/// parameters: a dense solution per axis.
double least_rms(const Samples& samples, const FitResult& result) {
    const std::vector<Index> shape = samples.shape();
    const auto a = [&](std::size_t k) {
        return reference::collocation(result.spline.axes()[k], result.parameters.axes[k]);
    };
    const reference::Matrix all = reference::matrix(samples.points);
    reference::Long sum = 0;
    for (Index d = 0; d < samples.dim(); ++d) {
        const auto residual = [](const reference::Matrix& m, const reference::Matrix& q) {
            return reference::product(m, reference::least_squares(m, q));
        };
        const reference::Matrix column = all.col(d);
        const reference::Matrix q = reference::Matrix(
            column.reshaped<Eigen::RowMajor>(shape[0], samples.size() / shape[0]));
        reference::Matrix fitted = residual(a(0), q);
        if (shape.size() == 2) fitted = residual(a(1), fitted.transpose()).transpose();
        sum += (q - fitted).squaredNorm();
    }
    return static_cast<double>(std::sqrt(sum / static_cast<reference::Long>(samples.size())));
}

TEST(Fit, all_methods_leave_the_least_residual) {
    for (const char* name : {"rose", "peaks"}) {
        const Samples samples = generate(name);
        double least = 0;
        for (const char* method : {"direct", "lspia", "mlspia", "cg"}) {
            FitOptions options =
                size(samples.grid.empty() ? std::vector<Index>{60} : std::vector<Index>{20, 24});
            options.method.name = method;
            options.stop = {.max_iterations = 200000, .relative_gradient = 1e-12};
            const FitResult result = fit(samples, options);
            if (least == 0) least = least_rms(samples, result);
            EXPECT_NEAR(result.report.deviation.rms / least, 1, 1e-12) << name << " " << method;
        }
    }
}

/// Largest gap across the seam of the first axis, by the last piece and the first.
double seam_gap(const Spline& surface) {
    double gap = 0;
    for (double v : {0.0, 0.3, 0.71}) {
        const auto a = reference::point(surface, {surface.axis(0).begin(), v});
        const auto b = reference::point(surface, {surface.axis(0).end(), v});
        gap = std::max(gap, static_cast<double>((a - b).cwiseAbs().maxCoeff()));
    }
    return gap;
}

TEST(Fit, a_volume_and_a_closed_surface_are_within_their_sampling) {
    const FitResult block = fit(generate("bent-block"), size({8, 6, 5}));
    EXPECT_EQ(block.report.kind, "volume");
    EXPECT_LT(reference::largest(reference::deviations(block.spline, generate("bent-block").points,
                                                       block.parameters)),
              5e-3);
    FitOptions options = size({16, 12});
    options.shape.closures = {Closure::closed};
    const FitResult torus = fit(generate("torus"), options);
    EXPECT_EQ(torus.spline.control_shape(), (std::vector<Index>{19, 15}));
    EXPECT_EQ(torus.report.control_shape, options.shape.control_points);
    // 16 cubic pieces of a circle of radius 4: (2 pi / 16)^4 / 720 * 4 and more
    EXPECT_LT(reference::largest(
                  reference::deviations(torus.spline, generate("torus").points, torus.parameters)),
              5e-3);
    EXPECT_LT(seam_gap(torus.spline), 1e-14);
}

TEST(Fit, coordinates_of_1e9_keep_detail_of_1e_3) {
    Samples near_zero = generate("rose");
    PointSet far(near_zero.points);
    for (double& x : far.values()) x = x * 0.01 + 1e9;
    PointSet rounded = far; // what the doubles near 1e9 can hold
    for (double& x : rounded.values()) x -= 1e9;
    for (const char* method : {"direct", "mlspia"}) {
        FitOptions options = size({40});
        options.method.name = method;
        const FitResult a = fit(sequence(far), options);
        const FitResult b = fit(sequence(rounded), options);
        EXPECT_NEAR(a.report.deviation.rms, b.report.deviation.rms, 2e-7)
            << method; // one rounding of 1e9 is 1.2e-7
        EXPECT_LT(a.report.deviation.maximum, 1e-3);
    }
}

TEST(Fit, weights_equal_repeated_samples) {
    const PointSet q = random_points(60, 2, 5);
    const auto t = testing::random_parameters(60, 6);
    Samples weighted = sequence(q);
    weighted.weights.assign(60, 1.0);
    PointSet repeated(61, 2);
    std::vector<double> tr;
    for (Index i = 0, row = 0; i < 60; ++i)
        for (int copy = 0; copy < (i == 30 ? 2 : 1); ++copy, ++row) {
            std::ranges::copy(q[i], repeated[row].begin());
            tr.push_back(t[static_cast<std::size_t>(i)]);
        }
    weighted.weights[30] = 2;
    FitOptions options = size({10});
    options.shape.placement = KnotPlacement::uniform;
    options.shape.parameters = Parameters{{t}, {}};
    const FitResult a = fit(weighted, options);
    options.shape.parameters = Parameters{{tr}, {}};
    const FitResult b = fit(sequence(repeated), options);
    EXPECT_LT(largest_difference(a.spline.control_points(), b.spline.control_points()), 1e-12);
    const reference::Matrix dense = reference::least_squares(
        reference::collocation(b.spline.axis(0), tr), reference::matrix(repeated));
    EXPECT_LT(reference::difference(dense, a.spline.control_points()), 1e-12);
}

TEST(Fit, samples_that_determine_too_little_are_named_or_iterated) {
    PointSet q(60, 2);
    std::vector<double> t;
    for (Index i = 0; i < 60; ++i) {
        const double x = i < 30 ? 0.299 * static_cast<double>(i) / 29
                                : 0.8 + 0.2 * static_cast<double>(i - 30) / 29;
        t.push_back(x);
        q(i, 0) = x;
        q(i, 1) = std::sin(5 * x);
    }
    FitOptions options = size({13});
    options.shape.parameters = Parameters{{t}, {}};
    options.shape.placement = KnotPlacement::uniform;
    options.method.name = "direct";
    EXPECT_EQ(message_of<InvalidInput>([&] { fit(sequence(q), options); }),
              "axis 0: no samples in knot spans [0.3, 0.4], [0.4, 0.5], [0.5, 0.6], ...: the "
              "direct solver cannot determine every control point "
              "(Schoenberg-Whitney); use an iterative method such as cg, or smoothing");
    options.method.name = "auto";
    const FitResult result = fit(sequence(q), options);
    EXPECT_EQ(result.report.method, "cg");
    EXPECT_LT(result.report.deviation.maximum, 1e-3);
    // the control points that no sample reaches stay where they started
    options.method.initial = Initial::given;
    options.method.control = random_points(13, 2, 9);
    for (const char* method : {"cg", "lspia", "mlspia"}) {
        options.method.name = method;
        const FitResult given = fit(sequence(q), options);
        for (Index d = 0; d < 2; ++d)
            EXPECT_NEAR(given.spline.control_points()(7, d), options.method.control(7, d), 1e-15)
                << method;
    }
}

TEST(Fit, refuses_what_breaks_a_rule) {
    const Samples rose = generate("rose", {20});
    const auto refusal = [&](const FitOptions& options) {
        return message_of<InvalidInput>([&] { fit(rose, options); });
    };
    EXPECT_EQ(refusal(size({3})), "axis 0: degree 3 needs at least 4 control points, got 3");
    EXPECT_EQ(refusal(size({21})),
              "axis 0: 21 control points need at least as many samples, got 20");
    EXPECT_EQ(refusal(size({5, 5})), "control points: 2 values given for 1 axis");
    FitOptions options = size({6});
    options.shape.degree = {12};
    EXPECT_EQ(refusal(options), "axis 0: degree 12 is outside 1 to 9");
    options = size({6});
    options.shape.knots = {{0, 0, 0, 0, 1, 1, 1, 1}};
    EXPECT_EQ(refusal(options),
              "control points and knots: the knots state the number of control points");
    options = {};
    options.shape.knots = {{0.2, 0.2, 0.2, 0.2, 1, 1, 1, 1}};
    EXPECT_EQ(refusal(options), "axis 0: parameters [0, 1] are outside the knots' domain [0.2, 1]");
    options = size({6});
    options.method.initial = Initial::given;
    options.method.control = PointSet(5, 2);
    options.method.name = "lspia";
    EXPECT_EQ(refusal(options),
              "initial control points: 5 of dimension 2 given, 6 of dimension 2 needed");
    EXPECT_EQ(message_of<InvalidInput>([] { fit(sequence(PointSet(30, 2)), size({6})); }),
              "axis 0: all points are identical; a curve through them has no length");
    options = size({6});
    options.shape.seam_continuity = -5;
    EXPECT_EQ(refusal(options), "closed: continuity C-5 at the seam: C0, C1, ... or -1 for as "
                                "smooth as elsewhere");
    options = size({6});
    options.smooth.lambda = 1;
    EXPECT_EQ(refusal(options), "smoothing: a factor is given, but smoothing is not wanted");
    options = size({6});
    options.method.control = PointSet(6, 2);
    EXPECT_EQ(refusal(options), "initial: control points are given, but the start is another");
    options = {};
    options.tolerance.corner_samples = {5};
    EXPECT_EQ(refusal(options),
              "corners: samples are given, but the corners are not the given ones");
    Samples cloud = generate("peaks", {9, 9});
    cloud.grid.clear();
    options = size({5, 5});
    options.shape.projection = Projection::xy;
    options.shape.closures = {Closure::open, Closure::closed};
    EXPECT_EQ(message_of<InvalidInput>([&] { fit(cloud, options); }),
              "closed: a cloud's parameters are its points' coordinates in a plane, where no axis "
              "closes; give it parameters that go round");
    options = size({6});
    options.cancelled = [] { return true; };
    EXPECT_EQ(message_of<Cancelled>([&] { fit(rose, options); }), "the fit was cancelled");
}

TEST(Fit, identical_consecutive_samples_are_legal_and_said) {
    const PointSet q({0, 0, 1, 1, 1, 1, 2, 1, 3, 0, 4, 0, 5, 1}, 2);
    const FitResult result = fit(sequence(q), size({5}));
    ASSERT_EQ(result.report.notes.size(), 1U);
    EXPECT_EQ(result.report.notes[0],
              "axis 0: 1 identical consecutive samples share a parameter and count each");
}

TEST(Fit, a_sensor_may_stand_still_for_most_samples) {
    PointSet track(240, 2);
    for (Index i = 0; i < track.size(); ++i) {
        const Index place = i < 16 ? i : i < 216 ? 16 : i - 200; // 200 samples at one of 40 places
        const double t = static_cast<double>(place) / 39;
        track(i, 0) = 2 * t;
        track(i, 1) = std::sin(5 * t);
    }
    for (Closure closure : {Closure::open, Closure::closed})
        for (int degree : {1, 3, 7}) {
            const FitResult result =
                fit(sequence(PointSet(track)),
                    {.shape = {.degree = {degree}, .control_points = {20}, .closures = {closure}}});
            if (closure == Closure::open) {
                EXPECT_LT(result.report.deviation.maximum, 0.03) << degree;
            }
            EXPECT_EQ(result.spline.axes()[0].breakpoints().size(),
                      static_cast<std::size_t>(closure == Closure::open ? 21 - degree : 21));
        }
}

TEST(Threads, do_not_change_a_bit) {
    struct Problem {
        Samples samples;
        FitOptions options;
    };
    std::vector<Problem> problems;
    problems.push_back({generate("rose", {200000}), size({500})}); // several chunks
    problems.push_back({generate("peaks", {600, 700}), size({40, 50})});
    problems.push_back({generate("bent-block"), size({7, 7, 7})});
    Problem cloud{sequence(random_points(100000, 3, 4)), size({20, 25})};
    PointSet uv = random_points(100000, 2, 5);
    cloud.options.shape.parameters = Parameters{{}, std::move(uv)};
    problems.push_back(std::move(cloud));
    for (Problem& problem : problems) {
        problem.options.threads = 1;
        const FitResult reference = fit(problem.samples, problem.options);
        for (int threads : {2, 3, 8}) {
            problem.options.threads = threads;
            const FitResult result = fit(problem.samples, problem.options);
            EXPECT_EQ(result.spline.control_points().values(),
                      reference.spline.control_points().values())
                << threads;
            EXPECT_EQ(result.report.deviation.rms, reference.report.deviation.rms);
        }
    }
}

TEST(Tolerance, holds_for_closed_surfaces_volumes_and_clouds) {
    FitOptions options;
    options.tolerance.value = 0.01;
    const FitResult block = fit(generate("bent-block"), options);
    EXPECT_EQ(block.report.termination, Termination::tolerance_met);
    EXPECT_LE(reference::largest(reference::deviations(block.spline, generate("bent-block").points,
                                                       block.parameters)),
              0.01 * (1 + 1e-12));
    PointSet uv = random_points(5000, 2, 3);
    PointSet q(5000, 3);
    for (Index i = 0; i < 5000; ++i) {
        q(i, 0) = uv(i, 0);
        q(i, 1) = uv(i, 1);
        q(i, 2) = std::sin(3 * uv(i, 0)) * std::cos(2 * uv(i, 1));
    }
    options.shape.parameters = Parameters{{}, std::move(uv)};
    options.tolerance.value = 1e-3;
    const FitResult cloud = fit(sequence(q), options);
    EXPECT_EQ(cloud.report.termination, Termination::tolerance_met);
    EXPECT_LE(reference::largest(reference::deviations(cloud.spline, q, *options.shape.parameters)),
              1e-3 * (1 + 1e-12));
    EXPECT_LE(cloud.spline.control_points().size(), 13 * 13); // 13 even knots a side do it
    options = {};
    options.tolerance.value = 0.01;
    options.shape.closures = {Closure::closed};
    const FitResult torus = fit(generate("torus"), options);
    EXPECT_EQ(torus.report.termination, Termination::tolerance_met);
    EXPECT_LE(reference::largest(
                  reference::deviations(torus.spline, generate("torus").points, torus.parameters)),
              0.01 * (1 + 1e-12));
    EXPECT_LT(seam_gap(torus.spline), 1e-13);
}

TEST(Tolerance, per_sample_tolerances_are_kept_each) {
    const Samples rose = generate("rose");
    FitOptions options;
    for (Index i = 0; i < rose.size(); ++i)
        options.tolerance.per_sample.push_back(i < 250 ? 1e-2 : 1e-4);
    const FitResult result = fit(rose, options);
    EXPECT_EQ(result.report.termination, Termination::tolerance_met);
    const auto d = reference::deviations(result.spline, rose.points, result.parameters);
    for (std::size_t i = 0; i < d.size(); ++i)
        EXPECT_LE(d[i], options.tolerance.per_sample[i] * (1 + 1e-12)) << i;
    FitOptions fine;
    fine.tolerance.value = 1e-4;
    EXPECT_LT(result.report.control_shape[0], fit(rose, fine).report.control_shape[0]);
    options.tolerance.per_sample[3] = 0;
    EXPECT_EQ(message_of<InvalidInput>([&] { fit(rose, options); }),
              "tolerance 3: 0 must be positive and finite");
    options.tolerance.per_sample = {1};
    EXPECT_EQ(message_of<InvalidInput>([&] { fit(rose, options); }),
              "tolerances: 1 given for 501 samples; one per sample is needed");
}

TEST(Tolerance, data_times_a_thousand_give_the_same_curve_times_a_thousand) {
    const Samples wing = generate("naca2412");
    PointSet large(wing.points);
    for (double& x : large.values()) x *= 1024; // a power of two: no rounding
    FitOptions options;
    options.tolerance.value = 1e-3;
    const FitResult small = fit(wing, options);
    options.tolerance.value = 1.024;
    const FitResult big = fit(sequence(large), options);
    ASSERT_EQ(small.report.control_shape, big.report.control_shape);
    for (std::size_t k = 0; k < small.spline.control_points().values().size(); ++k)
        EXPECT_NEAR(big.spline.control_points().values()[k],
                    1024 * small.spline.control_points().values()[k], 1e-8);
}

TEST(ClosestPoint, agrees_with_a_dense_search) {
    const FitResult curve = fit(generate("rose"), size({40}));
    const PointSet points = random_points(50, 2, 12);
    const auto found = closest_points(curve.spline, points);
    PointSet t(20001, 1);
    for (Index i = 0; i < t.size(); ++i) t(i, 0) = static_cast<double>(i) / 20000;
    const PointSet dense = reference::points(reference::curve_points(curve.spline, t.values()));
    for (Index i = 0; i < points.size(); ++i) {
        double best = 1e9;
        for (Index k = 0; k < dense.size(); ++k)
            best = std::min(best, distance(dense[k], points[i]));
        EXPECT_LE(found[static_cast<std::size_t>(i)].distance, best + 1e-12);
        EXPECT_GE(found[static_cast<std::size_t>(i)].distance,
                  best - 1e-3); // steps of the dense search
    }
}

TEST(Frames, are_kept_evenly_and_end_at_the_answer) {
    const Samples rose = generate("rose", {});
    FitOptions options{.shape = {.control_points = {40}},
                       .method = {.name = "lspia"},
                       .stop = {.max_iterations = 300, .relative_gradient = 0},
                       .most_frames = 20};
    const FitResult result = fit(rose, options);
    const std::vector<Frame>& frames = result.report.frames;
    ASSERT_GE(frames.size(), 10U);
    ASSERT_LE(frames.size(), 40U);
    const Index stride = frames[1].iteration;
    for (std::size_t k = 0; k < frames.size(); ++k)
        EXPECT_EQ(frames[k].iteration, static_cast<Index>(k) * stride);
    // absolute coordinates: the first frame is made of samples picked from the data
    EXPECT_NEAR(distance(frames[0].control[0], rose.points[0]), 0, 1e-12);
    EXPECT_LT(
        testing::largest_difference(frames.back().control, result.spline.free_control_points()),
        0.05);
}

} // namespace
} // namespace batten
