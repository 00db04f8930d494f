#include <batten/search/curve_direction.hpp>

#include <batten/basis/place_knots.hpp>
#include <batten/search/curve_knots.hpp>

#include <algorithm>
#include <cmath>

namespace batten {

namespace {

/// The parameter as far from the end as `t` is from the beginning.
double mirrored(double t, double begin, double end) {
    return t == begin ? end : begin + (end - t);
}

/// The same knots run the other way. Those of a closed curve begin with the first of equal ones,
/// as every evaluator takes them.
KnotVector mirrored(const KnotVector& knots) {
    std::vector<double> interior = interior_knots(knots);
    for (double& t : interior)
        if (knots.closure() == Closure::open || t > knots.begin())
            t = mirrored(t, knots.begin(), knots.end());
    std::ranges::sort(interior);
    return knots_around(knots.degree(), interior, knots.begin(), knots.end(), knots.closure());
}

/// How often a closed curve has the knot at its seam.
Index seam_multiplicity(const KnotVector& knots) {
    const std::vector<double> interior = interior_knots(knots);
    return 1 + std::ranges::count(interior, knots.begin());
}

/// Places along a sequence, as parts of its length from the middle, weighed.
class Balance {
  public:
    void add(double place, double weight) {
        moment_ += weight * place;
        total_ += weight;
    }
    /// -1 or 1 as the weight lies before or behind the middle, 0 where rounding could tell.
    int side() const {
        if (std::abs(moment_) <= 1e-9 * total_) return 0;
        return moment_ < 0 ? -1 : 1;
    }

  private:
    double moment_ = 0;
    double total_ = 0;
};

} // namespace

Index Turned::operator()(Index sample) const {
    return closure_ == Closure::closed ? (samples_ - sample) % samples_ : samples_ - 1 - sample;
}

std::vector<double> Turned::operator()(const std::vector<double>& values) const {
    std::vector<double> result;
    for (std::size_t i = 0; i < values.size(); ++i)
        result.push_back(values[static_cast<std::size_t>((*this)(static_cast<Index>(i)))]);
    return result;
}

Samples Turned::operator()(const Samples& samples) const {
    PointSet points(samples.size(), samples.dim());
    for (Index i = 0; i < points.size(); ++i)
        std::ranges::copy(samples.points[(*this)(i)], points[i].begin());
    return {.points = std::move(points), .weights = (*this)(samples.weights)};
}

HoldOptions Turned::operator()(HoldOptions hold) const {
    for (Index& i : hold.interpolate) i = (*this)(i);
    for (HeldTangent& tangent : hold.tangents) {
        tangent.sample = (*this)(tangent.sample);
        for (double& x : tangent.value) x = -x;
    }
    return hold;
}

std::vector<double> Turned::parameters(const std::vector<double>& parameters, double begin,
                                       double end) const {
    std::vector<double> result = (*this)(parameters);
    for (double& t : result) t = mirrored(t, begin, end);
    if (closure_ == Closure::closed) result[0] = begin - (parameters[0] - begin);
    return result;
}

CurveTrial Turned::operator()(const CurveTrial& trial) const {
    CurveTrial result = trial;
    result.knots = mirrored(trial.knots);
    result.parameters = parameters(trial.parameters, trial.knots.begin(), trial.knots.end());
    result.weights = (*this)(trial.weights);
    result.ratio = (*this)(trial.ratio);
    const Index n = trial.control.size();
    const bool closed = closure_ == Closure::closed;
    const Index last =
        trial.knots.control_count() - 1 + (closed ? seam_multiplicity(trial.knots) - 1 : 0);
    for (Index i = 0; i < n; ++i)
        std::ranges::copy(trial.control[(last - i) % n], result.control[i].begin());
    return result;
}

bool runs_backwards(const Points& q, Closure closure) {
    const Index m = q.size();
    const bool closed = closure == Closure::closed;
    std::vector<double> t = parametrize_sequence(q, Parametrization::chord, closure);
    if (closed) t.push_back(1);
    Balance turning;
    Balance samples;
    std::vector<double> before; // direction of the chord to the sample
    std::vector<double> after(static_cast<std::size_t>(q.dim()));
    for (Index i = 0; i + 1 < (closed ? m + 1 : m); ++i) {
        const auto next = q[(i + 1) % m];
        const double length = distance(q[i], next);
        if (!(length > 0)) continue;
        for (std::size_t d = 0; d < after.size(); ++d)
            after[d] = (next[d] - q(i, static_cast<Index>(d))) / length;
        const double from = t[static_cast<std::size_t>(i)];
        samples.add((from + t[static_cast<std::size_t>(i + 1)] - 1) / 2, 1);
        if (!before.empty()) turning.add(from - 0.5, distance(before, after));
        before = after;
    }
    if (turning.side() != 0) return turning.side() < 0;
    if (samples.side() != 0) return samples.side() < 0;
    return std::ranges::lexicographical_compare(q[m - 1], q[closed ? 1 : 0]);
}

} // namespace batten
