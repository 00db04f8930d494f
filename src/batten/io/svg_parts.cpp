#include <batten/io/svg_parts.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr std::array<std::array<double, 3>, 5> scale{{{0.2, 0.36, 0.72},
                                                      {0.16, 0.6, 0.72},
                                                      {0.36, 0.74, 0.45},
                                                      {0.93, 0.79, 0.27},
                                                      {0.93, 0.5, 0.2}}};

} // namespace

std::string deviation_colour(double part) {
    const double place = std::clamp(part, 0.0, 1.0) * static_cast<double>(scale.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), scale.size() - 2);
    const double f = place - static_cast<double>(k);
    std::array<int, 3> rgb{};
    for (std::size_t d = 0; d < 3; ++d)
        rgb[d] = static_cast<int>(std::lround(255 * ((1 - f) * scale[k][d] + f * scale[k + 1][d])));
    return fmt::format("rgb({},{},{})", rgb[0], rgb[1], rgb[2]);
}

std::string svg_escaped(std::string_view text) {
    std::string result;
    for (char c : text) {
        if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '&')
            result += "&amp;";
        else if (c == '"')
            result += "&quot;";
        else if (static_cast<unsigned char>(c) >= 0x20)
            result += c;
    }
    return result;
}

std::string deviation_legend(double largest, double x, double y) {
    constexpr double width = 180;
    std::string stops;
    for (std::size_t k = 0; k < scale.size(); ++k) {
        const double part = static_cast<double>(k) / static_cast<double>(scale.size() - 1);
        stops +=
            fmt::format("<stop offset=\"{}\" stop-color=\"{}\"/>", part, deviation_colour(part));
    }
    return fmt::format(
        "  <defs><linearGradient id=\"deviation\">{0}</linearGradient></defs>\n"
        "  <rect x=\"{1}\" y=\"{2}\" width=\"{3}\" height=\"8\" rx=\"3\" "
        "fill=\"url(#deviation)\"/>\n"
        "  <g font-family=\"sans-serif\" font-size=\"12\" fill=\"#17324d\">"
        "<text x=\"{1}\" y=\"{4}\">deviation</text><text x=\"{1}\" y=\"{5}\">0</text>"
        "<text x=\"{6}\" y=\"{5}\" text-anchor=\"end\">{7:.4g}</text></g>\n",
        stops, x, y + 14, width, y + 9, y + 36, x + width, largest);
}

std::string coloured_dots(const std::vector<std::string>& places,
                          const std::vector<double>* deviations, double largest, double radius) {
    constexpr std::size_t classes = 12;
    std::array<std::string, classes> paths;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double part = deviations != nullptr && largest > 0 ? (*deviations)[i] / largest : 0;
        const auto k = std::min(classes - 1, static_cast<std::size_t>(part * classes));
        paths[k] += "M " + places[i] + " h 0 ";
    }
    std::string svg;
    for (std::size_t k = 0; k < classes; ++k)
        if (!paths[k].empty())
            svg += fmt::format(
                "  <path class=\"samples\" d=\"{}\" stroke-width=\"{}\"{}/>\n", paths[k],
                2 * radius,
                deviations == nullptr
                    ? ""
                    : fmt::format(" style=\"stroke: {}\"",
                                  deviation_colour((static_cast<double>(k) + 0.5) / classes)));
    return svg;
}

} // namespace batten
