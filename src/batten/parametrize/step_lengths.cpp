#include <batten/parametrize/step_lengths.hpp>

#include <batten/core/vector_clones.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Where the dimension is known to the compiler, squares as they lie in memory come first.
template <int dim>
inline __attribute__((always_inline)) void lengths(const double* points, Index count, double* out) {
    constexpr Index block = 128;
    alignas(64) double squares[block * dim];
    for (Index first = 0; first < count; first += block) {
        const Index n = std::min(block, count - first);
        const double* from = points + first * dim;
        for (Index k = 0; k < n * dim; ++k)
            squares[k] = (from[k + dim] - from[k]) * (from[k + dim] - from[k]);
        for (Index i = 0; i < n; ++i) {
            double sum = squares[i * dim];
            for (Index d = 1; d < dim; ++d) sum += squares[i * dim + d];
            out[first + i] = std::sqrt(sum);
        }
    }
}

inline __attribute__((always_inline)) void lengths(const double* points, Index count, Index dim,
                                                   double* out) {
    for (Index i = 0; i < count; ++i) {
        const double* from = points + i * dim;
        double sum = 0;
        for (Index d = 0; d < dim; ++d)
            sum += (from[d + dim] - from[d]) * (from[d + dim] - from[d]);
        out[i] = std::sqrt(sum);
    }
}

/// Length of the step after each of the points.
BATTEN_VECTOR_CLONES
void step_lengths(const double* points, Index count, Index dim, double* out) {
    switch (dim) {
    case 1:
        return lengths<1>(points, count, out);
    case 2:
        return lengths<2>(points, count, out);
    case 3:
        return lengths<3>(points, count, out);
    default:
        return lengths(points, count, dim, out);
    }
}

BATTEN_VECTOR_CLONES
void take_roots(double* x, Index count) {
    for (Index i = 0; i < count; ++i) x[i] = std::sqrt(x[i]);
}

BATTEN_VECTOR_CLONES
Index equal_neighbours(const double* t, Index count) {
    Index equal = 0;
    for (Index i = 1; i < count; ++i) equal += t[i] == t[i - 1] ? 1 : 0;
    return equal;
}

} // namespace

double accumulate_steps(const double* points, Index count, Index dim, const double* before,
                        Parametrization rule, double* t) {
    if (count == 0) return 0;
    const auto d = static_cast<std::size_t>(dim);
    t[0] = before == nullptr ? 0 : distance({before, d}, {points, d});
    step_lengths(points, count - 1, dim, t + 1);
    if (rule == Parametrization::centripetal) take_roots(t, count);
    double sum = 0;
    for (Index i = 0; i < count; ++i) t[i] = sum += t[i];
    return sum;
}

void EqualRuns::add(std::span<const double> t, bool joined) {
    const Index inside = equal_neighbours(t.data(), static_cast<Index>(t.size()));
    equal_ += inside + (joined ? 1 : 0);
    run_ = joined ? run_ + 1 : 1;
    longest_ = std::max(longest_, run_);
    if (inside > 0)
        for (std::size_t i = 1; i < t.size(); ++i) {
            run_ = t[i] == t[i - 1] ? run_ + 1 : 1;
            longest_ = std::max(longest_, run_);
        }
    else if (t.size() > 1)
        run_ = 1;
    last_ = t.back();
    any_ = true;
}

} // namespace batten
