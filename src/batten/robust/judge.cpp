#include <batten/robust/judge.hpp>

#include <batten/core/vectors.hpp>
#include <batten/samples/noise.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

constexpr std::array to_both{closest,          Stencil{4, 4, 3}, Stencil{3, 3, 2},
                             Stencil{8, 8, 3}, Stencil{1, 2, 2}, Stencil{2, 1, 2},
                             Stencil{1, 4, 3}, Stencil{4, 1, 3}};
constexpr std::array before{Stencil{2, 0, 1}, Stencil{4, 0, 1}, Stencil{8, 0, 1},
                            Stencil{3, 0, 2}, Stencil{5, 0, 2}, Stencil{8, 0, 2},
                            Stencil{8, 0, 3}, Stencil{16, 0, 2}};

constexpr auto mirrored(auto stencils) {
    for (Stencil& s : stencils) std::swap(s.before, s.behind);
    return stencils;
}

constexpr std::array behind = mirrored(before);

constexpr auto to_any_side = [] {
    std::array<Stencil, to_both.size() + before.size() + behind.size()> all{};
    auto next = std::ranges::copy(to_both, all.begin()).out;
    next = std::ranges::copy(before, next).out;
    std::ranges::copy(behind, next);
    return all;
}();

/// Limits are alike up to this.
constexpr double rounded = 1 - 1e-9;

/// The value with that part of the others below it; orders them anew.
double quantile(std::vector<double>& values, double part) {
    const auto at =
        values.begin() + static_cast<Index>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Up to `count` trusted samples on each side asked for.
std::vector<Index> around(const Trusted& trusted, Index sample, std::size_t axis, Index count,
                          bool first = true, bool second = true) {
    std::vector<Index> result(static_cast<std::size_t>(2 * count));
    const auto room = std::span(result);
    Index found = 0;
    for (Index side : {-1, 1})
        if (side < 0 ? first : second)
            found += trusted.nearest(
                sample, axis, side,
                room.subspan(static_cast<std::size_t>(found), static_cast<std::size_t>(count)));
    result.resize(static_cast<std::size_t>(found));
    return result;
}

/// What smooth samples beside one are off if those that predict them reached as far: four times
/// what most of them are beyond noise, or twice what all, or the first, are on the average, for
/// noise has none.
class SmoothResidual {
  public:
    /// `largest`: usual residual in units of a sample's noise; `reach`: of the prediction in
    /// question; `first`: so many that were added first.
    SmoothResidual(double largest, double reach, std::size_t dim, std::size_t first)
        : largest_(largest), reach_(reach), first_(first), sum_(dim, 0) {}

    /// A neighbour's prediction, which may not exist, and its way from the neighbour.
    void add(const Prediction& there, std::span<const double> off);
    /// Infinite where no neighbour had a prediction.
    double value() const;

  private:
    double mean() const;

    double largest_;
    double reach_;
    std::size_t first_;
    std::vector<double> beyond_noise_;
    std::vector<double> sum_;
    double mean_of_first_ = 0;
};

void SmoothResidual::add(const Prediction& there, std::span<const double> off) {
    constexpr double tenth = 0.45; // of the largest one: a tenth of normal residuals are above it
    if (!there.exists()) return;
    const double far = there.reach > 0 ? std::max(1.0, reach_ / there.reach) : 1;
    beyond_noise_.push_back(far * std::max(0.0, there.residual - tenth * largest_ * there.gain));
    add_scaled(sum_.data(), far, off.data(), std::ssize(off));
    if (beyond_noise_.size() == first_) mean_of_first_ = mean();
}

double SmoothResidual::mean() const {
    return norm(sum_) / static_cast<double>(beyond_noise_.size());
}

double SmoothResidual::value() const {
    if (beyond_noise_.empty()) return std::numeric_limits<double>::infinity(); // nobody knows
    return std::max(4 * median(beyond_noise_), 2 * std::max(mean_of_first_, mean()));
}

} // namespace

UsualResidual::UsualResidual(std::vector<double> residuals) {
    std::erase_if(residuals, [](double x) { return !std::isfinite(x); });
    if (residuals.empty()) return;
    median = quantile(residuals, 0.5);
    largest = median + 6 * (quantile(residuals, 0.84) - median);
    largest = std::clamp(largest, 3.9 * median, 7.5 * median);
}

double Judge::usual_around(Index sample, std::size_t axis) const {
    std::vector<double> values;
    for (Index beside : around(trusted_, sample, axis, 16))
        if (const Prediction there = trusted_.predict(beside, axis, closest); there.exists())
            values.push_back(there.normal());
    const UsualResidual& usual = usual_[axis];
    return std::max(usual.largest, 0.7 * usual.ratio() * median(std::move(values)));
}

Judge::Verdict Judge::of(Index sample) const {
    Verdict best;
    for (std::size_t axis = 0; axis < trusted_.axis_count(); ++axis) {
        const double usual = usual_around(sample, axis);
        for (const Stencil& stencil : to_any_side) {
            const Verdict one = by_stencil(sample, axis, stencil, usual);
            if (one.limit < rounded * best.limit ||
                (one.limit * rounded <= best.limit && one.part < best.part))
                best = one;
        }
    }
    if (!std::isfinite(best.limit)) best.part = 0;
    return best;
}

Judge::Verdict Judge::by_stencil(Index sample, std::size_t axis, const Stencil& stencil,
                                 double usual) const {
    const Prediction here = trusted_.predict(sample, axis, stencil);
    if (!here.exists()) return {};
    const double limit =
        std::max(least_[static_cast<std::size_t>(sample)],
                 usual * here.gain + smooth_residual(sample, axis, stencil, here.reach));
    Verdict result{0, limit, axis, stencil};
    if (here.residual > 0) result.part = here.residual / limit;
    return result;
}

double Judge::smooth_residual(Index sample, std::size_t axis, const Stencil& stencil,
                              double reach) const {
    std::vector<double> off(static_cast<std::size_t>(trusted_.points().dim()));
    constexpr std::size_t first = 3; // before, or the nearest of one side
    SmoothResidual result(usual_[axis].largest, reach, off.size(), first);
    const Index side = stencil.one_sided() ? 6 : 3;
    for (Index beside :
         around(trusted_, sample, axis, side, stencil.before > 0, stencil.behind > 0))
        result.add(trusted_.predict(beside, axis, stencil, off), off);
    return result.value();
}

bool Judge::unresolved(Index sample, std::size_t axis, Index run) const {
    double off = std::numeric_limits<double>::infinity();
    const auto least = [&](Index i, std::span<const Stencil> stencils) {
        double normal = std::numeric_limits<double>::infinity();
        for (const Stencil& stencil : stencils) {
            const Prediction by = trusted_.predict(i, axis, stencil);
            normal = std::min(normal, by.normal());
            if (i == sample) off = std::min(off, by.residual);
        }
        return normal;
    };
    const auto across = std::span(to_both).first(3);
    double here = least(sample, across);
    if (!std::isfinite(here)) here = least(sample, to_both);
    const bool inside = !at_end(sample, axis) && std::isfinite(here);
    if (inside) {
        double worst = 0;
        for (Index beside : around(trusted_, sample, axis, 2))
            if (const double r = least(beside, across); std::isfinite(r))
                worst = std::max(worst, r);
        if (here <= 4 * worst) return true;
    } else {
        least(sample, before);
        least(sample, behind);
    }
    if (!trusted_.by_chords(axis) || trusted_.axis_count() > 1 || noise_is_seen(sample, axis))
        return false;
    return off <= (run > 2 ? 1.5 : run > 1 || !inside ? 0.3 : 0.07) * step(sample, axis);
}

/// Shape is far worse predicted by those four times as far away, noise about as well.
bool Judge::noise_is_seen(Index sample, std::size_t axis) const {
    if (usual_[axis].median > 0.01 * step(sample, axis)) return true;
    std::vector<double> by_near;
    std::vector<double> by_far;
    for (Index beside : around(trusted_, sample, axis, 16)) {
        const Prediction near = trusted_.predict(beside, axis, closest);
        const Prediction far = trusted_.predict(beside, axis, Stencil{4, 4, 3});
        if (!near.exists() || !far.exists()) continue;
        by_near.push_back(near.normal());
        by_far.push_back(far.normal());
    }
    return !by_near.empty() && median(std::move(by_far)) <= 2 * median(std::move(by_near));
}

bool Judge::at_end(Index sample, std::size_t axis) const {
    std::array<Index, 1> found{};
    return trusted_.nearest(sample, axis, -1, found) == 0 ||
           trusted_.nearest(sample, axis, 1, found) == 0;
}

/// Median step of the trusted samples about a sample.
double Judge::step(Index sample, std::size_t axis) const {
    std::vector<double> steps;
    for (Index side : {-1, 1}) {
        std::array<Index, 4> found{};
        const Index count = trusted_.nearest(sample, axis, side, found);
        for (Index k = 0; k + 1 < count; ++k)
            steps.push_back(distance(trusted_.points()[found[static_cast<std::size_t>(k)]],
                                     trusted_.points()[found[static_cast<std::size_t>(k + 1)]]));
    }
    return median(std::move(steps));
}

} // namespace batten
