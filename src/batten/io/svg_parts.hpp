#pragma once

#include <batten/core/core.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace batten {

/// Colour `rgb(...)` of a deviation as a part of the largest, 0 to 1: the scale of the HTML report.
std::string deviation_colour(double part);

/// Text that may stand in SVG.
std::string svg_escaped(std::string_view text);

/// The deviation's scale with its largest value, its upper left corner at (x, y).
std::string deviation_legend(double largest, double x, double y);

/// Dots of one radius at pixel places, coloured by deviation (all alike without), in a few paths.
std::string coloured_dots(const std::vector<std::string>& places,
                          const std::vector<double>* deviations, double largest, double radius);

} // namespace batten
