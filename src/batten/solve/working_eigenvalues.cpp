#include <batten/solve/working_eigenvalues.hpp>

#include <batten/system/row_sums.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

/// Words for control points that the samples reach hardly or not at all; nothing when there are
/// none. The smallest eigenvalue is at most the smallest diagonal entry, which an iteration started
/// in the range may be slow to show.
std::string ill_determined_words(const NormalSystem& system) {
    const std::vector<double> diagonal = system.diagonal();
    const double largest = *std::max_element(diagonal.begin(), diagonal.end());
    Index none = 0;
    Index few = 0;
    double smallest = largest;
    for (double x : diagonal) {
        none += x == 0 ? 1 : 0;
        few += x > 0 && hardly_reached(x, largest) ? 1 : 0;
        if (x > 0) smallest = std::min(smallest, x);
    }
    if (none + few == 0) return {};
    return fmt::format("ill-determined: {} control points without samples, which stay where they "
                       "start, and {} hardly reached by any "
                       "(eigenvalues of A^T A down to {:.1e} of the largest or less)",
                       none, few, smallest / largest);
}

/// Counts the smallest as `floor` of the largest and says so.
void raise(WorkingEigenvalues& working, double floor) {
    ExtremeEigenvalues& e = working.values;
    working.note +=
        fmt::format("{}the smallest eigenvalue, {:.1e} of the largest, counts as {:g} "
                    "of it: directions below that come slowly, if at all",
                    working.note.empty() ? "" : "; ", std::max(0.0, e.smallest) / e.largest, floor);
    e.smallest = floor * e.largest;
}

/// Whether roughness is a part of the system: products of B-splines are not negative.
bool has_roughness(const NormalSystem& system, const std::vector<double>& sums) {
    constexpr double rounding = 1e-9;
    PointSet ones(system.size(), 1);
    ones.fill(1);
    PointSet image(system.size(), 1);
    system.apply(ones, image);
    for (Index i = 0; i < system.size(); ++i)
        if (image(i, 0) < (1 - rounding) * sums[static_cast<std::size_t>(i)]) return true;
    return false;
}

std::vector<double> inverse_roots(std::vector<double> sums) {
    for (double& x : sums) x = x > 0 ? 1 / std::sqrt(x) : 0;
    return sums;
}

ExtremeEigenvalues row_scaled_extremes(const NormalSystem& system, const std::vector<double>& sums,
                                       double tolerance) {
    const auto factors = system.factors();
    if (factors.empty()) return scaled_eigenvalues(system, inverse_roots(sums), tolerance);
    ExtremeEigenvalues product{1, 1};
    for (const BandedMatrix* gram : factors) {
        const std::vector<double> root = inverse_roots(row_sums(*gram));
        BandedMatrix scaled = *gram;
        for (Index i = 0; i < scaled.size(); ++i)
            for (int k = 0; k <= scaled.bandwidth(); ++k)
                scaled.at(i, k) *= root[static_cast<std::size_t>(i)] *
                                   root[static_cast<std::size_t>((i + k) % scaled.size())];
        const ExtremeEigenvalues e =
            extreme_eigenvalues(scaled, tolerance / static_cast<double>(factors.size()));
        product.largest *= e.largest;
        product.smallest *= e.smallest;
        product.products += e.products;
    }
    return product;
}

} // namespace

bool reaches_all(const NormalSystem& system) {
    const std::vector<double> diagonal = system.diagonal();
    const auto [least, most] = std::ranges::minmax(diagonal);
    return !hardly_reached(least, most);
}

WorkingEigenvalues working_eigenvalues(const NormalSystem& system, double tolerance) {
    constexpr double too_small = 1e-7;
    constexpr double working = 1e-6;
    WorkingEigenvalues result{.values = extreme_eigenvalues(system, tolerance),
                              .note = ill_determined_words(system)};
    const ExtremeEigenvalues& e = result.values;
    result.found = e.smallest;
    result.ill_determined = !result.note.empty() || e.smallest < least_determined * e.largest;
    if (e.smallest < too_small * e.largest) raise(result, working);
    return result;
}

WorkingEigenvalues row_scaled_eigenvalues(const NormalSystem& system, double tolerance) {
    constexpr double working = 1e-3;
    const std::vector<double> sums = row_sums(system);
    WorkingEigenvalues result{.values = row_scaled_extremes(system, sums, tolerance),
                              .note = ill_determined_words(system)};
    const ExtremeEigenvalues& e = result.values;
    result.found = e.smallest;
    result.ill_determined = true;
    if (e.smallest < working * e.largest && !has_roughness(system, sums)) raise(result, working);
    return result;
}

} // namespace batten
