#include <batten/solve/smoothing_quality.hpp>

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

/// What a spline leaves of the samples, as normal equations.
struct Residuals {
    PointSet control;
    std::unique_ptr<NormalSystem> system;

    Residuals(PointSet reference, const NormalSystem& of, const Samples& samples,
              const Parameters& parameters)
        : control(std::move(reference)),
          system(residual_system(Spline::from_free(of.axes(), uncentred(control, of.centre())),
                                 of.axes(), samples, parameters)) {}

    /// Sum of the weighted squares for other control points than the reference.
    double squares(PointSet other) const {
        add_scaled(other, -1.0, control);
        other = centred(other, system->centre());
        return std::max(0.0, system->data_energy() + system->energy(other));
    }
};

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
          images_(probes_.size(), probes_.dim()) {
        system.apply(probes_, images_);
    }

    bool estimated() const override { return true; }

    Quality operator()(double lambda) const override {
        const auto smoothed = system_.clone();
        smoothed->add_roughness(lambda, order_);
        const auto factor = factorize(*smoothed);
        const PointSet control = factor->solve(system_.rhs());
        if (!residuals_) residuals_.emplace(control, system_, samples_, parameters_);
        return {residuals_->squares(control),
                inner_product(probes_, factor->solve(images_)) / static_cast<double>(probes_.dim()),
                {}};
    }

  private:
    const NormalSystem& system_;
    const Samples& samples_;
    const Parameters& parameters_;
    int order_;
    PointSet probes_;
    PointSet images_; // of the probes under the system
    mutable std::optional<Residuals> residuals_;
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
