#include <batten/robust/cloud_outliers.hpp>

#include <batten/core/threads.hpp>
#include <batten/robust/cloud_metric.hpp>
#include <batten/robust/cloud_suspects.hpp>
#include <batten/robust/trusted_cloud.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace batten {

namespace {

using Neighbours = TrustedCloud::Neighbours;

/// A sample that is not trusted and what its neighbours say of it.
struct Accused {
    Index sample;
    Neighbours neighbours;
    Eigen::VectorXd way{};                                  ///< to where they have it
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
        std::ranges::equal(neighbours, accused.neighbours, {}, &PlaceTree::Neighbour::place,
                           &PlaceTree::Neighbour::place);
    if (same && std::isfinite(accused.limit)) return;
    accused.neighbours = std::move(neighbours);
    const LocalProcess process = cloud.process(accused.sample, accused.neighbours);
    accused.part = 0;
    accused.limit = std::numeric_limits<double>::infinity();
    if (!process.exists()) return;
    const double worst = process.of_neighbours().maxCoeff();
    accused.limit = std::max(least, std::max(usual, beside * worst) * process.deviation());
    accused.part = process.residual() / accused.limit;
    accused.way = process.way();
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

/// Trusts the least of them, too, until they are no more than an eighth of a small cloud: some of
/// its samples agree by chance.
void take_back_of_few(TrustedCloud& cloud, const std::vector<double>& least,
                      std::vector<Accused>& left) {
    constexpr Index few = 100;
    take_back(cloud, least, left);
    while (cloud.size() < few && std::ssize(left) > std::max<Index>(1, cloud.size() / 8)) {
        const auto weakest = std::ranges::min_element(left, {}, &Accused::part);
        cloud.trust(weakest->sample, true);
        left.erase(weakest);
        take_back(cloud, least, left);
    }
}

/// Those that have no more than three others among their eight nearest, nor one that has more
/// beside it: many together are a part of the shape.
std::vector<Accused> alone(TrustedCloud& cloud, std::vector<Accused> left) {
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
                return out[static_cast<std::size_t>(n.place)] != 0;
            }) >= many;
    std::vector<Accused> result;
    for (std::size_t k = 0; k < left.size(); ++k)
        if (!crowded[static_cast<std::size_t>(left[k].sample)] &&
            std::ranges::none_of(around[k], [&](const auto& n) {
                return crowded[static_cast<std::size_t>(n.place)] != 0;
            }))
            result.push_back(std::move(left[k]));
    return result;
}

} // namespace

NeighbourOutliers cloud_outliers(const Points& points, const Points& places,
                                 const std::vector<double>& least) {
    TrustedCloud cloud = cloud_by_best_metric(points, places);
    std::vector<Accused> left;
    for (Index i : leave_out_suspects(cloud, least)) left.push_back({i, {}});
    if (2 * std::ssize(left) > cloud.size()) return {}; // nobody to ask
    take_back_of_few(cloud, least, left);
    left = alone(cloud, std::move(left));
    std::ranges::sort(left, {}, [&](const Accused& a) { return cloud.original(a.sample); });
    NeighbourOutliers result{{}, PointSet(std::ssize(left), points.dim())};
    for (const Accused& a : left) {
        const auto predicted = result.predicted[std::ssize(result.samples)];
        const Index sample = cloud.original(a.sample);
        for (Index d = 0; d < points.dim(); ++d)
            predicted[static_cast<std::size_t>(d)] = points(sample, d) + a.way(d);
        result.samples.push_back(sample);
    }
    return result;
}

} // namespace batten
