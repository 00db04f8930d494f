#include <batten/iterate/fairing_pia.hpp>

#include <batten/iterate/methods.hpp>

namespace batten {

FairingPia::FairingPia(const NormalSystem& system, double weight, int order)
    : system_(system), weight_(weight), order_(order) {
    check_setting("fairing-pia", "weight", weight);
    check_setting("fairing-pia", "order", order);
}

void FairingPia::start(PointSet& control) {
    // add_roughness counts the samples' weights: these are as if their mean were one
    lambda_ = weight_ / (1 - weight_) / static_cast<double>(system_.sample_count());
    smoothed_ = system_.clone();
    smoothed_->add_roughness(lambda_, order_);
    faired_.emplace(*smoothed_);
    faired_->start(control);
}

} // namespace batten
