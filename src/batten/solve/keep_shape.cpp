#include <batten/solve/keep_shape.hpp>

#include <batten/core/distinct.hpp>
#include <batten/shape/polygon.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

namespace batten {

namespace {

/// Turns of a control polygon at its vertices, over the seam when closed.
struct Turns {
    const PointSet& polygon;
    bool closed;

    Index count() const { return closed ? polygon.size() : polygon.size() - 2; }
    std::array<Index, 3> vertices(Index k) const {
        const Index n = polygon.size();
        return {k % n, (k + 1) % n, (k + 2) % n};
    }
    double value(Index k) const {
        const auto [a, b, c] = vertices(k);
        return turn(polygon[a], polygon[b], polygon[c]);
    }
    /// Sum of the two legs' lengths.
    double legs(Index k) const {
        const auto [a, b, c] = vertices(k);
        return distance(polygon[a], polygon[b]) + distance(polygon[b], polygon[c]);
    }
};

/// Signs with at most `most` changes (over the seam, too, when closed) that have to undo least.
std::vector<int> nearest_signs(const Turns& turns, Index most) {
    const auto n = static_cast<std::size_t>(turns.count());
    const auto states = static_cast<std::size_t>(2 * (most + 1)); // changes so far, sign now
    const double never = std::numeric_limits<double>::infinity();
    std::vector<double> height(n);
    for (std::size_t k = 0; k < n; ++k) {
        const double legs = turns.legs(static_cast<Index>(k));
        height[k] = legs > 0 ? turns.value(static_cast<Index>(k)) / legs : 0;
    }
    const auto cost = [&](std::size_t k, std::size_t sign) {
        return sign == 0 ? std::max(0.0, -height[k]) : std::max(0.0, height[k]);
    };
    std::vector<int> best;
    double best_cost = never;
    for (std::size_t first : {0U, 1U}) {
        std::vector<std::vector<double>> sum(n, std::vector<double>(states, never));
        std::vector<std::vector<std::size_t>> from(n, std::vector<std::size_t>(states));
        sum[0][first] = cost(0, first);
        for (std::size_t k = 1; k < n; ++k)
            for (std::size_t s = 0; s < states; ++s) {
                const std::size_t changed = s >= 2 ? (s - 2) ^ 1U : states;
                from[k][s] = changed < states && sum[k - 1][changed] < sum[k - 1][s] ? changed : s;
                sum[k][s] = sum[k - 1][from[k][s]] + cost(k, s % 2);
            }
        for (std::size_t s = 0; s < states; ++s) {
            const bool seam_changes = turns.closed && s % 2 != first;
            if (sum[n - 1][s] >= best_cost ||
                (seam_changes && s / 2 + 1 > static_cast<std::size_t>(most)))
                continue;
            best_cost = sum[n - 1][s];
            best.assign(n, 0);
            std::size_t at = s;
            for (std::size_t k = n; k-- > 0; at = from[k][at]) best[k] = at % 2 == 0 ? 1 : -1;
        }
    }
    return best;
}

/// The lambda >= 0 with the least lambda^T K lambda / 2 - r^T lambda: the active-set method of
/// [LawsonHanson1974, chapter 23].
Eigen::VectorXd nonnegative(const Eigen::MatrixXd& k, const Eigen::VectorXd& r) {
    const Index n = r.size();
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n);
    std::vector<Index> active;
    const double enough = 1e-12 * r.cwiseAbs().maxCoeff();
    for (Index round = 0; round < 3 * n; ++round) {
        Eigen::VectorXd pull = r - k * lambda;
        for (Index a : active) pull[a] = 0;
        Index enters = 0;
        if (!(pull.maxCoeff(&enters) > enough)) break;
        active.push_back(enters);
        while (!active.empty()) {
            const Eigen::MatrixXd part = k(active, active);
            const Eigen::VectorXd right = r(active);
            const Eigen::VectorXd goal = part.ldlt().solve(right);
            double step = 1;
            for (std::size_t j = 0; j < active.size(); ++j) {
                const double now = lambda[active[j]];
                const auto to = goal[static_cast<Index>(j)];
                if (to <= 0) step = std::min(step, now / std::max(now - to, 1e-300));
            }
            for (std::size_t j = 0; j < active.size(); ++j)
                lambda[active[j]] += step * (goal[static_cast<Index>(j)] - lambda[active[j]]);
            if (step == 1) break;
            std::erase_if(active, [&](Index a) {
                if (lambda[a] > 1e-14 * lambda.maxCoeff()) return false;
                lambda[a] = 0;
                return true;
            });
        }
    }
    return lambda;
}

/// Least-squares answers to pulls on the control points that leave the constraints alone.
class Response {
  public:
    Response(const NormalSystem& system, const Constraints& constraints)
        : system_(system), constraints_(constraints), normal_(factorize(system)) {
        if (!constraints.empty())
            schur_ = std::make_unique<SchurComplement>(*normal_, constraints, system.size());
    }
    PointSet operator()(const PointSet& pull) const {
        PointSet moves = normal_->solve(pull);
        if (!schur_) return moves;
        const PointSet multipliers = schur_->solve(constraints_.apply(moves));
        add_scaled(moves, -1.0,
                   normal_->solve(constraints_.apply_transposed(multipliers, system_.size())));
        return moves;
    }

    /// Control points that meet the constraints but for rounding.
    PointSet exact(PointSet control) const {
        return schur_ ? onto_constraints(std::move(control), constraints_, *normal_, *schur_)
                      : control;
    }

  private:
    const NormalSystem& system_;
    const Constraints& constraints_;
    std::unique_ptr<Factorization> normal_;
    std::unique_ptr<SchurComplement> schur_;
};

/// Adds the turns of the wrong sign, and their neighbours, to the ascending `watched`.
void watch_wrong(const Turns& turns, const std::vector<int>& signs, std::vector<Index>& watched) {
    const Index n = turns.count();
    for (Index k = 0; k < n; ++k) {
        if (turns.value(k) * signs[static_cast<std::size_t>(k)] > 0) continue;
        for (Index near : {k - 1, k, k + 1})
            if (near >= 0 && near < n) watched.push_back(near);
    }
    watched = distinct(std::move(watched));
}

/// One quadratic program: the best fit's control points moved so that the watched turns, linearised
/// around `around`, have their signs where coordinates are as large as `largest`.
PointSet with_signs(const PointSet& best, const PointSet& around, const std::vector<int>& signs,
                    const std::vector<Index>& watched, const Response& response, bool closed,
                    double largest) {
    constexpr double bent = 1e-7; // of the squared legs: a turn that counts as bent
    const double written = 8 * kept_roundings * std::numeric_limits<double>::epsilon() * largest;
    const Turns turns{around, closed};
    const auto count = static_cast<Index>(watched.size());
    PointSet pull_x(around.size(), count);
    PointSet pull_y(around.size(), count);
    Eigen::VectorXd missing(count);
    for (Index w = 0; w < count; ++w) {
        const Index k = watched[static_cast<std::size_t>(w)];
        const auto [a, b, c] = turns.vertices(k);
        const double legs = std::max(turns.legs(k), 1e-300);
        const double scale = signs[static_cast<std::size_t>(k)] / (legs * legs);
        const auto& p = around;
        // gradient of the turn, bilinear in the three points
        const double gx[] = {p(b, 1) - p(c, 1), p(c, 1) - p(a, 1), p(a, 1) - p(b, 1)};
        const double gy[] = {p(c, 0) - p(b, 0), p(a, 0) - p(c, 0), p(b, 0) - p(a, 0)};
        const Index at[] = {a, b, c};
        double here = turns.value(k);
        for (int v = 0; v < 3; ++v) {
            pull_x(at[v], w) += scale * gx[v];
            pull_y(at[v], w) += scale * gy[v];
            here += gx[v] * (best(at[v], 0) - p(at[v], 0)) + gy[v] * (best(at[v], 1) - p(at[v], 1));
        }
        missing[w] = std::max(bent, written / legs) - scale * here;
    }
    const PointSet moves_x = response(pull_x);
    const PointSet moves_y = response(pull_y);
    using Rows =
        Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
    const auto rows = [&](const PointSet& set) { return Rows(set.data(), set.size(), set.dim()); };
    const Eigen::MatrixXd matrix =
        rows(pull_x).transpose() * rows(moves_x) + rows(pull_y).transpose() * rows(moves_y);
    const Eigen::VectorXd lambda = nonnegative((matrix + matrix.transpose()) / 2, missing);
    PointSet result = best;
    const Eigen::VectorXd dx = rows(moves_x) * lambda;
    const Eigen::VectorXd dy = rows(moves_y) * lambda;
    for (Index i = 0; i < result.size(); ++i) {
        result(i, 0) += dx[i];
        result(i, 1) += dy[i];
    }
    return result;
}

} // namespace

PointSet solve_with_inflections(const NormalSystem& system, const Constraints& given,
                                Index most_inflections) {
    const Constraints constraints =
        given.empty() ? given : with_best_lengths(system, given.independent(system.size()));
    const PointSet best = solve_direct(system, constraints);
    const Closure closure = system.axes()[0].closure();
    const bool closed = closure == Closure::closed;
    const TurnMargin kept(kept_roundings, system.centre());
    if (inflection_count(best, closure, kept) <= most_inflections) return best;
    const double largest = largest_length(uncentred(best, system.centre()));
    const std::vector<int> signs = nearest_signs({best, closed}, most_inflections);
    const Response response(system, constraints);
    PointSet polygon = best;
    std::vector<Index> watched; // turns that had the other sign once
    constexpr int most_programs = 16;
    for (int round = 0; round < most_programs; ++round) {
        watch_wrong({polygon, closed}, signs, watched);
        polygon = with_signs(best, polygon, signs, watched, response, closed, largest);
        if (inflection_count(polygon, closure, kept) <= most_inflections) break;
    }
    return response.exact(std::move(polygon));
}

} // namespace batten
