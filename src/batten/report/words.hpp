#pragma once

#include <batten/problem/report.hpp>

#include <string>

namespace batten {

/// The stated goals that were not reached, each with what was stated and what came of it, on one
/// line; empty where all were.
std::string missed_words(const FitReport& report);

} // namespace batten
