#pragma once

#include "problems.hpp"

#include <batten/io/number_reader.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

namespace batten::testing {

/// A folder of its own that goes with the test.
class Readers : public ::testing::Test {
  protected:
    Readers()
        : folder_(std::filesystem::temp_directory_path() /
                  ("batten-readers-" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~Readers() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string file(const std::string& name, const std::string& content) const {
        std::ofstream(path(name), std::ios::binary) << content;
        return path(name);
    }
    std::filesystem::path folder_;
};

/// A text and, by the C library, the numbers that were written into it.
struct Written {
    std::string text;
    std::vector<double> numbers;
};

struct Style {
    std::string separator;
    std::string head;
    bool comments;
    std::string line_end;
    bool ends_with_line_end;
    std::size_t rows;
};

inline Written written(const Style& style, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(-1, 1);
    const char* const formats[] = {"%.17g", "%.18e", "%.3f", "%g", "%.25g", "%.0f", "%+.2e"};
    constexpr std::size_t columns = 3;
    Written result{style.head.empty() ? "" : style.head + style.line_end, {}};
    for (std::size_t row = 0; row < style.rows; ++row) {
        if (style.comments && random() % 4 == 0)
            result.text += (random() % 2 == 0 ? "# 1,2" : " ") + style.line_end;
        for (std::size_t c = 0; c < columns; ++c) {
            char token[64];
            const double x = std::ldexp(part(random), static_cast<int>(random() % 60) - 30);
            std::snprintf(token, sizeof token, formats[random() % std::size(formats)], x);
            result.numbers.push_back(std::strtod(token, nullptr));
            result.text += token + (c + 1 < columns ? style.separator : std::string());
        }
        if (style.comments && random() % 3 == 0) result.text += " # and, 7, words";
        if (row + 1 < style.rows || style.ends_with_line_end) result.text += style.line_end;
    }
    return result;
}

/// All numbers of a pass, `most` at a time.
inline std::vector<double> passed(NumberReader& reader, std::size_t most) {
    std::vector<double> numbers;
    std::vector<double> part(most);
    reader.rewind();
    while (const std::size_t got = reader.read(part))
        numbers.insert(numbers.end(), part.begin(),
                       part.begin() + static_cast<std::ptrdiff_t>(got));
    return numbers;
}

} // namespace batten::testing
