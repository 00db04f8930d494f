#include "problems.hpp"

#include <batten/iterate/lspia.hpp>
#include <batten/iterate/mlspia.hpp>

namespace batten {
namespace {

using testing::message_of;

TEST(SettingRange, holds_its_ends_as_it_says) {
    const SettingRange half{0, 1, RangeEnd::closed, RangeEnd::open};
    EXPECT_TRUE(half.contains(0));
    EXPECT_FALSE(half.contains(1));
    EXPECT_FALSE(half.contains(-1e-300));
    EXPECT_FALSE(half.contains(std::nan("")));
    EXPECT_EQ(half.words("eta"), "0 <= eta < 1");
    const SettingRange whole{1, 9, RangeEnd::closed, RangeEnd::closed, Numbers::whole};
    EXPECT_TRUE(whole.contains(9));
    EXPECT_FALSE(whole.contains(1.7));
    EXPECT_EQ(whole.words("rounds"), "the whole numbers 1 <= rounds <= 9");
    EXPECT_EQ((SettingRange{.low = 0}).words("mu"), "0 < mu");
    EXPECT_EQ(SettingRange{}.words("gamma"), "any number");
}

TEST(Settings, a_default_that_is_a_number_is_in_its_own_range) {
    for (const MethodEntry& entry : methods())
        for (const MethodSetting& s : entry.settings) {
            EXPECT_FALSE(s.meaning.empty() || s.default_words().empty()) << s.name;
            const double* number = std::get_if<double>(&s.otherwise);
            EXPECT_TRUE(number == nullptr || s.range.contains(*number)) << entry.name << s.name;
        }
}

TEST(Settings, an_absent_one_is_the_default_and_a_given_one_is_itself) {
    const MethodEntry& epia = method_entry("epia");
    EXPECT_EQ(setting(epia, {}, "eta"), 0.6);
    EXPECT_EQ(setting(epia, {{"eta", 0}}, "eta"), 0);
    EXPECT_FALSE(setting(Settings{}, "mu").has_value());
    EXPECT_EQ(setting(Settings{{"mu", 0}}, "mu"), 0);
}

TEST(Settings, every_range_is_checked_in_one_wording) {
    const auto refusal = [](std::string_view method, Settings settings) {
        return message_of<InvalidInput>([&] { check_settings(method_entry(method), settings); });
    };
    EXPECT_EQ(refusal("mlspia", {{"nu", 0}}), "setting nu = 0 of method mlspia is outside 0 < nu");
    EXPECT_EQ(refusal("epia", {{"rounds", 1.7}}),
              "setting rounds = 1.7 of method epia is outside the whole numbers 0 <= rounds <= "
              "1000000");
    EXPECT_EQ(refusal("pia", {{"weight", 2.5}}),
              "setting weight = 2.5 of method pia is outside 0 < weight <= 2");
    EXPECT_EQ(refusal("cg", {{"plain", std::nan("")}}),
              "setting plain = nan of method cg is not finite");
}

TEST(Settings, library_calls_check_what_the_command_checks) {
    const Samples rose = generate("rose");
    const Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    const auto system = assemble({knots_from_parameters(t.axes[0], 3, 30)}, rose, t);
    PointSet control(30, 2);
    const auto refusal = [&](Method&& method) {
        return message_of<InvalidInput>([&] { method.start(control); });
    };
    EXPECT_TRUE(
        refusal(Lspia(*system, 0)).starts_with("setting mu = 0 of method lspia is outside"));
    EXPECT_EQ(refusal(Lspia(*system, {}, 1)),
              "setting eigenvalue_tolerance = 1 of method lspia is outside 0 < "
              "eigenvalue_tolerance < 1");
    EXPECT_EQ(refusal(Mlspia(*system, {.omega = 0})),
              "setting omega = 0 of method mlspia is outside 0 < omega < 2");
    EXPECT_EQ(message_of<InvalidInput>([&] {
                  make_method("cg", *system, {{"plain", 1}, {"diagonal", 1}});
              }),
              "settings plain = 1 and diagonal = 1 of method cg: one of them at most");
}

TEST(Settings, a_gamma_of_0_is_inside_the_region_and_converges) {
    const Samples rose = generate("rose");
    const Parameters t = parametrize(rose, Parametrization::chord, {Closure::open});
    const auto system = assemble({knots_from_parameters(t.axes[0], 3, 30)}, rose, t);
    Mlspia method(*system, {.gamma = 0});
    PointSet control(30, 2);
    const Summary summary = iterate(method, control, {.max_iterations = 100000});
    EXPECT_EQ(summary.termination, Termination::converged);
    EXPECT_EQ(method.settings()["gamma"], 0);
    EXPECT_LT(testing::largest_difference(control, solve_direct(*system)), 1e-7);
}

} // namespace
} // namespace batten
