#include <batten/iterate/nonmonotone_search.hpp>

#include <algorithm>

namespace batten {

void NonmonotoneSearch::start() {
    functional_ = 0;
    functionals_ = {0};
    halvings_ = 0;
}

double NonmonotoneSearch::searched(double step, double rho, double curvature) {
    constexpr double enough = 1e-4;
    constexpr int most_halvings = 101;
    const double allowed = std::ranges::max(functionals_);
    for (int k = 0; k < most_halvings; ++k, ++halvings_, step /= 2)
        if (functional_ - step * rho + step * step / 2 * curvature <= allowed - enough * step * rho)
            break;
    return step;
}

void NonmonotoneSearch::moved(double change) {
    functional_ += change;
    functionals_.push_back(functional_);
    if (static_cast<int>(functionals_.size()) > memory_) functionals_.pop_front();
}

} // namespace batten
