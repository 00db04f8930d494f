#include <batten/drivers/table.hpp>

#include <batten/core/names.hpp>
#include <batten/drivers/epia_driver.hpp>
#include <batten/drivers/least_squares.hpp>
#include <batten/drivers/pia_driver.hpp>
#include <batten/search/search.hpp>

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

using enum Request;

constexpr Requests space{size, knots, placement, parameters, closed}; ///< the spline space, stated
constexpr Requests rules{placement, parameters}; ///< for what a cloud has in any case
constexpr Requests least_squares_terms{weights, smoothing, outliers};
constexpr Requests course{start, history, stop}; ///< of an iteration
constexpr Requests curves{seam, shape};          ///< what only a curve has
constexpr Requests held{samples, tangents};
constexpr Requests searched{tolerance, limit, parameters, weights, closed, outliers, history};

/// The columns of an iteration on the normal equations.
Driver iteration(std::string_view name, Requests more = {}) {
    const Requests all = space | least_squares_terms | course | more;
    return {method_entry(name), all | curves, all, all - rules, fit_least_squares};
}

/// What has its own roughness takes no other.
Driver without(Driver driver, Requests requests) {
    for (std::optional<Requests>* column : {&driver.sequence, &driver.grid, &driver.cloud})
        if (*column) *column = **column - requests;
    return driver;
}

/// Its limit is what it is for open curves and the samples alone.
Driver monotone(Driver driver) {
    driver.grid = driver.cloud = std::nullopt;
    return without(std::move(driver), Requests{smoothing, closed, seam, shape});
}

std::vector<Driver> table() {
    const Requests boundary{boundaries};
    // a solution depends on no start, is beyond every stop, and its course is one step
    const Requests solved = space | least_squares_terms | held | course;
    const Requests passed = space | course | Requests{weights, seam};
    const Requests interpolating = space | course | Requests{local};
    const Requests remembering{memory};
    const Requests grown{size, samples, tolerance, weights, start, local, history, stop, outliers};
    return {
        {method_entry("direct"), solved | curves, solved | boundary, solved - rules,
         fit_least_squares, passed},
        iteration("lspia"),
        iteration("mlspia", remembering),
        {method_entry("clspia"), solved | curves, solved | boundary, solved - rules,
         fit_least_squares},
        {method_entry("pia"), interpolating | Requests{shape}, interpolating, std::nullopt,
         fit_pia},
        {method_entry("epia"), grown | Requests{shape, parameters}, grown | Requests{parameters},
         grown | Requests{knots}, fit_epia},
        iteration("cg"),
        iteration("chebyshev"),
        iteration("nesterov", remembering),
        iteration("barzilai-borwein"),
        iteration("salspia"),
        iteration("alspia"),
        iteration("nmlspia", remembering),
        iteration("lin2018"),
        iteration("plspia"),
        iteration("anderson"),
        iteration("pmlspia"),
        iteration("rpia"),
        without(iteration("fairing-pia"), Requests{smoothing}),
        monotone(iteration("monotone-lspia")),
        {method_entry("search"), searched | held | curves | Requests{corners},
         searched | held | boundary, (searched | held) - rules, fit_by_search},
    };
}

/// The first few of them.
std::string some(const std::vector<std::string_view>& names) {
    constexpr std::size_t few = 3;
    const auto end = names.begin() + static_cast<Index>(std::min(few, names.size()));
    return fmt::format("{}{}", fmt::join(names.begin(), end, ", "),
                       names.size() > few ? ", ..." : "");
}

/// Names of the drivers that take all that is asked.
std::vector<std::string_view> able(SampleKind kind, Requests asked) {
    std::vector<std::string_view> names;
    for (const Driver& other : drivers())
        if (other.takes(kind) && other.takes(kind)->covers(asked)) names.push_back(other.name);
    return names;
}

std::string subject(const Driver& driver) {
    return driver.name == "search" ? std::string("a fit to a tolerance")
                                   : fmt::format("method {}", driver.name);
}

} // namespace

std::span<const Driver> drivers() {
    static const std::vector<Driver> all = table();
    return all;
}

const Driver& driver(std::string_view name) {
    std::vector<std::string_view> names{"auto"};
    for (const Driver& entry : drivers()) {
        if (entry.name == name) return entry;
        names.push_back(entry.name);
    }
    throw InvalidInput(unknown_name("method", name, names));
}

void check_column(const Driver& driver, SampleKind kind, Requests asked) {
    const auto& column = driver.takes(kind);
    if (!column) {
        const std::vector<std::string_view> names = able(kind, asked);
        throw InvalidInput(fmt::format("{} cannot fit a {}; {} can", subject(driver),
                                       to_string(kind), names.empty() ? "auto" : some(names)));
    }
    const Requests lacking = asked - *column;
    if (lacking.empty()) return;
    const Request first = lacking.list().front();
    std::vector<std::string_view> names = able(kind, asked);
    const bool together = !names.empty();
    if (!together) names = able(kind, Requests{first});
    throw InvalidInput(
        fmt::format("{} cannot {}{}; {}", subject(driver), to_string(first),
                    kind == SampleKind::sequence ? "" : fmt::format(" of a {}", to_string(kind)),
                    names.empty() ? "nothing can"
                                  : fmt::format("{} can{}", some(names),
                                                together ? "" : ", without what else is asked")));
}

std::string driver_table() {
    constexpr std::array kinds{SampleKind::sequence, SampleKind::grid, SampleKind::cloud};
    std::string text = fmt::format("| {:<50} |", "");
    std::string rule = fmt::format("|{:-<52}|", "");
    const auto width = [&](const Driver& driver) {
        return std::max(driver.name.size(), kinds.size());
    };
    for (const Driver& driver : drivers()) {
        text += fmt::format(" {:<{}} |", driver.name, width(driver));
        rule += fmt::format("{:-<{}}|", "", width(driver) + 2);
    }
    text += "\n" + rule + "\n";
    const auto row = [&](std::string_view words, auto letter) {
        text += fmt::format("| {:<50} |", words);
        for (const Driver& driver : drivers()) {
            std::string letters;
            for (SampleKind kind : kinds)
                if (driver.takes(kind) && letter(*driver.takes(kind)))
                    letters += to_string(kind)[0];
            text += fmt::format(" {:<{}} |", letters.empty() ? "-" : letters, width(driver));
        }
        text += "\n";
    };
    row("fit", [](Requests) { return true; });
    for (std::size_t k = 0; k < request_count; ++k)
        row(to_string(static_cast<Request>(k)),
            [&](Requests column) { return column.has(static_cast<Request>(k)); });
    return text;
}

} // namespace batten
