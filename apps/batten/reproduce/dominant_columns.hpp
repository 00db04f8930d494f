#pragma once

#include <batten/fit/fit.hpp>

namespace batten::command {

/// A patch by repeated least squares [Park2011], as Lin and Zhang compare with: knots are means of
/// the dominant rows' and columns' parameters; each iteration makes one more of them dominant, that
/// of the worst sample along the axis where its neighbours are further apart, and solves anew.
struct RepeatedLeastSquares {
    FitResult first;
    FitResult last;
    double seconds; ///< for all iterations
};

/// `shape`: dominant rows and columns to start with, at most; those of the largest curvature.
RepeatedLeastSquares repeated_least_squares(const Samples& grid, const std::vector<Index>& shape,
                                            Index iterations);

} // namespace batten::command
