#include "problems.hpp"

#include <batten/solve/factorization.hpp>

namespace batten {
namespace {

using testing::message_of;
using testing::random_points;

TEST(NestedCholesky, gives_the_dense_solution_of_any_net) {
    const Closure o = Closure::open;
    const Closure c = Closure::closed;
    struct Net {
        std::vector<Index> size;
        std::vector<int> degree;
        std::vector<Closure> closures;
    };
    for (const Net& net : {Net{{40, 25}, {3, 2}, {o, o}}, Net{{4, 60}, {3, 3}, {o, o}},
                           Net{{5, 30}, {3, 4}, {c, c}}, Net{{21, 26}, {3, 1}, {c, o}},
                           Net{{9, 10, 11}, {2, 3, 2}, {o, c, o}}, Net{{4, 4}, {3, 3}, {o, c}}}) {
        std::vector<KnotVector> axes;
        for (std::size_t k = 0; k < net.size.size(); ++k)
            axes.push_back(uniform_knots(net.degree[k], net.size[k], 0, 1, net.closures[k]));
        PointSet places = random_points(6000, static_cast<Index>(axes.size()), 3);
        for (double& t : places.values()) t = (t + 1) / 2;
        Samples samples{.points = random_points(6000, 1, 4)};
        const auto system = assemble(axes, samples, {{}, std::move(places)});
        const Index n = system->size();
        reference::Matrix full = reference::Matrix::Zero(n, n);
        system->for_each_entry([&](Index i, Index j, double value) { full(i, j) += value; });
        const PointSet b = random_points(n, 2, 5);
        const PointSet x = factorize(*system)->solve(b);
        const reference::Matrix exact = reference::solve_definite(full, reference::matrix(b));
        EXPECT_LT(reference::difference(exact, x), 1e-9L * exact.norm()) << n; // condition to 1e6
    }
}

TEST(NestedCholesky, refuses_what_no_sample_determines) {
    PointSet places(2000, 2);
    const PointSet random = random_points(2000, 2, 3);
    for (std::size_t k = 0; k < places.values().size(); ++k) // half of the domain
        places.values()[k] = (random.values()[k] + 1) / 4;
    const auto knots = uniform_knots(3, 20, 0, 1);
    const Samples samples{.points = random_points(2000, 1, 4)};
    const auto system = assemble({knots, knots}, samples, {{}, std::move(places)});
    EXPECT_EQ(message_of<SolverError>([&] { factorize(*system); }),
              "the normal equations are singular: some control points are not determined by the "
              "samples");
}

} // namespace
} // namespace batten
