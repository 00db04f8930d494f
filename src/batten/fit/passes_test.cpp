#include "allocations.hpp"
#include "problems.hpp"

#include <batten/samples/passes.hpp>

#include <limits>

namespace batten {
namespace {

using testing::message_of;
using testing::random_points;
using testing::sequence;

/// Samples in chunks of a caller's choice; counts what is asked of it.
class CountingSource final : public SampleSource {
  public:
    explicit CountingSource(const Samples& samples, Index most = 0, bool says_size = true)
        : samples_(samples), most_(most), says_size_(says_size) {}

    Index dim() const override { return samples_.dim(); }
    Index size() const override { return says_size_ || passes > 1 ? samples_.size() : -1; }
    Order order() const override { return samples_.order; }
    void rewind() override {
        ++passes;
        first_ = next_ = 0;
    }
    Points next(Index most) override {
        first_ = next_;
        const Index count = most_ > 0 ? std::min(most, most_) : most;
        next_ = std::min(samples_.size(), first_ + count);
        return samples_.points.slice(first_, next_ - first_);
    }
    std::span<const double> weights() const override {
        if (samples_.weights.empty()) return {};
        return std::span(samples_.weights)
            .subspan(static_cast<std::size_t>(first_), static_cast<std::size_t>(next_ - first_));
    }

    int passes = 0;

  private:
    const Samples& samples_;
    Index most_;
    bool says_size_;
    Index first_ = 0;
    Index next_ = 0;
};

/// A rose with noise, dim coordinates.
Samples rose(Index m, Index dim, unsigned seed) {
    PointSet q = random_points(m, dim, seed);
    for (Index i = 0; i < m; ++i)
        for (Index d = 0; d < dim; ++d) {
            const double t = 6.28 * static_cast<double>(i) / static_cast<double>(m);
            q(i, d) = 0.001 * q(i, d) + 100 + std::sin(static_cast<double>(2 * d + 1) * t + 1);
        }
    return sequence(std::move(q));
}

FitOptions direct(Index n) {
    FitOptions options;
    options.shape.control_points = {n};
    return options;
}

/// What a sequence can be asked for that is done in passes.
std::vector<std::pair<std::string, FitOptions>> requests(Index m) {
    std::vector<std::pair<std::string, FitOptions>> all;
    const auto add = [&](const char* name) -> FitOptions& {
        return all.emplace_back(name, direct(40)).second;
    };
    add("chord");
    add("uniform").shape.parametrization = Parametrization::uniform;
    add("centripetal").shape.parametrization = Parametrization::centripetal;
    add("rule 9.69").method.name = "direct";
    add("closed").shape.closures = {Closure::closed};
    FitOptions& seam = add("closed with a corner");
    seam.shape.closures = {Closure::closed};
    seam.shape.seam_continuity = 0;
    add("uniform knots").shape.placement = KnotPlacement::uniform;
    add("given parameters").shape.parameters = Parameters{{testing::random_parameters(m, 5)}, {}};
    FitOptions& given = add("given knots");
    const KnotVector knots = uniform_knots(4, 30, 0, 1);
    given.shape.degree = {4};
    given.shape.control_points = {};
    given.shape.knots = {{knots.knots().begin(), knots.knots().end()}};
    return all;
}

/// Knots that do not wait for the samples are there in the first pass, unless there are weights
/// whose range it is to find; lengths of the way are known after it, and what of them knots are
/// placed by when it was known beforehand which.
int passes_for(const FitOptions& options, const Samples& samples, bool says_size) {
    const ShapeOptions& shape = options.shape;
    const bool lengths = !shape.parameters && shape.parametrization != Parametrization::uniform;
    const bool placed = shape.knots.empty() && shape.placement != KnotPlacement::uniform;
    if (lengths) return placed && !says_size ? 4 : 3;
    return says_size && samples.weights.empty() ? 2 : 3;
}

TEST(Passes, any_chunks_and_threads_give_the_same_bits) {
    const Index m = 3 * chunk_samples + 777;
    Samples plain = rose(m, 3, 1);
    Samples weighted = rose(m, 2, 2);
    weighted.weights = random_points(m, 1, 3).values();
    // the largest from 1 to 2: others are first made so, in memory
    for (double& w : weighted.weights) w = 1.5 + 0.49 * w;
    for (const Samples* samples : {&plain, &weighted})
        for (const auto& [name, options] : requests(m)) {
            const FitResult whole = fit(*samples, options);
            EXPECT_EQ(whole.report.method, "direct") << name;
            for (const auto& [most, says_size, threads] :
                 {std::tuple{Index{1}, true, 1}, std::tuple{Index{777}, false, 2},
                  std::tuple{chunk_samples + 1, true, 3}, std::tuple{Index{0}, false, 1}}) {
                CountingSource source(*samples, most, says_size);
                FitOptions own = options;
                own.threads = threads;
                const FitResult result = fit(source, own);
                EXPECT_EQ(result.spline.control_points().values(),
                          whole.spline.control_points().values())
                    << name << " in chunks of " << most;
                EXPECT_EQ(result.spline.axes(), whole.spline.axes()) << name;
                EXPECT_EQ(result.parameters.axes, whole.parameters.axes) << name;
                EXPECT_EQ(result.deviations, whole.deviations) << name;
                EXPECT_EQ(result.report.deviation.maximum, whole.report.deviation.maximum);
                EXPECT_EQ(result.report.deviation.rms, whole.report.deviation.rms);
                EXPECT_EQ(result.report.deviation.worst_sample,
                          whole.report.deviation.worst_sample);
                EXPECT_EQ(source.passes, passes_for(options, *samples, says_size)) << name;
            }
        }
}

TEST(Passes, are_the_least_squares_of_the_definition) {
    const Index m = 900;
    Samples samples = rose(m, 2, 4);
    for (const bool weighted : {false, true}) {
        if (weighted) {
            samples.weights = random_points(m, 1, 6).values();
            for (double& w : samples.weights) w = 2 + w;
        }
        for (const auto& [name, options] : requests(m)) {
            CountingSource source(samples, 100);
            const FitResult result = fit(source, options);
            reference::Matrix a =
                reference::collocation(result.spline.axis(0), result.parameters.axes[0]);
            reference::Matrix q = reference::matrix(samples.points);
            for (Index i = 0; i < m && weighted; ++i) {
                const reference::Long root =
                    std::sqrt(reference::Long(samples.weights[static_cast<std::size_t>(i)]));
                a.row(i) *= root;
                q.row(i) *= root;
            }
            const reference::Matrix best = reference::least_squares(a, q);
            const PointSet control = result.spline.free_control_points();
            EXPECT_LT(static_cast<double>(
                          (reference::matrix(Points(control)) - best).cwiseAbs().maxCoeff()),
                      1e-9)
                << name;
        }
    }
}

TEST(Passes, what_needs_the_samples_in_memory_has_them) {
    const Samples samples = rose(500, 2, 7);
    FitOptions smooth = direct(40);
    smooth.smooth.wanted = true;
    FitOptions iterated = direct(20);
    iterated.method.name = "lspia";
    FitOptions within;
    within.tolerance.value = 0.1;
    for (const FitOptions& options : {smooth, iterated, within}) {
        CountingSource source(samples, 37, false);
        EXPECT_EQ(fit(source, options).spline.control_points().values(),
                  fit(samples, options).spline.control_points().values());
    }
    FitOptions bare = iterated;
    bare.keep_per_sample = false;
    const FitResult result = fit(samples, bare);
    EXPECT_TRUE(result.parameters.axes.empty());
    EXPECT_TRUE(result.deviations.empty());
    EXPECT_GT(result.report.deviation.maximum, 0);
}

TEST(Passes, what_the_samples_turn_out_to_be_is_the_same_from_a_source) {
    PointSet gap = random_points(300, 2, 8); // most of them in one place
    for (Index i = 40; i < 300; ++i) gap(i, 0) = gap(i, 1) = 1;
    PointSet large = random_points(300, 2, 9); // whose squares leave the range of numbers
    for (double& x : large.values()) x *= 1e200;
    for (const PointSet& points : {gap, large}) {
        const Samples samples = sequence(PointSet(points));
        CountingSource source(samples, 50);
        FitOptions options = direct(30);
        options.method.name = "auto";
        const FitResult whole = fit(samples, options);
        const FitResult result = fit(source, options);
        EXPECT_EQ(result.spline.control_points().values(), whole.spline.control_points().values());
        EXPECT_EQ(result.report.notes, whole.report.notes);
        EXPECT_EQ(result.report.method_reason, whole.report.method_reason);
    }
}

TEST(Passes, refusals_name_the_sample) {
    const auto says = [](const Samples& samples, const FitOptions& options, const char* words) {
        CountingSource source(samples, 64);
        const std::string message = message_of<InvalidInput>([&] { (void)fit(source, options); });
        EXPECT_NE(message.find(words), std::string::npos) << message;
    };
    PointSet q = random_points(20000, 2, 10);
    q(17000, 1) = std::numeric_limits<double>::quiet_NaN();
    says(sequence(std::move(q)), direct(30), "sample 17000: its coordinates (");
    Samples weighted = rose(20000, 2, 11);
    weighted.weights.assign(20000, 1);
    weighted.weights[18000] = -1;
    says(weighted, direct(30), "weight 18000: -1 must be positive and finite");
    const Samples plain = rose(300, 2, 12);
    FitOptions descending = direct(30);
    descending.shape.parameters = Parameters{{testing::random_parameters(300, 5)}, {}};
    std::swap(descending.shape.parameters->axes[0][150], descending.shape.parameters->axes[0][151]);
    says(plain, descending, "axis 0: parameter 151 = ");
    descending.shape.parameters->axes[0].resize(299);
    says(plain, descending, "axis 0: parameter 151 = ");
    FitOptions fewer = direct(30);
    fewer.shape.parameters = Parameters{{testing::random_parameters(299, 5)}, {}};
    says(plain, fewer, "axis 0: 299 parameters given for 300 samples");
    says(plain, direct(301), "axis 0: 301 control points need at least as many samples, got 300");
    says(sequence(PointSet(300, 2)), direct(10), "all points are identical");
    says(sequence(PointSet(0, 2)), direct(10), "samples: there are none");
}

#ifndef __SANITIZE_ADDRESS__
TEST(Passes, nothing_large_is_allocated_for_many_samples) {
    const Index m = 2'000'000;
    const Samples samples = rose(m, 3, 13);
    const Parameters given{{testing::random_parameters(m, 14)}, {}};
    FitOptions chord = direct(1000);
    FitOptions by_parameters = direct(1000);
    by_parameters.shape.parameters = given;
    for (FitOptions* options : {&chord, &by_parameters}) {
        options->keep_per_sample = false;
        options->threads = 1;
        for (const Index most : {Index{0}, Index{1000}}) {
            CountingSource source(samples, most);
            testing::largest_allocation = 0;
            const FitResult result = fit(source, *options);
            EXPECT_LE(testing::largest_allocation, std::size_t{1} << 20U);
            EXPECT_EQ(source.passes, options == &chord ? 3 : 2);
            EXPECT_LT(result.report.deviation.maximum, 0.01);
        }
        testing::largest_allocation = 0;
        (void)fit(samples, *options);
        EXPECT_LE(testing::largest_allocation, std::size_t{1} << 20U);
    }
}
#endif

} // namespace
} // namespace batten
