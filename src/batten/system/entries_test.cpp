#include <batten/basis/place_knots.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/system/normal_system.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace batten {
namespace {

std::vector<double> numbers(Index count, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<double> result(static_cast<std::size_t>(count));
    for (double& x : result) x = unit(random);
    return result;
}

/// Samples over axes, and the dense A of them: column i is the spline whose control points are zero
/// but for the i-th.
struct Case {
    std::string name;
    std::vector<KnotVector> axes;
    Samples samples;
    Parameters parameters;

    Eigen::MatrixXd gram() const {
        const PointSet rows = parameter_rows(parameters);
        const GridIndex controls(free_shape(axes));
        Eigen::MatrixXd a(rows.size(), controls.size());
        for (Index i = 0; i < controls.size(); ++i) {
            PointSet unit(controls.size(), 1);
            unit(i, 0) = 1;
            const Spline spline = Spline::from_free(axes, unit);
            for (Index j = 0; j < rows.size(); ++j) a(j, i) = spline(rows[j])[0];
        }
        Eigen::VectorXd weights = Eigen::VectorXd::Ones(rows.size());
        for (std::size_t j = 0; j < samples.weights.size(); ++j)
            weights[static_cast<Index>(j)] = samples.weights[j];
        return a.transpose() * weights.asDiagonal() * a;
    }
};

Case cloud(std::vector<KnotVector> axes, Index count, bool weighted) {
    const auto k = static_cast<Index>(axes.size());
    Case result{"", std::move(axes), {}, {}};
    result.parameters.scattered = PointSet(numbers(count * k, 1), k);
    result.samples.points = PointSet(numbers(2 * count, 2), 2);
    if (weighted) {
        result.samples.weights = numbers(count, 3);
        for (double& w : result.samples.weights) w += 0.5;
    }
    return result;
}

Case grid(std::vector<KnotVector> axes, const std::vector<Index>& shape) {
    Case result{"", std::move(axes), {}, {}};
    for (Index m : shape) {
        std::vector<double> t;
        for (Index i = 0; i < m; ++i)
            t.push_back(std::pow(static_cast<double>(i) / static_cast<double>(m), 1.2));
        result.parameters.axes.push_back(std::move(t));
    }
    const Index count = GridIndex(shape).size();
    result.samples.points = PointSet(numbers(2 * count, 4), 2);
    if (shape.size() > 1) result.samples.grid = shape;
    return result;
}

std::vector<Case> cases() {
    const KnotVector cubic = uniform_knots(3, 6, 0, 1);
    const KnotVector quadratic = knots_around(2, std::vector{0.3, 0.5, 0.6}, 0, 1);
    const KnotVector ring = uniform_knots(3, 7, 0, 1, Closure::closed);
    const KnotVector short_ring = uniform_knots(2, 3, 0, 1, Closure::closed);
    std::vector<Case> all{
        grid({cubic}, {40}),
        grid({ring}, {40}),
        grid({short_ring}, {20}),
        grid({cubic, ring}, {12, 15}),
        grid({quadratic, short_ring, cubic}, {8, 7, 9}),
        cloud({cubic}, 60, false),
        cloud({cubic, quadratic}, 200, true),
        cloud({ring, quadratic}, 200, false),
        cloud({short_ring, ring, quadratic}, 500, true),
    };
    const char* names[] = {"curve", "closed curve", "short closed curve",
                           "grid",  "volume",       "cloud of a curve",
                           "cloud", "closed cloud", "cloud of a volume"};
    for (std::size_t k = 0; k < all.size(); ++k) all[k].name = names[k];
    return all;
}

TEST(NormalSystems, tell_every_entry_of_the_matrix) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto system = assemble(c.axes, c.samples, c.parameters);
        Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(system->size(), system->size());
        system->for_each_entry([&](Index i, Index j, double value) { sum(i, j) += value; });
        const Eigen::MatrixXd expected = c.gram();
        EXPECT_LT((sum - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
    }
}

TEST(NormalSystems, are_copied_whole_and_apart) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto system = assemble(c.axes, c.samples, c.parameters);
        const std::vector<double> before = system->diagonal();
        const auto copy = system->clone();
        EXPECT_EQ(copy->diagonal(), before);
        EXPECT_EQ(copy->rhs().values(), system->rhs().values());
        EXPECT_EQ(copy->sample_count(), system->sample_count());
        copy->add_roughness(0.5, 1);
        EXPECT_NE(copy->diagonal(), before);
        EXPECT_EQ(system->diagonal(), before);
    }
}

TEST(NormalSystems, have_nearby_factors_where_they_have_none) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto system = assemble(c.axes, c.samples, c.parameters);
        ASSERT_NE(system->factors().empty(), system->nearby_factors().empty());
        if (!system->factors().empty()) continue;
        // the product of sums that each hold all the weight: W^k over W^(k - 1)
        double product = 1;
        for (const BandedMatrix& factor : system->nearby_factors()) product *= factor.total();
        double weight = 0;
        for (double w : c.samples.weights) weight += w;
        if (c.samples.weights.empty()) weight = static_cast<double>(c.samples.size());
        EXPECT_NEAR(product, weight, 1e-11 * weight);
    }
}

/// A system of which nothing is known but its entries: what a new kind has to say at least.
class EntriesOnly : public NormalSystem {
  public:
    EntriesOnly(const Case& c, const NormalSystem& whole)
        : NormalSystem(c.axes, whole.centre()), matrix_(c.gram()) {
        rhs_ = whole.rhs();
        sample_count_ = whole.sample_count();
    }
    std::unique_ptr<NormalSystem> clone() const override {
        return std::make_unique<EntriesOnly>(*this);
    }
    void apply(const PointSet& x, PointSet& y) const override {
        y.fill(0);
        for_each_entry([&](Index i, Index j, double value) {
            for (Index d = 0; d < x.dim(); ++d) y(i, d) += value * x(j, d);
        });
    }
    std::vector<double> diagonal() const override {
        const Eigen::VectorXd d = matrix_.diagonal();
        return {d.begin(), d.end()};
    }
    void for_each_entry(EntryVisitor visit) const override {
        for (Index i = 0; i < matrix_.rows(); ++i)
            for (Index j = 0; j < matrix_.cols(); ++j) visit(i, j, matrix_(i, j));
    }
    void add_roughness(double, int) override { FAIL() << "not used here"; }

  private:
    Eigen::MatrixXd matrix_;
};

TEST(NormalSystems, of_a_new_kind_are_solved_as_they_stand) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto system = assemble(c.axes, c.samples, c.parameters);
        const EntriesOnly other(c, *system);
        EXPECT_EQ(factorize_axes(other), nullptr);
        const PointSet control = solve_direct(other);
        const Eigen::MatrixXd gram = c.gram();
        using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const Eigen::Map<const Rows> p(control.data(), control.size(), control.dim());
        const Eigen::Map<const Rows> b(system->rhs().data(), control.size(), control.dim());
        EXPECT_LT((gram * p - b).norm(), 1e-10 * b.norm());
    }
}

} // namespace
} // namespace batten
