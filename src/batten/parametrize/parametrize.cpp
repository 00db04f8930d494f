#include <batten/parametrize/parametrize.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

using Strand = GridIndex::Strand;

double step_length(const Points& points, Index from, Index to, Parametrization rule) {
    const double length = distance(points[from], points[to]);
    return rule == Parametrization::centripetal ? std::sqrt(length) : length;
}

constexpr Index block_size = 1 << 15;

/// Accumulated step lengths of a strand into `t`; returns the whole length. In blocks, whose sums
/// are added in order.
double accumulate(const Points& points, const Strand& strand, Parametrization rule,
                  std::vector<double>& t) {
    std::vector<double> offset(static_cast<std::size_t>(block_count(strand.count, block_size)));
    for_each_block(strand.count, block_size, [&](const Block& block) {
        double sum = 0;
        for (Index i = block.begin; i < block.end; ++i) {
            if (i > 0) sum += step_length(points, strand[i - 1], strand[i], rule);
            t[static_cast<std::size_t>(i)] = sum;
        }
        offset[static_cast<std::size_t>(block.index)] = sum;
    });
    double before = 0;
    for (double& sum : offset) before += std::exchange(sum, before);
    if (offset.size() > 1)
        for_each_block(strand.count, block_size, [&](const Block& block) {
            for (Index i = block.begin; i < block.end; ++i)
                t[static_cast<std::size_t>(i)] += offset[static_cast<std::size_t>(block.index)];
        });
    return before;
}

/// Adds the strand's normalised parameters to `sum`; returns false when it has no length.
bool add_normalised(const Points& points, const Strand& strand, Parametrization rule,
                    Closure closure, std::vector<double>& scratch, std::vector<double>& sum) {
    double total = accumulate(points, strand, rule, scratch);
    if (closure == Closure::closed)
        total += step_length(points, strand[strand.count - 1], strand[0], rule);
    if (!(total > 0)) return false;
    for (std::size_t i = 0; i < scratch.size(); ++i) sum[i] += scratch[i] / total;
    return true;
}

std::vector<double> uniform(Index count, Closure closure) {
    const auto steps = static_cast<double>(closure == Closure::closed ? count : count - 1);
    std::vector<double> t(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = static_cast<double>(i) / steps;
    return t;
}

std::vector<double> averaged(const Samples& samples, std::size_t axis, Parametrization rule,
                             Closure closure) {
    const GridIndex grid(samples.shape());
    const Index count = grid.length(axis);
    if (count < 2)
        throw InvalidInput(fmt::format("axis {}: {} sample, at least 2 are needed", axis, count));
    if (rule == Parametrization::uniform) return uniform(count, closure);
    std::vector<double> sum(static_cast<std::size_t>(count));
    std::vector<double> scratch(sum.size());
    Index used = 0;
    grid.for_each_strand(axis, [&](const Strand& strand) {
        if (add_normalised(samples.points, strand, rule, closure, scratch, sum)) ++used;
    });
    if (used == 0)
        throw InvalidInput(fmt::format(
            "axis {}: all points are identical; a curve through them has no length", axis));
    for (double& t : sum) t /= static_cast<double>(used);
    if (closure == Closure::open) sum.back() = 1;
    return sum;
}

void check_ascending(const std::vector<double>& t, Index count, std::size_t axis) {
    if (static_cast<Index>(t.size()) != count)
        throw InvalidInput(
            fmt::format("axis {}: {} parameters given for {} samples", axis, t.size(), count));
    for (std::size_t i = 0; i < t.size(); ++i) {
        if (!std::isfinite(t[i]))
            throw InvalidInput(
                fmt::format("axis {}: parameter {} is not a finite number", axis, i));
        if (i > 0 && t[i] < t[i - 1])
            throw InvalidInput(
                fmt::format("axis {}: parameter {} = {} is less than the one before, {}", axis, i,
                            t[i], t[i - 1]));
    }
    if (!(t.back() > t.front()))
        throw InvalidInput(fmt::format("axis {}: all parameters are {}", axis, t.front()));
}

void check_scattered(const Parameters& parameters, const Samples& samples) {
    const PointSet& s = parameters.scattered;
    if (s.size() != samples.size())
        throw InvalidInput(
            fmt::format("parameters: {} rows given for {} samples", s.size(), samples.size()));
    if (s.dim() < 1 || s.dim() > 3)
        throw InvalidInput(
            fmt::format("parameters: {} columns given, 1 to 3 are possible", s.dim()));
    for (Index i = 0; i < s.size(); ++i)
        for (double t : s[i])
            if (!std::isfinite(t))
                throw InvalidInput(fmt::format("parameters: row {} is not finite", i));
    const PointSet box = bounding_box(s);
    for (Index d = 0; d < s.dim(); ++d)
        if (!(box(1, d) > box(0, d)))
            throw InvalidInput(fmt::format("axis {}: all parameters are {}", d, box(0, d)));
}

} // namespace

GridIndex Parameters::grid() const {
    std::vector<Index> shape;
    for (const auto& t : axes) shape.push_back(static_cast<Index>(t.size()));
    return GridIndex(shape);
}

std::vector<double> parametrize_sequence(const Points& points, Parametrization rule,
                                         Closure closure) {
    return averaged({.points = points}, 0, rule, closure);
}

Parameters parametrize(const Samples& samples, Parametrization rule,
                       const std::vector<Closure>& closures) {
    Parameters result;
    for (std::size_t axis = 0; axis < closures.size(); ++axis)
        result.axes.push_back(averaged(samples, axis, rule, closures[axis]));
    return result;
}

std::vector<double> parameter_of(const Parameters& parameters, Index i) {
    if (parameters.is_scattered()) {
        const auto row = parameters.scattered[i];
        return {row.begin(), row.end()};
    }
    const GridIndex::Place place = parameters.grid().place(i);
    std::vector<double> t;
    for (std::size_t k = 0; k < parameters.axes.size(); ++k)
        t.push_back(parameters.axes[k][static_cast<std::size_t>(place[k])]);
    return t;
}

PointSet parameter_rows(const Parameters& parameters) {
    if (parameters.is_scattered()) return parameters.scattered;
    const GridIndex grid = parameters.grid();
    PointSet rows(grid.size(), parameters.axis_count());
    grid.for_each([&](const GridIndex::Place& place, Index i) {
        for (std::size_t k = 0; k < parameters.axes.size(); ++k)
            rows(i, static_cast<Index>(k)) = parameters.axes[k][static_cast<std::size_t>(place[k])];
    });
    return rows;
}

void check(const Parameters& parameters, const Samples& samples) {
    if (parameters.is_scattered()) return check_scattered(parameters, samples);
    const std::vector<Index> shape = samples.shape();
    if (parameters.axes.size() != shape.size())
        throw InvalidInput(fmt::format("parameters: given for {} axes, the samples have {}",
                                       parameters.axes.size(), shape.size()));
    for (std::size_t axis = 0; axis < shape.size(); ++axis)
        check_ascending(parameters.axes[axis], shape[axis], axis);
}

} // namespace batten
