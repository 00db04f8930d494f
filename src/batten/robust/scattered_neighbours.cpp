#include <batten/robust/scattered_neighbours.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace batten {

namespace {

struct Cells {
    std::array<double, 3> low{};
    double width = 1;
    std::array<Index, 3> count{1, 1, 1};
};

/// Cubes over the places' box, four samples to each on the average.
Cells cells_of(const Points& places) {
    Cells result;
    std::array<double, 3> extent{};
    double volume = 1;
    int extended = 0;
    for (Index d = 0; d < places.dim(); ++d) {
        double low = places(0, d);
        double high = low;
        for (Index i = 0; i < places.size(); ++i) {
            low = std::min(low, places(i, d));
            high = std::max(high, places(i, d));
        }
        result.low[static_cast<std::size_t>(d)] = low;
        extent[static_cast<std::size_t>(d)] = high - low;
        if (high > low) {
            volume *= high - low;
            ++extended;
        }
    }
    if (extended == 0) return result;
    result.width = std::pow(volume * 4 / static_cast<double>(places.size()), 1.0 / extended);
    constexpr double most = 1e3; // along an axis
    for (double e : extent) result.width = std::max(result.width, e / most);
    for (std::size_t d = 0; d < 3; ++d)
        result.count[d] = static_cast<Index>(extent[d] / result.width) + 1;
    return result;
}

/// Values of the polynomial terms up to a degree, the constant first.
void terms(std::span<const double> x, int degree, std::vector<double>& value) {
    value.assign(1, 1.0);
    std::size_t begin = 0; // of the terms of the last degree, by their first factor
    std::vector<std::size_t> start(x.size(), 0);
    for (int k = 0; k < degree; ++k) {
        const std::size_t end = value.size();
        std::vector<std::size_t> next(x.size());
        for (std::size_t d = 0; d < x.size(); ++d) {
            next[d] = value.size();
            for (std::size_t j = std::max(begin, start[d]); j < end; ++j)
                value.push_back(x[d] * value[j]);
        }
        start = next;
        begin = end;
    }
}

} // namespace

TrustedCloud::TrustedCloud(Points points, Points places)
    : points_(std::move(points)),
      places_(std::move(places)),
      trusted_(static_cast<std::size_t>(points_.size()), 1),
      cells_({1}) {
    const Cells cells = cells_of(places_);
    low_ = cells.low;
    width_ = cells.width;
    cells_ = GridIndex({cells.count[0], cells.count[1], cells.count[2]});
    first_.assign(static_cast<std::size_t>(cells_.size()) + 1, 0);
    const auto at = [&](Index i) {
        const std::array<Index, 3> c = cell(i);
        return static_cast<std::size_t>(cells_.at({c[0], c[1], c[2], 0}));
    };
    for (Index i = 0; i < size(); ++i) ++first_[at(i) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    order_.resize(static_cast<std::size_t>(size()));
    std::vector<Index> next(first_);
    for (Index i = 0; i < size(); ++i) order_[static_cast<std::size_t>(next[at(i)]++)] = i;
}

std::array<Index, 3> TrustedCloud::cell(Index sample) const {
    std::array<Index, 3> result{};
    for (std::size_t d = 0; d < static_cast<std::size_t>(places_.dim()); ++d)
        result[d] = std::min(
            cells_.length(d) - 1,
            static_cast<Index>((places_(sample, static_cast<Index>(d)) - low_[d]) / width_));
    return result;
}

std::vector<Index> TrustedCloud::nearest(Index sample, Index count) const {
    const std::array<Index, 3> here = cell(sample);
    const Index widest = std::max({cells_.length(0), cells_.length(1), cells_.length(2)});
    std::vector<std::pair<double, Index>> found;
    const auto last = [&] { return found.begin() + count - 1; };
    for (Index ring = 0; ring < widest; ++ring) {
        if (std::ssize(found) >= count) {
            std::ranges::nth_element(found, last());
            if (last()->first < static_cast<double>(ring - 1) * width_) break;
        }
        std::array<Index, 3> low{};
        std::array<Index, 3> high{};
        for (std::size_t d = 0; d < 3; ++d) {
            low[d] = std::max<Index>(0, here[d] - ring);
            high[d] = std::min(cells_.length(d) - 1, here[d] + ring);
        }
        for (Index a = low[0]; a <= high[0]; ++a)
            for (Index b = low[1]; b <= high[1]; ++b)
                for (Index c = low[2]; c <= high[2]; ++c) {
                    if (std::max({std::abs(a - here[0]), std::abs(b - here[1]),
                                  std::abs(c - here[2])}) != ring)
                        continue;
                    const auto k = static_cast<std::size_t>(cells_.at({a, b, c, 0}));
                    for (Index j = first_[k]; j < first_[k + 1]; ++j)
                        if (const Index i = order_[static_cast<std::size_t>(j)];
                            i != sample && trusts(i))
                            found.emplace_back(distance(places_[i], places_[sample]), i);
                }
    }
    std::ranges::sort(found); // by distance, then by index
    std::vector<Index> result;
    for (const auto& [far, i] : found) {
        if (std::ssize(result) >= count && far > (1 + 1e-9) * last()->first) break;
        result.push_back(i);
    }
    return result;
}

Prediction TrustedCloud::predict(Index sample, const Surroundings& by,
                                 std::span<double> off) const {
    const auto dim = static_cast<std::size_t>(places_.dim());
    std::vector<double> value;
    std::vector<double> x(dim, 0);
    terms(x, by.degree, value);
    const auto p = static_cast<Index>(value.size());
    const std::vector<Index> beside = nearest(sample, by.times * p);
    const auto k = static_cast<Index>(beside.size());
    if (k < by.times * p) return {};
    const double scale = distance(places_[beside.back()], places_[sample]);
    if (!(scale > 0)) return {};
    Eigen::MatrixXd a(k, p);
    for (Index j = 0; j < k; ++j) {
        const Index i = beside[static_cast<std::size_t>(j)];
        for (std::size_t d = 0; d < dim; ++d)
            x[d] = (places_(i, static_cast<Index>(d)) - places_(sample, static_cast<Index>(d))) /
                   scale;
        terms(x, by.degree, value);
        for (Index t = 0; t < p; ++t) a(j, t) = value[static_cast<std::size_t>(t)];
    }
    const Eigen::LDLT<Eigen::MatrixXd> factors(a.transpose() * a);
    if (factors.vectorD().minCoeff() < 1e-10 * static_cast<double>(k)) return {};
    const Eigen::VectorXd weight = a * factors.solve(Eigen::VectorXd::Unit(p, 0));
    Prediction result;
    result.gain = std::sqrt(1 + weight.squaredNorm());
    for (Index j = 0; j < k; ++j)
        result.reach +=
            std::abs(weight(j)) *
            std::pow(distance(places_[beside[static_cast<std::size_t>(j)]], places_[sample]),
                     by.degree + 1);
    double square = 0;
    for (Index d = 0; d < points_.dim(); ++d) {
        double sum = 0;
        for (Index j = 0; j < k; ++j)
            sum +=
                weight(j) * (points_(beside[static_cast<std::size_t>(j)], d) - points_(sample, d));
        square += sum * sum;
        if (!off.empty()) off[static_cast<std::size_t>(d)] = sum;
    }
    result.residual = std::sqrt(square);
    return result;
}

} // namespace batten
