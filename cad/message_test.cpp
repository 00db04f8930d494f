// Messages come back as they went, and damaged ones are refused, whatever was damaged.
#include "message.hpp"

#include <batten/basis/place_knots.hpp>
#include <batten/fit/fit.hpp>
#include <batten/samples/generate.hpp>

#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace batten::cad {
namespace {

Spline closed_curve() {
    FitOptions options{.shape = {.control_points = {12}}};
    options.shape.closures = {Closure::closed};
    return fit(generate("rose"), options).spline;
}

Spline block() {
    return {{uniform_knots(1, 2, 0, 1), uniform_knots(2, 3, 0, 1), uniform_knots(1, 4, -1, 1)},
            PointSet(24, 17)};
}

std::string message() {
    Packer packer;
    packer.put(std::numeric_limits<std::int64_t>::min());
    packer.put(std::string_view("a\0b", 3));
    packer.put(closed_curve());
    packer.put(block());
    packer.put(std::string_view());
    return std::move(packer).finish();
}

/// Takes the message apart as it was made; how many splines it held.
int taken_apart(std::string text) {
    Unpacker unpacker(std::move(text));
    unpacker.take_number();
    unpacker.take_text();
    for (int count = 0; count < 2; ++count) {
        const Spline spline = unpacker.take_spline();
        EXPECT_GE(spline.control_points().size(), spline.axis(0).control_count());
    }
    unpacker.take_text();
    return 2;
}

TEST(CadMessage, comes_back_as_it_went) {
    Unpacker unpacker(message());
    EXPECT_EQ(unpacker.take_number(), std::numeric_limits<std::int64_t>::min());
    EXPECT_EQ(unpacker.take_text(), std::string("a\0b", 3));
    for (const Spline& spline : {closed_curve(), block()}) {
        const Spline back = unpacker.take_spline();
        EXPECT_TRUE(back.axes() == spline.axes());
        EXPECT_EQ(back.control_points().values(), spline.control_points().values());
        EXPECT_EQ(back.dim(), spline.dim());
    }
    EXPECT_EQ(unpacker.take_text(), "");
    EXPECT_THROW(unpacker.take_number(), Failed);
}

TEST(CadMessage, every_prefix_is_refused) {
    const std::string whole = message();
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_THROW(taken_apart(whole.substr(0, size)), Failed) << size;
    EXPECT_THROW(taken_apart(whole + "x"), Failed);
}

TEST(CadMessage, wrong_numbers_are_refused_or_make_whole_splines) {
    const std::string whole = message();
    std::mt19937 random(1);
    int refused = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        std::string text = whole;
        const std::size_t place = random() % (text.size() - 8);
        const std::int64_t numbers[] = {
            -1, 0, 1, 1000, std::int64_t{1} << 40, std::numeric_limits<std::int64_t>::max()};
        std::memcpy(text.data() + place, &numbers[random() % std::size(numbers)], 8);
        try {
            taken_apart(text);
        } catch (const Failed&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 100); // most bytes are coordinates, which may be anything
}

} // namespace
} // namespace batten::cad
