// Huang and Wang, MLSPIA: Example 3 (r = sin(theta/4), 501 points), Tables 1 and 2.
#include "problems.hpp"

#include <batten/iterate/lspia.hpp>
#include <batten/iterate/mlspia.hpp>

namespace batten {
namespace {

constexpr double paper_accuracy = 1e-12; // eigenvalues to the figures that the paper prints

FitResult example_3(const char* method, Index n, Initial initial) {
    FitOptions options;
    options.shape.control_points = {n};
    options.method = {.name = method,
                      .settings = {{"eigenvalue_tolerance", paper_accuracy}},
                      .initial = initial,
                      .control = {}};
    options.stop = {.max_iterations = 10000,
                    .gradient = 1e-8,
                    .relative_gradient = 0}; // prints 1e-7; its counts are those of 1e-8
    return fit(generate("rose", {501}), options);
}

TEST(HuangWang, weights_of_example_3_to_all_digits) {
    const Settings mlspia = example_3("mlspia", 50, Initial::data).report.settings;
    EXPECT_NEAR(mlspia.at("omega"), 0.589932226424, 5e-13);
    EXPECT_NEAR(mlspia.at("gamma"), 0.589932226424, 5e-13);
    EXPECT_NEAR(mlspia.at("nu"), 0.418520492365, 5e-13);
    EXPECT_NEAR(example_3("lspia", 50, Initial::data).report.settings.at("mu"), 0.175097063057,
                5e-13);
}

TEST(HuangWang, iterations_of_table_1) {
    const Index n[] = {501 / 12, 501 / 10, 501 / 8, 501 / 6, 501 / 4, 501 / 2, 2 * 501 / 3};
    const Index from_zero[] = {56, 55, 55, 55, 55, 85, 696};
    const Index from_data[] = {49, 47, 48, 48, 49, 74, 570};
    for (std::size_t k = 0; k < 7; ++k) {
        EXPECT_EQ(example_3("mlspia", n[k], Initial::zero).report.iterations, from_zero[k]) << n[k];
        EXPECT_EQ(example_3("mlspia", n[k], Initial::data).report.iterations, from_data[k]) << n[k];
    }
}

TEST(HuangWang, iterations_of_table_2) {
    EXPECT_EQ(example_3("mlspia", 50, Initial::data).report.iterations, 47);
    EXPECT_EQ(example_3("lspia", 50, Initial::data).report.iterations,
              157); // 156 in the 2-norm, the paper's
}

} // namespace
} // namespace batten
