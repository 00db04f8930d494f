#include <batten/robust/neighbours.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace batten {

/// The neighbours and where they and the sample are along the curve.
struct Trusted::Line {
    std::array<Index, most_neighbours> sample{};
    std::array<double, most_neighbours> at{};
    std::size_t count = 0;
    double here = 0;
};

namespace {

using Weights = std::array<double, Trusted::most_neighbours>;

/// Weights of the neighbours' points in the value at the sample of their least-squares polynomial,
/// by orthogonal polynomials; the next one's value there is what is answered, infinite where the
/// neighbours do not determine the polynomial [Forsythe1957].
double weights(std::span<const double> at, double here, int degree, Weights& weight) {
    const std::size_t n = at.size();
    if (n == 0) return std::numeric_limits<double>::infinity();
    const double half = (at[n - 1] - at[0]) / 2;
    if (!(half > 0)) return std::numeric_limits<double>::infinity();
    Weights t;
    Weights now;
    Weights last;
    for (std::size_t j = 0; j < n; ++j) {
        t[j] = (at[j] - at[0]) / half - 1;
        now[j] = 1;
        last[j] = 0;
        weight[j] = 0;
    }
    const double x = (here - at[0]) / half - 1;
    double value = 1;
    double value_last = 0;
    double norm_last = 1;
    double scale = 1;
    for (int k = 0; k <= degree; ++k) {
        double norm = 0;
        double centre = 0;
        for (std::size_t j = 0; j < n; ++j) {
            norm += now[j] * now[j];
            centre += t[j] * now[j] * now[j];
        }
        if (!(norm > 1e-24)) return std::numeric_limits<double>::infinity();
        centre /= norm;
        const double back = k > 0 ? norm / norm_last : 0;
        for (std::size_t j = 0; j < n; ++j) {
            weight[j] += now[j] * value / norm;
            last[j] = std::exchange(now[j], (t[j] - centre) * now[j] - back * last[j]);
        }
        value_last = std::exchange(value, (x - centre) * value - back * value_last);
        norm_last = norm;
        scale *= half;
    }
    return std::abs(value) * scale;
}

} // namespace

Trusted::Trusted(Points points, GridIndex grid, std::vector<Closure> closures,
                 std::vector<std::vector<double>> along)
    : points_(std::move(points)),
      grid_(grid),
      closures_(std::move(closures)),
      along_(std::move(along)),
      trusted_(static_cast<std::size_t>(points_.size()), 1) {}

void Trusted::place_along(std::size_t axis, std::vector<double> along) {
    along_[axis] = std::move(along);
}

void Trusted::leave_out(const std::vector<Index>& samples) {
    for (Index i : samples) trusted_[static_cast<std::size_t>(i)] = 0;
}

Index Trusted::beside(Index sample, std::size_t axis, Index steps) const {
    const Index m = grid_.length(axis);
    const Index from = position(sample, axis);
    Index to = from + steps;
    if (to < 0 || to >= m) {
        if (closures_[axis] == Closure::open) return -1;
        to = (to % m + m) % m;
    }
    return sample + (to - from) * grid_.stride(axis);
}

Index Trusted::nearest(Index sample, std::size_t axis, Index step, std::span<Index> found) const {
    const Index m = grid_.length(axis);
    const Index stride = step * grid_.stride(axis);
    const bool closed = closures_[axis] == Closure::closed;
    Index left = step > 0 ? m - 1 - position(sample, axis) : position(sample, axis); // to the end
    Index at = sample;
    Index count = 0;
    for (Index far = 1; far < m && count < std::ssize(found); ++far) {
        at += stride;
        if (left-- == 0) {
            if (!closed) break;
            at -= m * stride;
            left = m - 1;
        }
        if (trusts(at)) found[static_cast<std::size_t>(count++)] = at;
    }
    return count;
}

bool Trusted::within(Index sample, Index count) const {
    for (std::size_t axis = 0; axis < axis_count(); ++axis)
        for (Index k = -count; k <= count; ++k)
            if (const Index at = beside(sample, axis, k); at >= 0 && at != sample && trusts(at))
                return true;
    return false;
}

/// Between two neighbours the sample divides their chord as its distances from them have it; beyond
/// the last it is as far as it is in their direction, at least half of its distance and at most two
/// chords for each sample.
void Trusted::by_chords(Index sample, std::size_t axis, const Stencil& stencil, Line& line) const {
    double longest = 0;
    const auto point = [&](std::size_t j) { return points_[line.sample[j]]; };
    line.at[0] = 0;
    for (std::size_t j = 1; j < line.count; ++j) {
        const double chord = distance(point(j - 1), point(j));
        longest = std::max(longest, chord);
        line.at[j] = line.at[j - 1] + chord;
    }
    const auto before = static_cast<std::size_t>(stencil.before);
    const std::span<const double> q = points_[sample];
    if (!stencil.one_sided()) {
        const double a = distance(q, point(before - 1));
        const double b = distance(q, point(before));
        const double part = a + b > 0 ? a / (a + b) : 0.5;
        line.here = line.at[before - 1] + part * (line.at[before] - line.at[before - 1]);
        return;
    }
    const bool ahead = before > 0;
    const std::size_t far = std::min<std::size_t>(3, line.count - 1); // one step is rather noise
    const auto near = point(ahead ? before - 1 : 0);
    const auto next = point(ahead ? before - 1 - far : far);
    double along = 0;
    for (std::size_t d = 0; d < q.size(); ++d) along += (q[d] - near[d]) * (near[d] - next[d]);
    const double length = distance(near, next);
    along = length > 0 ? along / length : 0;
    const Index m = grid_.length(axis);
    const Index steps =
        std::abs(position(sample, axis) - position(line.sample[ahead ? before - 1 : 0], axis));
    const auto most = static_cast<double>(std::min({2 * steps, 2 * (m - steps), Index{10}}));
    along = std::min(std::max(along, distance(q, near) / 2), most * longest);
    line.here = ahead ? line.at[before - 1] + along : -along;
}

/// The neighbours in order; false where there are too few.
bool Trusted::line(Index sample, std::size_t axis, const Stencil& stencil, Line& line) const {
    std::array<Index, most_neighbours> found{};
    const Index skipped = stencil.skipped;
    const auto all_found = [&](Index step, Index count) {
        if (count == 0) return true;
        const auto room = std::span(found).first(static_cast<std::size_t>(count + skipped));
        return nearest(sample, axis, step, room) == std::ssize(room);
    };
    if (!all_found(-1, stencil.before)) return false;
    for (Index k = stencil.before; k-- > 0;)
        line.sample[line.count++] = found[static_cast<std::size_t>(skipped + k)];
    if (!all_found(1, stencil.behind)) return false;
    for (Index k = 0; k < stencil.behind; ++k)
        line.sample[line.count++] = found[static_cast<std::size_t>(skipped + k)];
    if (along_[axis].empty()) {
        by_chords(sample, axis, stencil, line);
        return true;
    }
    const std::vector<double>& along = along_[axis];
    const Index here = position(sample, axis);
    line.here = along[static_cast<std::size_t>(here)];
    for (std::size_t j = 0; j < line.count; ++j) {
        const bool first = static_cast<Index>(j) < stencil.before;
        const Index there = position(line.sample[j], axis);
        const double turn = first && there > here ? -1 : !first && there < here ? 1 : 0;
        line.at[j] = along[static_cast<std::size_t>(there)] + turn;
    }
    return true;
}

Prediction Trusted::predict(Index sample, std::size_t axis, const Stencil& stencil,
                            std::span<double> off) const {
    Line line;
    if (stencil.before + stencil.behind + 2 * stencil.skipped >= grid_.length(axis) ||
        !this->line(sample, axis, stencil, line))
        return {};
    Weights weight;
    Prediction result;
    result.reach = weights(std::span(line.at).first(line.count), line.here, stencil.degree, weight);
    if (!std::isfinite(result.reach)) return {};
    const std::span<const double> point = points_[sample];
    double square = 0;
    for (std::size_t d = 0; d < point.size(); ++d) {
        double sum = 0;
        for (std::size_t j = 0; j < line.count; ++j)
            sum += weight[j] * (points_[line.sample[j]][d] - point[d]);
        square += sum * sum;
        if (!off.empty()) off[d] = sum;
    }
    result.residual = std::sqrt(square);
    double noise = 1;
    for (std::size_t j = 0; j < line.count; ++j) noise += weight[j] * weight[j];
    result.gain = std::sqrt(noise);
    return result;
}

} // namespace batten
