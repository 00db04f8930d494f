#include <batten/robust/outliers.hpp>

#include <batten/measure/deviation.hpp>
#include <batten/robust/robust_fit.hpp>
#include <batten/samples/noise.hpp>
#include <batten/search/tolerance.hpp>

#include <algorithm>
#include <array>
#include <map>

namespace batten {

namespace {

/// Median residual of the samples around each one: up to 4 places away along a sequence, 2 along
/// a grid's axes.
std::vector<double> around(const Samples& samples, const std::vector<double>& residual) {
    const GridIndex grid(samples.shape());
    const Index reach = grid.axis_count() == 1 ? 4 : 2;
    std::vector<double> result(residual.size());
    for_each_chunk(samples.size(), [&](Index i) {
        const GridIndex::Place here = grid.place(i);
        GridIndex::Place low{};
        std::vector<Index> window;
        for (std::size_t k = 0; k < grid.axis_count(); ++k) {
            low[k] = std::max<Index>(0, here[k] - reach);
            window.push_back(std::min(grid.length(k), here[k] + reach + 1) - low[k]);
        }
        const Index first = grid.at(low);
        std::vector<double> values;
        GridIndex(window).for_each([&](const GridIndex::Place& place, Index) {
            const Index j = first + grid.at(place);
            if (j != i) values.push_back(residual[static_cast<std::size_t>(j)]);
        });
        result[static_cast<std::size_t>(i)] = median(std::move(values));
    });
    return result;
}

/// The same for a cloud: of the samples in the same cell of the knots.
std::vector<double> around(const Parameters& parameters, const std::vector<KnotVector>& axes,
                           const std::vector<double>& residual) {
    std::map<std::array<Index, 3>, std::vector<double>> cells;
    const auto cell_of = [&](Index i) {
        std::array<Index, 3> cell{};
        for (std::size_t k = 0; k < axes.size(); ++k)
            cell[k] = axes[k].span(axes[k].wrapped(parameters.scattered(i, static_cast<Index>(k))));
        return cell;
    };
    const auto m = static_cast<Index>(residual.size());
    for (Index i = 0; i < m; ++i)
        cells[cell_of(i)].push_back(residual[static_cast<std::size_t>(i)]);
    std::map<std::array<Index, 3>, double> medians;
    for (auto& [cell, values] : cells) medians[cell] = median(std::move(values));
    std::vector<double> result;
    for (Index i = 0; i < m; ++i) result.push_back(medians[cell_of(i)]);
    return result;
}

std::vector<bool> protected_samples(const Samples& samples, const HoldOptions& hold) {
    std::vector<bool> result(static_cast<std::size_t>(samples.size()), false);
    const auto protect = [&](Index i) {
        if (i >= 0 && i < samples.size()) result[static_cast<std::size_t>(i)] = true;
    };
    for (Index i : hold.interpolate) protect(i);
    for (const HeldTangent& tangent : hold.tangents) protect(tangent.sample);
    return result;
}

/// The residual that a sample may have in any case: its tolerance, or a small part of the data's
/// size.
std::vector<double> least_residuals(const Samples& samples, const FitOptions& options) {
    if (options.tolerance.stated()) return sample_tolerances(samples, options.tolerance);
    return std::vector<double>(static_cast<std::size_t>(samples.size()),
                               1e-4 * diagonal(samples.points));
}

/// A robust fit, its values at the samples, and which samples are far from it.
struct Judgement {
    Spline spline;
    PointSet fitted;
    double usual; ///< six times the residuals' scale
    std::vector<Index> outliers;
};

Judgement judge(const Samples& samples, const FitOptions& options) {
    const Parameters parameters = robust_parameters(samples, options);
    const bool cloud = parameters.is_scattered();
    const std::vector<double> least = least_residuals(samples, options);
    const std::vector<KnotVector> knots = robust_knots(samples, parameters, options);
    Judgement result{
        robust_spline(samples, parameters, knots, *std::ranges::min_element(least)), {}, 0, {}};
    result.fitted = fitted_values(result.spline, parameters);
    std::vector<double> residual;
    for (Index i = 0; i < samples.size(); ++i)
        residual.push_back(distance(samples.points[i], result.fitted[i]));
    const std::vector<double> near =
        cloud ? around(parameters, knots, residual) : around(samples, residual);
    result.usual = 6 * 1.4826 * median(residual);
    const std::vector<bool> held = protected_samples(samples, options.hold);
    for (std::size_t i = 0; i < residual.size(); ++i)
        if (!held[i] && residual[i] > std::max({least[i], result.usual, 5 * near[i]}))
            result.outliers.push_back(static_cast<Index>(i));
    return result;
}

template <class Value>
void keep_only(std::vector<Value>& values, const std::vector<Index>& kept) {
    if (values.empty()) return;
    std::vector<Value> result;
    for (Index i : kept) result.push_back(values[static_cast<std::size_t>(i)]);
    values = std::move(result);
}

PointSet rows_of(const Points& points, const std::vector<Index>& kept) {
    PointSet result(static_cast<Index>(kept.size()), points.dim());
    for (Index i = 0; i < result.size(); ++i)
        std::ranges::copy(points[kept[static_cast<std::size_t>(i)]], result[i].begin());
    return result;
}

} // namespace

std::vector<Index> find_outliers(const Samples& samples, const FitOptions& options) {
    std::vector<Index> outliers = judge(samples, options).outliers;
    if (!samples.grid.empty()) return outliers;
    // far samples stretch the chords that parameters come from, and take neighbours along: fits
    // without them tell which of all samples are far indeed
    const std::vector<double> least = least_residuals(samples, options);
    constexpr int most_rounds = 5;
    for (int round = 0; round < most_rounds && !outliers.empty(); ++round) {
        const WithoutOutliers rest = without_outliers(samples, options, outliers);
        if (rest.samples.size() < 8) break;
        const Judgement now = judge(rest.samples, rest.options);
        std::vector<Index> next;
        for (Index i : now.outliers) next.push_back(rest.kept[static_cast<std::size_t>(i)]);
        if (now.spline.axis_count() < 3) {
            const std::vector<ClosestPoint> closest =
                closest_points(now.spline, rows_of(samples.points, outliers));
            for (std::size_t k = 0; k < outliers.size(); ++k)
                if (closest[k].distance >
                    std::max(least[static_cast<std::size_t>(outliers[k])], now.usual))
                    next.push_back(outliers[k]);
        }
        std::ranges::sort(next);
        if (next == outliers) break;
        outliers = std::move(next);
    }
    return outliers;
}

WithoutOutliers without_outliers(const Samples& samples, const FitOptions& options,
                                 const std::vector<Index>& outliers) {
    WithoutOutliers result{samples, options, {}};
    std::vector<bool> out(static_cast<std::size_t>(samples.size()), false);
    for (Index i : outliers) out[static_cast<std::size_t>(i)] = true;
    if (!samples.grid.empty()) {
        ToleranceOptions& tolerance = result.options.tolerance;
        if (tolerance.stated() && tolerance.per_sample.empty())
            tolerance.per_sample.assign(out.size(), tolerance.value);
        const PointSet fitted = judge(samples, options).fitted;
        PointSet points(samples.points);
        for (Index i : outliers) {
            std::ranges::copy(fitted[i], points[i].begin());
            if (tolerance.stated()) tolerance.per_sample[static_cast<std::size_t>(i)] = 1e300;
        }
        result.samples.points = std::move(points);
        return result;
    }
    for (Index i = 0; i < samples.size(); ++i)
        if (!out[static_cast<std::size_t>(i)]) result.kept.push_back(i);
    const auto moved = [&](Index& i) {
        if (i >= 0 && i < samples.size())
            i = std::ranges::lower_bound(result.kept, i) - result.kept.begin();
    };
    result.samples.points = rows_of(samples.points, result.kept);
    keep_only(result.samples.weights, result.kept);
    keep_only(result.options.tolerance.per_sample, result.kept);
    if (auto& given = result.options.shape.parameters) {
        if (given->is_scattered())
            given->scattered = rows_of(given->scattered, result.kept);
        else
            keep_only(given->axes[0], result.kept);
    }
    for (Index& i : result.options.hold.interpolate) moved(i);
    for (HeldTangent& tangent : result.options.hold.tangents) moved(tangent.sample);
    for (Index& i : result.options.tolerance.corner_samples) moved(i);
    return result;
}

void account_for(const Samples& samples, const FitOptions& options, const WithoutOutliers& rest,
                 const std::vector<Index>& outliers, FitResult& result) {
    FitReport& report = result.report;
    report.set_aside = outliers;
    if (!samples.grid.empty()) {
        if (!outliers.empty())
            report.notes.push_back(
                "samples set aside count as the robust fit's values in the grid's equations");
        return;
    }
    report.samples = samples.size();
    const auto original = [&](Index i) { return rest.kept[static_cast<std::size_t>(i)]; };
    report.deviation.worst_sample = original(report.deviation.worst_sample);
    Parameters& parameters = result.parameters;
    if (parameters.is_scattered()) {
        parameters = *options.shape.parameters;
        return;
    }
    // a sample set aside gets a parameter between those of the neighbours that were kept
    const std::vector<double>& t = parameters.axes[0];
    std::vector<double> all;
    std::size_t next = 0;
    for (Index i = 0; i < samples.size(); ++i) {
        const bool here = next < rest.kept.size() && rest.kept[next] == i;
        if (here)
            all.push_back(t[next++]);
        else if (next == 0)
            all.push_back(t.front());
        else if (next == t.size())
            all.push_back(t.back());
        else {
            const double part = static_cast<double>(i - rest.kept[next - 1]) /
                                static_cast<double>(rest.kept[next] - rest.kept[next - 1]);
            all.push_back(t[next - 1] + part * (t[next] - t[next - 1]));
        }
    }
    parameters.axes[0] = std::move(all);
}

} // namespace batten
