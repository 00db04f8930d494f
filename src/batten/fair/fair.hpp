#pragma once

#include <batten/iterate/iterate.hpp>
#include <batten/spline/spline.hpp>

#include <string>
#include <vector>

namespace batten {

/// How a spline is made fairer.
struct FairOptions {
    /// w: 0 leaves a control point where it is, nearly 1 makes it as fair as its neighbours allow.
    double weight = 1e-6;
    /// One per free control point in place of `weight`; empty: none.
    std::vector<double> weights{};
    /// Only these free control points move; empty: all but the ends of open axes.
    std::vector<Index> points{};
    /// Only so many move: those whose own best place leaves the least energy; 0: not asked for.
    Index automatic = 0;
    /// Of the derivatives whose squares are the energy, 1 to 3.
    int order = 2;
    /// `direct`, an iteration of make_method (the paper's is lin2018), or `auto`: direct, for more
    /// than 65536 control points (volumes: 4000) cg.
    std::string method = "auto";
    Settings settings{}; ///< of the method
    StopRule stop{};
};

/// How it went.
struct FairReport {
    double energy_before = 0; ///< integral of the squared derivatives, over axes of unit length
    double energy_after = 0;
    double largest_move = 0;     ///< of a control point
    std::vector<Index> moving{}; ///< the free control points that may move
    std::string method{};
    Settings settings{}; ///< of the method
    Summary course{};    ///< of an iteration

    /// The account in lines of words.
    std::string full() const;
    /// The JSON of docs/formats.md.
    std::string to_json() const;
};

struct FairResult {
    Spline spline;
    FairReport report;
};

/// Moves control points so that the sum of (1 - w_i) / w_i times their squared moves plus the
/// energy, the thin-plate roughness of the spline, is least: progressive-iterative fairing
/// [LinHuangZhangLin2026]. Throws InvalidInput for a weight outside 0 <= w < 1, an order that is
/// not 1 to 3 or above a degree, a control point that is not there or named twice, weights so
/// near 1 that nothing is held, or a method that is no iteration on equations.
FairResult fair(const Spline& spline, const FairOptions& options);

} // namespace batten
