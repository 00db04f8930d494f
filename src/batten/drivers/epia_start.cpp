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

/// The maxima that stand out by more than `rise`, at most so many: then those that do so most.
std::vector<Index> most_dominant(const std::vector<double>& curvature, double rise, Index most) {
    std::vector<Index> own = dominant_indices(curvature, rise);
    if (static_cast<Index>(own.size()) <= most) return own;
    double low = rise;
    double high = std::ranges::max(curvature);
    own = dominant_indices(curvature, high);
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = (low + high) / 2;
        std::vector<Index> now = dominant_indices(curvature, middle);
        const bool few = static_cast<Index>(now.size()) <= most;
        if (few) own = std::move(now);
        (few ? high : low) = middle;
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

/// What is said of the numbers of control points.
struct Numbers {
    std::vector<Index> stated;
    bool exact;  ///< they are given to start from, or there is no precision to grow for
    bool screen; ///< what noise makes is not dominant
};

Numbers numbers_of(const Problem& problem, bool screen) {
    const bool given = problem.options.method.initial == Initial::given;
    const bool grows = problem.options.stop.deviation > 0 || !problem.tolerance.empty();
    const std::vector<Index> stated = stated_shape(problem);
    return {stated, given || (screen && !stated.empty() && !grows), screen};
}

/// An axis with its dominant samples as control points' own [eq. 31, 34 and 35].
EpiaAxis dominant_axis(const Problem& problem, std::size_t k, EpiaAxis::Line line,
                       const Numbers& numbers) {
    if (numbers.screen) line.noise = span_of_noise(line.curvature);
    const bool bounded = !numbers.stated.empty() && (numbers.screen || numbers.exact);
    const Index stated = bounded ? numbers.stated[k] : static_cast<Index>(line.curvature.size());
    const std::vector<Index> alone = alone_along(problem, k);
    const double rise = numbers.exact ? 0 : line.noise;
    const auto with = [&](Index most) {
        return EpiaAxis(problem.axes.degree[k], line,
                        numbers.screen || numbers.exact ? most_dominant(line.curvature, rise, most)
                                                        : dominant_indices(line.curvature),
                        alone, numbers.exact ? stated : 0);
    };
    Index most = stated;
    EpiaAxis axis = with(most);
    while (axis.control_count() > stated && most > 2) { // room for those to be interpolated
        most = std::max<Index>(2, most - (axis.control_count() - stated));
        axis = with(most);
    }
    if (problem.options.method.initial == Initial::given && axis.control_count() != stated)
        throw InvalidInput(fmt::format("epia: axis {}: {} control points given to start from, the "
                                       "samples to interpolate need {}",
                                       k, stated, axis.control_count()));
    return axis;
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

/// Axes whose validation check goes on until it holds, or as far as it may.
class Validation {
  public:
    Validation(const Problem& problem, const EpiaSettings& settings)
        : problem_(problem),
          settings_(settings),
          noise_(white_noise(problem.samples.points, problem.samples.shape())) {}

    EpiaStart of(std::vector<EpiaAxis> axes) const {
        const double chance =
            settings_.screen ? std::max(3 * noise_, rounding_of(problem_.samples.points)) : 0;
        EpiaStart start{std::move(axes)};
        while (settings_.rounds > 0) {
            const Invalid invalid = invalid_of(start.axes, problem_, settings_.eta, chance);
            if (invalid.groups == 0) break;
            std::vector<EpiaAxis> split = start.axes;
            for (std::size_t k = 0; k < split.size(); ++k) split[k].insert(invalid.fences[k]);
            const std::string why = forbidden(split, start);
            if (!why.empty()) {
                start.notes.push_back(
                    fmt::format("{} groups fail the validation check (47){}", invalid.groups, why));
                break;
            }
            start.axes = std::move(split);
            ++start.rounds;
        }
        return start;
    }

    /// Whether a grid has as many control points as may be without insertions, for detail.
    bool is_detailed(const EpiaStart& start) const {
        return settings_.screen && !(noise_ > 0) && start.axes.size() > 1 && !start.notes.empty() &&
               problem_.axes.control_points.empty();
    }

  private:
    /// Why no more groups may be split, in words; nothing where they may.
    std::string forbidden(const std::vector<EpiaAxis>& split, const EpiaStart& start) const {
        if (start.rounds == settings_.rounds)
            return fmt::format(" after {} rounds, the most allowed", start.rounds);
        if (!settings_.screen) return {};
        const std::vector<Index>& most = problem_.axes.control_points;
        Index controls = 1;
        for (std::size_t k = 0; k < split.size(); ++k) {
            const Index count = split[k].control_count();
            controls *= count;
            if (!most.empty() && count > std::max(most[k], start.axes[k].control_count()))
                return "; to split them would take more control points than are stated";
        }
        constexpr Index sparse = 8; // the paper's patch: 31 x 66 of 121 x 161, a tenth
        if (split.size() == 1 || sparse * controls <= problem_.samples.size()) return {};
        return fmt::format("; to split them would take more control points than an eighth of the "
                           "samples, which {}",
                           noise_ > 0 ? fmt::format("are noisy by {:.3g}", noise_)
                                      : "show detail, not noise");
    }

    const Problem& problem_;
    const EpiaSettings& settings_;
    double noise_;
};

} // namespace

EpiaStart epia_start(const Problem& problem, const EpiaSettings& settings) {
    const std::vector<std::vector<double>> curvatures = axis_curvatures(problem.samples, settings);
    const auto dominant = [&](bool screen) {
        const Numbers numbers = numbers_of(problem, screen);
        std::vector<EpiaAxis> axes;
        for (std::size_t k = 0; k < problem.axes.count(); ++k)
            axes.push_back(
                dominant_axis(problem, k, {problem.parameters.axes[k], curvatures[k]}, numbers));
        return axes;
    };
    if (problem.options.method.initial == Initial::given) return {dominant(settings.screen)};
    const Validation check(problem, settings);
    EpiaStart start = check.of(dominant(settings.screen));
    return check.is_detailed(start) ? check.of(dominant(false)) : start; // no maximum is noise
}

} // namespace batten
