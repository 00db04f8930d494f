#include <batten/parametrize/parametrize.hpp>

#include <batten/core/vector_clones.hpp>
#include <batten/parametrize/step_lengths.hpp>
#include <batten/samples/passes.hpp>

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

/// Accumulated step lengths of a strand into `t`; returns the whole length. In blocks, whose sums
/// are added in order.
double accumulate(const Points& points, const Strand& strand, Parametrization rule,
                  std::vector<double>& t) {
    std::vector<double> offset(static_cast<std::size_t>(block_count(strand.count, chunk_samples)));
    for_each_block(strand.count, chunk_samples, [&](const Block& block) {
        double sum = 0;
        if (strand.stride == 1) {
            const double* first = points[strand[block.begin]].data();
            sum = accumulate_steps(first, block.end - block.begin, points.dim(),
                                   block.begin > 0 ? first - points.dim() : nullptr, rule,
                                   t.data() + block.begin);
        } else {
            for (Index i = block.begin; i < block.end; ++i) {
                if (i > 0) sum += step_length(points, strand[i - 1], strand[i], rule);
                t[static_cast<std::size_t>(i)] = sum;
            }
        }
        offset[static_cast<std::size_t>(block.index)] = sum;
    });
    double before = 0;
    for (double& sum : offset) before += std::exchange(sum, before);
    if (offset.size() > 1)
        for_each_block(strand.count, chunk_samples, [&](const Block& block) {
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
    check_strand(count, axis);
    if (rule == Parametrization::uniform) return uniform(count, closure);
    std::vector<double> sum(static_cast<std::size_t>(count));
    std::vector<double> scratch(sum.size());
    Index used = 0;
    grid.for_each_strand(axis, [&](const Strand& strand) {
        if (add_normalised(samples.points, strand, rule, closure, scratch, sum)) ++used;
    });
    if (used == 0) throw no_length(axis);
    for (double& t : sum) t /= static_cast<double>(used);
    if (closure == Closure::open) sum.back() = 1;
    return sum;
}

/// Neighbours that are not in order, or no numbers.
BATTEN_VECTOR_CLONES
Index descents(const double* t, Index count) {
    Index found = 0;
    for (Index i = 1; i < count; ++i) found += t[i] >= t[i - 1] ? 0 : 1;
    return found;
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

void check_strand(Index samples, std::size_t axis) {
    if (samples < 2)
        throw InvalidInput(fmt::format("axis {}: {} sample, at least 2 are needed", axis, samples));
}

InvalidInput no_length(std::size_t axis) {
    return InvalidInput(
        fmt::format("axis {}: all points are identical; a curve through them has no length", axis));
}

void check_parameter_count(Index given, Index samples, std::size_t axis) {
    if (given != samples)
        throw InvalidInput(
            fmt::format("axis {}: {} parameters given for {} samples", axis, given, samples));
}

void check_ascending(std::span<const double> t, Index begin, Index end, std::size_t axis) {
    const auto first = static_cast<std::size_t>(begin);
    const auto last = static_cast<std::size_t>(end);
    if (first >= last) return;
    const std::size_t before = first > 0 ? first - 1 : 0;
    if (std::isfinite(t[first]) && std::isfinite(t[last - 1]) &&
        descents(t.data() + before, static_cast<Index>(last - before)) == 0)
        return;
    for (std::size_t i = first; i < last; ++i) {
        if (!std::isfinite(t[i]))
            throw InvalidInput(
                fmt::format("axis {}: parameter {} is not a finite number", axis, i));
        if (i > 0 && t[i] < t[i - 1])
            throw InvalidInput(
                fmt::format("axis {}: parameter {} = {} is less than the one before, {}", axis, i,
                            t[i], t[i - 1]));
    }
}

void check_range(std::span<const double> t, std::size_t axis) {
    if (!(t.back() > t.front()))
        throw InvalidInput(fmt::format("axis {}: all parameters are {}", axis, t.front()));
}

void check(const Parameters& parameters, const Samples& samples) {
    if (parameters.is_scattered()) return check_scattered(parameters, samples);
    const std::vector<Index> shape = samples.shape();
    if (parameters.axes.size() != shape.size())
        throw InvalidInput(fmt::format("parameters: given for {} axes, the samples have {}",
                                       parameters.axes.size(), shape.size()));
    for (std::size_t axis = 0; axis < shape.size(); ++axis) {
        const std::vector<double>& t = parameters.axes[axis];
        check_parameter_count(static_cast<Index>(t.size()), shape[axis], axis);
        check_ascending(t, 0, shape[axis], axis);
        check_range(t, axis);
    }
}

} // namespace batten
