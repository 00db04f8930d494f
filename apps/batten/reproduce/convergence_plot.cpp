#include "convergence_plot.hpp"

#include <batten/io/svg_parts.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten::command {

namespace {

constexpr double left = 70, top = 44, width = 560, height = 340, right = 170, bottom = 48;
constexpr std::size_t many_iterations = 300;
constexpr double least_value = 1e-40;

// told apart by those who see few colours, too; dashes take over where they are used up
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                             "#56b4e9", "#a6761d", "#000000", "#7570b3"};
constexpr std::array dashes{"", "6 3", "2 3"};

struct Axis {
    double low, high; ///< what is drawn, a logarithm where `logarithmic`
    bool logarithmic;

    double part(double value) const {
        return ((logarithmic ? std::log10(value) : value) - low) / (high - low);
    }
};

bool drawable(double value) {
    return std::isfinite(value) && value > least_value;
}

Axis upwards(const std::vector<Series>& series) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Series& s : series)
        for (const double value : s.values)
            if (drawable(value)) {
                low = std::min(low, std::log10(value));
                high = std::max(high, std::log10(value));
            }
    if (!(low <= high)) return {-1, 0, true};
    return {std::floor(low), std::max(std::ceil(high), std::floor(low) + 1), true};
}

/// Iteration k stands at k + 1 where the axis is logarithmic.
Axis sideways(const std::vector<Series>& series) {
    std::size_t most = 2;
    for (const Series& s : series) most = std::max(most, s.values.size());
    const auto last = static_cast<double>(most - 1);
    return most > many_iterations ? Axis{0, std::log10(last + 1), true} : Axis{0, last, false};
}

double across(const Axis& x, double iteration) {
    return left + width * x.part(x.logarithmic ? iteration + 1 : iteration);
}

double up(const Axis& y, double value) {
    return top + height * (1 - y.part(value));
}

/// A step of 1, 2 or 5 times a power of ten that makes about six of `span`.
double round_step(double span) {
    const double rough = std::max(span / 6, 1.0);
    const double power = std::pow(10, std::floor(std::log10(rough)));
    for (const double part : {1.0, 2.0, 5.0})
        if (rough <= part * power) return part * power;
    return 10 * power;
}

std::string words(double x, double y, const char* anchor, std::string_view text,
                  const char* more = "") {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}"{}>{}</text>)"
                       "\n",
                       x, y, anchor, more, svg_escaped(text));
}

std::string grid_line(double x1, double y1, double x2, double y2) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="#e4e4e4"/>)"
                       "\n",
                       x1, y1, x2, y2);
}

std::string grid(const Axis& x, const Axis& y) {
    std::string svg;
    for (double k = y.low; k <= y.high; k += round_step(y.high - y.low)) {
        const double at = up(y, std::pow(10, k));
        svg += grid_line(left, at, left + width, at);
        svg += words(left - 8, at + 4, "end", fmt::format("1e{:.0f}", k));
    }
    const double step = x.logarithmic ? 1 : round_step(x.high);
    for (double k = x.low; k <= x.high; k += step) {
        const double iteration = x.logarithmic ? std::pow(10, k) - 1 : k;
        const double at = across(x, iteration);
        svg += grid_line(at, top, at, top + height);
        svg += words(at, top + height + 18, "middle",
                     fmt::format("{:.0f}", x.logarithmic ? std::pow(10, k) : k));
    }
    return svg;
}

std::string line(const Series& series, const Axis& x, const Axis& y, const std::string& style) {
    std::string path;
    bool pen_down = false;
    double last = -1;
    for (std::size_t k = 0; k < series.values.size(); ++k) {
        const double at = across(x, static_cast<double>(k));
        const bool shown = drawable(series.values[k]);
        // a long series has many iterations to a pixel
        if (shown && pen_down && at - last < 0.6 && k + 1 < series.values.size()) continue;
        if (shown) {
            path +=
                fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", at, up(y, series.values[k]));
            last = at;
        }
        pen_down = shown;
    }
    return fmt::format(R"(<path d="{}" fill="none" stroke-width="1.5" {}/>)"
                       "\n",
                       path, style);
}

} // namespace

std::string convergence_plot(const std::string& title, const std::string& what,
                             const std::vector<Series>& series) {
    const Axis x = sideways(series);
    const Axis y = upwards(series);
    std::string svg = fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0} {1}" font-family="sans-serif" font-size="12" fill="#333">)"
        "\n"
        R"(<rect width="{0}" height="{1}" fill="#fff"/>)"
        "\n",
        left + width + right, top + height + bottom);
    svg += words(left, 18, "start", title, R"( font-size="15" font-weight="bold")");
    svg += words(left, 35, "start", what, R"( fill="#666")");
    svg += grid(x, y);
    svg += words(left + width / 2, top + height + 38, "middle",
                 x.logarithmic ? "iteration + 1" : "iteration", R"( fill="#666")");
    for (std::size_t k = 0; k < series.size(); ++k) {
        const std::string style =
            fmt::format(R"(stroke="{}" stroke-dasharray="{}")", colours[k % colours.size()],
                        dashes[k / colours.size() % dashes.size()]);
        const double at = top + 8 + 19 * static_cast<double>(k);
        svg += line(series[k], x, y, style);
        svg += fmt::format(R"(<path d="M{0:.1f} {1:.1f}h24" stroke-width="2.2" {2}/>)"
                           "\n",
                           left + width + 14, at, style);
        svg += words(left + width + 44, at + 4, "start", series[k].name);
    }
    return svg + "</svg>\n";
}

} // namespace batten::command
