#include <batten/robust/judge.hpp>

#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// The value with that part of the finite ones below it, 0 of none.
double quantile(std::vector<double> values, double part) {
    std::erase_if(values, [](double x) { return !std::isfinite(x); });
    if (values.empty()) return 0;
    const auto at =
        values.begin() + static_cast<Index>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// What noise does to a stencil's residual nine times out of ten, in medians of the closest one's.
double noise_factor(const Stencil& stencil) {
    if (!stencil.one_sided()) return 2.5;
    return stencil.before + stencil.behind == 3 ? 7.5 : 4;
}

} // namespace

std::vector<double> residuals(const Trusted& trusted, const Stencil& stencil) {
    std::vector<double> result(static_cast<std::size_t>(trusted.size()));
    for_each_block(trusted.size(), 4096, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i) {
            const auto k = static_cast<std::size_t>(i);
            result[k] = trusted.predict(trusted.members()[k], {i - 1, i + 1}, stencil).residual;
        }
    });
    return result;
}

double finite_median(std::vector<double> values) {
    std::erase_if(values, [](double x) { return !std::isfinite(x); });
    return median(std::move(values));
}

double median_around(const std::vector<double>& values, const Trusted& trusted, Index place) {
    std::vector<double> window;
    for (Index k = -10; k <= 10; ++k)
        if (const Index at = trusted.within(place + k * trusted.stride()); at >= 0)
            window.push_back(values[static_cast<std::size_t>(at)]);
    return finite_median(std::move(window));
}

Scale::Scale(const Trusted& trusted) : around_(static_cast<std::size_t>(trusted.size())) {
    std::vector<double> least = residuals(trusted, closest);
    noise_ = finite_median(least);
    const std::vector<double> wide = residuals(trusted, central[1]);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], wide[i]);
    // of normal residuals along a line, in a plane or in space this is 5.3, 5.8 or 6.1 times their
    // standard deviation
    const double half = quantile(least, 0.5);
    usual_ = half + 6 * (quantile(least, 0.84) - half);
    for_each_block(trusted.size(), 4096, [&](const Block& block) {
        for (Index i = block.begin; i < block.end; ++i)
            around_[static_cast<std::size_t>(i)] = 7 * median_around(least, trusted, i);
    });
}

double Scale::usual(const Trusted& trusted, const Gap& gap) const {
    double result = usual_;
    for (Index place : {gap.before, gap.behind})
        if (const Index at = trusted.within(place); at >= 0)
            result = std::max(result, around_[static_cast<std::size_t>(at)]);
    return result;
}

double Judge::part(Index sample) const {
    const Gap gap = trusted_.gap(sample);
    double best = std::numeric_limits<double>::infinity();
    const auto by = [&](std::span<const Stencil> stencils) {
        for (const Stencil& stencil : stencils)
            best = std::min(best, by_stencil(sample, gap, stencil));
    };
    by(central);
    if (best > 1) by(lopsided);
    if (best > 1 && breaks(gap, usual_[static_cast<std::size_t>(sample)]))
        by(std::span(one_sided).subspan(trusted_.stride() > 1 ? 4 : 0)); // few say nothing in noise
    return best;
}

bool Judge::unresolved(Index sample) const {
    const Gap gap = trusted_.gap(sample);
    const double here = std::min(trusted_.least_residual(sample, central),
                                 trusted_.least_residual(sample, lopsided));
    if (!at_end(gap) && std::isfinite(here)) {
        double worst = 0;
        for (Index beside : trusted_.around(gap, 1, true, true))
            if (const double r = trusted_.least_residual(beside, central); std::isfinite(r))
                worst = std::max(worst, r);
        return here <= 4 * worst;
    }
    return trusted_.stride() == 1 &&
           std::min(here, trusted_.least_residual(sample, one_sided)) <= 0.3 * step(gap);
}

double Judge::by_stencil(Index sample, const Gap& gap, const Stencil& stencil) const {
    const Prediction here = trusted_.predict(sample, gap, stencil);
    // beside a corner one side alone has less to go by
    const double spread = stencil.one_sided() ? 2 : 1;
    const double usual = spread * usual_[static_cast<std::size_t>(sample)];
    if (!here.exists() || here.residual <= usual || stencil.degree == 1)
        return here.residual / usual;
    return here.residual / std::max(usual, smooth_residual(gap, stencil, here.reach));
}

/// Four times what smooth samples beside it have, beyond noise, if the stencil reached as far.
double Judge::smooth_residual(const Gap& gap, const Stencil& stencil, double reach) const {
    std::vector<double> values;
    for (Index beside : trusted_.around(gap, 4, stencil.before > 0, stencil.behind > 0)) {
        const Prediction there = trusted_.predict(beside, stencil);
        if (!there.exists()) continue;
        const double beyond = std::max(0.0, there.residual - noise_factor(stencil) * noise_);
        values.push_back(there.reach > 0 ? beyond * std::max(1.0, reach / there.reach) : beyond);
    }
    return 4 * median(std::move(values));
}

bool Judge::at_end(const Gap& gap) const {
    return trusted_.within(gap.before) < 0 || trusted_.within(gap.behind) < 0;
}

/// Whether the curve's two sides do not know of each other: only there is one of them enough to
/// explain a sample.
bool Judge::breaks(const Gap& gap, double usual) const {
    return at_end(gap) ||
           std::ranges::any_of(trusted_.around(gap, 1, true, true), [&](Index beside) {
               return trusted_.predict(beside, closest).residual > 0.7 * usual;
           });
}

/// Median step of the trusted samples about a gap.
double Judge::step(const Gap& gap) const {
    const Points& q = trusted_.sequence();
    const std::vector<Index>& member = trusted_.members();
    std::vector<double> steps;
    for (Index k = -3; k < 3; ++k) {
        const Index a = trusted_.within(gap.before + k);
        const Index b = trusted_.within(gap.before + k + 1);
        if (a >= 0 && b >= 0)
            steps.push_back(distance(q[member[static_cast<std::size_t>(a)]],
                                     q[member[static_cast<std::size_t>(b)]]));
    }
    return median(std::move(steps));
}

} // namespace batten
