#pragma once

#include <batten/search/grid_sizes.hpp>
#include <batten/search/spread_knots.hpp>

#include <limits>
#include <map>

namespace batten {

/// A spline and how far the samples of a task are from it.
struct GridFit {
    Spline spline;
    std::vector<double> ratio; ///< distance over tolerance, per sample
    double worst = 0;          ///< the largest of these
};

GridFit measured(const GridTask& task, Spline spline);

/// Least squares to `goals`, which stand for the samples; judged by the samples. Throws SolverError
/// when they do not determine the control points, ConstraintConflict when what must hold cannot.
GridFit least_squares(const GridTask& task, const std::vector<KnotVector>& axes,
                      const Samples& goals);

/// Fits with given numbers of control points and remembers the best that met the tolerance.
class GridTrials {
  public:
    GridTrials(const GridTask& task, std::vector<Spread> spreads);

    /// Whether a fit that misses the tolerance by little is pushed towards its worst samples.
    enum class Effort { least_squares, equalised };
    Effort effort = Effort::least_squares;

    /// Largest distance over tolerance with n control points per axis; remembered.
    double operator()(const std::vector<Index>& n);

    Spline best; ///< of the fewest control points that met the tolerance, or nearest to it
    Index fewest = std::numeric_limits<Index>::max();
    double best_worst = std::numeric_limits<double>::infinity();
    bool met = false;
    std::string conflict; ///< why what must hold could not, with too few control points

  private:
    double attempt(const std::vector<Index>& n);
    /// Moves the goals of the samples that are furthest out beyond them, again and again, as a
    /// greater weight would: the system keeps its factors.
    void equalise(const std::vector<KnotVector>& axes, GridFit& best_trial) const;
    /// Part of what would be wild between samples, where that counts; else 0.
    double between(const GridFit& trial) const;
    void keep(Index count, GridFit& trial);

    const GridTask& task_;
    std::vector<Spread> spreads_;
    std::map<std::vector<Index>, double> known_[2];
    std::vector<std::vector<double>> ascending_;
};

} // namespace batten
