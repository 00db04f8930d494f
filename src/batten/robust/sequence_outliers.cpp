#include <batten/robust/sequence_outliers.hpp>

#include <batten/robust/neighbour_outliers.hpp>

#include <algorithm>
#include <utility>

namespace batten {

std::vector<Index> sequence_outliers(const Points& sequence, Closure closure,
                                     const std::vector<double>& least,
                                     const std::vector<double>& along) {
    const auto same = [&](Index i, Index j) {
        return std::ranges::equal(sequence[i], sequence[j]) &&
               (along.empty() ||
                along[static_cast<std::size_t>(i)] == along[static_cast<std::size_t>(j)]);
    };
    std::vector<Index> first; // of each run of identical samples
    for (Index i = 0; i < sequence.size(); ++i)
        if (i == 0 || !same(i - 1, i)) first.push_back(i);
    Index seam = sequence.size(); // from here on a closed one's first sample is repeated
    if (closure == Closure::closed && along.empty() && first.size() > 1 && same(first.back(), 0)) {
        seam = first.back();
        first.pop_back();
    }
    if (static_cast<Index>(first.size()) < fewest_in_sequence) return {};
    PointSet different(static_cast<Index>(first.size()), sequence.dim());
    std::vector<double> theirs;
    std::vector<double> places;
    for (std::size_t k = 0; k < first.size(); ++k) {
        std::ranges::copy(sequence[first[k]], different[static_cast<Index>(k)].begin());
        theirs.push_back(least[static_cast<std::size_t>(first[k])]);
        if (!along.empty()) places.push_back(along[static_cast<std::size_t>(first[k])]);
    }
    const auto count = static_cast<Index>(first.size());
    const NeighbourOutliers found = neighbour_outliers(
        Trusted(Points(std::move(different)), {count}, {closure}, {std::move(places)}), theirs);
    std::vector<bool> outlier(first.size(), false);
    for (Index i : found.samples) outlier[static_cast<std::size_t>(i)] = true;
    std::vector<Index> result;
    std::size_t k = 0;
    for (Index i = 0; i < sequence.size(); ++i) {
        while (k + 1 < first.size() && first[k + 1] <= i) ++k;
        if (outlier[i >= seam ? 0 : k]) result.push_back(i);
    }
    return result;
}

} // namespace batten
