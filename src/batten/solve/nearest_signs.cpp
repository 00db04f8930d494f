#include <batten/solve/nearest_signs.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// How high each turn stands over its legs, and what a sign of it has to undo.
struct Heights {
    std::vector<double> of;
    bool closed;

    explicit Heights(const Turns& turns) : closed(turns.closed) {
        for (Index k = 0; k < turns.count(); ++k) {
            const double legs = turns.legs(k);
            of.push_back(legs > 0 ? turns.value(k) / legs : 0);
        }
    }
    /// Of sign 0, to the left, or 1.
    double cost(std::size_t k, std::size_t sign) const {
        return sign == 0 ? std::max(0.0, -of[k]) : std::max(0.0, of[k]);
    }
};

/// By the changes so far and the sign now.
std::vector<int> signs_by_table(const Heights& heights, Index most) {
    const std::size_t n = heights.of.size();
    const auto states = static_cast<std::size_t>(2 * (most + 1));
    std::vector<int> best;
    double best_cost = never;
    for (std::size_t first : {0U, 1U}) {
        std::vector<std::vector<double>> sum(n, std::vector<double>(states, never));
        std::vector<std::vector<std::size_t>> from(n, std::vector<std::size_t>(states));
        sum[0][first] = heights.cost(0, first);
        for (std::size_t k = 1; k < n; ++k)
            for (std::size_t s = 0; s < states; ++s) {
                const std::size_t changed = s >= 2 ? (s - 2) ^ 1U : states;
                from[k][s] = changed < states && sum[k - 1][changed] < sum[k - 1][s] ? changed : s;
                sum[k][s] = sum[k - 1][from[k][s]] + heights.cost(k, s % 2);
            }
        for (std::size_t s = 0; s < states; ++s) {
            const bool seam_changes = heights.closed && s % 2 != first;
            if (sum[n - 1][s] >= best_cost ||
                (seam_changes && s / 2 + 1 > static_cast<std::size_t>(most)))
                continue;
            best_cost = sum[n - 1][s];
            best.assign(n, 0);
            std::size_t at = s;
            for (std::size_t k = n; k-- > 0; at = from[k][at]) best[k] = at % 2 == 0 ? 1 : -1;
        }
    }
    return best;
}

/// Where every change costs so much more.
std::vector<int> signs_at_price(const Heights& heights, double price) {
    const std::size_t n = heights.of.size();
    std::vector<int> best(n);
    double best_cost = never;
    for (std::size_t first : {0U, 1U}) {
        std::array<double, 2> sum{never, never};
        sum[first] = heights.cost(0, first);
        std::vector<std::array<bool, 2>> changes(n);
        for (std::size_t k = 1; k < n; ++k) {
            const std::array<double, 2> before = sum;
            for (std::size_t s : {0U, 1U}) {
                changes[k][s] = before[1 - s] + price < before[s];
                sum[s] = std::min(before[s], before[1 - s] + price) + heights.cost(k, s);
            }
        }
        if (heights.closed) sum[1 - first] += price;
        std::size_t at = sum[0] <= sum[1] ? 0 : 1;
        if (!(sum[at] < best_cost)) continue;
        best_cost = sum[at];
        for (std::size_t k = n; k-- > 0;) {
            best[k] = at == 0 ? 1 : -1;
            if (changes[k][at]) at = 1 - at;
        }
    }
    return best;
}

Index count_changes(const std::vector<int>& signs, bool closed) {
    Index result = closed && signs.front() != signs.back() ? 1 : 0;
    for (std::size_t k = 1; k < signs.size(); ++k) result += signs[k] != signs[k - 1] ? 1 : 0;
    return result;
}

} // namespace

std::vector<int> nearest_signs(const Turns& turns, Index most) {
    constexpr Index large = 1 << 21; // numbers in a table
    constexpr int halvings = 60;
    const Heights heights(turns);
    if (turns.count() * (most + 1) <= large) return signs_by_table(heights, most);
    double low = 0;
    double high = 0; // more than one change can save
    for (const double height : heights.of) high += std::abs(height);
    std::vector<int> result = signs_at_price(heights, high);
    for (int k = 0; k < halvings; ++k) {
        const double price = (low + high) / 2;
        std::vector<int> signs = signs_at_price(heights, price);
        const bool few = count_changes(signs, heights.closed) <= most;
        (few ? high : low) = price;
        if (few) result = std::move(signs);
    }
    return result;
}

} // namespace batten
