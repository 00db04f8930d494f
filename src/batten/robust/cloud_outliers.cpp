#include <batten/robust/cloud_outliers.hpp>

#include <batten/core/vectors.hpp>
#include <batten/robust/judge.hpp>
#include <batten/robust/scattered_neighbours.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr Surroundings closest_around{2, 3};
constexpr std::array surroundings{closest_around, Surroundings{1, 3}, Surroundings{1, 8},
                                  Surroundings{2, 6}, Surroundings{3, 3}};
constexpr Index near = 80; ///< neighbours that a residual is compared with: most know nothing of it

/// What the nearest neighbours of each trusted sample have it off; those of `places` anew.
void update(const TrustedCloud& cloud, const std::vector<Index>& places,
            std::vector<double>& normal) {
    for_each_block(static_cast<Index>(places.size()), 64, [&](const Block& block) {
        for (Index k = block.begin; k < block.end; ++k) {
            const Index i = places[static_cast<std::size_t>(k)];
            normal[static_cast<std::size_t>(i)] = cloud.predict(i, closest_around).normal();
        }
    });
}

std::vector<double> of(const std::vector<double>& values, const std::vector<Index>& samples) {
    std::vector<double> result;
    for (Index i : samples)
        if (const double x = values[static_cast<std::size_t>(i)]; std::isfinite(x))
            result.push_back(x);
    return result;
}

/// Leaves out what is far off among its neighbours, round by round: what hides behind others is
/// seen without them.
std::vector<Index> leave_out(TrustedCloud& cloud, const std::vector<double>& least) {
    constexpr int most_rounds = 12;
    const Index m = cloud.size();
    std::vector<Index> changed(static_cast<std::size_t>(m));
    for (Index i = 0; i < m; ++i) changed[static_cast<std::size_t>(i)] = i;
    std::vector<double> normal(static_cast<std::size_t>(m));
    std::vector<Index> left;
    double part = 0;
    for (int round = 0; round < most_rounds && !changed.empty(); ++round) {
        update(cloud, changed, normal);
        const UsualResidual usual(normal);
        part = 0.67 * usual.ratio();
        std::vector<char> out(changed.size(), 0);
        for_each_block(static_cast<Index>(changed.size()), 64, [&](const Block& block) {
            for (Index k = block.begin; k < block.end; ++k) {
                const Index i = changed[static_cast<std::size_t>(k)];
                const double here = normal[static_cast<std::size_t>(i)];
                if (!cloud.trusts(i) || !std::isfinite(here) ||
                    here <= least[static_cast<std::size_t>(i)] / 3 || here <= 0.67 * usual.largest)
                    continue;
                out[static_cast<std::size_t>(k)] =
                    here > part * median(of(normal, cloud.nearest(i, near)));
            }
        });
        std::vector<Index> now;
        for (std::size_t k = 0; k < changed.size(); ++k)
            if (out[k]) now.push_back(changed[k]);
        changed.clear();
        for (Index i : now) cloud.trust(i, false);
        left.insert(left.end(), now.begin(), now.end());
        for (Index i : now)
            for (Index beside : cloud.nearest(i, 48)) changed.push_back(beside);
        std::ranges::sort(changed);
        changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
        for (Index i : now)
            normal[static_cast<std::size_t>(i)] = std::numeric_limits<double>::infinity();
    }
    std::ranges::sort(left);
    return left;
}

/// Says whether the most certain surroundings explain a sample.
struct CloudJudge {
    const TrustedCloud& cloud;
    const std::vector<double>& least;
    double largest; ///< usual residual in units of a sample's noise

    Judge::Verdict of(Index sample) const {
        const std::vector<Index> beside = cloud.nearest(sample, 6);
        Judge::Verdict best;
        for (const Surroundings& by : surroundings) {
            const Prediction here = cloud.predict(sample, by);
            if (!here.exists()) continue;
            const double limit =
                std::max(least[static_cast<std::size_t>(sample)],
                         largest * here.gain + smooth_residual(beside, by, here.reach));
            if (limit >= best.limit) continue;
            best.limit = limit;
            best.part = here.residual / limit;
        }
        if (!std::isfinite(best.limit)) best.part = 0;
        return best;
    }

    double smooth_residual(const std::vector<Index>& beside, const Surroundings& by,
                           double reach) const {
        std::vector<double> off(static_cast<std::size_t>(cloud.points().dim()));
        SmoothResidual result(largest, reach, off.size());
        for (Index i : beside) result.add(cloud.predict(i, by, off), off);
        return result.value();
    }

    /// Whether neighbours are about as badly predicted without it: of many, for where places are
    /// uneven some see little of the shape.
    bool unresolved(Index sample) const {
        double worst = 0;
        for (Index i : cloud.nearest(sample, 48))
            if (const Prediction there = cloud.predict(i, closest_around); there.exists())
                worst = std::max(worst, there.normal());
        return cloud.predict(sample, closest_around).normal() <= 3 * worst;
    }
};

/// Trusts those that are explained, the most certain first.
void take_back(TrustedCloud& cloud, const CloudJudge& judge, std::vector<Index>& left) {
    constexpr int most_rounds = 40;
    constexpr double more = 1.5;
    double certain = more * judge.largest;
    std::vector<Judge::Verdict> verdict(left.size());
    for (int round = 0; round < most_rounds; ++round) {
        for_each_block(static_cast<Index>(left.size()), 4, [&](const Block& block) {
            for (Index k = block.begin; k < block.end; ++k)
                verdict[static_cast<std::size_t>(k)] = judge.of(left[static_cast<std::size_t>(k)]);
        });
        double next = std::numeric_limits<double>::infinity(); // limit of one that is explained
        for (std::size_t k = 0; k < left.size(); ++k)
            if (verdict[k].part <= 1) next = std::min(next, verdict[k].limit);
        if (next == std::numeric_limits<double>::infinity()) break;
        certain = std::max(certain, more * next);
        std::vector<Index> still;
        for (std::size_t k = 0; k < left.size(); ++k) {
            if (verdict[k].part <= 1 && verdict[k].limit <= certain)
                cloud.trust(left[k], true);
            else
                still.push_back(left[k]);
        }
        left = std::move(still);
    }
}

/// Those that have no more than three others among their eight nearest, nor one that has more
/// beside it: many together are a part of the shape.
std::vector<Index> alone(TrustedCloud& cloud, const std::vector<Index>& left) {
    constexpr Index beside = 8;
    constexpr Index many = 4;
    std::vector<char> out(static_cast<std::size_t>(cloud.size()), 0);
    for (Index i : left) out[static_cast<std::size_t>(i)] = 1;
    for (Index i : left) cloud.trust(i, true);
    std::vector<std::vector<Index>> around;
    for (Index i : left) around.push_back(cloud.nearest(i, beside));
    for (Index i : left) cloud.trust(i, false);
    std::vector<char> crowded(out.size(), 0);
    for (std::size_t k = 0; k < left.size(); ++k)
        crowded[static_cast<std::size_t>(left[k])] =
            std::ranges::count_if(
                around[k], [&](Index i) { return out[static_cast<std::size_t>(i)] != 0; }) >= many;
    std::vector<Index> result;
    for (std::size_t k = 0; k < left.size(); ++k)
        if (!crowded[static_cast<std::size_t>(left[k])] &&
            std::ranges::none_of(
                around[k], [&](Index i) { return crowded[static_cast<std::size_t>(i)] != 0; }))
            result.push_back(left[k]);
    return result;
}

} // namespace

std::vector<Index> cloud_outliers(const Points& points, const Points& places,
                                  const std::vector<double>& least) {
    TrustedCloud cloud(points, places);
    std::vector<Index> left = leave_out(cloud, least);
    std::vector<Index> rest;
    for (Index i = 0; i < cloud.size(); ++i)
        if (cloud.trusts(i)) rest.push_back(i);
    if (rest.size() < left.size()) return {}; // nobody to ask
    std::vector<double> normal(static_cast<std::size_t>(cloud.size()),
                               std::numeric_limits<double>::infinity());
    update(cloud, rest, normal);
    const CloudJudge judge{cloud, least, UsualResidual(normal).largest};
    take_back(cloud, judge, left);
    std::erase_if(left, [&](Index i) { return judge.unresolved(i); });
    return alone(cloud, left);
}

} // namespace batten
