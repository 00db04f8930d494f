#pragma once

#include <batten/solve/sample_rows.hpp>

#include <memory>
#include <vector>

namespace batten {

/// What smoothing by one factor leaves.
struct Quality {
    double squares;                    ///< of the weighted residuals, summed
    double trace;                      ///< of the matrix that makes fitted values of the samples
    std::vector<double> axis_traces{}; ///< whose product it is, where it is one
    double squares_growth = 0;         ///< of a cloud: derivatives by the factor's logarithm
    double trace_growth = 0;
};

/// Judges factors of the roughness, none of its numbers a difference of larger ones.
class SmoothingQuality {
  public:
    virtual ~SmoothingQuality() = default;
    SmoothingQuality() = default;
    SmoothingQuality(const SmoothingQuality&) = delete;
    SmoothingQuality& operator=(const SmoothingQuality&) = delete;
    /// Throws SolverError when the factor does not determine every control point.
    virtual Quality operator()(double lambda) const = 0;
    /// Whether the trace is an estimate and a factor dear.
    virtual bool estimated() const = 0;
};

/// Of a system with factors from the samples' rows, else from its entries. The arguments must
/// outlive it.
std::unique_ptr<SmoothingQuality> smoothing_quality(const NormalSystem& system,
                                                    const Samples& samples,
                                                    const Parameters& parameters, int order);

} // namespace batten
