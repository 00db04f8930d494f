#include <batten/robust/cloud_outliers.hpp>

#include <batten/core/distinct.hpp>
#include <batten/robust/judge.hpp>
#include <batten/robust/scattered_neighbours.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace batten {

namespace {

using Neighbours = TrustedCloud::Neighbours;

/// Samples that are far off among their neighbours.
class Suspected {
  public:
    Suspected(TrustedCloud& cloud, const std::vector<double>& least)
        : cloud_(cloud), least_(least), normal_(static_cast<std::size_t>(cloud.size())) {}

    /// Leaves them out round by round: what hides behind others is seen without them.
    std::vector<Index> leave_out() {
        constexpr int most_rounds = 12;
        std::vector<Index> changed(normal_.size());
        std::iota(changed.begin(), changed.end(), Index{0});
        std::vector<Index> left;
        for (int round = 0; round < most_rounds && !changed.empty(); ++round) {
            const std::vector<Index> now = far_off(changed);
            left.insert(left.end(), now.begin(), now.end());
            changed = around(now);
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
        constexpr int most_rounds = 12;
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

    /// Trusted samples whose neighbours these were.
    std::vector<Index> around(const std::vector<Index>& samples) const {
        std::vector<Index> result;
        Neighbours near;
        for (Index i : samples) {
            cloud_.nearest(i, cloud_.process_size() / 2, near);
            for (const auto& [square, beside] : near) result.push_back(beside);
        }
        return distinct(std::move(result));
    }

    static constexpr double none = std::numeric_limits<double>::infinity();
    TrustedCloud& cloud_;
    const std::vector<double>& least_;
    std::vector<double> normal_;
};

/// A sample that is not trusted and what its neighbours say of it.
struct Accused {
    Index sample;
    Neighbours neighbours;
    double part = 0;                                        ///< the residual in limits
    double limit = std::numeric_limits<double>::infinity(); ///< how far off it might be; infinite
                                                            ///< where nobody knows
};

/// Anew where the neighbours are others than before.
void judge(const TrustedCloud& cloud, double least, Accused& accused) {
    constexpr double usual = 6;    // standard deviations
    constexpr double beside = 2.5; // times what the process is off at one of the nearer half
    Neighbours neighbours;
    cloud.nearest(accused.sample, cloud.process_size(), neighbours);
    const bool same =
        std::ranges::equal(neighbours, accused.neighbours, {}, &TrustedCloud::Neighbour::sample,
                           &TrustedCloud::Neighbour::sample);
    if (same && std::isfinite(accused.limit)) return;
    accused.neighbours = std::move(neighbours);
    const LocalProcess process = cloud.process(accused.sample, accused.neighbours);
    accused.part = 0;
    accused.limit = std::numeric_limits<double>::infinity();
    if (!process.exists()) return;
    const double worst = process.of_neighbours().maxCoeff();
    accused.limit = std::max(least, std::max(usual, beside * worst) * process.deviation());
    accused.part = process.residual() / accused.limit;
}

/// Trusts those that are explained, the most certain first; those that nobody knows stay, too.
void take_back(TrustedCloud& cloud, const std::vector<double>& least, std::vector<Accused>& left) {
    constexpr int most_rounds = 40;
    constexpr double more = 1.5;
    double certain = 0;
    for (int round = 0; round < most_rounds; ++round) {
        for_each_block(std::ssize(left), 4, [&](const Block& block) {
            for (Index k = block.begin; k < block.end; ++k) {
                Accused& accused = left[static_cast<std::size_t>(k)];
                judge(cloud, least[static_cast<std::size_t>(cloud.original(accused.sample))],
                      accused);
            }
        });
        const auto explained = [](const Accused& a) { return a.part <= 1; };
        double next = std::numeric_limits<double>::infinity();
        for (const Accused& a : left)
            if (explained(a)) next = std::min(next, a.limit);
        if (next == std::numeric_limits<double>::infinity()) break;
        certain = std::max(certain, more * next);
        std::erase_if(left, [&](const Accused& a) {
            if (!explained(a) || a.limit > certain) return false;
            cloud.trust(a.sample, true);
            return true;
        });
    }
    std::erase_if(left, [](const Accused& a) { return !std::isfinite(a.limit); });
}

/// Those that have no more than three others among their eight nearest, nor one that has more
/// beside it: many together are a part of the shape.
std::vector<Index> alone(TrustedCloud& cloud, const std::vector<Accused>& left) {
    constexpr Index beside = 8;
    constexpr Index many = 4;
    std::vector<char> out(static_cast<std::size_t>(cloud.size()), 0);
    for (const Accused& a : left) {
        out[static_cast<std::size_t>(a.sample)] = 1;
        cloud.trust(a.sample, true);
    }
    std::vector<Neighbours> around(left.size());
    for (std::size_t k = 0; k < left.size(); ++k) cloud.nearest(left[k].sample, beside, around[k]);
    std::vector<char> crowded(out.size(), 0);
    for (std::size_t k = 0; k < left.size(); ++k)
        crowded[static_cast<std::size_t>(left[k].sample)] =
            std::ranges::count_if(around[k], [&](const auto& n) {
                return out[static_cast<std::size_t>(n.sample)] != 0;
            }) >= many;
    std::vector<Index> result;
    for (std::size_t k = 0; k < left.size(); ++k)
        if (!crowded[static_cast<std::size_t>(left[k].sample)] &&
            std::ranges::none_of(around[k], [&](const auto& n) {
                return crowded[static_cast<std::size_t>(n.sample)] != 0;
            }))
            result.push_back(cloud.original(left[k].sample));
    std::ranges::sort(result);
    return result;
}

} // namespace

std::vector<Index> cloud_outliers(const Points& points, const Points& places,
                                  const std::vector<double>& least) {
    TrustedCloud cloud(points, places);
    std::vector<Accused> left;
    for (Index i : Suspected(cloud, least).leave_out()) left.push_back({i, {}});
    if (2 * std::ssize(left) > cloud.size()) return {}; // nobody to ask
    take_back(cloud, least, left);
    return alone(cloud, left);
}

} // namespace batten
