#include <batten/parametrize/parametrize.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace batten {

namespace {

/// Points at a fixed distance in memory: one row of a grid along one axis.
struct Strand {
    const double* first;
    Index count;
    Index stride;
    Index dim;
};

double step_length(const Strand& strand, Index i, Index j, Parametrization rule) {
    const double* a = strand.first + i * strand.stride;
    const double* b = strand.first + j * strand.stride;
    double square = 0;
    for (Index d = 0; d < strand.dim; ++d) square += (b[d] - a[d]) * (b[d] - a[d]);
    const double length = std::sqrt(square);
    return rule == Parametrization::centripetal ? std::sqrt(length) : length;
}

constexpr Index chunk_size = 1 << 15;

/// Accumulated step lengths of a strand into `t`; returns the whole length. In chunks, whose sums
/// are added in order.
double accumulate(const Strand& strand, Parametrization rule, std::vector<double>& t) {
    const Index chunks = (strand.count + chunk_size - 1) / chunk_size;
    std::vector<double> offset(static_cast<std::size_t>(chunks));
    for_each_chunk(chunks, [&](Index chunk) {
        double sum = 0;
        for (Index i = chunk * chunk_size; i < std::min(strand.count, (chunk + 1) * chunk_size);
             ++i) {
            if (i > 0) sum += step_length(strand, i - 1, i, rule);
            t[static_cast<std::size_t>(i)] = sum;
        }
        offset[static_cast<std::size_t>(chunk)] = sum;
    });
    double before = 0;
    for (double& sum : offset) before += std::exchange(sum, before);
    if (chunks > 1)
        for_each_chunk(chunks, [&](Index chunk) {
            for (Index i = chunk * chunk_size; i < std::min(strand.count, (chunk + 1) * chunk_size);
                 ++i)
                t[static_cast<std::size_t>(i)] += offset[static_cast<std::size_t>(chunk)];
        });
    return before;
}

/// Adds the strand's normalised parameters to `sum`; returns false when it has no length.
bool add_normalised(const Strand& strand, Parametrization rule, Closure closure,
                    std::vector<double>& scratch, std::vector<double>& sum) {
    double total = accumulate(strand, rule, scratch);
    if (closure == Closure::closed) total += step_length(strand, strand.count - 1, 0, rule);
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

Index product(const std::vector<Index>& shape, std::size_t begin, std::size_t end) {
    Index result = 1;
    for (std::size_t k = begin; k < end; ++k) result *= shape[k];
    return result;
}

std::vector<double> averaged(const Samples& samples, std::size_t axis, Parametrization rule,
                             Closure closure) {
    const std::vector<Index> shape = samples.shape();
    const Index count = shape[axis];
    const Index inner = product(shape, axis + 1, shape.size());
    const Index outer = product(shape, 0, axis);
    if (count < 2)
        throw InvalidInput(fmt::format("axis {}: {} sample, at least 2 are needed", axis, count));
    if (rule == Parametrization::uniform) return uniform(count, closure);
    const Index dim = samples.dim();
    std::vector<double> sum(static_cast<std::size_t>(count));
    std::vector<double> scratch(sum.size());
    Index used = 0;
    for (Index o = 0; o < outer; ++o)
        for (Index i = 0; i < inner; ++i) {
            const Strand strand{samples.points.data() + (o * count * inner + i) * dim, count,
                                inner * dim, dim};
            if (add_normalised(strand, rule, closure, scratch, sum)) ++used;
        }
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
