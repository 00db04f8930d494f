#include <batten/robust/local_process.hpp>

#include <batten/core/vector_clones.hpp>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include <array>
#include <cmath>
#include <limits>

namespace batten {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

enum class Smoothness { once, always };

constexpr std::array lengths{0.25, 0.5, 1.0, 2.0, 4.0}; ///< in parts of the neighbours' radius
constexpr std::array noises{1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1.0, 100.0}; ///< their variance
constexpr std::size_t middle = 2;                                       ///< of the lengths

/// Covariances at distances in lengths, on the diagonal and below it, of a process that can be
/// differentiated once (Matern 3/2) or always.
MatrixXd covariances(const MatrixXd& distances, Smoothness smoothness, double length) {
    MatrixXd result(distances.rows(), distances.cols());
    for (Index j = 0; j < distances.cols(); ++j) {
        const Index count = distances.rows() - j;
        const auto far = distances.col(j).tail(count).array() / length;
        auto here = result.col(j).tail(count).array();
        if (smoothness == Smoothness::always) {
            here = (-0.5 * far.square()).exp();
        } else {
            here = std::sqrt(3.0) * far;
            here = (1 + here) * (-here).exp();
        }
    }
    return result;
}

/// Eliminates `n` columns of length `rows`, whose first n rows are symmetric, of which the lower
/// half is read: they become the factor L, those below become theirs times L^-T. False where a
/// pivot is not positive.
BATTEN_VECTOR_CLONES
bool eliminate(double* a, Index rows, Index n) {
    for (Index j = 0; j < n; ++j) {
        double* column = a + j * rows;
        if (!(column[j] > 0)) return false;
        const double scale = 1 / std::sqrt(column[j]);
        for (Index i = j; i < rows; ++i) column[i] *= scale;
        for (Index c = j + 1; c < n; ++c) {
            const double factor = column[c];
            double* next = a + c * rows;
            for (Index i = c; i < rows; ++i) next[i] -= factor * column[i];
        }
    }
    return true;
}

/// What does not depend on the kind of process.
struct Neighbourhood {
    MatrixXd distances; ///< of the neighbours from each other and, in the last row, the sample
    MatrixXd terms;     ///< of the drift, at the neighbours
    MatrixXd rest;      ///< of the values without a drift
};

/// A process of unit size through the neighbours.
struct Solved {
    /// L of their covariance with noise, and times L^-T, as rows: that with the sample, the drift's
    /// terms, the values.
    MatrixXd factor;
    MatrixXd of_drift; ///< factor of the products of the drift's terms
    double noise = 1;
    double variance = 0; ///< likeliest size
    double likelihood = -std::numeric_limits<double>::infinity();

    auto sample() const { return factor.row(factor.cols()); }
    auto terms(const Neighbourhood& by) const {
        return factor.middleRows(factor.cols() + 1, by.terms.cols());
    }
    auto values(const Neighbourhood& by) const { return factor.bottomRows(by.rest.cols()); }
    /// Of the values by the drift.
    MatrixXd explained(const Neighbourhood& by) const {
        return of_drift.triangularView<Eigen::Lower>().solve(terms(by) * values(by).transpose());
    }

    Solved() = default;
    Solved(const Neighbourhood& by, const MatrixXd& covariance, double of_noise) : noise(of_noise) {
        const Index k = covariance.cols();
        factor.resize(k + 1 + by.terms.cols() + by.rest.cols(), k);
        factor << covariance, by.terms.transpose(), by.rest.transpose();
        factor.diagonal().array() += noise;
        if (!eliminate(factor.data(), factor.rows(), k)) return;
        const Eigen::LLT<MatrixXd> products(terms(by) * terms(by).transpose());
        if (products.info() != Eigen::Success) return;
        of_drift = products.matrixL();
        const auto free = static_cast<double>(k - by.terms.cols());
        variance = (values(by).squaredNorm() - explained(by).squaredNorm()) / free;
        if (!(variance > 0)) return;
        likelihood = -free * std::log(variance) - 2 * factor.diagonal().array().log().sum() -
                     2 * of_drift.diagonal().array().log().sum();
    }
};

/// Goes from a place among so many to the next one while that has more; the most there is.
template <class Value>
double uphill(std::size_t& at, std::size_t count, int step, double most, Value value) {
    while (step < 0 ? at > 0 : at + 1 < count) {
        const std::size_t next = step < 0 ? at - 1 : at + 1;
        const double there = value(next);
        if (!(there > most)) break;
        most = there;
        at = next;
    }
    return most;
}

/// The likeliest process, sought uphill from the middle of the lengths and noises.
class Likeliest {
  public:
    explicit Likeliest(const Neighbourhood& by) : by_(by) {
        seek(Smoothness::always);
        seek(Smoothness::once);
    }

    Solved solved;

  private:
    void seek(Smoothness smoothness) {
        std::size_t noise = noises.size() / 2;
        const double at_middle = of_length(smoothness, middle, noise);
        for (const int step : {-1, 1}) {
            std::size_t length = middle;
            std::size_t near = noise;
            uphill(length, lengths.size(), step, at_middle,
                   [&](std::size_t k) { return of_length(smoothness, k, near); });
        }
    }

    /// Likelihood of a length with the noise that is likeliest, sought from one which it replaces.
    double of_length(Smoothness smoothness, std::size_t length, std::size_t& noise) {
        const MatrixXd covariance = covariances(by_.distances, smoothness, lengths[length]);
        double best = take(covariance, noise);
        for (const int step : {1, -1}) {
            const std::size_t before = noise;
            best = uphill(noise, noises.size(), step, best,
                          [&](std::size_t k) { return take(covariance, k); });
            if (noise != before) break;
        }
        return best;
    }

    double take(const MatrixXd& covariance, std::size_t noise) {
        Solved one(by_, covariance, noises[noise]);
        const double likelihood = one.likelihood;
        if (likelihood > solved.likelihood) std::swap(solved, one);
        return likelihood;
    }

    const Neighbourhood& by_;
};

} // namespace

LocalProcess::LocalProcess(const MatrixXd& places, const MatrixXd& values) {
    const Index k = places.rows();
    const Index terms = places.cols() + 1;
    const double radius = places.rowwise().norm().maxCoeff();
    if (!(radius > 0) || k < 2 * terms) return;
    Neighbourhood by{MatrixXd(k + 1, k), MatrixXd(k, terms), {}};
    for (Index j = 0; j < k; ++j) {
        for (Index i = j; i < k; ++i)
            by.distances(i, j) = (places.row(i) - places.row(j)).norm() / radius;
        by.distances(k, j) = places.row(j).norm() / radius;
    }
    by.terms << VectorXd::Ones(k), places / radius;
    Eigen::JacobiSVD<MatrixXd> straight(by.terms, Eigen::ComputeThinU | Eigen::ComputeThinV);
    straight.setThreshold(1e-8);
    const Index p = straight.rank(); // fewer where they are on a line or plane
    const MatrixXd directions = straight.matrixV().leftCols(p);
    const VectorXd at_sample = directions.row(0).transpose();
    if (at_sample.norm() < 1 - 1e-8) return; // which the sample is not on
    by.terms *= directions;
    const MatrixXd by_drift = directions.transpose() * straight.solve(values);
    by.rest = values - by.terms * by_drift; // for the sake of rounding
    exists_ = true;
    way_ = (at_sample.transpose() * by_drift).transpose();
    of_neighbours_.setZero(k);
    const Solved best = Likeliest(by).solved;
    if (!(best.variance > 0)) return; // nothing but the drift
    const auto lower = best.factor.topRows(k).triangularView<Eigen::Lower>();
    const auto drift_factor = best.of_drift.triangularView<Eigen::Lower>();
    const MatrixXd drift = drift_factor.solve(best.terms(by)); // orthonormal rows
    const VectorXd to_drift = drift_factor.solve(at_sample) - drift * best.sample().transpose();
    way_ = (best.sample() * best.values(by).transpose() +
            to_drift.transpose() * best.explained(by) + at_sample.transpose() * by_drift)
               .transpose();
    const auto free = static_cast<double>(k - p);
    const double variance = best.variance * std::pow(1 + 24 / (free * free), 2);
    deviation_ = std::sqrt(variance *
                           (1 + best.noise - best.sample().squaredNorm() + to_drift.squaredNorm()));
    // the inverse of the covariance without the drift is R^T R
    MatrixXd r = lower.solve(MatrixXd::Identity(k, k));
    r -= drift.transpose() * (drift * r);
    const MatrixXd off = r.transpose() * best.values(by).transpose();
    for (Index j = 0; j < k; ++j)
        of_neighbours_(j) = off.row(j).norm() / (r.col(j).norm() * std::sqrt(variance));
}

double LocalProcess::normal() const {
    if (deviation_ > 0) return residual() / deviation_;
    return residual() > 0 ? std::numeric_limits<double>::infinity() : 0;
}

} // namespace batten
