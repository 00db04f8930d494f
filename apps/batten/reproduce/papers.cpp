#include "papers.hpp"

#include <batten/io/points_file.hpp>
#include <batten/io/svg.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace batten::command {

bool Workshop::has(std::string_view file) const {
    return !data.empty() && !file.empty() && std::filesystem::exists(data / file);
}

std::optional<Samples> Workshop::real(std::string_view file) const {
    if (!has(file)) return std::nullopt;
    return read_points(data / file);
}

std::optional<PointSet> Workshop::real_table(std::string_view file) const {
    if (!has(file)) return std::nullopt;
    return read_table(data / file);
}

std::span<const Paper> papers() {
    static const std::vector<Paper> all = {
        {"pia", "Lin, Wang, Dong 2004",
         "Figures 4 and 5 have data that are not printed. No curve or surface is given by a "
         "formula: the helix is one that has the printed error at the start; MATLAB's peaks, "
         "however sampled, are never 33.6 off, as the surface of figure 6 is at the start.",
         lin_wang_dong},
        {"epia", "Lin, Zhang 2011",
         "The glyph and the scanned patch are not public: a letter G and peaks stand in, with "
         "--data "
         "glyph273.csv and a window of terrain344x403.npy.",
         lin_zhang},
        {"mlspia", "Huang, Wang 2020",
         "Example 3 is given by its formula; data of the same sizes stand in for the others. The "
         "paper prints 1e-7 as its stop, its counts are those of 1e-8; LSPIA's 156 is counted in "
         "the 2-norm of eq. 39, the deviation beside it in the Frobenius norm, which takes 157.",
         huang_wang},
        {"clspia", "Chang, Ma, Deng 2023",
         "Built-in data of the same sizes stand in where the authors' are not in --data.",
         chang_ma_deng},
        {"salspia", "Peng, Li 2026",
         "The stop rule tests the square of the relative gradient, 1e-6. alspia takes the authors' "
         "cycle of 10000 roots, in which these steps are all but the largest eigenvalue's.",
         peng_li},
        {"race", "ten problems, twelve iterations on the normal equations",
         "Iterations to a gradient of 1e-6 of the first, at most 2000; the pictures go on to "
         "1e-10.",
         race},
    };
    return all;
}

FitResult drawn_fit(const Samples& samples, FitOptions options, Workshop& workshop,
                    const std::string& stem, const std::vector<Index>& steps) {
    std::vector<Drawing>& drawings = workshop.drawings;
    std::map<Index, PointSet> kept;
    options.keep_history = true;
    options.observer = [&](const Iteration& now) {
        if (std::ranges::count(steps, now.number) > 0) kept[now.number] = now.control;
        return Continue::yes;
    };
    FitResult result = fit(samples, options);
    std::string csv = "iteration,gradient_norm,largest_move,max_deviation,constraint_error\n";
    for (const HistoryEntry& h : result.report.history)
        csv += fmt::format("{},{},{},{},{}\n", h.iteration, h.gradient_norm, h.largest_move,
                           h.max_deviation, h.constraint_error);
    drawings.push_back({stem + "_history.csv", csv});
    drawings.push_back({stem + "_limit.svg", svg_picture({result.spline, &samples, "limit"})});
    const Index controls = result.spline.free_control_points().size();
    for (const auto& [step, control] : kept) {
        if (control.size() != controls) continue; // before a knot was inserted
        const Spline spline = Spline::from_free(result.spline.axes(), control);
        drawings.push_back({fmt::format("{}_step{}.svg", stem, step),
                            svg_picture({spline, &samples, fmt::format("step {}", step)})});
    }
    if (samples.dim() != 2) return result;
    drawings.push_back(
        {stem + "_comb.svg", svg_picture({result.spline, nullptr, "curvature comb", true})});
    return result;
}

} // namespace batten::command
