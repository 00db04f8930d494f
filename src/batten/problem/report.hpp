#pragma once

#include <batten/iterate/iterate.hpp>
#include <batten/measure/deviation.hpp>

#include <string>
#include <utility>
#include <vector>

namespace batten {

/// One iteration, as kept on request.
struct HistoryEntry {
    Index iteration;
    double gradient_norm;
    double largest_move;
    double max_deviation;     ///< of a sample at its parameter
    double constraint_error;  ///< sum of squares; 0 without constraints
    Index control_points = 0; ///< in all, where an iteration changes their number; else 0
    double largest_mean = 0;  ///< longest mean residual of a group, e_c of EPIA; else 0
};

/// Something that was stated and that the fit must reach.
struct Goal {
    std::string name; ///< tolerance, deviation, gradient, relative gradient, exact samples, ...
    double stated;    ///< at most this much
    double reached;
    bool met;
};

/// A polygon on the way: the free control points of one iteration.
struct Frame {
    Index iteration;
    PointSet control; ///< (N x dim)
};

/// What was fitted, how it went and how far the samples are: the same object for library, command
/// and page.
struct FitReport {
    std::string kind; ///< curve, surface or volume
    Index samples = 0;
    Index dim = 0;
    std::vector<int> degree;
    std::vector<Index> control_shape; ///< free control points per axis, as sizes are stated
    std::vector<Closure> closures;
    std::string method;
    std::string method_reason; ///< why `auto` chose it; empty when the caller did
    Settings settings;
    Termination termination = Termination::converged;
    Index iterations = 0;
    double gradient_norm = 0;
    double first_gradient_norm = 0;
    double predicted_rate = 0; ///< 0 when the theory gives none
    double observed_rate = 0;  ///< 0 when the run was too short
    Deviation deviation;
    double above_minimum = -1; ///< by how much a smooth curve's or grid's iteration ended above the
                               ///< least functional, in parts of it; -1: not measured
    Index interpolated = 0;    ///< samples that must be hit exactly
    double constraint_error = 0; ///< largest distance from one of them
    Index tangents = 0;          ///< directions and derivatives that must hold
    double tangent_error = 0;    ///< by how much they are missed, over the data's size; infinite:
                                 ///< the spline runs against one, or has no direction there
    Index boundaries = 0;        ///< boundaries that must hold
    double boundary_error = 0;   ///< largest distance from one of them
    Index inflections = -1;      ///< of the control polygon, where they are kept; else -1
    Index allowed_inflections = -1; ///< that the kept shape allows it; -1: not counted
    double held_back = 0;         ///< longest move that was left to make when the kept shape locked
                                  ///< the iteration; 0 where it did not
    Index curve_inflections = -1; ///< of a planar curve fitted to a tolerance, those larger than a
                                  ///< quarter of it; -1 where not counted
    Index data_inflections = -1;  ///< the same of the samples
    double tolerance = 0;         ///< as stated, 0 when none was (per sample: the smallest)
    double largest_tolerance = 0; ///< the largest of those per sample; 0 where all are alike
    double tolerance_ratio = 0;   ///< largest distance of a sample in parts of its own tolerance
    std::string verdict;          ///< whether and how the tolerance was met, in words
    double noise_level = 0;       ///< of the samples, where it was estimated; else 0
    double between_samples = 0; ///< part of what is allowed between samples that is used: at most 1
                                ///< is good; 0 where not checked
    std::vector<std::pair<std::string, Index>>
        stages;                 ///< control points after each stage of a fit to a tolerance
    Index searched_samples = 0; ///< that a fit to a tolerance went by; 0: by all
    Index full_checks = 0;      ///< of what was found by some of the samples, by all of them
    double smoothing = 0;       ///< lambda, where smoothness counts; else 0
    double freedom = 0;         ///< degrees of freedom that cross-validation left; else 0
    std::vector<Index>
        set_aside;        ///< samples found to be outliers: not fitted, not in the deviation
    double data_size = 0; ///< diagonal of the samples' box, the greatest double at most
    std::vector<std::pair<std::string, double>> seconds; ///< per stage, in order
    Index passes = 0;     ///< over a source's samples; 0 where they were in memory at once
    Index bytes_read = 0; ///< of files by these passes
    std::vector<HistoryEntry> history;
    std::vector<Frame> frames; ///< with FitOptions::most_frames, evenly over the iterations
    std::vector<Goal> goals;   ///< all that was stated, met or not
    std::vector<std::string> notes;

    /// Whether an iteration was run, so that gradients and rates mean something.
    bool iterated() const { return first_gradient_norm > 0 || iterations > 0; }
    /// Whether every stated goal is reached.
    bool goals_met() const;
    /// Whether the spline can be used: all endings but breakdown.
    bool usable() const { return termination != Termination::breakdown; }
    /// Sum of the stages.
    double total_seconds() const;
    /// One line.
    std::string brief() const;
    /// The account in words: a name and what there is to say, line by line.
    std::vector<std::pair<std::string, std::string>> lines() const;
    /// brief() and these lines, aligned.
    std::string full() const;
    /// The JSON of docs/formats.md.
    std::string to_json() const;
};

} // namespace batten
