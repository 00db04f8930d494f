#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<Index>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double noise_bound(const Points& q) {
    if (q.size() < 5) return 0;
    double sum = 0;
    for (Index i = 0; i + 3 < q.size(); ++i)
        for (Index d = 0; d < q.dim(); ++d) {
            const double third = q(i + 3, d) - 3 * q(i + 2, d) + 3 * q(i + 1, d) - q(i, d);
            sum += third * third;
        }
    return std::sqrt(
        sum /
        (20 * static_cast<double>(
                  q.size() - 3))); // a third difference of white noise has 20 times its variance
}

double usual_noise(const Points& q) {
    std::vector<double> size;
    for (Index i = 0; i + 3 < q.size(); ++i) {
        double square = 0;
        for (Index d = 0; d < q.dim(); ++d) {
            const double third = q(i + 3, d) - 3 * q(i + 2, d) + 3 * q(i + 1, d) - q(i, d);
            square += third * third;
        }
        size.push_back(std::sqrt(square));
    }
    // noise in one direction has a median of 0.67 standard deviations, in a plane of 0.83
    return median(std::move(size)) / (0.75 * std::sqrt(20.0));
}

} // namespace batten
