#include "fit_flags.hpp"
#include "parse.hpp"

namespace batten::command {

namespace {

void add_tolerance_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_option("--tolerance,-t", flags.tolerance,
                   "Every sample within this distance, with as few control points as it takes")
        ->check(positive())
        ->group("Size");
    fit.add_option("--tolerances", flags.tolerances,
                   "File of one tolerance per sample; beside --tolerance the smaller holds")
        ->group("Size");
    fit.add_option("--max-control-points", flags.max_control_points,
                   "Not more than these for a tolerance")
        ->check(positive())
        ->group("Size");
    fit.add_option("--corners", flags.corners,
                   "auto, none, or a list of samples: where a curve may bend sharply")
        ->group("Size")
        ->capture_default_str();
}

} // namespace

void add_data_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_option("--control-points,-n", flags.control_points,
                   "Number of control points: 30, 20x30 or 8x8x8")
        ->group("Size");
    fit.add_option("--degree,-p", flags.degree, "Degree 1 to 9, one for all axes or one each")
        ->delimiter(',')
        ->group("Shape")
        ->capture_default_str();
    fit.add_flag("--closed{all}", flags.closed,
                 "Closed curve, at its seam as smooth as elsewhere or --closed=C0, C1, ...; for a "
                 "grid the closed axes, as --closed=0 or --closed=0,1")
        ->group("Shape");
    fit.add_option("--parametrize", flags.parametrize,
                   "chord (which holds without it for points in order), centripetal or uniform")
        ->group("Shape");
    fit.add_option("--parameters", flags.parameters,
                   "File of parameters, one per sample; for a grid one file per axis")
        ->group("Shape");
    fit.add_option("--project", flags.project,
                   "A cloud's parameters: its coordinates xy, xz or yz, or in its best plane")
        ->group("Shape");
    fit.add_option("--knots", flags.knots,
                   "data (NURBS Book 9.69, as for a named method), uniform, a text file of one "
                   "axis's knots, or a spline .json whose knots to take; without it as data, from "
                   "both ends alike")
        ->group("Shape");
    fit.add_option("--grid", flags.grid, "Grid shape of the points, last axis fastest: 81x81")
        ->group("Points");
    fit.add_flag("--heights", flags.heights, "The file is a table of heights over a regular grid")
        ->group("Points");
    fit.add_option("--spacing", flags.spacing, "Grid distances DX,DY of --heights")
        ->group("Points")
        ->capture_default_str();
}

namespace {

void add_weights_flag(CLI::App& fit, FitFlags& flags) {
    fit.add_option("--weights", flags.weights, "File of one positive weight per sample")
        ->group("Points");
}

void add_method_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_option("--method,-m", flags.method, "auto, or one of `batten methods`")
        ->group("Method")
        ->capture_default_str();
    fit.add_option("--initial", flags.initial,
                   "data, zero, or a file of control points or a spline .json")
        ->group("Method")
        ->capture_default_str();
    fit.add_option(
           "--before", flags.before,
           "File of the control points one iteration before --initial, or the spline .json: "
           "a method with memory goes on")
        ->group("Method");
    fit.add_option("--set", flags.set, "The method's own numbers: name=value")->group("Method");
    fit.add_option("--moving", flags.moving, "Local PIA: only these control points move: 3,4,5")
        ->group("Method");
    fit.add_option("--interpolate", flags.interpolate,
                   "Samples to hit exactly: ends, a list 0,20,40, or a file of indices")
        ->group("Must hold");
    fit.add_option("--tangents", flags.tangents,
                   "File of directions to have exactly: sample, x, y[, z] per line (for a grid: "
                   "sample, axis, x, y, z)")
        ->group("Must hold");
    fit.add_option("--derivatives", flags.derivatives,
                   "The same for first derivatives, length and all, by parameters over [0, 1]")
        ->group("Must hold");
    fit.add_option("--boundary", flags.boundaries,
                   "A surface's boundary: u0=FILE, u1=, v0=, v1= (spline .json); may be repeated")
        ->group("Must hold");
    fit.add_option("--preserve", flags.preserve,
                   "convexity, or no more inflections than the samples (with a size: than the "
                   "initial control polygon)")
        ->group("Must hold");
}

void add_noise_and_stop_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_flag("--robust", flags.robust, "Find outliers, list them and leave them out")
        ->group("Noise");
    fit.add_option("--smooth", flags.smooth,
                   "Smoothing: auto (generalised cross-validation), or the factor of the roughness")
        ->group("Noise");
    fit.add_option("--smooth-order", flags.smooth_order,
                   "Derivative whose square is the roughness, 2 or 3")
        ->check(CLI::IsMember({2, 3}))
        ->group("Noise")
        ->capture_default_str();
    fit.add_option("--max-iterations", flags.max_iterations, "Most iterations")
        ->check(not_negative())
        ->group("Stop")
        ->capture_default_str();
    fit.add_option("--stop-gradient", flags.stop_gradient,
                   "Stop at this Frobenius norm of A^T(Q - AP)")
        ->check(not_negative())
        ->group("Stop");
    fit.add_option("--stop-relative-gradient", flags.stop_relative_gradient,
                   "Stop at this part of its first value (1e-10 when no other stop is given)")
        ->check(not_negative())
        ->group("Stop");
    fit.add_option("--stop-deviation", flags.stop_deviation, "Stop when every sample is this close")
        ->check(not_negative())
        ->group("Stop");
    fit.add_option("--threads", flags.threads, "Threads; 0 takes every core")
        ->check(not_negative())
        ->group("Machine")
        ->capture_default_str();
    fit.add_option("--memory", flags.memory,
                   "Most memory for the samples, like 800M or 2G; more are refused")
        ->group("Machine");
    fit.add_flag("--quiet,-q", flags.quiet, "Say nothing unless something is wrong")
        ->group("Machine");
}

void add_output_flags(CLI::App& fit, FitFlags& flags) {
    fit.add_option(
           "POINTS", flags.points,
           "Points: .csv .txt .xyz .dat (also .csv.gz ...) .npy .ply .obj .stl .las, or - for "
           "standard input")
        ->required();
    fit.add_option("--output,-o", flags.outputs,
                   "Write the spline: .json .step .iges .svg .obj .g2 .stl .vtu .vts .csv; may be "
                   "repeated")
        ->group("Output");
    fit.add_option("--report", flags.report, "Write a page to look at: .html")->group("Output");
    add_export_flags(fit, flags.exported);
    fit.add_option("--summary", flags.summary, "Write the report as JSON")->group("Output");
    fit.add_flag("--history", flags.history, "Keep every iteration in the summary")
        ->group("Output");
}

} // namespace

void add_flags(CLI::App& fit, FitFlags& flags) {
    add_output_flags(fit, flags);
    add_data_flags(fit, flags);
    add_tolerance_flags(fit, flags);
    add_weights_flag(fit, flags);
    add_method_flags(fit, flags);
    add_noise_and_stop_flags(fit, flags);
    one_value_each(fit);
}

} // namespace batten::command
