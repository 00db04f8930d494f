#include <batten/samples/noise.hpp>

#include <batten/core/grid_index.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

/// Calls `visit` with every third difference of a line's samples, in order; white noise has 20
/// times its variance there.
template <class Visit>
void third_differences(const Points& q, const GridIndex::Strand& line, Visit visit) {
    std::vector<double> third(static_cast<std::size_t>(q.dim()));
    for (Index i = 0; i + 3 < line.count; ++i) {
        for (Index d = 0; d < q.dim(); ++d)
            third[static_cast<std::size_t>(d)] =
                q(line[i + 3], d) - 3 * q(line[i + 2], d) + 3 * q(line[i + 1], d) - q(line[i], d);
        visit(std::as_const(third));
    }
}

GridIndex::Strand all_of(const Points& q) {
    return {0, q.size(), 1};
}

double square(const std::vector<double>& x) {
    double sum = 0;
    for (double value : x) sum += value * value;
    return sum;
}

/// A standard deviation by the lengths of third differences: noise in one direction has a median of
/// 0.67 standard deviations, in a plane of 0.83.
double usual(std::vector<double> lengths) {
    return median(std::move(lengths)) / (0.75 * std::sqrt(20.0));
}

} // namespace

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<Index>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double noise_bound(const Points& q) {
    if (q.size() < 5) return 0;
    double sum = 0;
    third_differences(q, all_of(q), [&](const std::vector<double>& d) {
        for (double value : d) sum += value * value;
    });
    return std::sqrt(sum / (20 * static_cast<double>(q.size() - 3)));
}

double usual_noise(const Points& q) {
    std::vector<double> lengths;
    third_differences(q, all_of(q), [&](const std::vector<double>& d) {
        lengths.push_back(std::sqrt(square(d)));
    });
    return usual(std::move(lengths));
}

double white_noise(const Points& samples, const std::vector<Index>& shape) {
    constexpr double alike = -0.7; // of white noise -3/4, of a random walk -2/3
    const GridIndex grid(shape);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < grid.axis_count(); ++axis) {
        std::vector<double> lengths;
        double products = 0;
        double squares = 0;
        grid.for_each_strand(axis, [&](const GridIndex::Strand& line) {
            std::vector<double> last;
            third_differences(samples, line, [&](const std::vector<double>& d) {
                for (std::size_t k = 0; k < last.size(); ++k) products += d[k] * last[k];
                last = d;
                lengths.push_back(std::sqrt(square(d)));
                squares += square(d);
            });
        });
        const double chance = 1 / std::sqrt(static_cast<double>(lengths.size()));
        if (!(products <= (alike + chance) * squares)) return 0;
        least = std::min(least, usual(std::move(lengths)));
    }
    return least;
}

} // namespace batten
