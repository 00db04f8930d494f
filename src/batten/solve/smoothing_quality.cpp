#include <batten/solve/smoothing_quality.hpp>

#include <batten/solve/nested_cholesky.hpp>
#include <batten/solve/residual_system.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace batten {

namespace {

/// Axis by axis: with A = Q R the samples are rotated once to R and Q^T b, and what a factor does
/// to them is that of R (R^T R + lambda W roughness)^{-1} R^T.
class AxesQuality : public SmoothingQuality {
  public:
    AxesQuality(const NormalSystem& system, const SampleRows& rows)
        : samples_(system.axes(), rows, system.centre()) {}

    bool estimated() const override { return false; }

    Quality operator()(double lambda) const override {
        std::vector<Extended> fitted = samples_.rotated();
        Quality result{0, 1, {}};
        for (std::size_t k = 0; k < samples_.axes().size(); ++k) {
            const BandedQr& rows = samples_.axes()[k];
            const BandedQr factor =
                samples_.rows()[k].smoothed(rows, lambda * samples_.rows()[k].total_weight());
            factor.check();
            const AxisLayout layout = along(samples_.controls(), k, samples_.dim());
            rows.apply_transposed(fitted.data(), layout);
            factor.solve_transposed(fitted.data(), layout);
            factor.solve(fitted.data(), layout);
            rows.apply(fitted.data(), layout);
            result.axis_traces.push_back(factor.squares_of(rows));
            result.trace *= result.axis_traces.back();
        }
        Extended squares = samples_.left_over();
        for (std::size_t i = 0; i < fitted.size(); ++i) {
            const Extended rest = samples_.rotated()[i] - fitted[i];
            squares += rest * rest;
        }
        result.squares = static_cast<double>(squares);
        return result;
    }

  private:
    RowFactorization samples_;
};

/// Random signs, the same in every run.
PointSet probes(Index rows) {
    constexpr Index count = 8;
    PointSet result(rows, count);
    std::mt19937_64 random(1);
    for (double& x : result.values()) x = random() % 2 == 0 ? -1 : 1;
    return result;
}

/// Some control points and what they leave of the samples, to judge others by.
struct Reference {
    PointSet control;
    Residuals residuals;
    const NormalSystem& system;

    Reference(PointSet reference, const NormalSystem& of, const Samples& samples,
              const Parameters& parameters)
        : control(std::move(reference)),
          residuals(residuals_of(control, of, samples, parameters)),
          system(of) {}

    /// A^T D r of other control points.
    PointSet pulls(PointSet other) const {
        add_scaled(other, -1.0, control);
        PointSet image(other.size(), other.dim());
        system.apply(other, image);
        PointSet result = residuals.pulls;
        add_scaled(result, -1.0, image);
        return result;
    }
    /// The weighted squares that other control points leave, from their pulls.
    double squares(PointSet other, const PointSet& left) const {
        add_scaled(other, -1.0, control);
        return std::max(0.0, residuals.squares - inner_product(other, residuals.pulls) -
                                 inner_product(other, left));
    }
};

/// Points of two sets side by side.
PointSet beside(const PointSet& left, const PointSet& right) {
    PointSet result(left.size(), left.dim() + right.dim());
    for (Index i = 0; i < left.size(); ++i) {
        std::ranges::copy(left[i], result[i].begin());
        std::ranges::copy(right[i], result[i].begin() + left.dim());
    }
    return result;
}

/// So many coordinates of all points from one on.
PointSet coordinates(const PointSet& points, Index first, Index count) {
    PointSet result(points.size(), count);
    for (Index i = 0; i < points.size(); ++i)
        for (Index d = 0; d < count; ++d) result(i, d) = points(i, first + d);
    return result;
}

/// As a whole: the residuals are those of the first factor that is judged and what changes from
/// there, the trace is estimated.
class NetQuality : public SmoothingQuality {
  public:
    NetQuality(const NormalSystem& system, const Samples& samples, const Parameters& parameters,
               int order)
        : system_(system),
          samples_(samples),
          parameters_(parameters),
          order_(order),
          probes_(probes(system.size())),
          images_(probes_.size(), probes_.dim()),
          factor_(system.axes()) {
        system.apply(probes_, images_);
    }

    bool estimated() const override { return true; }

    Quality operator()(double lambda) const override {
        const auto smoothed = system_.clone();
        smoothed->add_roughness(lambda, order_);
        factor_.factor(*smoothed);
        const Index dim = system_.dim();
        const Index count = probes_.dim();
        const PointSet solved = factor_.solve(
            beside(system_.rhs(), parameters_.is_scattered() ? beside(images_, probes_) : images_));
        const PointSet control = coordinates(solved, 0, dim);
        const PointSet fitted = coordinates(solved, dim, count);
        if (!reference_) reference_.emplace(control, system_, samples_, parameters_);
        const PointSet pulls = reference_->pulls(control);
        Quality result{reference_->squares(control, pulls),
                       inner_product(probes_, fitted) / static_cast<double>(count),
                       {}};
        if (!parameters_.is_scattered()) return result;
        // the roughness's part of the equations S = G + lambda R is what their solutions leave of G
        result.squares_growth = 2 * inner_product(pulls, factor_.solve(pulls));
        PointSet left = images_;
        PointSet image(left.size(), count);
        system_.apply(fitted, image);
        add_scaled(left, -1.0, image);
        result.trace_growth = -inner_product(coordinates(solved, dim + count, count), left) /
                              static_cast<double>(count);
        return result;
    }

  private:
    const NormalSystem& system_;
    const Samples& samples_;
    const Parameters& parameters_;
    int order_;
    PointSet probes_;
    PointSet images_; // of the probes under the system
    mutable std::optional<Reference> reference_;
    mutable NestedCholesky factor_;
};

} // namespace

std::unique_ptr<SmoothingQuality> smoothing_quality(const NormalSystem& system,
                                                    const Samples& samples,
                                                    const Parameters& parameters, int order) {
    if (system.factors().empty())
        return std::make_unique<NetQuality>(system, samples, parameters, order);
    return std::make_unique<AxesQuality>(system, SampleRows{samples, parameters, 0, order});
}

} // namespace batten
