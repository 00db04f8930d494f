#include <batten/robust/cloud_metric.hpp>

#include <batten/core/threads.hpp>
#include <batten/samples/noise.hpp>
#include <batten/samples/samples.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace batten {

namespace {

using Neighbours = TrustedCloud::Neighbours;

/// Medians of each coordinate of what ask(sample, neighbours, answer) says of samples from
/// everywhere.
template <class Ask>
std::vector<double> usual(const TrustedCloud& cloud, const Ask& ask) {
    constexpr Index most = 400;
    const Index count = std::min(most, cloud.size());
    const Index dim = cloud.points().dim();
    PointSet answers(count, dim);
    for_each_block(count, 16, [&](const Block& block) {
        Neighbours near;
        for (Index k = block.begin; k < block.end; ++k)
            ask((2 * k + 1) * cloud.size() / (2 * count), near, answers[k]);
    });
    std::vector<double> medians;
    for (Index d = 0; d < dim; ++d) {
        std::vector<double> values;
        for (Index k = 0; k < count; ++k) values.push_back(answers(k, d));
        medians.push_back(median(std::move(values)));
    }
    return medians;
}

/// Half of the smallest step from a sample to one beside it: what rounded coordinates may be off.
std::vector<double> half_steps(const TrustedCloud& cloud) {
    constexpr Index beside = 16;
    return usual(cloud, [&](Index sample, Neighbours& near, std::span<double> answer) {
        cloud.nearest(sample, beside, near);
        for (Index d = 0; d < std::ssize(answer); ++d) {
            double least = std::numeric_limits<double>::infinity();
            for (const auto& [square, i] : near)
                if (const double step = std::abs(cloud.points()(i, d) - cloud.points()(sample, d));
                    step > 0)
                    least = std::min(least, step);
            answer[static_cast<std::size_t>(d)] = std::isfinite(least) ? least / 2 : 0;
        }
    });
}

/// What samples are off by their neighbours beyond what they may be.
double usual_error(const TrustedCloud& cloud, const std::vector<double>& may_be) {
    const std::vector<double> off =
        usual(cloud, [&](Index sample, Neighbours& near, std::span<double> answer) {
            const bool exists = cloud.predict(sample, near, answer).exists();
            for (double& x : answer)
                x = exists ? std::abs(x) : std::numeric_limits<double>::infinity();
        });
    double square = 0;
    for (std::size_t d = 0; d < off.size(); ++d)
        if (off[d] > may_be[d]) square += off[d] * off[d];
    return std::sqrt(square);
}

/// The parameters over [0, 1], times a metric.
PointSet unit_places(const Points& places, const Metric& metric) {
    const PointSet box = bounding_box(places);
    PointSet result(places);
    for (Index d = 0; d < places.dim(); ++d) {
        const double extent = box(1, d) - box(0, d);
        const double scale = metric[static_cast<std::size_t>(d)];
        for (Index i = 0; i < places.size(); ++i)
            result(i, d) = extent > 0 ? scale * ((places(i, d) - box(0, d)) / extent) : 0;
    }
    return result;
}

/// What is less than `negligible` off is as good as nothing.
Metric best_metric(TrustedCloud& cloud, double negligible) {
    constexpr int farthest = 10;
    constexpr double as_good = 1.1;
    const std::vector<double> may_be = half_steps(cloud);
    Metric metric{1, 1, 1};
    std::array<double, 2 * farthest + 1> errors{};
    for (std::size_t axis = 1; axis < static_cast<std::size_t>(cloud.axes()); ++axis) {
        for (int power = -farthest; power <= farthest; ++power) {
            metric[axis] = std::ldexp(1.0, power);
            cloud.measure_by(metric);
            errors[static_cast<std::size_t>(power + farthest)] = usual_error(cloud, may_be);
        }
        const double good = as_good * std::max(negligible, std::ranges::min(errors));
        int best = farthest + 1;
        for (int power = -farthest; power <= farthest; ++power)
            if (errors[static_cast<std::size_t>(power + farthest)] <= good &&
                std::abs(power) < std::abs(best))
                best = power;
        metric[axis] = best > farthest ? 1 : std::ldexp(1.0, best);
    }
    cloud.measure_by(metric);
    return metric;
}

} // namespace

TrustedCloud cloud_by_best_metric(const Points& points, const Points& places) {
    constexpr double rounding = 1e-12;
    constexpr Metric plain{1, 1, 1};
    TrustedCloud cloud(points, unit_places(places, plain));
    const Metric metric = best_metric(cloud, rounding * diagonal(points));
    if (metric == plain) return cloud;
    return {points, unit_places(places, metric)};
}

} // namespace batten
