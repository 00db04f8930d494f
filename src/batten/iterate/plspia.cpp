#include <batten/iterate/plspia.hpp>

#include <batten/core/vectors.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/solve/working_eigenvalues.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// Those of M^{-1} A^T D A.
ExtremeEigenvalues preconditioned_extremes(const NormalSystem& system,
                                           const Preconditioning& preconditioning,
                                           double tolerance) {
    const VectorOperator inverse = [&](const std::vector<double>& x, std::vector<double>& y) {
        PointSet solved(x, 1);
        preconditioning.apply(solved);
        y = solved.values();
    };
    return lanczos(operator_of(system), system.size(), tolerance, SpectrumEnds::both, inverse);
}

} // namespace

Plspia::Plspia(const NormalSystem& system, int band, std::optional<double> relaxation,
               double eigenvalue_tolerance)
    : system_(system),
      band_(band),
      given_factor_(relaxation),
      eigenvalue_tolerance_(eigenvalue_tolerance) {}

void Plspia::start(PointSet&) {
    check_setting("plspia", "band", band_);
    check_setting("plspia", "eigenvalue_tolerance", eigenvalue_tolerance_);
    const bool banded = !system_.factors().empty();
    preconditioning_ = banded ? Preconditioning::compensated_bands(system_, band_)
                              : Preconditioning(system_, Preconditioner::axes);
    ExtremeEigenvalues e{1, 0, 0}; // as no compensated matrix has a larger one
    if (!reaches_all(system_)) {
        note_ = "ill-determined: some control points are hardly reached by any sample";
    } else {
        e = preconditioned_extremes(system_, preconditioning_, eigenvalue_tolerance_);
        setup_products_ = e.products;
        if (banded) e.largest = std::max(e.largest, 1.0);
        if (e.smallest <= least_determined * e.largest)
            note_ = "ill-determined: the smallest eigenvalue is below 1e-5 of the largest";
    }
    if (!note_.empty()) { // the best factor would leave the largest modes where they are
        if (!banded) preconditioning_ = Preconditioning::row_sums(system_);
        e = {1, 0, e.products};
        note_ += banded ? "; steps are of factor 1" : "; steps are over row sums, of factor 1";
    }
    const double best = e.smallest > 0 ? 2 / (e.largest + e.smallest) : 1;
    factor_ = given_factor_.value_or(best);
    check_setting("plspia", "relaxation", factor_, {.low = 0, .high = 2 / e.largest},
                  "its region of convergence");
    rate_ = e.smallest > 0
                ? std::max(std::abs(1 - factor_ * e.smallest), std::abs(1 - factor_ * e.largest))
                : 0;
}

const PointSet& Plspia::propose(const PointSet& control) {
    moves_ = system_.gradient(control);
    norm_ = frobenius_norm(moves_);
    preconditioning_.apply(moves_);
    scale(moves_.values(), factor_);
    return moves_;
}

Settings Plspia::settings() const {
    Settings result{{"relaxation", factor_}};
    if (preconditioning_.diagonals() >= 0) result["band"] = preconditioning_.diagonals();
    return result;
}

} // namespace batten
