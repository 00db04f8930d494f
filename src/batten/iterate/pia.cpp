#include <batten/iterate/pia.hpp>

#include <cmath>
#include <fmt/format.h>
#include <random>

namespace batten {

Pia::Pia(const DataSide& data, double weight, std::vector<Index> chosen)
    : data_(data), weight_(weight) {
    const Index controls = data.groups().size();
    if (!(weight > 0 && weight <= 2))
        throw InvalidInput(fmt::format("pia: weight {} is outside 0 to 2", weight));
    if (chosen.empty()) return;
    moves_allowed_.assign(static_cast<std::size_t>(controls), false);
    for (Index i : chosen) {
        if (i < 0 || i >= controls)
            throw InvalidInput(
                fmt::format("pia: chosen control point {} is outside 0 to {}", i, controls - 1));
        moves_allowed_[static_cast<std::size_t>(i)] = true;
    }
}

void Pia::keep_chosen(PointSet& moves) const {
    for (Index i = 0; i < moves.size() && !moves_allowed_.empty(); ++i)
        if (!moves_allowed_[static_cast<std::size_t>(i)])
            for (double& x : moves[i]) x = 0;
}

void Pia::start(const PointSet& control) {
    // power iteration: residuals of zero data are -A x, so the image of x is x - weight W A x
    constexpr int steps = 60;
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    PointSet x(control.size(), control.dim());
    for (double& value : x.values()) value = normal(random);
    keep_chosen(x);
    const PointSet zero(control.size(), control.dim());
    const PointSet base = data_.groups().means(data_.residual(zero));
    const auto minus_wa = [&](const PointSet& at) {
        PointSet image = data_.groups().means(data_.residual(at));
        add_scaled(image, -1.0, base);
        keep_chosen(image);
        return image;
    };
    x = minus_wa(
        minus_wa(x)); // moves lie in the range of W A: what it maps to zero must not be seen
    for (int k = 0; k < steps; ++k) {
        const PointSet image = minus_wa(x);
        PointSet next = x;
        add_scaled(next, weight_, image);
        const double last = rate_;
        rate_ = frobenius_norm(next) / frobenius_norm(x);
        if (!(rate_ > 0) || std::abs(rate_ - last) < 1e-6 * rate_) break;
        x = std::move(next);
        const double length = frobenius_norm(x);
        for (double& value : x.values()) value /= length;
    }
}

const PointSet& Pia::propose(const PointSet& control) {
    residual_ = data_.residual(control);
    means_ = data_.groups().means(residual_);
    keep_chosen(means_);
    norm_ = frobenius_norm(means_);
    moves_ = means_;
    for (double& x : moves_.values()) x *= weight_;
    return moves_;
}

std::vector<bool> Pia::valid(double eta) const {
    const SampleGroups& groups = data_.groups();
    PointSet sum(groups.size(), residual_.dim());
    std::vector<double> lengths(static_cast<std::size_t>(groups.size()));
    groups.for_each_member([&](Index control, Index sample) {
        double square = 0;
        for (Index d = 0; d < residual_.dim(); ++d) {
            sum(control, d) += residual_(sample, d);
            square += residual_(sample, d) * residual_(sample, d);
        }
        lengths[static_cast<std::size_t>(control)] += std::sqrt(square);
    });
    std::vector<bool> result(lengths.size());
    for (std::size_t i = 0; i < lengths.size(); ++i) {
        double square = 0;
        for (double x : sum[static_cast<Index>(i)]) square += x * x;
        result[i] =
            lengths[i] == 0 || std::sqrt(square) / lengths[i] > eta; // no residual at all is valid
    }
    return result;
}

} // namespace batten
