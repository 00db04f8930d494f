#pragma once

#include "export_flags.hpp"

#include <batten/fit/fit.hpp>
#include <batten/io/points_file.hpp>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace batten::command {

/// The flags of `batten fit` as typed.
struct FitFlags {
    std::string points;
    std::vector<std::string> outputs;
    std::string summary;
    std::string report;
    ExportFlags exported;
    bool history = false;
    std::string grid;
    bool heights = false;
    std::string spacing = "1,1";
    std::string control_points;
    std::vector<int> degree{3};
    std::string closed;
    std::string parametrize;
    std::vector<std::string> parameters;
    std::string knots;
    std::string method = "auto";
    std::string initial = "data";
    std::string before;
    std::vector<std::string> set;
    Index max_iterations = StopRule{}.max_iterations;
    double stop_gradient = 0;
    double stop_relative_gradient = 0;
    double stop_deviation = 0;
    std::string weights;
    double tolerance = 0;
    std::string tolerances;
    Index max_control_points = 0;
    std::string corners = "auto";
    std::string interpolate;
    std::string tangents;
    std::string derivatives;
    std::vector<std::string> boundaries;
    std::string preserve;
    std::string moving;
    std::string smooth;
    int smooth_order = 2;
    bool robust = false;
    std::string project;
    int threads = 0;
    std::string memory;
    bool quiet = false;
};

/// Adds the flags to the subcommand.
void add_flags(CLI::App& fit, FitFlags& flags);

/// Of these, those that say what the points are and over which knots they are taken: size, shape
/// and parameters, grid and heights.
void add_data_flags(CLI::App& fit, FitFlags& flags);

/// The points that the flags name, with their grid, weights and notes. Throws InvalidInput for more
/// than --memory allows.
Samples samples_of(const FitFlags& flags, const ReadObserver& observer = {});

/// What they say of the spline's space; `fit` knows which were given.
ShapeOptions shape_options(const FitFlags& flags, const CLI::App& fit, const Samples& samples);

/// `auto`, or the factor of a roughness of this order; nothing is smoothed for an empty text.
SmoothOptions smooth_options(const std::string& text, int order);

/// Knots per axis: of a spline .json, or of one axis in a text file.
std::vector<std::vector<double>> given_knots(const std::string& path);

/// What the flags ask of the fit; `fit` knows which were given. Throws InvalidInput naming the
/// flag.
FitOptions options_of(const FitFlags& flags, const CLI::App& fit, const Samples& samples);

} // namespace batten::command
