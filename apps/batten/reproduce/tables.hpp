#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace batten::command {

/// A figure of a paper beside ours.
struct Row {
    std::string what;
    std::string printed; ///< as in the paper, its digits are what is compared; empty: not there
    double computed;
    bool less_is_right = false; ///< an error that goes to 0: at most as large is what counts
};

/// Whose data a table is of.
enum class Data { the_papers, stand_in, none };

/// A table or a figure of a paper.
struct Table {
    std::string name;
    std::vector<Row> rows;
    Data data = Data::the_papers;
    std::string why{};      ///< the stand-in, or why it is not run
    std::string pictures{}; ///< the files that show it
};

/// Whether `computed`, rounded or cut to as many digits, is `printed`.
bool to_the_digit(const std::string& printed, double computed);

/// "to the digit", "3 of 5 to the digit, the rest within 2 %", "stand-in: ...", "not run: ...".
std::string verdict(const Table& table);

/// Heading, verdict and rows, in columns.
std::string in_words(const Table& table);

} // namespace batten::command
