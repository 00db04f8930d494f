#include <batten/iterate/rpia.hpp>

#include <batten/iterate/lin2018.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

Rpia::Rpia(const NormalSystem& system, Index block, std::uint64_t seed)
    : system_(system),
      block_(std::min(block > 0 ? block : (system.size() + 3) / 4, system.size())),
      seed_(seed) {}

void Rpia::start(PointSet&) {
    random_.seed(seed_);
    steps_ = diagonal_steps(system_);
    const std::vector<double> diagonal = system_.diagonal();
    traces_.clear();
    double sum = 0;
    for (Index i = 0; i < system_.size(); ++i) {
        if (steps_[static_cast<std::size_t>(i)] > 0) sum += diagonal[static_cast<std::size_t>(i)];
        if ((i + 1) % block_ == 0 || i + 1 == system_.size()) traces_.push_back(sum);
    }
}

std::size_t Rpia::drawn() {
    constexpr double unit = 0x1p-53; // of a number's digits, over [0, 1)
    const double at = static_cast<double>(random_() >> 11U) * unit * traces_.back();
    const auto found = std::ranges::upper_bound(traces_, at) - traces_.begin();
    return std::min(static_cast<std::size_t>(found), traces_.size() - 1);
}

/// Longest move of a block.
double Rpia::longest_in(std::size_t block) const {
    const Index first = static_cast<Index>(block) * block_;
    double longest = 0;
    for (Index i = first; i < std::min(first + block_, moves_.size()); ++i)
        for (double x : moves_[i]) longest = std::max(longest, std::abs(x));
    return longest;
}

const PointSet& Rpia::propose(const PointSet& control) {
    constexpr double nothing = 1e-3; // of the longest move
    moves_ = reached_gradient(system_, control, steps_);
    norm_ = frobenius_norm(moves_);
    scale_rows(moves_, steps_);
    std::vector<double> longest(traces_.size());
    for (std::size_t b = 0; b < longest.size(); ++b) longest[b] = longest_in(b);
    const double least = nothing * std::ranges::max(longest);
    std::size_t turn = drawn();
    while (longest[turn] < least) turn = (turn + 1) % longest.size(); // it has nothing to move
    const Index first = static_cast<Index>(turn) * block_;
    for (Index i = 0; i < moves_.size(); ++i)
        if (i < first || i >= first + block_) std::ranges::fill(moves_[i], 0.0);
    return moves_;
}

Settings Rpia::settings() const {
    return {{"block", static_cast<double>(block_)}, {"seed", static_cast<double>(seed_)}};
}

} // namespace batten
