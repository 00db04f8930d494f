#include <batten/robust/cloud_suspects.hpp>

#include <batten/core/distinct.hpp>
#include <batten/core/threads.hpp>
#include <batten/robust/judge.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace batten {

namespace {

using Neighbours = TrustedCloud::Neighbours;

constexpr int most_rounds = 12;

/// Trusted samples whose neighbours these were.
std::vector<Index> around(const TrustedCloud& cloud, const std::vector<Index>& samples) {
    std::vector<Index> result;
    Neighbours near;
    for (Index i : samples) {
        cloud.nearest(i, cloud.process_size() / 2, near);
        for (const auto& [square, beside] : near) result.push_back(beside);
    }
    return distinct(std::move(result));
}

/// Samples that are far off by a parabola through their neighbours, among these.
class ByParabolas {
  public:
    ByParabolas(TrustedCloud& cloud, const std::vector<double>& least)
        : cloud_(cloud), least_(least), normal_(static_cast<std::size_t>(cloud.size())) {}

    /// Leaves them out round by round: what hides behind others is seen without them.
    std::vector<Index> leave_out() {
        std::vector<Index> changed(normal_.size());
        std::iota(changed.begin(), changed.end(), Index{0});
        std::vector<Index> left;
        for (int round = 0; round < most_rounds && !changed.empty(); ++round) {
            const std::vector<Index> now = far_off(changed);
            left.insert(left.end(), now.begin(), now.end());
            changed = around(cloud_, now);
        }
        take_back(left);
        return left;
    }

  private:
    /// Of these samples, whose neighbours are others than before; they are not trusted any more.
    std::vector<Index> far_off(const std::vector<Index>& changed) {
        for_each_block(std::ssize(changed), 1024, [&](const Block& block) {
            Neighbours near;
            for (Index k = block.begin; k < block.end; ++k) {
                const Index i = changed[static_cast<std::size_t>(k)];
                normal_[static_cast<std::size_t>(i)] = cloud_.predict(i, near).normal();
            }
        });
        const UsualResidual usual(normal_);
        std::vector<char> out(changed.size(), 0);
        for_each_block(std::ssize(changed), 1024, [&](const Block& block) {
            Neighbours near;
            for (Index k = block.begin; k < block.end; ++k)
                out[static_cast<std::size_t>(k)] =
                    is_far_off(changed[static_cast<std::size_t>(k)], usual, near) ? 1 : 0;
        });
        std::vector<Index> result;
        for (std::size_t k = 0; k < changed.size(); ++k)
            if (out[k]) result.push_back(changed[k]);
        for (Index i : result) {
            cloud_.trust(i, false);
            normal_[static_cast<std::size_t>(i)] = none;
        }
        return result;
    }

    bool is_far_off(Index sample, const UsualResidual& usual, Neighbours& near) const {
        constexpr double part = 0.67;
        constexpr Index many = 80; // most know nothing of the sample
        const double here = normal_[static_cast<std::size_t>(sample)];
        const double least = least_[static_cast<std::size_t>(cloud_.original(sample))];
        if (!std::isfinite(here) || here <= std::max(least / 3, part * usual.largest)) return false;
        cloud_.nearest(sample, many, near);
        std::vector<double> beside;
        for (const auto& [square, i] : near)
            if (const double x = normal_[static_cast<std::size_t>(i)]; std::isfinite(x))
                beside.push_back(x);
        return here > part * usual.ratio() * median(std::move(beside));
    }

    /// Trusts those that are not far off, as the others beside an outlier's are without it, where
    /// neighbours all around leave no doubt.
    void take_back(std::vector<Index>& left) {
        constexpr double all_around = 1.35; // of the noise; 18 evenly around a sample have 1.1
        const UsualResidual usual(normal_);
        for (int round = 0; round < most_rounds; ++round) {
            std::vector<char> back(left.size(), 0);
            for_each_block(std::ssize(left), 64, [&](const Block& block) {
                Neighbours near;
                for (Index k = block.begin; k < block.end; ++k) {
                    const Index i = left[static_cast<std::size_t>(k)];
                    const Prediction there = cloud_.predict(i, near);
                    normal_[static_cast<std::size_t>(i)] = there.normal();
                    back[static_cast<std::size_t>(k)] =
                        there.gain <= all_around && !is_far_off(i, usual, near) ? 1 : 0;
                }
            });
            std::vector<Index> still;
            for (std::size_t k = 0; k < left.size(); ++k) {
                if (back[k])
                    cloud_.trust(left[k], true);
                else
                    still.push_back(left[k]);
            }
            if (still.size() == left.size()) break;
            left = std::move(still);
        }
    }

    static constexpr double none = std::numeric_limits<double>::infinity();
    TrustedCloud& cloud_;
    const std::vector<double>& least_;
    std::vector<double> normal_;
};

/// A sample that a process is made for.
struct Centre {
    Index sample;
    Neighbours neighbours;

    std::ptrdiff_t nearer_half() const { return std::ssize(neighbours) / 2; }
};

/// Some of these samples, so that each is one or among the nearer half of one's neighbours; of a
/// small cloud all, for what a process was made with can be off by so many deviations only.
std::vector<Centre> cover(const TrustedCloud& cloud, const std::vector<Index>& samples) {
    constexpr Index small = 400;
    std::vector<Centre> result;
    std::vector<char> covered(static_cast<std::size_t>(cloud.size()), 0);
    for (Index i : samples) {
        if (covered[static_cast<std::size_t>(i)] || !cloud.trusts(i)) continue;
        Centre centre{i, {}};
        cloud.nearest(i, cloud.process_size(), centre.neighbours);
        if (cloud.size() > small)
            for (const auto& [square, beside] :
                 std::span(centre.neighbours).first(static_cast<std::size_t>(centre.nearer_half())))
                covered[static_cast<std::size_t>(beside)] = 1;
        result.push_back(std::move(centre));
    }
    return result;
}

/// How far a centre is off in standard deviations without its nearest two, which may be outliers
/// like it.
double without_nearest(const TrustedCloud& cloud, const Centre& centre) {
    constexpr Index others = 2; // in a run
    const Neighbours rest(centre.neighbours.begin() +
                              std::min(others, std::ssize(centre.neighbours)),
                          centre.neighbours.end());
    const LocalProcess process = cloud.process(centre.sample, rest);
    return process.exists() ? process.normal() : 0;
}

/// What is far off by the process around a centre: itself or of the nearer half.
std::vector<Index> far_off(const TrustedCloud& cloud, const Centre& centre) {
    constexpr double usual = 3.5; // standard deviations
    constexpr double part = 0.67; // of the farthest there
    const LocalProcess process = cloud.process(centre.sample, centre.neighbours);
    if (!process.exists()) return {};
    const auto beside = process.of_neighbours().head(centre.nearer_half());
    const double own = std::max(process.normal(), without_nearest(cloud, centre));
    const double limit = std::max(usual, part * std::max(own, beside.maxCoeff()));
    std::vector<Index> result;
    if (own > limit) result.push_back(centre.sample);
    for (Index j = 0; j < beside.size(); ++j)
        if (beside(j) > limit)
            result.push_back(centre.neighbours[static_cast<std::size_t>(j)].place);
    return result;
}

/// What is left over by processes, round by round.
void leave_out_by_processes(TrustedCloud& cloud, std::vector<Index>& left) {
    std::vector<Index> open(static_cast<std::size_t>(cloud.size()));
    std::iota(open.begin(), open.end(), Index{0});
    for (int round = 0; round < most_rounds && !open.empty(); ++round) {
        const std::vector<Centre> centres = cover(cloud, open);
        std::vector<std::vector<Index>> far(centres.size());
        for_each_block(std::ssize(centres), 4, [&](const Block& block) {
            for (Index c = block.begin; c < block.end; ++c)
                far[static_cast<std::size_t>(c)] =
                    far_off(cloud, centres[static_cast<std::size_t>(c)]);
        });
        std::vector<Index> now;
        for (const auto& some : far) now.insert(now.end(), some.begin(), some.end());
        now = distinct(std::move(now));
        for (Index i : now) cloud.trust(i, false);
        left.insert(left.end(), now.begin(), now.end());
        open = around(cloud, now);
    }
}

} // namespace

std::vector<Index> leave_out_suspects(TrustedCloud& cloud, const std::vector<double>& least) {
    constexpr Index few = 20000; // what processes for all of them cost is no matter
    std::vector<Index> left = ByParabolas(cloud, least).leave_out();
    if (4 * std::ssize(left) > cloud.size()) { // they know nothing
        for (Index i : left) cloud.trust(i, true);
        left.clear();
    }
    if (cloud.size() <= few) leave_out_by_processes(cloud, left);
    return left;
}

} // namespace batten
