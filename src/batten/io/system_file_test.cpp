#include "problems.hpp"

#include <batten/io/checksum.hpp>

#include <cstring>
#include <limits>

namespace batten {
namespace {

/// Sums of every kind: of a curve, a grid, a cloud, a weighted grid.
std::vector<SystemSums> kinds() {
    const KnotVector open = uniform_knots(2, 5, 0, 1);
    const KnotVector ring = uniform_knots(1, 3, 0, 1, Closure::closed);
    std::vector<SystemSums> result;
    Samples samples = testing::sequence(testing::random_points(20, 2, 1));
    const std::vector<double> t = testing::random_parameters(20, 2);
    result.push_back(sums_of(*assemble({open}, samples, {{t}, {}}), samples));
    samples.order = Order::none;
    PointSet uv = testing::random_points(20, 2, 3);
    for (double& x : uv.values()) x = (x + 1) / 2;
    result.push_back(sums_of(*assemble({open, ring}, samples, {{}, uv}), samples));
    samples.points = testing::random_points(40, 1, 4);
    samples.grid = {8, 5};
    const Parameters grid{{testing::random_parameters(8, 5), testing::random_parameters(5, 6)}, {}};
    result.push_back(sums_of(*assemble({open, ring}, samples, grid), samples));
    samples.weights.assign(40, 2);
    result.push_back(sums_of(*assemble({open, ring}, samples, grid), samples));
    return result;
}

/// With the checksum of what comes before.
std::string summed(std::string content) {
    const std::uint64_t sum = checksum(content);
    for (unsigned k = 0; k < 8; ++k) content.push_back(static_cast<char>(sum >> 8 * k & 0xFFU));
    return content;
}

TEST(SystemFile, holds_every_number) {
    for (const SystemSums& sums : kinds()) {
        const std::string content = system_content(sums);
        const SystemSums again = parse_system("a.sys", content);
        EXPECT_EQ(again.axes, sums.axes);
        EXPECT_EQ(again.centre, sums.centre);
        EXPECT_EQ(again.samples, sums.samples);
        EXPECT_EQ(again.weight, sums.weight);
        EXPECT_EQ(again.energy, sums.energy);
        EXPECT_EQ(again.box.values(), sums.box.values());
        EXPECT_EQ(again.rhs.values(), sums.rhs.values());
        EXPECT_EQ(again.factors, sums.factors);
        EXPECT_EQ(again.stencil, sums.stencil);
        EXPECT_EQ(again.axis_sums, sums.axis_sums);
        EXPECT_EQ(again.grid_means, sums.grid_means);
        EXPECT_EQ(system_content(again), content);
    }
}

TEST(SystemFile, is_saved_and_loaded) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       ("batten_system_" + std::to_string(std::rand()) + ".sys");
    const SystemSums sums = kinds()[1];
    save_system(path, sums);
    EXPECT_EQ(load_system(path).stencil, sums.stencil);
    std::filesystem::remove(path);
    EXPECT_THROW(load_system(path), FileError);
}

TEST(SystemFile, with_any_byte_changed_is_refused) {
    for (const SystemSums& sums : kinds()) {
        const std::string content = system_content(sums);
        for (std::size_t at = 0; at < content.size(); ++at)
            for (int change : {1, 2, 4, 8, 16, 32, 64, 128, 255}) {
                std::string damaged = content;
                damaged[at] = static_cast<char>(damaged[at] ^ change);
                EXPECT_THROW(parse_system("a.sys", damaged), FileError) << at;
            }
    }
}

TEST(SystemFile, whose_header_lies_is_refused_whatever_its_checksum) {
    for (const SystemSums& sums : kinds()) {
        const std::string content = system_content(sums);
        const std::string body = content.substr(0, content.size() - 8);
        const std::size_t header = 32 + 16 * sums.axes.size();
        for (std::size_t at = 0; at < header; ++at)
            for (int change : {1, 2, 4, 8, 16, 32, 64, 128, 255}) {
                std::string damaged = body;
                damaged[at] = static_cast<char>(damaged[at] ^ change);
                if (at >= 24 && at < 32) continue; // the number of samples: any may be
                try { // a change of the kind or of closed axes may leave another valid system
                    parse_system("a.sys", summed(damaged));
                } catch (const FileError&) {
                }
            }
    }
}

TEST(SystemFile, cut_off_anywhere_is_refused) {
    for (const SystemSums& sums : kinds()) {
        const std::string content = system_content(sums);
        for (std::size_t size = 0; size < content.size(); ++size) {
            const std::string part = content.substr(0, size);
            EXPECT_THROW(parse_system("a.sys", part), FileError) << size;
            if (size + 8 == content.size()) continue; // with its checksum that is the whole file
            EXPECT_THROW(parse_system("a.sys", summed(part)), FileError) << size;
        }
        EXPECT_THROW(parse_system("a.sys", content + "more"), FileError);
    }
}

TEST(SystemFile, with_numbers_that_no_samples_have_is_refused) {
    const SystemSums good = kinds()[0];
    const auto message = [&](const auto& change) {
        SystemSums sums = good;
        change(sums);
        return testing::message_of<FileError>([&] { parse_system("a.sys", system_content(sums)); });
    };
    EXPECT_EQ(message([](SystemSums& s) { s.weight = 0; }), "a.sys: a weight of 0: not of samples");
    EXPECT_EQ(message([](SystemSums& s) { s.energy = -1; }),
              "a.sys: a sum of squares of -1: not of samples");
    EXPECT_EQ(message([](SystemSums& s) { s.box(0, 0) = s.box(1, 0) + 1; }).substr(0, 20),
              "a.sys: coordinate 0 ");
    EXPECT_EQ(message([](SystemSums& s) { s.samples = 0; }).substr(0, 47),
              "a.sys: damaged: a number of samples of 0, 1 to ");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(message([&](SystemSums& s) { s.rhs(0, 0) = nan; }).find("is not finite"),
              std::string::npos);
    std::string knots = system_content(good);
    knots.resize(knots.size() - 8);
    const double wrong = 7;
    std::memcpy(knots.data() + 48, &wrong, sizeof wrong);
    EXPECT_EQ(testing::message_of<FileError>([&] { parse_system("a.sys", summed(knots)); }),
              "a.sys: axis 0: knots must ascend: knot 1 = 0 is less than knot 0 = 7");
    SystemSums without = good;
    without.box = {};
    EXPECT_THROW(system_content(without), InvalidInput);
}

TEST(SystemFile, is_what_its_header_says_or_nothing_is_allocated) {
    // counts beyond every file, and beyond every number
    std::string content = system_content(kinds()[1]);
    for (const std::uint64_t knots : {std::uint64_t{1} << 39U, ~std::uint64_t{0}}) {
        std::memcpy(content.data() + 40, &knots, sizeof knots);
        std::memcpy(content.data() + 56, &knots, sizeof knots);
        EXPECT_THROW(parse_system("a.sys", summed(content.substr(0, content.size() - 8))),
                     FileError);
    }
}

TEST(Checksum, is_that_of_crc_64_xz) {
    EXPECT_EQ(checksum("123456789"), 0x995DC9BBDF1939FAU); // the standard's check value
    EXPECT_EQ(checksum(""), 0U);
}

} // namespace
} // namespace batten
