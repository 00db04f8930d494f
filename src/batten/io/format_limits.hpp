#pragma once

#include <batten/spline/spline.hpp>

#include <string>
#include <string_view>

namespace batten {

/// Which splines fit into a file of a format.
struct FormatLimits {
    /// What it holds, a sentence without its stop: "an .obj holds curves and surfaces in space".
    std::string_view holds{};
    Index least_axes = 1;
    Index most_axes = 3;
    Index least_dim = 1;
    Index most_dim = 16;
    /// Functions of up to so many variables are drawn as graphs, whatever the dimensions say.
    Index most_variables = 0;
};

/// Throws InvalidInput for a spline of so many axes and dimension that does not fit.
void check(const FormatLimits& limits, Index axes, Index dim);

inline constexpr FormatLimits obj_limits{.holds = "an .obj holds curves and surfaces in space",
                                         .most_axes = 2,
                                         .least_dim = 2,
                                         .most_dim = 3,
                                         .most_variables = 2};
inline constexpr FormatLimits stl_limits{.holds = "an .stl holds surfaces in space",
                                         .least_axes = 2,
                                         .least_dim = 3,
                                         .most_dim = 3,
                                         .most_variables = 2};
inline constexpr FormatLimits vts_limits{.holds = "a .vts holds points in space", .most_dim = 3};
inline constexpr FormatLimits vtu_limits{.holds = "a .vtu holds points in space", .most_dim = 3};
/// Of what shows splines and graphs in the plane and in space.
constexpr FormatLimits shown(std::string_view holds) {
    return {.holds = holds, .least_dim = 2, .most_dim = 3, .most_variables = 2};
}

inline constexpr FormatLimits svg_limits =
    shown("an .svg picture shows the plane, space and functions of one and two variables");
inline constexpr FormatLimits page_limits =
    shown("a report page shows curves, surfaces and volumes in space and functions of one and two "
          "variables");
inline constexpr FormatLimits cad_limits{.holds = "a CAD file holds curves and surfaces in space",
                                         .most_axes = 2,
                                         .least_dim = 2,
                                         .most_dim = 3};

} // namespace batten
