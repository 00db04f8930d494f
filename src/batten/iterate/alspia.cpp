#include <batten/iterate/alspia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>

#include <cmath>
#include <numbers>

namespace batten {

Alspia::Alspia(const NormalSystem& system, Index cycle, double eigenvalue_tolerance,
               RowSums row_sums)
    : gradient_(system, row_sums, eigenvalue_tolerance), cycle_(cycle) {}

void Alspia::start(PointSet&) {
    constexpr double singular = 1e-10;
    check_setting("alspia", "cycle", static_cast<double>(cycle_));
    check_setting("alspia", "eigenvalue_tolerance", gradient_.tolerance());
    gradient_.start();
    setup_products_ = gradient_.setup_products();
    const WorkingEigenvalues& working = gradient_.eigenvalues();
    largest_ = working.values.largest * (1 + gradient_.tolerance()); // known from below
    // the roots that vanish at 0 do without an eigenvalue that would have to be raised
    const bool open =
        gradient_.by_row_sums() ? working.raised() : working.found <= singular * largest_;
    smallest_ = open ? 0 : working.found;
    taken_ = 0;
}

/// One over the next root, of a cycle in its natural order.
double Alspia::factor() const {
    const auto cycle = static_cast<double>(cycle_);
    const auto odd = static_cast<double>(2 * (taken_ % cycle_) + 1);
    const auto root = [&](double of, double odd_number) {
        return std::cos(odd_number * std::numbers::pi / (2 * of));
    };
    if (smallest_ > 0)
        return 2 / (largest_ + smallest_ + (largest_ - smallest_) * root(cycle, odd));
    const double last = root(cycle + 1, 2 * cycle + 1); // of the roots it is moved to 0
    return (1 - last) / (largest_ * (root(cycle + 1, odd) - last));
}

const PointSet& Alspia::propose(const PointSet& control) {
    moves_ = gradient_.at(control);
    const double step = factor();
    scale(moves_.values(), step);
    return moves_;
}

Settings Alspia::settings() const {
    return {{"cycle", static_cast<double>(cycle_)}, {"largest", largest_}, {"smallest", smallest_}};
}

} // namespace batten
