#include <batten/system/roughness.hpp>

#include <batten/samples/samples.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace batten {

namespace {

/// Nodes and weights of Gauss-Legendre quadrature with `count` points on [-1, 1]: Newton's method
/// on the Legendre polynomial.
std::vector<std::pair<double, double>> gauss_rule(int count) {
    std::vector<std::pair<double, double>> rule;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
        double slope = 0;
        for (int round = 0; round < 50; ++round) {
            double before = 1;
            double now = x;
            for (int k = 2; k <= count; ++k)
                before = std::exchange(now, ((2 * k - 1) * x * now - (k - 1) * before) / k);
            slope = count * (x * now - before) / (x * x - 1);
            const double step = now / slope;
            x -= step;
            if (std::abs(step) < 1e-16) break;
        }
        rule.emplace_back(x, 2 / ((1 - x * x) * slope * slope));
    }
    return rule;
}

} // namespace

void for_each_roughness_row(
    const KnotVector& knots, int order, int nodes,
    FunctionRef<void(double weight, const ActiveFunctions& derivatives)> visit) {
    const auto rule = gauss_rule(nodes);
    for (Index span = knots.degree(); span < knots.control_count(); ++span) {
        const double half = (knots[span + 1] - knots[span]) / 2;
        if (!(half > 0)) continue;
        const double middle = (knots[span + 1] + knots[span]) / 2;
        for (const auto& [x, weight] : rule)
            visit(weight * half,
                  active_functions(knots, middle + half * x, Numbering::free, order));
    }
}

BandedMatrix roughness_matrix(const KnotVector& knots, int order) {
    const int p = knots.degree();
    BandedMatrix matrix(knots.free_count(), p, knots.closure());
    for_each_roughness_row(knots, order, p + 1,
                           [&](double weight, const ActiveFunctions& derivatives) {
                               matrix.add_outer(weight, derivatives);
                           });
    return matrix;
}

double unit_roughness_scale(const KnotVector& knots, int order) {
    double scale = 1 / knots.length();
    for (int k = 0; k < 2 * order; ++k) scale *= knots.length();
    return scale;
}

BandedMatrix unit_roughness_matrix(const KnotVector& knots, int order) {
    BandedMatrix matrix(knots.free_count(), knots.degree(), knots.closure());
    matrix.add(unit_roughness_scale(knots, order), roughness_matrix(knots, order));
    return matrix;
}

bool determine_smoothest(const Points& places, int order) {
    const PointSet box = bounding_box(places);
    Index terms = 1;
    for (Index d = 0; d < places.dim(); ++d) terms *= order;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
    Eigen::VectorXd value(terms);
    for (Index i = 0; i < places.size(); ++i) {
        value(0) = 1;
        Index count = 1;
        for (Index d = 0; d < places.dim(); ++d) {
            const double half = (box(1, d) - box(0, d)) / 2;
            const double x = half > 0 ? (places(i, d) - box(0, d)) / half - 1 : 0;
            const std::array<double, 3> legendre{1, x, 1.5 * x * x - 0.5};
            for (Index k = count; k < order * count; ++k)
                value(k) = value(k % count) * legendre[static_cast<std::size_t>(k / count)];
            count *= order;
        }
        normal.noalias() += value * value.transpose();
    }
    constexpr double rounding = 1e-12;
    const Eigen::VectorXd spread =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(normal, Eigen::EigenvaluesOnly)
            .eigenvalues();
    return spread(0) > rounding * spread(terms - 1);
}

} // namespace batten
