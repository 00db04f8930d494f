#include <batten/io/spline_file.hpp>

#include <batten/core/names.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace batten {

namespace {

using Json = nlohmann::json;

/// A list over the axes, written by `entry` for each.
template <class Entry>
std::string over_axes(const Spline& spline, Entry entry) {
    std::string text = "[";
    for (const KnotVector& axis : spline.axes())
        text += (text.size() > 1 ? ", " : "") + entry(axis);
    return text + "]";
}

/// A list of whole numbers; the library's own conversion would cut off fractions and wrap what is
/// too large.
template <class Number>
std::vector<Number> whole_numbers(const Json& json, const char* key) {
    std::vector<Number> result;
    for (const Json& entry : json.at(key)) {
        const bool whole = entry.is_number_integer() &&
                           (!entry.is_number_unsigned() ||
                            entry.get<std::uint64_t>() <= std::numeric_limits<Index>::max());
        if (!whole || !std::in_range<Number>(entry.get<Index>()))
            throw InvalidInput(
                fmt::format("{}: {} is not a whole number in range", key, entry.dump()));
        result.push_back(entry.get<Number>());
    }
    return result;
}

void check_head(const Json& json) {
    if (!json.is_object() || !json.contains("format") || json["format"] != "batten-spline")
        throw InvalidInput("\"format\" is not \"batten-spline\"");
    if (json.at("version") != 1)
        throw InvalidInput(fmt::format("version {} is not 1", json.at("version").dump()));
    constexpr std::string_view known[] = {"format", "version",       "degree",        "closed",
                                          "knots",  "control_shape", "control_points"};
    for (const auto& [key, value] : json.items())
        if (std::ranges::count(known, std::string_view(key)) == 0)
            throw InvalidInput(unknown_name("key", key, known));
}

/// Numbers that are finite, but whose differences or quotients are not, make no spline.
void check_extents(const std::vector<KnotVector>& axes, const PointSet& control) {
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const std::vector<double> breaks = axes[k].breakpoints();
        for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
            if (const double span = breaks[b + 1] - breaks[b];
                !std::isnormal(span) || !std::isfinite(1 / span))
                throw InvalidInput(fmt::format("axis {}: between knots {} and {} nothing can be "
                                               "computed",
                                               k, breaks[b], breaks[b + 1]));
    }
    for (double x : control.values())
        if (!std::isfinite(2 * x))
            throw InvalidInput(
                fmt::format("control_points: {} is so large that nothing can be computed", x));
}

Spline build(const Json& json) {
    check_head(json);
    const auto degree = whole_numbers<int>(json, "degree");
    const auto knots = json.at("knots").get<std::vector<std::vector<double>>>();
    const auto shape = whole_numbers<Index>(json, "control_shape");
    const auto closed = json.value("closed", std::vector<bool>(degree.size(), false));
    if (knots.size() != degree.size() || shape.size() != degree.size() ||
        closed.size() != degree.size())
        throw InvalidInput("degree, knots, control_shape and closed need one entry per axis each");
    std::vector<KnotVector> axes;
    for (std::size_t k = 0; k < degree.size(); ++k) {
        axes.emplace_back(degree[k], knots[k], closed[k] ? Closure::closed : Closure::open);
        if (axes.back().control_count() != shape[k])
            throw InvalidInput(fmt::format(
                "axis {}: {} knots of degree {} make {} control points, control_shape says {}", k,
                knots[k].size(), degree[k], axes.back().control_count(), shape[k]));
    }
    const Json& rows = json.at("control_points");
    if (!rows.is_array() || rows.empty() || !rows[0].is_array() || rows[0].empty())
        throw InvalidInput("control_points is not a list of points");
    PointSet control(static_cast<Index>(rows.size()), static_cast<Index>(rows[0].size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto point = rows[i].get<std::vector<double>>();
        if (static_cast<Index>(point.size()) != control.dim())
            throw InvalidInput(fmt::format("control point {} has {} coordinates, the first has {}",
                                           i, point.size(), control.dim()));
        std::copy(point.begin(), point.end(), control[static_cast<Index>(i)].begin());
    }
    check_extents(axes, control);
    return {std::move(axes), std::move(control)};
}

} // namespace

std::string spline_json(const Spline& spline) {
    fmt::memory_buffer out;
    const auto append = std::back_inserter(out);
    bool any_closed = false;
    for (const KnotVector& axis : spline.axes()) any_closed = any_closed || axis.closed();
    fmt::format_to(append, "{{\n  \"format\": \"batten-spline\",\n  \"version\": 1,\n");
    fmt::format_to(append, "  \"degree\": {},\n", over_axes(spline, [](const KnotVector& k) {
                       return fmt::format("{}", k.degree());
                   }));
    if (any_closed)
        fmt::format_to(append, "  \"closed\": {},\n", over_axes(spline, [](const KnotVector& k) {
                           return fmt::format("{}", k.closed());
                       }));
    fmt::format_to(append, "  \"knots\": {},\n", over_axes(spline, [](const KnotVector& k) {
                       return fmt::format("[{}]", fmt::join(k.knots(), ", "));
                   }));
    fmt::format_to(append, "  \"control_shape\": [{}],\n  \"control_points\": [\n",
                   fmt::join(spline.control_shape(), ", "));
    const PointSet& control = spline.control_points();
    for (Index i = 0; i < control.size(); ++i)
        fmt::format_to(append, "    [{}]{}\n", fmt::join(control[i], ", "),
                       i + 1 < control.size() ? "," : "");
    fmt::format_to(append, "  ]\n}}\n");
    return fmt::to_string(out);
}

Spline parse_spline_json(const std::filesystem::path& path, const std::string& content) {
    try {
        return build(Json::parse(content));
    } catch (const Json::exception& error) {
        std::string what = error.what(); // "[json.exception...] words"
        const std::size_t end = what.find("] ");
        throw FileError(fmt::format("{}: {}", path.string(),
                                    end == std::string::npos ? what : what.substr(end + 2)));
    } catch (const InvalidInput& error) {
        throw FileError(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace batten
