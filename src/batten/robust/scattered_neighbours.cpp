#include <batten/robust/scattered_neighbours.hpp>

#include <batten/samples/samples.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace batten {

namespace {

constexpr double per_cell = 4; ///< samples, on the average

struct Cells {
    std::array<double, 3> low{};
    double width = 1;
    std::array<Index, 3> count{1, 1, 1};
};

/// Cubes over the places' box.
Cells cells_of(const Points& places) {
    Cells result;
    std::array<double, 3> extent{};
    double volume = 1;
    int extended = 0;
    const PointSet box = bounding_box(places);
    for (Index d = 0; d < places.dim(); ++d) {
        const double low = box(0, d);
        const double high = box(1, d);
        result.low[static_cast<std::size_t>(d)] = low;
        extent[static_cast<std::size_t>(d)] = high - low;
        if (high > low) {
            volume *= high - low;
            ++extended;
        }
    }
    if (extended == 0) return result;
    result.width = std::pow(volume * per_cell / static_cast<double>(places.size()), 1.0 / extended);
    constexpr double most = 1e3; // along an axis
    for (double e : extent) result.width = std::max(result.width, e / most);
    for (std::size_t d = 0; d < 3; ++d)
        result.count[d] = static_cast<Index>(extent[d] / result.width) + 1;
    return result;
}

constexpr int parabola_terms(int axes) {
    return 1 + axes + axes * (axes + 1) / 2;
}

constexpr Index per_term = 3; ///< neighbours that make a parabola

/// What least squares by a polynomial of second degree over so many axes miss of a sample.
template <int axes>
Prediction by_parabola(const Points& points, const Points& places, Index sample,
                       const TrustedCloud::Neighbours& neighbours) {
    constexpr int terms = parabola_terms(axes);
    using Terms = Eigen::Matrix<double, terms, 1>;
    if (std::ssize(neighbours) < per_term * terms) return {};
    const double scale = 1 / std::sqrt(neighbours.back().square);
    if (!std::isfinite(scale)) return {};
    const auto terms_at = [&](Index i) {
        Terms value;
        value(0) = 1;
        for (int d = 0; d < axes; ++d) value(1 + d) = scale * (places(i, d) - places(sample, d));
        int t = 1 + axes;
        for (int d = 0; d < axes; ++d)
            for (int e = d; e < axes; ++e) value(t++) = value(1 + d) * value(1 + e);
        return value;
    };
    Eigen::Matrix<double, terms, terms> normal = Eigen::Matrix<double, terms, terms>::Zero();
    for (const auto& [square, i] : neighbours) {
        const Terms value = terms_at(i);
        normal.noalias() += value * value.transpose();
    }
    const Eigen::LDLT<Eigen::Matrix<double, terms, terms>> factors(normal);
    if (factors.vectorD().minCoeff() < 1e-10 * static_cast<double>(neighbours.size())) return {};
    const Terms at_sample = factors.solve(Terms::Unit(0));
    double sum_of_squares = 0;
    for (Index k = 0; k < points.dim(); ++k) {
        double off = 0;
        for (const auto& [square, i] : neighbours)
            off += at_sample.dot(terms_at(i)) * (points(i, k) - points(sample, k));
        sum_of_squares += off * off;
    }
    return {std::sqrt(sum_of_squares), std::sqrt(1 + at_sample(0))};
}

} // namespace

TrustedCloud::TrustedCloud(const Points& points, const Points& places)
    : points_(points.size(), points.dim()),
      places_(places.size(), places.dim()),
      order_(static_cast<std::size_t>(points.size())),
      trusted_(order_.size(), 1),
      cells_({1}) {
    const Cells cells = cells_of(places);
    low_ = cells.low;
    width_ = cells.width;
    Cell count{1, 1, 1};
    for (std::size_t d = 0; d < static_cast<std::size_t>(places.dim()); ++d)
        count[3 - static_cast<std::size_t>(places.dim()) + d] = cells.count[d];
    cells_ = GridIndex({count[0], count[1], count[2]});
    std::vector<Index> cell_of(order_.size());
    first_.assign(static_cast<std::size_t>(cells_.size()) + 1, 0);
    for (Index i = 0; i < size(); ++i) {
        const Cell c = cell(places[i]);
        const Index at = cells_.at({c[0], c[1], c[2], 0});
        cell_of[static_cast<std::size_t>(i)] = at;
        ++first_[static_cast<std::size_t>(at) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<Index> next(first_);
    for (Index i = 0; i < size(); ++i) {
        const Index to = next[static_cast<std::size_t>(cell_of[static_cast<std::size_t>(i)])]++;
        order_[static_cast<std::size_t>(to)] = i;
        std::ranges::copy(points[i], points_[to].begin());
        std::ranges::copy(places[i], places_[to].begin());
    }
}

TrustedCloud::Cell TrustedCloud::cell(std::span<const double> place) const {
    Cell result{};
    for (std::size_t d = 0; d < place.size(); ++d) {
        const std::size_t axis = 3 - place.size() + d;
        result[axis] =
            std::min(cells_.length(axis) - 1, static_cast<Index>((place[d] - low_[d]) / width_));
    }
    return result;
}

/// How far everything is within those cells, both ends counted.
double TrustedCloud::clear(Index sample, const Cell& low, const Cell& high) const {
    double result = std::numeric_limits<double>::infinity();
    const std::span<const double> place = std::as_const(places_)[sample];
    for (std::size_t d = 0; d < place.size(); ++d) {
        const std::size_t axis = 3 - place.size() + d;
        const double at = place[d] - low_[d];
        if (low[axis] > 0) result = std::min(result, at - static_cast<double>(low[axis]) * width_);
        if (high[axis] < cells_.length(axis) - 1)
            result = std::min(result, static_cast<double>(high[axis] + 1) * width_ - at);
    }
    return result;
}

void TrustedCloud::nearest(Index sample, Index count, Neighbours& found) const {
    const std::span<const double> place = std::as_const(places_)[sample];
    const Cell here = cell(place);
    const Index widest = std::max({cells_.length(0), cells_.length(1), cells_.length(2)});
    for (Index ring = 1;; ++ring) {
        Cell low{};
        Cell high{};
        for (std::size_t d = 0; d < 3; ++d) {
            low[d] = std::max<Index>(0, here[d] - ring);
            high[d] = std::min(cells_.length(d) - 1, here[d] + ring);
        }
        const double all_within = clear(sample, low, high);
        found.clear();
        for (Index a = low[0]; a <= high[0]; ++a)
            for (Index b = low[1]; b <= high[1]; ++b) {
                const auto begin = first_[static_cast<std::size_t>(cells_.at({a, b, low[2], 0}))];
                const auto end =
                    first_[static_cast<std::size_t>(cells_.at({a, b, high[2], 0})) + 1];
                for (Index i = begin; i < end; ++i) {
                    if (i == sample || !trusts(i)) continue;
                    double square = 0;
                    for (std::size_t d = 0; d < place.size(); ++d) {
                        const double far = std::as_const(places_)[i][d] - place[d];
                        square += far * far;
                    }
                    found.push_back({square, i});
                }
            }
        if (ring >= widest) break;
        if (std::ssize(found) < count) continue;
        std::ranges::nth_element(found, found.begin() + count - 1, {}, &Neighbour::square);
        if (found[static_cast<std::size_t>(count - 1)].square < all_within * all_within) break;
    }
    const Index least = std::min(count, std::ssize(found));
    if (least == 0) return;
    std::ranges::nth_element(found, found.begin() + least - 1, {}, &Neighbour::square);
    const double last = (1 + 1e-9) * found[static_cast<std::size_t>(least - 1)].square;
    std::erase_if(found, [&](const Neighbour& n) { return n.square > last; });
    std::ranges::sort(found, [](const Neighbour& a, const Neighbour& b) {
        return a.square < b.square || (a.square == b.square && a.sample < b.sample);
    });
}

Prediction TrustedCloud::predict(Index sample, Neighbours& found) const {
    const auto axes = static_cast<int>(places_.dim());
    nearest(sample, per_term * parabola_terms(axes), found);
    if (axes == 1) return by_parabola<1>(points_, places_, sample, found);
    if (axes == 2) return by_parabola<2>(points_, places_, sample, found);
    return by_parabola<3>(points_, places_, sample, found);
}

LocalProcess TrustedCloud::process(Index sample, const Neighbours& neighbours) const {
    const std::ptrdiff_t k = std::ssize(neighbours);
    Eigen::MatrixXd places(k, places_.dim());
    Eigen::MatrixXd values(k, points_.dim());
    for (Index j = 0; j < k; ++j) {
        const Index i = neighbours[static_cast<std::size_t>(j)].sample;
        for (Index d = 0; d < places_.dim(); ++d) places(j, d) = places_(i, d) - places_(sample, d);
        for (Index d = 0; d < points_.dim(); ++d) values(j, d) = points_(i, d) - points_(sample, d);
    }
    return {places, values};
}

} // namespace batten
