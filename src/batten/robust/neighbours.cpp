#include <batten/robust/neighbours.hpp>

#include <batten/samples/noise.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace batten {

namespace {

constexpr std::size_t most_neighbours = 8;
constexpr std::size_t most_dim = 16;

/// The neighbours' points and where they and the sample are along the curve.
struct Line {
    std::array<std::array<double, most_dim>, most_neighbours> coordinates{};
    std::array<std::span<const double>, most_neighbours> point{};
    std::array<double, most_neighbours> at{};
    std::size_t count = 0;
    double sample = 0;
    double longest = 0; ///< chord
    bool degenerate = false;

    double chord(std::size_t j) const { return at[j + 1] - at[j]; }
};

/// Between two neighbours the sample divides their chord as its distances from them have it; beyond
/// the last it is as far as it is in their direction, at most ten chords.
double place_of(std::span<const double> sample, const Line& line, std::size_t before) {
    if (before > 0 && before < line.count) {
        const double a = distance(sample, line.point[before - 1]);
        const double b = distance(sample, line.point[before]);
        const double part = a + b > 0 ? a / (a + b) : 0.5;
        return line.at[before - 1] + part * line.chord(before - 1);
    }
    const bool ahead = before > 1;
    const std::size_t last = ahead ? before - 1 : 1;
    const auto near = line.point[ahead ? last : 0];
    const auto next = line.point[ahead ? last - 1 : 1];
    const double length = distance(near, next);
    double along = 0;
    for (std::size_t d = 0; d < sample.size(); ++d)
        along += (sample[d] - near[d]) * (near[d] - next[d]);
    along = std::clamp(along / length, 0.0, 10 * line.longest);
    return ahead ? line.at[last] + along : -along;
}

/// Weights of the neighbours' points in the value at the sample of their least-squares polynomial,
/// by orthogonal polynomials; the next one's value there is what is answered [Forsythe1957].
double weights(const Line& line, int degree, std::array<double, most_neighbours>& weight) {
    const std::size_t n = line.count;
    const double half = line.at[n - 1] / 2;
    std::array<double, most_neighbours> t{};
    std::array<double, most_neighbours> now{};
    std::array<double, most_neighbours> last{};
    for (std::size_t j = 0; j < n; ++j) {
        t[j] = (line.at[j] - half) / half;
        now[j] = 1;
    }
    const double x = (line.sample - half) / half;
    double here = 1;
    double here_last = 0;
    double norm_last = 1;
    double scale = 1;
    for (int k = 0; k <= degree; ++k) {
        double norm = 0;
        double centre = 0;
        for (std::size_t j = 0; j < n; ++j) {
            norm += now[j] * now[j];
            centre += t[j] * now[j] * now[j];
        }
        centre /= norm;
        const double back = k > 0 ? norm / norm_last : 0;
        for (std::size_t j = 0; j < n; ++j) {
            weight[j] += now[j] * here / norm;
            last[j] = std::exchange(now[j], (t[j] - centre) * now[j] - back * last[j]);
        }
        here_last = std::exchange(here, (x - centre) * here - back * here_last);
        norm_last = norm;
        scale *= half;
    }
    return std::abs(here) * scale;
}

} // namespace

Trusted::Trusted(Points sequence, Closure closure, Index stride)
    : sequence_(std::move(sequence)), closure_(closure), stride_(stride) {
    take(std::vector<bool>(static_cast<std::size_t>(sequence_.size()), false));
}

void Trusted::take(const std::vector<bool>& left_out) {
    members_.clear();
    for (std::size_t i = 0; i < left_out.size(); ++i)
        if (!left_out[i]) members_.push_back(static_cast<Index>(i));
    if (stride_ == 1) return;
    sums_ = PointSet(size() + 1, sequence_.dim());
    for (Index k = 0; k < size(); ++k)
        for (Index d = 0; d < sequence_.dim(); ++d)
            sums_(k + 1, d) =
                sums_(k, d) + sequence_(members_[static_cast<std::size_t>(k)], d) - sequence_(0, d);
}

/// The neighbour at a place; false beyond an end.
bool Trusted::neighbour(Index place, std::span<double> point) const {
    const Index half = stride_ / 2;
    const Index n = size();
    if (closure_ == Closure::open && (place < half || place + half >= n)) return false;
    if (half == 0) {
        std::ranges::copy(sequence_[members_[static_cast<std::size_t>(within(place))]],
                          point.begin());
        return true;
    }
    const Index begin = within(place - half);
    const Index end = begin + 2 * half + 1;
    for (std::size_t d = 0; d < point.size(); ++d) {
        const auto e = static_cast<Index>(d);
        double sum = sums_(std::min(end, n), e) - sums_(begin, e);
        if (end > n) sum += sums_(end - n, e); // round the seam
        point[d] = sequence_(0, e) + sum / static_cast<double>(2 * half + 1);
    }
    return true;
}

double Trusted::usual_step() const {
    std::vector<double> steps;
    const auto dim = static_cast<std::size_t>(sequence_.dim());
    std::vector<double> a(dim);
    std::vector<double> b(dim);
    for (Index k = 0; k + stride_ < size(); ++k)
        if (neighbour(k, a) && neighbour(k + stride_, b)) steps.push_back(distance(a, b));
    return median(std::move(steps));
}

Gap Trusted::gap(Index sample) const {
    const auto at = std::ranges::lower_bound(members_, sample);
    const Index place = at - members_.begin();
    return {place - 1, at != members_.end() && *at == sample ? place + 1 : place};
}

Index Trusted::within(Index place) const {
    const Index n = size();
    if (place >= 0 && place < n) return place;
    return closure_ == Closure::closed ? (place % n + n) % n : -1;
}

std::vector<Index> Trusted::around(const Gap& gap, Index count, bool before, bool behind) const {
    std::vector<Index> result;
    const auto add = [&](Index place) {
        if (const Index at = within(place); at >= 0)
            result.push_back(members_[static_cast<std::size_t>(at)]);
    };
    for (Index k = 0; k < count; ++k) {
        if (before) add(gap.before - k * stride_);
        if (behind) add(gap.behind + k * stride_);
    }
    return result;
}

double Trusted::least_residual(Index sample, std::span<const Stencil> stencils) const {
    const Gap here = gap(sample);
    double least = std::numeric_limits<double>::infinity();
    for (const Stencil& stencil : stencils)
        least = std::min(least, predict(sample, here, stencil).residual);
    return least;
}

Prediction Trusted::predict(Index sample, const Gap& gap, const Stencil& stencil) const {
    if ((stencil.before + stencil.behind + 1) * stride_ > size()) return {};
    const std::span<const double> point = sequence_[sample];
    Line line;
    for (Index k = 1 - stencil.before; k <= stencil.behind; ++k) {
        const Index place =
            k <= 0 ? gap.before + 1 + (k - 1) * stride_ : gap.behind - 1 + k * stride_;
        const auto next = std::span(line.coordinates[line.count]).first(point.size());
        if (!neighbour(place, next)) return {};
        line.point[line.count] = next;
        if (line.count > 0) {
            const double chord = distance(line.point[line.count - 1], line.point[line.count]);
            if (!(chord > 0)) return {};
            line.at[line.count] = line.at[line.count - 1] + chord;
            line.longest = std::max(line.longest, chord);
        }
        ++line.count;
    }
    line.sample = place_of(point, line, static_cast<std::size_t>(stencil.before));
    std::array<double, most_neighbours> weight{};
    Prediction result;
    result.reach = weights(line, stencil.degree, weight);
    double square = 0;
    for (std::size_t d = 0; d < point.size(); ++d) {
        double off = 0;
        for (std::size_t j = 0; j < line.count; ++j)
            off += weight[j] * (line.point[j][d] - point[d]);
        square += off * off;
    }
    result.residual = std::sqrt(square);
    return result;
}

} // namespace batten
