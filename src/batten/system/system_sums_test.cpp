#include "problems.hpp"

#include <batten/basis/nested_knots.hpp>
#include <batten/system/system_sums.hpp>

namespace batten {
namespace {

using LongMatrix = reference::Matrix;

/// Samples of some kind over axes, their dense A and weights in extended precision.
struct Case {
    std::string name;
    std::vector<KnotVector> axes;
    Samples samples{};
    Parameters parameters{};

    LongMatrix rows(const std::vector<KnotVector>& over) const {
        return reference::scattered_collocation(over, parameter_rows(parameters));
    }
    LongMatrix weighted(LongMatrix a) const {
        for (std::size_t j = 0; j < samples.weights.size(); ++j)
            a.row(static_cast<Index>(j)) *= samples.weights[j];
        return a;
    }
    SystemSums sums() const { return sums_of(*assemble(axes, samples, parameters), samples); }
};

std::vector<double> weights_of(Index count) {
    std::vector<double> result = testing::random_points(count, 1, 9).values();
    for (double& w : result) w += 1.5;
    return result;
}

Case of_cloud(std::string name, std::vector<KnotVector> axes, Index count, bool weighted,
              unsigned seed = 1) {
    Case result{std::move(name), std::move(axes)};
    const auto k = static_cast<Index>(result.axes.size());
    result.parameters.scattered = testing::random_points(count, k, seed);
    for (double& t : result.parameters.scattered.values()) t = (t + 1) / 2;
    result.samples.points = testing::random_points(count, 2, seed + 1);
    result.samples.order = Order::none;
    if (weighted) result.samples.weights = weights_of(count);
    return result;
}

Case of_grid(std::string name, std::vector<KnotVector> axes, const std::vector<Index>& shape,
             bool weighted, unsigned seed = 2) {
    Case result{std::move(name), std::move(axes)};
    for (std::size_t k = 0; k < shape.size(); ++k)
        result.parameters.axes.push_back(
            testing::random_parameters(shape[k], k == 0 ? seed : static_cast<unsigned>(k)));
    const Index count = GridIndex(shape).size();
    result.samples.points = testing::random_points(count, 3, seed + 5);
    if (shape.size() > 1) result.samples.grid = shape;
    if (weighted) result.samples.weights = weights_of(count);
    return result;
}

std::vector<Case> cases(unsigned seed = 2) {
    const KnotVector cubic = uniform_knots(3, 15, 0, 1);
    const KnotVector quadratic = knots_around(2, std::vector{0.2, 0.3, 0.5, 0.5, 0.6}, 0, 1);
    const KnotVector ring = uniform_knots(3, 12, 0, 1, Closure::closed);
    const KnotVector short_ring = uniform_knots(2, 6, 0, 1, Closure::closed);
    const KnotVector seam = knots_around(3, std::vector{0.0, 0.1, 0.3, 0.7}, 0, 1, Closure::closed);
    const KnotVector linear = uniform_knots(1, 7, 0, 1);
    const KnotVector ninth = uniform_knots(9, 15, 0, 1);
    return {of_grid("curve", {cubic}, {80}, false, seed),
            of_grid("weighted curve", {quadratic}, {60}, true, seed),
            of_grid("degree 9", {ninth}, {90}, false, seed),
            of_grid("closed curve", {ring}, {70}, false, seed),
            of_grid("short closed curve", {short_ring}, {50}, true, seed),
            of_grid("seam", {seam}, {60}, false, seed),
            of_grid("grid", {cubic, short_ring}, {16, 8}, false, seed),
            of_grid("weighted grid", {ring, linear}, {14, 9}, true, seed),
            of_grid("volume", {linear, quadratic, short_ring}, {6, 5, 4}, false, seed),
            of_grid("weighted volume", {short_ring, linear, linear}, {7, 4, 5}, true, seed),
            of_cloud("cloud of a curve", {cubic}, 90, true, seed),
            of_cloud("cloud", {quadratic, cubic}, 100, true, seed),
            of_cloud("closed cloud", {short_ring, ring}, 100, false, seed),
            of_cloud("cloud of a volume", {short_ring, linear, quadratic}, 100, true, seed)};
}

LongMatrix matrix_of(const NormalSystem& system) {
    LongMatrix result = LongMatrix::Zero(system.size(), system.size());
    system.for_each_entry([&](Index i, Index j, double value) { result(i, j) += value; });
    return result;
}

/// The sums are those of all rows and points over the axes, but for rounding.
void expect_sums(SystemSums sums, const LongMatrix& a, const LongMatrix& weighted,
                 const LongMatrix& q) {
    LongMatrix shift = q;
    for (Index d = 0; d < q.cols(); ++d)
        shift.col(d).array() -= sums.centre[static_cast<std::size_t>(d)];
    const auto system = system_of(std::move(sums));
    const LongMatrix gram = reference::transposed_product(weighted, a);
    const LongMatrix right = reference::transposed_product(weighted, shift);
    EXPECT_LT((matrix_of(*system) - gram).cwiseAbs().maxCoeff(),
              1e-13 * gram.cwiseAbs().maxCoeff());
    EXPECT_LT(reference::difference(right, system->rhs()), 1e-13 * right.cwiseAbs().maxCoeff());
}

TEST(SystemSums, over_coarser_knots_are_those_of_the_same_samples) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        for (std::size_t axis = 0; axis < c.axes.size(); ++axis)
            for (const KnotVector& coarse : nested_knots(c.axes[axis])) {
                std::vector<KnotVector> axes = c.axes;
                axes[axis] = coarse;
                if (axis > 0) axes[0] = nested_knots(c.axes[0]).front();
                SCOPED_TRACE(coarse.free_count());
                const LongMatrix a = c.rows(axes);
                expect_sums(coarsened(c.sums(), axes), a, c.weighted(a),
                            reference::matrix(c.samples.points));
            }
    }
}

TEST(SystemSums, of_two_parts_add_up) {
    const std::vector<Case> first = cases(2);
    for (unsigned seed : {2U, 40U}) { // the same parameters twice, and others along the first axis
        const std::vector<Case> second = cases(seed);
        for (std::size_t k = 0; k < first.size(); ++k) {
            SCOPED_TRACE(first[k].name);
            const Case& a = first[k];
            const Case& b = second[k];
            const LongMatrix one = a.rows(a.axes);
            const LongMatrix other = b.rows(a.axes);
            LongMatrix both(one.rows() + other.rows(), one.cols());
            both << one, other;
            LongMatrix weighted = both;
            weighted << a.weighted(one), b.weighted(other);
            LongMatrix q(both.rows(), a.samples.dim());
            q << reference::matrix(a.samples.points), reference::matrix(b.samples.points);
            SystemSums sums = merged(a.sums(), b.sums());
            EXPECT_EQ(sums.samples, both.rows());
            EXPECT_EQ(sums.factors.empty(), a.sums().factors.empty()); // grids stay grids
            EXPECT_EQ(sums.grid_means.empty(), a.sums().grid_means.empty());
            expect_sums(std::move(sums), both, weighted, q);
        }
    }
}

TEST(SystemSums, of_grids_with_other_parameters_along_two_axes_are_a_clouds) {
    for (bool weighted : {false, true}) {
        const KnotVector knots = uniform_knots(2, 7, 0, 1);
        Case a = of_grid("", {knots, knots}, {20, 15}, weighted, 3);
        Case b = of_grid("", {knots, knots}, {18, 15}, false, 4);
        b.parameters.axes[1] = testing::random_parameters(15, 77);
        const LongMatrix one = a.rows(a.axes);
        const LongMatrix other = b.rows(a.axes);
        LongMatrix both(one.rows() + other.rows(), one.cols());
        both << one, other;
        LongMatrix heavy = both;
        heavy << a.weighted(one), other;
        LongMatrix q(both.rows(), 3);
        q << reference::matrix(a.samples.points), reference::matrix(b.samples.points);
        const SystemSums sums = merged(a.sums(), b.sums());
        EXPECT_TRUE(sums.factors.empty() && sums.grid_means.empty());
        expect_sums(sums, both, heavy, q);
        // what preconditions is that of a cloud: each axis's matrix holds all the weight
        for (const BandedMatrix& axis : sums.axis_sums)
            EXPECT_NEAR(axis.total(), sums.weight, 1e-11 * sums.weight);
    }
}

TEST(SystemSums, of_a_grids_parts_are_smoothed_as_the_grid) {
    for (bool weighted : {false, true}) {
        const KnotVector knots = uniform_knots(3, 9, 0, 1);
        Case whole = of_grid("", {knots, knots}, {30, 12}, weighted, 3);
        std::vector<Case> parts;
        for (int k = 0; k < 2; ++k) { // the first 11 layers, and the others
            Case part = whole;
            const Index begin = k == 0 ? 0 : 11;
            const Index count = k == 0 ? 11 : 19;
            auto& u = part.parameters.axes[0];
            u = {u.begin() + begin, u.begin() + begin + count};
            part.samples.points = whole.samples.points.slice(12 * begin, 12 * count);
            part.samples.grid = {count, 12};
            auto& w = part.samples.weights;
            if (weighted) w = {w.begin() + 12 * begin, w.begin() + 12 * (begin + count)};
            parts.push_back(part);
        }
        const auto together = system_of(merged(parts[0].sums(), parts[1].sums()));
        const auto once = system_of(whole.sums());
        for (NormalSystem* system : {together.get(), once.get()}) system->add_roughness(0.01, 2);
        EXPECT_LT((matrix_of(*together) - matrix_of(*once)).cwiseAbs().maxCoeff(),
                  1e-13 * matrix_of(*once).cwiseAbs().maxCoeff());
    }
}

TEST(SystemSums, about_another_centre_have_the_same_energies) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        std::vector<double> centre(static_cast<std::size_t>(c.samples.dim()), 3.5);
        const SystemSums moved = recentred(c.sums(), centre);
        const LongMatrix a = c.rows(c.axes);
        expect_sums(moved, a, c.weighted(a), reference::matrix(c.samples.points));
        long double energy = 0;
        for (Index i = 0; i < c.samples.size(); ++i)
            for (double x : c.samples.points[i]) {
                const auto k = static_cast<std::size_t>(i);
                const long double w = c.samples.weights.empty() ? 1 : c.samples.weights[k];
                energy += w * (x - 3.5L) * (x - 3.5L);
            }
        EXPECT_NEAR(moved.energy, static_cast<double>(energy), 1e-13 * moved.energy);
    }
}

TEST(SystemSums, make_a_system_that_acts_alike) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const auto system = assemble(c.axes, c.samples, c.parameters);
        const auto again = system_of(system->sums());
        const PointSet x = testing::random_points(system->size(), 4, 8);
        PointSet y(x);
        PointSet z(x);
        system->apply(x, y);
        again->apply(x, z);
        EXPECT_EQ(y.values(), z.values());
        EXPECT_EQ(system->diagonal(), again->diagonal());
        EXPECT_EQ(system->of_grid(), again->of_grid());
        EXPECT_EQ(system->data_energy(), again->data_energy());
        EXPECT_EQ(system->nearby_factors(), again->nearby_factors());
        for (NormalSystem* one : {system.get(), again.get()}) one->add_roughness(0.1, 1);
        EXPECT_EQ(system->diagonal(), again->diagonal());
    }
}

TEST(SystemSums, over_knots_that_are_not_nested_are_refused) {
    const Case c = cases()[0];
    EXPECT_EQ(testing::message_of<InvalidInput>(
                  [&] { coarsened(c.sums(), {uniform_knots(3, 8, 0, 1)}); }),
              "axis 0: the knots are not nested in the system's, of degree 3 with 15 control "
              "points");
    EXPECT_THROW(coarsened(c.sums(), {uniform_knots(2, 14, 0, 1)}), InvalidInput);
    EXPECT_THROW(coarsened(c.sums(), {uniform_knots(3, 12, 0, 1, Closure::closed)}), InvalidInput);
    EXPECT_THROW(coarsened(c.sums(), {}), InvalidInput);
}

TEST(SystemSums, are_those_of_samples_only) {
    class Nothing : public NormalSystem {
      public:
        Nothing() : NormalSystem({uniform_knots(1, 2, 0, 1)}, {0}) {}
        std::unique_ptr<NormalSystem> clone() const override {
            return std::make_unique<Nothing>(*this);
        }
        void apply(const PointSet&, PointSet&) const override {}
        std::vector<double> diagonal() const override { return {}; }
        void for_each_entry(EntryVisitor) const override {}
        void add_roughness(double, int) override {}
    };
    EXPECT_THROW(Nothing().sums(), InvalidInput);
}

} // namespace
} // namespace batten
