#include <batten/iterate/pia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <random>

namespace batten {

Pia::Pia(const DataSide& data, std::optional<double> weight, std::vector<Index> chosen,
         Divergence divergence)
    : data_(data), given_weight_(weight), divergence_(divergence) {
    const Index controls = data.groups().size();
    if (weight) check_setting("pia", "weight", *weight);
    if (chosen.empty()) return;
    moves_allowed_.assign(static_cast<std::size_t>(controls), false);
    for (Index i : chosen) {
        if (i < 0 || i >= controls)
            throw InvalidInput(
                fmt::format("moving: control point {} is outside 0 to {}", i, controls - 1));
        moves_allowed_[static_cast<std::size_t>(i)] = true;
    }
}

void Pia::keep_chosen(PointSet& moves) const {
    for (Index i = 0; i < moves.size() && !moves_allowed_.empty(); ++i)
        if (!moves_allowed_[static_cast<std::size_t>(i)])
            for (double& x : moves[i]) x = 0;
}

void Pia::start(PointSet& control) {
    if (divergence_ == Divergence::unasked) return;
    const VectorOperator wa = [&](const std::vector<double>& in, std::vector<double>& out) {
        out = std::move(image(PointSet(in, 1)).values());
    };
    // moves are images under W: doubled control points move alike
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    PointSet residual(data_.sample_count(), 1);
    for (double& value : residual.values()) value = normal(random);
    PointSet moves = data_.groups().means(residual);
    keep_chosen(moves);
    const RateEffort effort = divergence_ == Divergence::allowed
                                  ? RateEffort{.directions = 24, .restarts = 1}
                                  : RateEffort{};
    // B-splines sum to one: so do the means of their values, where all control points move
    std::vector<std::complex<double>> known;
    if (moves_allowed_.empty()) known.emplace_back(1);
    weight_ = given_weight_ ? *given_weight_ : best_weight(wa, moves.values(), effort, known);
    rate_ = convergence_rate(wa, weight_, std::move(moves.values()), effort);
    if (!known.empty()) rate_.value = std::max(rate_.value, std::abs(1 - weight_));
    if (divergence_ == Divergence::refused && diverges(control))
        throw InvalidInput(fmt::format(
            "pia: the predicted rate is {:.6g}, above 1: the control points would move off without "
            "bound; other parameters or knots, or a smaller weight, may do",
            rate_.value));
}

PointSet Pia::image(const PointSet& moves) const {
    PointSet result = data_.groups().means(data_.values(moves));
    keep_chosen(result);
    return result;
}

bool Pia::diverges(const PointSet& control) {
    constexpr double growth = 1e9;
    constexpr double faded = 1e-3;
    constexpr Index most_steps = 30'000;
    constexpr Index most_numbers = 300'000'000; // computed on the way
    if (!(rate_.value > 1)) return false;
    PointSet moves = propose(control);
    const double first = frobenius_norm(moves);
    const Index steps = std::min(most_steps, most_numbers / (moves.size() * moves.dim()));
    for (Index k = 0; k < steps; ++k) {
        add_scaled(moves, -weight_, image(moves));
        const double now = frobenius_norm(moves);
        if (!(now <= growth * first)) return true;
        if (now <= faded * first) return false;
    }
    return false;
}

std::string Pia::note() const {
    constexpr double rounding = 1e-9;
    constexpr double printed = 1e-6;
    const std::string known =
        rate_.accuracy > printed && divergence_ == Divergence::refused
            ? fmt::format("the predicted rate is known to {:.1g} only", rate_.accuracy)
            : "";
    if (rate_.value <= 1 + rounding) return known;
    return fmt::format("the predicted rate is {:.6g}, not below 1: the moves may grow before they "
                       "fade, or not fade{}{}",
                       rate_.value, known.empty() ? "" : "; ", known);
}

const PointSet& Pia::propose(const PointSet& control) {
    residual_ = data_.residual(control);
    means_ = data_.groups().means(residual_);
    keep_chosen(means_);
    norm_ = frobenius_norm(means_);
    moves_ = means_;
    scale(moves_.values(), weight_);
    return moves_;
}

std::vector<bool> Pia::valid(double eta, double noise) const {
    const SampleGroups& groups = data_.groups();
    PointSet sum(groups.size(), residual_.dim());
    std::vector<double> lengths(static_cast<std::size_t>(groups.size()));
    std::vector<double> spare = lengths; // of the squares, beside what noise makes
    groups.for_each_member([&](Index control, Index sample) {
        const double weight = groups.weight(sample);
        double square = 0;
        for (Index d = 0; d < residual_.dim(); ++d) {
            sum(control, d) += weight * residual_(sample, d);
            square += residual_(sample, d) * residual_(sample, d);
        }
        lengths[static_cast<std::size_t>(control)] += weight * std::sqrt(square);
        spare[static_cast<std::size_t>(control)] += noise * noise - square;
    });
    std::vector<bool> result(lengths.size());
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        double square = 0;
        for (double x : sum[static_cast<Index>(i)]) square += x * x;
        result[i] = spare[i] >= 0 || std::sqrt(square) / lengths[i] > eta;
    }
    return result;
}

} // namespace batten
