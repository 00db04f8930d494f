#pragma once

#include <batten/problem/report.hpp>
#include <batten/spline/spline.hpp>

namespace batten {

/// A fitted spline and the account of it.
struct FitResult {
    Spline spline;
    FitReport report;
    Parameters parameters;
};

} // namespace batten
