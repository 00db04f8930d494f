#pragma once

#include <Eigen/Core>

namespace batten {

/// A Gaussian process through the neighbours of a sample: a linear drift, a covariance that falls
/// with the distance, and white noise. How smooth it is, how far it reaches and how large the
/// noise is are what is likeliest of the neighbours [Patterson1971], [Rasmussen2006] (5.8).
class LocalProcess {
  public:
    /// `places` (k x 1 to 3) and `values` (k x dim) of the neighbours, seen from the sample, whose
    /// own are zero; k at least twice the drift's terms.
    LocalProcess(const Eigen::MatrixXd& places, const Eigen::MatrixXd& values);

    /// Whether the neighbours determine the drift.
    bool exists() const { return exists_; }
    /// How far the sample is from where the process has it.
    double residual() const { return way_.norm(); }
    /// From the sample to there (dim).
    const Eigen::VectorXd& way() const { return way_; }
    /// Standard deviation of that, 0 where the neighbours have neither noise nor a bend; the more
    /// the fewer they are, for few know less of it.
    double deviation() const { return deviation_; }
    /// The residual in its standard deviations.
    double normal() const;
    /// Residuals of the neighbours, each by the process without it, in its standard deviations.
    const Eigen::VectorXd& of_neighbours() const { return of_neighbours_; }

  private:
    bool exists_ = false;
    Eigen::VectorXd way_;
    double deviation_ = 0;
    Eigen::VectorXd of_neighbours_;
};

} // namespace batten
