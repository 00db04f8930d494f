#include <batten/robust/neighbour_outliers.hpp>

#include <batten/core/vectors.hpp>
#include <batten/parametrize/parametrize.hpp>
#include <batten/robust/judge.hpp>
#include <batten/robust/suspects.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Running means of so many points to each side, fewer at an open end; sums are from the first one.
PointSet running_means(const Points& q, Index half, Closure closure) {
    const Index m = q.size();
    const Index ring = closure == Closure::closed ? half : 0;
    PointSet sums(m + 2 * ring + 1, q.dim());
    for (Index k = 0; k < m + 2 * ring; ++k)
        for (Index d = 0; d < q.dim(); ++d)
            sums(k + 1, d) = sums(k, d) + q((k - ring + m) % m, d) - q(0, d);
    PointSet result(m, q.dim());
    for (Index i = 0; i < m; ++i) {
        const Index reach = ring > 0 ? half : std::min({half, i, m - 1 - i});
        for (Index d = 0; d < q.dim(); ++d)
            result(i, d) = q(0, d) + (sums(i + ring + reach + 1, d) - sums(i + ring - reach, d)) /
                                         static_cast<double>(2 * reach + 1);
    }
    return result;
}

/// Places along a noisy sequence: by chords between running means of its trusted samples, and
/// between and beyond these by counting. `noise` in steps.
std::vector<double> smooth_places(const Trusted& trusted, double noise) {
    std::vector<Index> members;
    for (Index i = 0; i < trusted.size(); ++i)
        if (trusted.trusts(i)) members.push_back(i);
    PointSet points(static_cast<Index>(members.size()), trusted.points().dim());
    for (std::size_t k = 0; k < members.size(); ++k)
        std::ranges::copy(trusted.points()[members[k]], points[static_cast<Index>(k)].begin());
    // means of w samples have steps with noise of sqrt(2) / w: a fifth of the step is little
    const double wanted = std::min(3.5 * noise, static_cast<double>(members.size()) / 20);
    const Closure closure = trusted.closure(0);
    const std::vector<double> t = parametrize_sequence(
        running_means(points, std::max<Index>(1, static_cast<Index>(wanted)), closure),
        Parametrization::chord, closure);
    const Index m = trusted.size();
    const bool closed = trusted.closure(0) == Closure::closed;
    std::vector<double> result(static_cast<std::size_t>(m));
    const auto fill = [&](Index a, double at_a, Index b, double at_b, Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
            result[static_cast<std::size_t>((i + m) % m)] =
                at_a + (at_b - at_a) * static_cast<double>(i - a) / static_cast<double>(b - a);
    };
    const std::size_t last = members.size() - 1;
    for (std::size_t k = 0; k < last; ++k)
        fill(members[k], t[k], members[k + 1], t[k + 1], members[k], members[k + 1] + 1);
    if (closed) {
        fill(members[last], t[last], members[0] + m, 1, members[last] + 1, m);
        fill(members[last] - m, t[last] - 1, members[0], 0, 0, members[0]);
    } else {
        const std::size_t far = std::min<std::size_t>(last, 8);
        fill(members[0], t[0], members[far], t[far], 0, members[0]);
        fill(members[last - far], t[last - far], members[last], t[last], members[last] + 1, m);
    }
    return result;
}

/// Suspects in one piece: next to each other along an axis.
struct Piece {
    std::vector<std::size_t> members;
};

std::vector<Piece> pieces(const Trusted& trusted, const std::vector<Index>& suspect) {
    std::vector<char> seen(suspect.size(), 0);
    std::vector<Piece> result;
    for (std::size_t first = 0; first < suspect.size(); ++first) {
        if (seen[first]) continue;
        seen[first] = 1;
        Piece piece{{first}};
        for (std::size_t next = 0; next < piece.members.size(); ++next)
            for (std::size_t axis = 0; axis < trusted.axis_count(); ++axis)
                for (Index side : {-1, 1}) {
                    const Index at = trusted.beside(suspect[piece.members[next]], axis, side);
                    const auto found = std::ranges::lower_bound(suspect, at);
                    if (found == suspect.end() || *found != at) continue;
                    const auto k = static_cast<std::size_t>(found - suspect.begin());
                    if (seen[k]) continue;
                    seen[k] = 1;
                    piece.members.push_back(k);
                }
        result.push_back(std::move(piece));
    }
    return result;
}

/// Suspects that may be trusted next: of those in one piece that are explained, and beyond no more
/// than a run of three that are not trusted, the most certain ones.
std::vector<Index> cleared(const Trusted& trusted, const std::vector<Index>& suspect,
                           const std::vector<Judge::Verdict>& verdict) {
    std::vector<Index> result;
    const auto clear = [&](std::size_t k) {
        return verdict[k].part <= 1 && trusted.within(suspect[k], 4);
    };
    for (const Piece& piece : pieces(trusted, suspect)) {
        double certain = std::numeric_limits<double>::infinity();
        for (std::size_t k : piece.members)
            if (clear(k)) certain = std::min(certain, verdict[k].limit);
        for (std::size_t k : piece.members)
            if (clear(k) && verdict[k].limit <= 1.1 * certain) result.push_back(suspect[k]);
    }
    std::ranges::sort(result);
    return result;
}

/// Whether one of some samples is so near along an axis that it is a neighbour or a neighbour's.
class Near {
  public:
    Near(const Trusted& trusted, const std::vector<Index>& samples)
        : near_(static_cast<std::size_t>(trusted.size()), 0) {
        constexpr Index reach = 24;
        for (Index i : samples)
            for (std::size_t axis = 0; axis < trusted.axis_count(); ++axis)
                for (Index k = -reach; k <= reach; ++k)
                    if (const Index at = trusted.beside(i, axis, k); at >= 0)
                        near_[static_cast<std::size_t>(at)] = 1;
    }

    bool operator()(Index sample) const { return near_[static_cast<std::size_t>(sample)] != 0; }

  private:
    std::vector<char> near_;
};

/// Trusts, round by round, the suspects that trusted neighbours explain; the others are left, with
/// what was found of them.
void grow(Trusted& trusted, const Judge& judge, std::vector<Index>& suspect,
          std::vector<Judge::Verdict>& verdict) {
    constexpr int most_rounds = 60;
    std::vector<Index> now = suspect;
    for (int round = 0; round < most_rounds && !suspect.empty() && !now.empty(); ++round) {
        const Near near(trusted, now);
        for_each_block(static_cast<Index>(suspect.size()), 16, [&](const Block& block) {
            for (Index k = block.begin; k < block.end; ++k)
                if (const Index i = suspect[static_cast<std::size_t>(k)]; near(i))
                    verdict[static_cast<std::size_t>(k)] = judge.of(i);
        });
        now = cleared(trusted, suspect, verdict);
        for (Index i : now) trusted.take(i);
        std::size_t kept = 0;
        for (std::size_t k = 0; k < suspect.size(); ++k) {
            if (trusted.trusts(suspect[k])) continue;
            suspect[kept] = suspect[k];
            verdict[kept++] = verdict[k];
        }
        suspect.resize(kept);
        verdict.resize(kept);
    }
}

/// Whether samples follow each other as those beside them do: straight on for the most part, or by
/// steps that are usual there.
bool agree(const Trusted& trusted, std::size_t axis, const std::vector<Index>& run) {
    const Points& q = trusted.points();
    int straight_on = 0;
    int turns = 0;
    double longest = 0;
    for (std::size_t k = 1; k < run.size(); ++k) {
        const std::vector<double> in = difference(q[run[k]], q[run[k - 1]]);
        longest = std::max(longest, norm(in));
        if (k + 1 == run.size()) break;
        const std::vector<double> out = difference(q[run[k + 1]], q[run[k]]);
        straight_on += dot(in, out) > 0.85 * norm(in) * norm(out) ? 1 : 0; // within 32 degrees
        ++turns;
    }
    if (2 * straight_on >= turns) return true;
    double usual = 0;
    for (Index side : {-1, 1}) {
        std::array<Index, 5> found{};
        const Index count = trusted.nearest(side < 0 ? run.front() : run.back(), axis, side, found);
        for (Index k = 0; k + 1 < count; ++k)
            usual = std::max(usual, distance(q[found[static_cast<std::size_t>(k)]],
                                             q[found[static_cast<std::size_t>(k + 1)]]));
    }
    return longest <= 2 * usual;
}

/// Whether samples that are left are a part of the shape after all, along an axis: a run of four or
/// more that agrees with itself, or what is not resolved.
bool part_of_shape(const Trusted& trusted, const Judge& judge, std::size_t axis, Index sample) {
    std::vector<Index> run{sample};
    for (Index side : {-1, 1}) {
        for (Index k = 1; k < trusted.grid().length(axis); ++k) {
            const Index at = trusted.beside(sample, axis, side * k);
            if (at < 0 || trusted.trusts(at)) break;
            run.push_back(at);
        }
        if (side < 0) std::ranges::reverse(run);
    }
    return (run.size() >= 4 && agree(trusted, axis, run)) ||
           judge.unresolved(sample, axis, static_cast<Index>(run.size()));
}

} // namespace

NeighbourOutliers neighbour_outliers(Trusted trusted, const std::vector<double>& least) {
    Suspects found = suspects(trusted, least);
    std::vector<Index> left = std::move(found.samples);
    if (4 * static_cast<Index>(left.size()) > 3 * trusted.size()) return {}; // nobody to ask
    trusted.leave_out(left);
    std::vector<UsualResidual> usual;
    for (std::size_t axis = 0; axis < trusted.axis_count(); ++axis) {
        if (found.noisy(axis))
            trusted.place_along(axis, trusted.axis_count() == 1
                                          ? smooth_places(trusted, found.noise[axis])
                                          : counted(trusted.grid().length(axis)));
        usual.emplace_back(normal_residuals(trusted, axis));
    }
    const Judge judge(trusted, usual, least);
    std::vector<Judge::Verdict> verdict(left.size());
    grow(trusted, judge, left, verdict);
    NeighbourOutliers result;
    std::vector<double> predicted;
    std::vector<double> off(static_cast<std::size_t>(trusted.points().dim()));
    for (std::size_t k = 0; k < left.size(); ++k) {
        bool part = verdict[k].by.before + verdict[k].by.behind == 0; // nobody to ask
        for (std::size_t axis = 0; axis < trusted.axis_count() && !part; ++axis)
            part = part_of_shape(trusted, judge, axis, left[k]);
        if (part) continue;
        result.samples.push_back(left[k]);
        std::ranges::fill(off, 0.0);
        trusted.predict(left[k], verdict[k].axis, verdict[k].by, off);
        for (std::size_t d = 0; d < off.size(); ++d)
            predicted.push_back(trusted.points()[left[k]][d] + off[d]);
    }
    result.predicted = PointSet(std::move(predicted), trusted.points().dim());
    return result;
}

} // namespace batten
