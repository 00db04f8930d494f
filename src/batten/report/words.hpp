#pragma once

#include <batten/problem/report.hpp>

#include <string>
#include <vector>

namespace batten {

/// The stated goals that were not reached, each with what was stated and what came of it, on one
/// line; empty where all were.
std::string missed_words(const FitReport& report);

/// ", closed" or ", closed along axis 0, 1"; empty where none is.
std::string closed_axes(const std::vector<Closure>& closures);

/// A length in hundredths of the data's size.
std::string percentage(double part, double whole);

} // namespace batten
