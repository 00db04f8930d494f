#include <batten/basis/active_functions.hpp>
#include <batten/basis/place_knots.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <vector>

namespace batten {
namespace {

/// B_{i,p} and its derivatives by the recursion of Cox and de Boor as it stands in books, without
/// spans: in extended precision, over the knots alone.
long double cox_de_boor(const KnotVector& knots, Index i, int p, long double t, int order) {
    const auto knot = [&](Index k) { return static_cast<long double>(knots[k]); };
    if (p == 0) { // spans hold their begin; the domain's end belongs to the last one
        const bool at_end = t == knot(knots.control_count());
        const bool inside =
            at_end ? knot(i) < t && t == knot(i + 1) : knot(i) <= t && t < knot(i + 1);
        return order == 0 && inside;
    }
    const auto over = [](long double a, long double b) { return b == 0 ? 0.0L : a / b; };
    const long double left = knot(i + p) - knot(i);
    const long double right = knot(i + p + 1) - knot(i + 1);
    if (order > 0)
        return p * (over(cox_de_boor(knots, i, p - 1, t, order - 1), left) -
                    over(cox_de_boor(knots, i + 1, p - 1, t, order - 1), right));
    return over(t - knot(i), left) * cox_de_boor(knots, i, p - 1, t, 0) +
           over(knot(i + p + 1) - t, right) * cox_de_boor(knots, i + 1, p - 1, t, 0);
}

/// All values of one axis's functions, those of a closed axis that mean one control point added.
std::vector<long double> all_values(const KnotVector& knots, double t, Numbering numbering,
                                    int order) {
    const Index n = numbering == Numbering::free ? knots.free_count() : knots.control_count();
    std::vector<long double> result(static_cast<std::size_t>(n));
    for (Index i = 0; i < knots.control_count(); ++i)
        result[static_cast<std::size_t>(i % n)] += cox_de_boor(knots, i, knots.degree(), t, order);
    return result;
}

const std::vector<KnotVector>& axes() {
    static const std::vector<KnotVector> all{
        uniform_knots(3, 7, 0, 1),
        knots_around(2, std::vector{0.2, 0.2, 0.7}, 0, 1),
        uniform_knots(1, 4, -1, 2),
        uniform_knots(3, 5, 0, 1, Closure::closed),
        knots_around(2, std::vector{0.1, 0.45, 0.8}, 0, 1, Closure::closed),
        uniform_knots(3, 4, 0, 1, Closure::closed), // as few as there can be
    };
    return all;
}

std::vector<double> parameters_of(const KnotVector& knots) {
    std::vector<double> t;
    for (double part : {0.0, 0.013, 0.2, 0.45, 0.6999, 0.85, 1.0})
        t.push_back(knots.begin() + part * knots.length());
    return t;
}

TEST(ActiveFunctions, are_the_functions_that_do_not_vanish) {
    for (const KnotVector& knots : axes())
        for (Numbering numbering : {Numbering::stored, Numbering::free})
            for (int order = 0; order <= knots.degree(); ++order)
                for (double t : parameters_of(knots)) {
                    const ActiveFunctions active = active_functions(knots, t, numbering, order);
                    std::vector<long double> rest = all_values(knots, t, numbering, order);
                    ASSERT_EQ(active.controls, static_cast<Index>(rest.size()));
                    for (int r = 0; r <= active.degree; ++r)
                        rest[static_cast<std::size_t>(active.index(r))] -=
                            active.value[static_cast<std::size_t>(r)];
                    const double scale = std::pow(30, order); // differences of knots divide
                    for (long double x : rest)
                        EXPECT_NEAR(static_cast<double>(x), 0, 1e-14 * scale);
                }
}

TEST(ActiveFunctions, go_around_with_the_parameter_on_a_closed_axis_only) {
    const KnotVector closed = uniform_knots(3, 5, 0, 1, Closure::closed);
    const ActiveFunctions inside = active_functions(closed, 0.25, Numbering::free);
    const ActiveFunctions turned = active_functions(closed, 3.25, Numbering::free);
    EXPECT_EQ(inside.first, turned.first);
    EXPECT_EQ(inside.value, turned.value);
    // an open axis's end piece continues: x^1 is still told beyond the end
    const KnotVector open = uniform_knots(2, 6, 0, 1);
    const std::vector<double> at = greville_abscissae(open);
    const ActiveFunctions beyond = active_functions(open, 1.3, Numbering::free);
    double sum = 0;
    for (int r = 0; r <= 2; ++r)
        sum += beyond.value[static_cast<std::size_t>(r)] *
               at[static_cast<std::size_t>(beyond.index(r))];
    EXPECT_NEAR(sum, 1.3, 1e-14);
}

TEST(ActiveRow, is_the_tensor_product_in_row_major_order) {
    const std::vector<std::vector<KnotVector>> cases{
        {axes()[0]},
        {axes()[3], axes()[1]},
        {axes()[1], axes()[5], axes()[2]},
        {axes()[4], axes()[3], axes()[0]},
    };
    for (const auto& knots : cases)
        for (Numbering numbering : {Numbering::stored, Numbering::free})
            for (const auto& orders : {std::vector<int>{}, std::vector<int>{1, 0, 1}}) {
                std::vector<double> t;
                std::vector<int> order(orders.begin(),
                                       orders.empty()
                                           ? orders.end()
                                           : orders.begin() + static_cast<Index>(knots.size()));
                std::vector<std::vector<long double>> single;
                for (std::size_t k = 0; k < knots.size(); ++k) {
                    t.push_back(knots[k].begin() +
                                knots[k].length() * (0.37 + 0.31 * static_cast<double>(k)));
                    single.push_back(
                        all_values(knots[k], t[k], numbering, order.empty() ? 0 : order[k]));
                }
                // every product, whether it vanishes or not
                std::vector<long double> expected{1};
                for (const auto& values : single) {
                    std::vector<long double> next;
                    for (long double a : expected)
                        for (long double b : values) next.push_back(a * b);
                    expected = std::move(next);
                }
                std::map<Index, double> got;
                std::size_t visits = 0;
                ActiveRow(knots, t, numbering, order)
                    .for_each_active([&](Index control, double value) {
                        got[control] += value;
                        ++visits;
                    });
                std::size_t functions = 1;
                for (const KnotVector& k : knots)
                    functions *= static_cast<std::size_t>(k.degree() + 1);
                EXPECT_EQ(visits, functions);
                EXPECT_EQ(got.size(), functions) << "each function once";
                for (std::size_t i = 0; i < expected.size(); ++i)
                    EXPECT_NEAR(got[static_cast<Index>(i)], static_cast<double>(expected[i]),
                                1e-11);
            }
}

} // namespace
} // namespace batten
