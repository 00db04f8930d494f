#pragma once

#include <string>
#include <vector>

namespace batten::command {

/// One line of a plot: a value for each iteration from 0 on.
struct Series {
    std::string name;
    std::vector<double> values;
};

/// SVG picture of positive values over iterations: logarithmic upwards, and sideways where the
/// longest series has more than a few hundred; zeros and what is not finite leave gaps.
std::string convergence_plot(const std::string& title, const std::string& what,
                             const std::vector<Series>& series);

} // namespace batten::command
