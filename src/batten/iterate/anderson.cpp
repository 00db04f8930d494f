#include <batten/iterate/anderson.hpp>

#include <batten/iterate/lin2018.hpp>
#include <batten/iterate/methods.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace batten {

Anderson::Anderson(const NormalSystem& system, int window)
    : system_(system), window_(static_cast<std::size_t>(window)) {
    check_setting("anderson", "window", window);
}

void Anderson::start(PointSet&) {
    scales_ = diagonal_steps(system_);
    for (double& x : scales_) x = std::sqrt(x);
    past_.clear();
    newest_ = 0;
    products_.assign(window_ * window_, 0);
    last_residual_ = {};
}

/// What the last move changed.
void Anderson::learn() {
    Past& now = past_[newest_];
    now.change = residual_;
    add_scaled(now.change, -1.0, last_residual_);
    for (std::size_t j = 0; j < past_.size(); ++j)
        products_[newest_ * window_ + j] = products_[j * window_ + newest_] =
            inner_product(now.change, past_[j].change);
}

/// Factors gamma of the changes that leave the least of the residual, |residual - sum of gamma
/// change|; directions that the changes hardly tell apart are left out.
std::vector<double> Anderson::combination() const {
    constexpr double rounding = 1e-12;
    const auto count = static_cast<Eigen::Index>(past_.size());
    Eigen::VectorXd lengths(count);
    Eigen::VectorXd along(count);
    for (Eigen::Index j = 0; j < count; ++j) {
        const auto at = static_cast<std::size_t>(j);
        const double length = std::sqrt(products_[at * window_ + at]);
        lengths[j] = length > 0 ? length : 1;
        along[j] = inner_product(past_[at].change, residual_) / lengths[j];
    }
    Eigen::MatrixXd gram(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j)
            gram(i, j) =
                products_[static_cast<std::size_t>(i) * window_ + static_cast<std::size_t>(j)] /
                (lengths[i] * lengths[j]);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
    const double least = rounding * solver.eigenvalues().maxCoeff();
    Eigen::VectorXd parts = solver.eigenvectors().transpose() * along;
    for (Eigen::Index j = 0; j < count; ++j)
        parts[j] = solver.eigenvalues()[j] > least ? parts[j] / solver.eigenvalues()[j] : 0;
    const Eigen::VectorXd gamma = (solver.eigenvectors() * parts).cwiseQuotient(lengths);
    return {gamma.begin(), gamma.end()};
}

const PointSet& Anderson::propose(const PointSet& control) {
    residual_ = reached_gradient(system_, control, scales_);
    norm_ = frobenius_norm(residual_);
    scale_rows(residual_, scales_);
    if (!last_residual_.empty()) learn();
    moves_ = residual_;
    const std::vector<double> gamma = past_.empty() ? std::vector<double>{} : combination();
    for (std::size_t j = 0; j < gamma.size(); ++j) add_scaled(moves_, -gamma[j], past_[j].change);
    scale_rows(moves_, scales_);
    for (std::size_t j = 0; j < gamma.size(); ++j) add_scaled(moves_, -gamma[j], past_[j].move);
    return moves_;
}

void Anderson::accept(const PointSet& moves) {
    std::swap(last_residual_, residual_);
    if (past_.size() < window_) {
        newest_ = past_.size();
        past_.emplace_back();
    } else {
        newest_ = (newest_ + 1) % window_;
    }
    past_[newest_].move = moves;
}

} // namespace batten
