#include <batten/system/system_sums.hpp>

#include <batten/system/factored_system.hpp>
#include <batten/system/stencil_system.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace batten {

namespace {

/// Axes along which two lists of matrices, one per axis, differ.
std::vector<std::size_t> differing(const std::vector<BandedMatrix>& a,
                                   const std::vector<BandedMatrix>& b) {
    std::vector<std::size_t> result;
    for (std::size_t k = 0; k < a.size(); ++k)
        if (a[k] != b[k]) result.push_back(k);
    return result;
}

void check_alike(const SystemSums& a, const SystemSums& b) {
    const auto refuse = [](const std::string& what, const auto& one, const auto& other) {
        throw InvalidInput(fmt::format("{}: {} and {}; only systems over the same knots add up",
                                       what, one, other));
    };
    if (a.axes.size() != b.axes.size()) refuse("number of axes", a.axes.size(), b.axes.size());
    if (a.centre.size() != b.centre.size())
        refuse("coordinates of the points", a.centre.size(), b.centre.size());
    for (std::size_t k = 0; k < a.axes.size(); ++k) {
        const KnotVector& one = a.axes[k];
        const KnotVector& other = b.axes[k];
        const std::string axis = fmt::format("axis {}", k);
        if (one.degree() != other.degree()) refuse(axis + ": degree", one.degree(), other.degree());
        if (one.closed() != other.closed())
            refuse(axis, one.closed() ? "closed" : "open", other.closed() ? "closed" : "open");
        if (one.free_count() != other.free_count())
            refuse(axis + ": control points", one.free_count(), other.free_count());
        for (Index i = 0; i < std::ssize(one.knots()); ++i)
            if (one[i] != other[i]) refuse(fmt::format("{}: knot {}", axis, i), one[i], other[i]);
    }
}

void add(std::vector<double>& to, const std::vector<double>& from) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

/// The sums that every system has.
void add_common(SystemSums& to, const SystemSums& from) {
    to.samples += from.samples;
    to.weight += from.weight;
    to.energy += from.energy;
    add(to.rhs.values(), from.rhs.values());
    for (Index d = 0; d < std::min(to.box.dim(), from.box.dim()); ++d) {
        to.box(0, d) = std::min(to.box(0, d), from.box(0, d));
        to.box(1, d) = std::max(to.box(1, d), from.box(1, d));
    }
}

/// Of grids with parameters of their own along one axis at most, the means of both together: as the
/// others have the same numbers of parameters, those along it are as the numbers of samples.
std::vector<BandedMatrix> means_of_both(const SystemSums& a, const SystemSums& b) {
    if (a.grid_means.empty() || b.grid_means.empty()) return {};
    const std::vector<std::size_t> own = differing(a.grid_means, b.grid_means);
    std::vector<BandedMatrix> result = a.grid_means;
    if (own.size() > 1) return {};
    if (own.empty()) return result;
    BandedMatrix& mean = result[own[0]];
    const auto m = static_cast<double>(a.samples);
    const auto n = static_cast<double>(b.samples);
    mean.divide((m + n) / m);
    mean.add(n / (m + n), b.grid_means[own[0]]);
    return result;
}

SystemSums spelled_out(SystemSums sums) {
    if (sums.factors.empty()) return sums;
    const PointSet box = sums.box;
    SystemSums result = StencilSystem(std::move(sums)).sums();
    result.box = box;
    return result;
}

} // namespace

SystemSums sums_of(const NormalSystem& system, const Samples& samples) {
    SystemSums result = system.sums();
    result.box = bounding_box(samples.points);
    result.weight = static_cast<double>(samples.size());
    if (!samples.weights.empty())
        result.weight = std::accumulate(samples.weights.begin(), samples.weights.end(), 0.0);
    return result;
}

std::unique_ptr<NormalSystem> system_of(SystemSums sums) {
    if (sums.factors.empty()) return std::make_unique<StencilSystem>(std::move(sums));
    return std::make_unique<FactoredSystem>(std::move(sums));
}

SystemSums recentred(SystemSums sums, const std::vector<double>& centre) {
    if (centre == sums.centre) return sums;
    const auto system = system_of(sums);
    PointSet ones(system->size(), 1);
    ones.fill(1);
    PointSet weights(system->size(), 1); // of the samples at each B-spline: A^T D 1
    system->apply(ones, weights);
    for (std::size_t d = 0; d < centre.size(); ++d) {
        const double shift = sums.centre[d] - centre[d];
        double pull = 0; // sum of weight (Q - c)
        for (Index i = 0; i < sums.rhs.size(); ++i) {
            double& right = sums.rhs(i, static_cast<Index>(d));
            pull += right;
            right += shift * weights(i, 0);
        }
        sums.energy += shift * (2 * pull + shift * sums.weight);
    }
    sums.centre = centre;
    return sums;
}

SystemSums merged(SystemSums first, const SystemSums& second) {
    check_alike(first, second);
    SystemSums other = recentred(second, first.centre);
    const bool products = !first.factors.empty() && !other.factors.empty();
    const std::vector<std::size_t> own =
        products ? differing(first.factors, other.factors) : std::vector<std::size_t>{};
    if (products && own.size() <= 1) { // (U1 x V) + (U2 x V) = (U1 + U2) x V
        const std::size_t axis = own.empty() ? 0 : own[0];
        first.factors[axis].add(1, other.factors[axis]);
        add_common(first, other);
        return first;
    }
    first = spelled_out(std::move(first));
    other = spelled_out(std::move(other));
    first.grid_means = means_of_both(first, other);
    add(first.stencil, other.stencil);
    for (std::size_t k = 0; k < first.axis_sums.size(); ++k)
        first.axis_sums[k].add(1, other.axis_sums[k]);
    add_common(first, other);
    return first;
}

ResidualEnergy residual_energy(const NormalSystem& system, const PointSet& control) {
    // the sums were added up in blocks: their rounding grows with the square root of the terms
    const double terms = std::sqrt(static_cast<double>(system.sample_count()));
    const double unit = std::numeric_limits<double>::epsilon() * (8 + terms / 8);
    const double drawn = system.energy(control);
    const double rounding = unit * (system.data_energy() + std::abs(drawn));
    return {std::max(0.0, system.data_energy() + drawn), rounding};
}

} // namespace batten
