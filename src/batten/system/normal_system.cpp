#include <batten/system/normal_system.hpp>

#include <batten/system/factored_system.hpp>
#include <batten/system/stencil_system.hpp>
#include <batten/system/system_sums.hpp>

#include <algorithm>

namespace batten {

namespace {

PointSet shifted(const PointSet& control, const std::vector<double>& centre, double sign) {
    PointSet result = control;
    for (Index i = 0; i < result.size(); ++i)
        for (Index d = 0; d < result.dim(); ++d)
            result(i, d) += sign * centre[static_cast<std::size_t>(d)];
    return result;
}

} // namespace

NormalSystem::NormalSystem(std::vector<KnotVector> axes, std::vector<double> centre)
    : axes_(std::move(axes)),
      controls_(free_shape(axes_)),
      centre_(std::move(centre)),
      rhs_(controls_.size(), static_cast<Index>(centre_.size())) {}

NormalSystem::NormalSystem(SystemSums&& sums)
    : axes_(std::move(sums.axes)),
      controls_(free_shape(axes_)),
      centre_(std::move(sums.centre)),
      rhs_(std::move(sums.rhs)),
      data_energy_(sums.energy),
      sample_count_(sums.samples) {}

SystemSums NormalSystem::common_sums() const {
    return {.axes = axes_,
            .centre = centre_,
            .samples = sample_count_,
            .energy = data_energy_,
            .rhs = rhs_};
}

SystemSums NormalSystem::sums() const {
    throw InvalidInput("a system that is not one of samples has no sums over them");
}

PointSet NormalSystem::gradient(const PointSet& control) const {
    PointSet result(size(), dim());
    apply(control, result);
    for (std::size_t k = 0; k < result.values().size(); ++k)
        result.values()[k] = rhs_.values()[k] - result.values()[k];
    return result;
}

double NormalSystem::energy(const PointSet& control) const {
    // E(P) - E(0) = -<P, rhs + gradient(P)>
    PointSet sum = gradient(control);
    add_scaled(sum, 1.0, rhs_);
    return -inner_product(control, sum);
}

std::unique_ptr<NormalSystem> assemble(const std::vector<KnotVector>& axes, const Samples& samples,
                                       const Parameters& parameters) {
    const auto origin = samples.points[0];
    const std::vector<double> centre(origin.begin(), origin.end());
    const bool weighted_grid =
        axes.size() > 1 && std::ranges::any_of(samples.weights, [](double w) { return w != 1; });
    if (parameters.is_scattered() || weighted_grid) {
        auto system = std::make_unique<StencilSystem>(axes, centre);
        if (parameters.is_scattered()) {
            system->add(samples.points, parameters.scattered, samples.weights);
        } else {
            system->set_grid(parameters);
            system->add(samples.points, parameter_rows(parameters), samples.weights);
        }
        return system;
    }
    if (axes.size() == 1) {
        auto system = std::make_unique<BandedSystem>(axes[0], centre);
        system->add(parameters.axes[0], samples.points, samples.weights);
        return system;
    }
    auto system = std::make_unique<KroneckerSystem>(axes, centre, parameters);
    system->add(0, samples.points);
    system->finish();
    return system;
}

PointSet centred(const PointSet& control, const std::vector<double>& centre) {
    return shifted(control, centre, -1);
}
PointSet uncentred(const PointSet& control, const std::vector<double>& centre) {
    return shifted(control, centre, 1);
}

} // namespace batten
