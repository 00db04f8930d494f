#include <batten/system/collocation.hpp>

#include <batten/core/distinct.hpp>
#include <batten/core/vectors.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

Collocation::Collocation(const KnotVector& knots, std::span<const double> parameters)
    : degree_(knots.degree()), columns_(knots.free_count()) {
    const auto width = static_cast<std::size_t>(degree_ + 1);
    first_.resize(parameters.size());
    values_.resize(parameters.size() * width);
    for (std::size_t j = 0; j < parameters.size(); ++j) {
        const double t = knots.wrapped(parameters[j]);
        if (!knots.contains(t)) throw outside_domain(knots, fmt::format("parameter {} = {}", j, t));
        const ActiveFunctions active = active_functions(knots, t, Numbering::free);
        first_[j] = active.first;
        std::copy_n(active.value.begin(), width, values_.begin() + static_cast<Index>(j * width));
    }
}

ActiveFunctions Collocation::row(Index j) const {
    ActiveFunctions result{first_[static_cast<std::size_t>(j)], columns_, degree_, {}};
    std::copy_n(values_.begin() + j * (degree_ + 1), degree_ + 1, result.value.begin());
    return result;
}

PointSet Collocation::apply(const PointSet& x) const {
    return {apply_along(x.values(), x.dim()), x.dim()};
}

PointSet Collocation::apply_transposed(const PointSet& y) const {
    return {apply_transposed_along(y.values(), y.dim()), y.dim()};
}

std::vector<double> Collocation::apply_along(const std::vector<double>& values, Index inner) const {
    const Index outer = static_cast<Index>(values.size()) / (columns_ * inner);
    std::vector<double> result(static_cast<std::size_t>(outer * rows() * inner));
    for_each_chunk(outer, [&](Index o) {
        for (Index j = 0; j < rows(); ++j)
            for (int r = 0; r <= degree_; ++r)
                add_scaled(result.data() + (o * rows() + j) * inner, value(j, r),
                           values.data() + (o * columns_ + column(j, r)) * inner, inner);
    });
    return result;
}

namespace {

/// One strand of apply_transposed_along whose points are `dim` long: the sums of rows that share
/// their columns stay in registers.
template <int dim>
void transpose_strand(const Collocation& a, const double* in, double* out) {
    const int terms = a.degree() + 1;
    for (Index j = 0; j < a.rows();) {
        const Index column = a.column(j, 0);
        double sums[max_degree + 1][dim] = {};
        for (; j < a.rows() && a.column(j, 0) == column; ++j)
            for (int r = 0; r < terms; ++r)
                for (int d = 0; d < dim; ++d) sums[r][d] += a.value(j, r) * in[j * dim + d];
        for (int r = 0; r < terms; ++r)
            for (int d = 0; d < dim; ++d) out[a.column(j - 1, r) * dim + d] += sums[r][d];
    }
}

void transpose_long_strand(const Collocation& a, const double* in, double* out, Index inner) {
    for (Index j = 0; j < a.rows(); ++j)
        for (int r = 0; r <= a.degree(); ++r)
            add_scaled(out + a.column(j, r) * inner, a.value(j, r), in + j * inner, inner);
}

} // namespace

std::vector<double> Collocation::apply_transposed_along(const std::vector<double>& values,
                                                        Index inner) const {
    const Index outer = static_cast<Index>(values.size()) / (rows() * inner);
    std::vector<double> result(static_cast<std::size_t>(outer * columns_ * inner));
    for_each_chunk(outer, [&](Index o) {
        const double* in = values.data() + o * rows() * inner;
        double* out = result.data() + o * columns_ * inner;
        switch (inner) {
        case 1:
            return transpose_strand<1>(*this, in, out);
        case 2:
            return transpose_strand<2>(*this, in, out);
        case 3:
            return transpose_strand<3>(*this, in, out);
        default:
            return transpose_long_strand(*this, in, out, inner);
        }
    });
    return result;
}

namespace {

/// Matches control points to distinct samples inside their supports, greedily in order; -1 when all
/// n are matched, else the first that finds none. Greedy is exact as supports and samples both
/// ascend.
Index first_unmatched(const KnotVector& knots, std::span<const double> ascending) {
    auto at = ascending.begin();
    for (Index i = 0; i < knots.control_count(); ++i) {
        const double low = knots[i];
        const double high = knots[i + knots.degree() + 1];
        const bool at_begin = low == knots.begin() && knots[i + knots.degree()] == low;
        const bool at_end = high == knots.end() && knots[i + 1] == high;
        if (at != ascending.end() && (at_begin ? *at < low : *at <= low))
            at = at_begin ? std::lower_bound(at, ascending.end(), low)
                          : std::upper_bound(at, ascending.end(), low);
        if (at == ascending.end() || (at_end ? *at > high : *at >= high)) return i;
        const double used = *at;
        if (++at != ascending.end() && *at == used)
            at = std::upper_bound(at, ascending.end(), used);
    }
    return -1;
}

/// On a closed axis the conditions must hold for some rotation: n consecutive samples (over the
/// seam, too) with the i-th inside the support of B_i for every i.
bool closed_matched(const KnotVector& knots, const std::vector<double>& distinct) {
    const Index n = knots.free_count();
    const auto m = static_cast<Index>(distinct.size());
    const auto sample = [&](Index k) { // over three periods, the middle one being the domain
        return distinct[static_cast<std::size_t>(k % m)] +
               static_cast<double>(k / m - 1) * knots.length();
    };
    for (Index start = 0; start < 2 * m && sample(start) < knots[knots.degree() + 1]; ++start) {
        if (sample(start) <= knots[0]) continue;
        Index at = start;
        Index i = 0;
        for (; i < n; ++i, ++at) {
            while (at < start + m && sample(at) <= knots[i]) ++at;
            if (at == start + m || sample(at) >= knots[i + knots.degree() + 1]) break;
        }
        if (i == n) return true;
    }
    return false;
}

std::string spans_without(const KnotVector& knots, const std::vector<double>& distinct) {
    std::vector<std::string> spans;
    const std::vector<double> breaks = knots.breakpoints();
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        const bool last = k + 2 == breaks.size();
        const auto first = std::ranges::lower_bound(distinct, breaks[k]);
        if (first != distinct.end() &&
            (*first < breaks[k + 1] || (last && *first == breaks[k + 1])))
            continue;
        if (spans.size() == 3) {
            spans.emplace_back("...");
            break;
        }
        spans.push_back(fmt::format("[{:.6g}, {:.6g}]", breaks[k], breaks[k + 1]));
    }
    if (spans.empty())
        return fmt::format("too few distinct parameters for {} control points", knots.free_count());
    return fmt::format("no samples in knot span{} {}", spans.size() > 1 ? "s" : "",
                       fmt::join(spans, ", "));
}

} // namespace

std::optional<std::string> undetermined(const KnotVector& knots,
                                        std::span<const double> parameters) {
    if (!knots.closed() && first_unmatched(knots, parameters) < 0) return std::nullopt;
    std::vector<double> inside;
    for (double t : parameters) {
        inside.push_back(knots.wrapped(t));
        if (knots.closed() && inside.back() == knots.end()) inside.back() = knots.begin();
    }
    inside = knots.closed() ? distinct(std::move(inside)) : without_repeats(std::move(inside));
    if (knots.closed() && closed_matched(knots, inside)) return std::nullopt;
    return spans_without(knots, inside);
}

} // namespace batten
