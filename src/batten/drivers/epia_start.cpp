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

/// Curvature along an axis: of the sequence, or total curvatures averaged over the other axis of a
/// grid [eq. 32 and 33].
std::vector<double> axis_curvature(const Samples& samples, std::size_t axis, Index smoothing,
                                   double error) {
    if (samples.grid.empty()) return discrete_curvature(samples.points, smoothing, error);
    const GridIndex grid(samples.grid);
    std::vector<double> total(static_cast<std::size_t>(grid.size()));
    for (std::size_t along : {std::size_t{1}, std::size_t{0}})
        grid.for_each_strand(along, [&](const GridIndex::Strand& strand) {
            PointSet line(strand.count, samples.dim());
            for (Index j = 0; j < strand.count; ++j)
                std::ranges::copy(samples.points[strand[j]], line[j].begin());
            const std::vector<double> k = discrete_curvature(line, smoothing, error);
            for (Index j = 0; j < strand.count; ++j) {
                const double bend = k[static_cast<std::size_t>(j)];
                total[static_cast<std::size_t>(strand[j])] += bend * bend;
            }
        });
    std::vector<double> mean(static_cast<std::size_t>(grid.length(axis)));
    const auto others = static_cast<double>(grid.length(1 - axis));
    grid.for_each([&](const GridIndex::Place& place, Index at) {
        mean[static_cast<std::size_t>(place[axis])] += total[static_cast<std::size_t>(at)] / others;
    });
    return mean;
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

std::vector<EpiaAxis> dominant_axes(const Problem& problem, const EpiaSettings& settings) {
    const std::vector<Index> stated = stated_shape(problem);
    const bool given = problem.options.method.initial == Initial::given;
    const double error = settings.screen ? rounding_of(problem.samples.points) : 0;
    std::vector<EpiaAxis> axes;
    for (std::size_t k = 0; k < problem.axes.count(); ++k) {
        EpiaAxis::Line line{problem.parameters.axes[k],
                            axis_curvature(problem.samples, k, settings.smoothing, error)};
        if (settings.screen) line.noise = span_of_noise(line.curvature);
        const Index most = stated.empty() ? std::numeric_limits<Index>::max() : stated[k];
        std::vector<Index> own = dominant(line, most, settings.screen || given);
        axes.emplace_back(problem.axes.degree[k], std::move(line), std::move(own),
                          alone_along(problem, k), given ? stated[k] : 0);
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

/// Whether more than half of an axis's samples are control points' own.
bool near_interpolation(const std::vector<EpiaAxis>& axes) {
    return std::ranges::any_of(
        axes, [](const EpiaAxis& axis) { return 2 * axis.control_count() > axis.sample_count(); });
}

/// One round of the validation check, in which the fences of `invalid` groups become own samples;
/// false where a stated number of control points forbids it.
bool split(EpiaStart& start, const Invalid& invalid, const Problem& problem, bool screen) {
    const std::vector<EpiaAxis> before = start.axes;
    for (std::size_t k = 0; k < start.axes.size(); ++k) start.axes[k].insert(invalid.fences[k]);
    const std::vector<Index>& most = problem.axes.control_points;
    for (std::size_t k = 0; k < most.size() && screen; ++k)
        if (start.axes[k].control_count() > std::max(most[k], before[k].control_count())) {
            start.axes = before;
            start.notes.push_back(fmt::format("{} groups fail the validation check (47), which the "
                                              "stated number of control points forbids to split",
                                              invalid.groups));
            return false;
        }
    ++start.rounds;
    return true;
}

} // namespace

EpiaStart epia_start(const Problem& problem, const EpiaSettings& settings) {
    EpiaStart start{dominant_axes(problem, settings)};
    if (problem.options.method.initial == Initial::given) return start; // of their number
    const std::vector<EpiaAxis> before = start.axes;
    const double noise = white_noise(problem.samples.points, problem.samples.shape());
    const double chance =
        settings.screen ? std::max(3 * noise, rounding_of(problem.samples.points)) : 0;
    while (settings.rounds > 0) {
        const Invalid invalid = invalid_of(start.axes, problem, settings.eta, chance);
        if (invalid.groups == 0) break;
        if (start.rounds == settings.rounds) {
            start.notes.push_back(fmt::format("{} groups fail the validation check (47) after {} "
                                              "rounds, the most allowed",
                                              invalid.groups, start.rounds));
            break;
        }
        if (!split(start, invalid, problem, settings.screen)) break;
        if (settings.screen && start.axes.size() > 1 && near_interpolation(start.axes)) {
            start.axes = before;
            start.rounds = 0;
            start.notes.push_back(fmt::format(
                "the validation check (47) would make most samples of an axis control points, for "
                "{}: it is left out",
                noise > 0 ? fmt::format("they are noisy, by {:.3g}", noise)
                          : "there is detail, not noise, between any two"));
            break;
        }
    }
    return start;
}

} // namespace batten
