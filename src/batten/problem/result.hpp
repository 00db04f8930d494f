#pragma once

#include <batten/problem/report.hpp>
#include <batten/spline/spline.hpp>

namespace batten {

/// A fitted spline and the account of it.
struct FitResult {
    Spline spline;
    FitReport report;
    /// Empty, as are the deviations, without FitOptions::keep_per_sample.
    Parameters parameters;
    /// How far the spline is from each sample, those set aside too: of report.deviation.kind.
    std::vector<double> deviations{};
};

/// What a driver answers: its account holds how it went, not yet what every fit's account says.
struct Fitted {
    Spline spline;
    Parameters parameters; ///< of the problem's samples, as the driver left them
    FitReport report{};
    /// How the driver means samples to be close.
    DeviationKind judged_by = DeviationKind::parametric;
    /// One per sample, of that kind, where the driver has measured them; else empty.
    std::vector<double> deviations{};
};

} // namespace batten
