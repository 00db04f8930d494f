#include <batten/spline/curve_pieces.hpp>

#include <batten/basis/active_functions.hpp>

#include <algorithm>

namespace batten {

CurvePieces::CurvePieces(const KnotVector& knots, const PointSet& control)
    : degree_(knots.degree()), dim_(control.dim()), breaks_(knots.breakpoints()) {
    coefficients_.resize((breaks_.size() - 1) * static_cast<std::size_t>((degree_ + 1) * dim_));
    double* out = coefficients_.data();
    for (std::size_t b = 0; b + 1 < breaks_.size(); ++b) {
        double factorial = 1;
        for (int k = 0; k <= degree_; ++k, out += dim_) {
            if (k > 0) factorial *= k;
            const ActiveFunctions active = active_functions(knots, breaks_[b], Numbering::free, k);
            for (int r = 0; r <= degree_; ++r)
                for (Index d = 0; d < dim_; ++d)
                    out[d] += active.value[static_cast<std::size_t>(r)] *
                              control(active.index(r), d) / factorial;
        }
    }
}

CurvePoint CurvePieces::operator()(double t) const {
    const auto after = std::upper_bound(breaks_.begin() + 1, breaks_.end() - 1, t);
    const auto piece = static_cast<std::size_t>(after - breaks_.begin() - 1);
    const double h = t - breaks_[piece];
    const double* c = coefficients_.data() + piece * static_cast<std::size_t>((degree_ + 1) * dim_);
    CurvePoint result;
    for (Index d = 0; d < dim_; ++d) {
        double value = c[degree_ * dim_ + d];
        double first = 0;
        double second = 0;
        for (int k = degree_ - 1; k >= 0; --k) { // Horner with derivatives
            second = second * h + first;
            first = first * h + value;
            value = value * h + c[k * dim_ + d];
        }
        const auto at = static_cast<std::size_t>(d);
        result.point[at] = value;
        result.first[at] = first;
        result.second[at] = 2 * second;
    }
    return result;
}

} // namespace batten
