#include <batten/robust/sequence_outliers.hpp>

#include <batten/core/vectors.hpp>
#include <batten/robust/judge.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace batten {

namespace {

/// How many samples a neighbour is the mean of: enough for steps well above its noise. Of noisy
/// dense samples the next ones show no direction.
Index clear_stride(const Points& q, Closure closure) {
    for (Index stride = 1;; stride *= 2) {
        if (20 * stride > q.size()) return stride;
        const Trusted all(q, closure, stride);
        const double noise =
            finite_median(residuals(all, closest)) / std::sqrt(static_cast<double>(stride));
        if (all.usual_step() >= 3 * noise) return stride;
    }
}

/// Samples to be judged: what their nearest neighbours predict is three times as far off as usual
/// around them. Neighbours of outliers are among them.
std::vector<bool> suspects(const Trusted& all, const std::vector<double>& least) {
    std::vector<double> residual = residuals(all, closest);
    for (Index i = 0; i < all.size(); ++i) {
        double& r = residual[static_cast<std::size_t>(i)];
        if (!std::isfinite(r)) r = all.least_residual(i, lopsided);
        if (!std::isfinite(r)) r = all.least_residual(i, std::span(one_sided).first(2));
    }
    std::vector<char> result(residual.size()); // written by several threads
    for_each_block(all.size(), 4096, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i) {
            const auto k = static_cast<std::size_t>(i);
            result[k] =
                residual[k] > least[k] / 3 && residual[k] > 3 * median_around(residual, all, i) ? 1
                                                                                                : 0;
        }
    });
    return {result.begin(), result.end()};
}

std::vector<Index> listed(const std::vector<bool>& marked) {
    std::vector<Index> result;
    for (std::size_t i = 0; i < marked.size(); ++i)
        if (marked[i]) result.push_back(static_cast<Index>(i));
    return result;
}

/// Suspects that may be trusted now: those explained without doubt, else the best of a run.
std::vector<Index> cleared(const std::vector<Index>& suspect, const std::vector<double>& part) {
    std::vector<Index> result;
    for (std::size_t k = 0; k < suspect.size(); ++k) {
        const auto better_than = [&](std::size_t other) {
            return other >= suspect.size() || std::abs(suspect[k] - suspect[other]) > 1 ||
                   part[k] <= part[other];
        };
        if (part[k] < 0.25 || (part[k] <= 1 && better_than(k - 1) && better_than(k + 1)))
            result.push_back(suspect[k]);
    }
    return result;
}

/// Runs of four or more outliers that go on in their own direction are a part of the curve.
void keep_smooth_runs(std::vector<bool>& outlier, const Points& q) {
    for (std::size_t begin = 0; begin < outlier.size();) {
        std::size_t end = begin;
        while (end < outlier.size() && outlier[end]) ++end;
        int straight_on = 0;
        int turns = 0;
        for (std::size_t i = begin + 1; i + 1 < end; ++i) {
            const auto at = static_cast<Index>(i);
            const std::vector<double> in = difference(q[at], q[at - 1]);
            const std::vector<double> out = difference(q[at + 1], q[at]);
            straight_on += dot(in, out) > 0.85 * norm(in) * norm(out) ? 1 : 0; // within 32 degrees
            ++turns;
        }
        if (turns >= 2 && 2 * straight_on >= turns)
            for (std::size_t i = begin; i < end; ++i) outlier[i] = false;
        begin = end + 1;
    }
}

/// Whether one of the ascending samples is so near, along the sequence or round its seam, that it
/// is a neighbour or a neighbour's.
bool any_near(const std::vector<Index>& samples, Index sample, Index count) {
    constexpr Index near = 16;
    for (Index turn : {-count, Index{0}, count}) {
        const auto next = std::ranges::lower_bound(samples, sample + turn - near);
        if (next != samples.end() && *next <= sample + turn + near) return true;
    }
    return false;
}

/// Trusts, round by round, the suspects that trusted neighbours explain.
void grow(Trusted& trusted, std::vector<bool>& suspect, const Judge& judge) {
    constexpr int most_rounds = 40;
    const auto m = static_cast<Index>(suspect.size());
    std::vector<double> all(suspect.size());
    std::vector<Index> now;
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<Index> left = listed(suspect);
        std::vector<double> part(left.size());
        for_each_block(static_cast<Index>(left.size()), 64, [&](const Block& block) {
            for (Index k = block.begin; k < block.end; ++k) {
                const Index i = left[static_cast<std::size_t>(k)];
                double& mine = all[static_cast<std::size_t>(i)];
                // a few more samples do not move neighbours that are means
                const bool changed = trusted.stride() == 1 && any_near(now, i, m);
                if (round == 0 || changed) mine = judge.part(i);
                part[static_cast<std::size_t>(k)] = mine;
            }
        });
        now = cleared(left, part);
        if (now.empty()) break;
        for (Index i : now) suspect[static_cast<std::size_t>(i)] = false;
        trusted.take(suspect);
    }
}

std::vector<bool> found(const Points& q, Closure closure, const std::vector<double>& least) {
    Trusted trusted(q, closure, clear_stride(q, closure));
    std::vector<bool> suspect = suspects(trusted, least);
    trusted.take(suspect);
    if (2 * trusted.size() < q.size()) // nobody to ask
        return std::vector<bool>(suspect.size(), false);
    const Scale scale(trusted);
    std::vector<double> usual = least;
    for (Index i : listed(suspect)) {
        double& mine = usual[static_cast<std::size_t>(i)];
        mine = std::max(mine, scale.usual(trusted, trusted.gap(i)));
    }
    const Judge judge(trusted, usual, scale.noise());
    grow(trusted, suspect, judge);
    for (Index i : listed(suspect))
        if (judge.unresolved(i)) suspect[static_cast<std::size_t>(i)] = false;
    keep_smooth_runs(suspect, q);
    return suspect;
}

} // namespace

std::vector<Index> sequence_outliers(const Points& sequence, Closure closure,
                                     const std::vector<double>& least) {
    const auto same = [&](Index i, Index j) {
        return std::ranges::equal(sequence[i], sequence[j]);
    };
    std::vector<Index> first; // of each run of identical samples
    for (Index i = 0; i < sequence.size(); ++i)
        if (i == 0 || !same(i - 1, i)) first.push_back(i);
    Index seam = sequence.size(); // from here on a closed one's first sample is repeated
    if (closure == Closure::closed && first.size() > 1 && same(first.back(), 0)) {
        seam = first.back();
        first.pop_back();
    }
    if (static_cast<Index>(first.size()) < fewest_in_sequence) return {};
    PointSet different(static_cast<Index>(first.size()), sequence.dim());
    std::vector<double> theirs;
    for (std::size_t k = 0; k < first.size(); ++k) {
        std::ranges::copy(sequence[first[k]], different[static_cast<Index>(k)].begin());
        theirs.push_back(least[static_cast<std::size_t>(first[k])]);
    }
    const std::vector<bool> outlier = found(Points(std::move(different)), closure, theirs);
    std::vector<Index> result;
    std::size_t k = 0;
    for (Index i = 0; i < sequence.size(); ++i) {
        while (k + 1 < first.size() && first[k + 1] <= i) ++k;
        if (outlier[i >= seam ? 0 : k]) result.push_back(i);
    }
    return result;
}

} // namespace batten
