#include <batten/drivers/epia_start.hpp>

#include <batten/core/grid_index.hpp>
#include <batten/iterate/pia.hpp>
#include <batten/samples/curvature.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

/// How far rounding may have moved a coordinate.
double rounding_of(const Points& points) {
    double largest = 0;
    for (Index j = 0; j < points.size(); ++j)
        for (double x : points[j]) largest = std::max(largest, std::abs(x));
    return 4 * std::numeric_limits<double>::epsilon() * largest;
}

/// Curvatures along the axes: of the sequence, or total curvatures averaged over the other axis of
/// a grid [eq. 30, 32 and 33].
std::vector<std::vector<double>> axis_curvatures(const Samples& samples,
                                                 const EpiaSettings& settings) {
    const double error = settings.screen ? rounding_of(samples.points) : 0;
    if (samples.grid.empty())
        return {discrete_curvature(samples.points, settings.smoothing, error)};
    const GridIndex grid(samples.grid);
    std::vector<double> total(static_cast<std::size_t>(grid.size()));
    for (std::size_t along : {std::size_t{1}, std::size_t{0}})
        grid.for_each_strand(along, [&](const GridIndex::Strand& strand) {
            PointSet line(strand.count, samples.dim());
            for (Index j = 0; j < strand.count; ++j)
                std::ranges::copy(samples.points[strand[j]], line[j].begin());
            const std::vector<double> k = discrete_curvature(line, settings.smoothing, error);
            for (Index j = 0; j < strand.count; ++j) {
                const double bend = k[static_cast<std::size_t>(j)];
                total[static_cast<std::size_t>(strand[j])] += bend * bend;
            }
        });
    std::vector<std::vector<double>> means;
    for (std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
        means.emplace_back(static_cast<std::size_t>(grid.length(axis)));
        const auto others = static_cast<double>(grid.length(1 - axis));
        grid.for_each([&](const GridIndex::Place& place, Index at) {
            means[axis][static_cast<std::size_t>(place[axis])] +=
                total[static_cast<std::size_t>(at)] / others;
        });
    }
    return means;
}

/// The dominant samples of an axis [eq. 31, 34 and 35], at most so many: those that stand out most.
std::vector<Index> dominant(const EpiaAxis::Line& line, Index most, bool screen) {
    if (!screen) return dominant_indices(line.curvature);
    std::vector<Index> own = dominant_indices(line.curvature, line.noise);
    if (static_cast<Index>(own.size()) <= most) return own;
    double low = line.noise;
    double high = std::ranges::max(line.curvature);
    own = dominant_indices(line.curvature, high);
    for (int halving = 0; halving < 60; ++halving) {
        const double rise = (low + high) / 2;
        std::vector<Index> now = dominant_indices(line.curvature, rise);
        const bool few = static_cast<Index>(now.size()) <= most;
        if (few) own = std::move(now);
        (few ? high : low) = rise;
    }
    return own;
}

/// Samples to be interpolated along an axis.
std::vector<Index> alone_along(const Problem& problem, std::size_t axis) {
    const GridIndex grid(problem.samples.shape());
    std::vector<Index> result;
    for (Index sample : problem.options.hold.interpolate)
        result.push_back(grid.place(sample)[axis]);
    return result;
}

/// Control points per axis that are stated, or given to start from; none where neither is.
std::vector<Index> stated_shape(const Problem& problem) {
    if (!problem.axes.control_points.empty()) return problem.axes.control_points;
    if (problem.options.method.initial != Initial::given) return {};
    if (problem.axes.count() > 1)
        throw InvalidInput("epia: control points to start from need their numbers along the axes");
    return {problem.options.method.control.size()};
}

std::vector<EpiaAxis> dominant_axes(const Problem& problem,
                                    const std::vector<std::vector<double>>& curvatures,
                                    bool screen) {
    const std::vector<Index> stated = stated_shape(problem);
    const bool given = problem.options.method.initial == Initial::given;
    std::vector<EpiaAxis> axes;
    for (std::size_t k = 0; k < problem.axes.count(); ++k) {
        EpiaAxis::Line line{problem.parameters.axes[k], curvatures[k]};
        if (screen) line.noise = span_of_noise(line.curvature);
        Index most = stated.empty() ? problem.samples.size() : stated[k];
        const std::vector<Index> alone = alone_along(problem, k);
        const auto with = [&](Index so_many) {
            return EpiaAxis(problem.axes.degree[k], line, dominant(line, so_many, screen || given),
                            alone, given ? stated[k] : 0);
        };
        EpiaAxis axis = with(most);
        while ((screen || given) && !stated.empty() && axis.control_count() > stated[k] &&
               most > 2) { // room for those to be interpolated
            most = std::max<Index>(2, most - (axis.control_count() - stated[k]));
            axis = with(most);
        }
        axes.push_back(std::move(axis));
        if (given && axes[k].control_count() != stated[k])
            throw InvalidInput(fmt::format("epia: axis {}: {} control points given to start from, "
                                           "the samples to interpolate need {}",
                                           k, stated[k], axes[k].control_count()));
    }
    return axes;
}

/// The samples at the fences of the groups whose residuals do not point one way [eq. 47], per axis;
/// `noise`: residuals that are no longer than this point anywhere.
struct Invalid {
    Index groups = 0;
    std::vector<std::vector<Index>> fences;
};

Invalid invalid_of(const std::vector<EpiaAxis>& axes, const Problem& problem, double eta,
                   double noise) {
    const std::vector<std::vector<SampleRange>> ranges = groups_of(axes);
    const DataSide data(knots_of(axes), problem.samples, problem.parameters,
                        {ranges, problem.samples.shape(), problem.samples.weights});
    Pia step(data);
    step.propose(own_samples(axes, problem.samples));
    const std::vector<bool> valid = step.valid(eta, noise);
    Invalid result{0, std::vector<std::vector<Index>>(axes.size())};
    GridIndex(shape_of(axes)).for_each([&](const GridIndex::Place& place, Index group) {
        if (valid[static_cast<std::size_t>(group)]) return;
        ++result.groups;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            const SampleRange range = ranges[k][static_cast<std::size_t>(place[k])];
            if (range.begin > 0) result.fences[k].push_back(range.begin);
            if (range.end < axes[k].sample_count()) result.fences[k].push_back(range.end);
        }
    });
    return result;
}

/// Why the validation check may not make these control points of those before; nothing where it
/// may.
std::string forbidden(const std::vector<EpiaAxis>& now, const std::vector<EpiaAxis>& before,
                      const Problem& problem, double noise) {
    const std::vector<Index>& most = problem.axes.control_points;
    Index controls = 1;
    for (std::size_t k = 0; k < now.size(); ++k) {
        const Index count = now[k].control_count();
        controls *= count;
        if (!most.empty() && count > std::max(most[k], before[k].control_count()))
            return "than are stated";
    }
    constexpr Index sparse = 8; // the paper's patch: 31 x 66 of 121 x 161, a tenth
    if (now.size() == 1 || sparse * controls <= problem.samples.size()) return {};
    return fmt::format("than an eighth of the samples, which {}",
                       noise > 0 ? fmt::format("are noisy by {:.3g}", noise)
                                 : "have detail, not noise, between any two");
}

} // namespace

EpiaStart epia_start(const Problem& problem, const EpiaSettings& settings) {
    const std::vector<std::vector<double>> curvatures = axis_curvatures(problem.samples, settings);
    EpiaStart start{dominant_axes(problem, curvatures, settings.screen)};
    if (problem.options.method.initial == Initial::given) return start; // of their number
    const double noise = white_noise(problem.samples.points, problem.samples.shape());
    const double chance =
        settings.screen ? std::max(3 * noise, rounding_of(problem.samples.points)) : 0;
    while (settings.rounds > 0) {
        const Invalid invalid = invalid_of(start.axes, problem, settings.eta, chance);
        if (invalid.groups == 0) break;
        const auto end = [&](const std::string& why) {
            start.notes.push_back(
                fmt::format("{} groups fail the validation check (47){}", invalid.groups, why));
        };
        if (start.rounds == settings.rounds) {
            end(fmt::format(" after {} rounds, the most allowed", start.rounds));
            break;
        }
        std::vector<EpiaAxis> split = start.axes;
        for (std::size_t k = 0; k < split.size(); ++k) split[k].insert(invalid.fences[k]);
        const std::string why =
            settings.screen ? forbidden(split, start.axes, problem, noise) : std::string();
        if (!why.empty()) {
            end(", to split them would take more control points " + why);
            break;
        }
        start.axes = std::move(split);
        ++start.rounds;
    }
    return start;
}

} // namespace batten
