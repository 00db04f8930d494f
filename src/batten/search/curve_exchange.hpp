#pragma once

#include <batten/search/curve_refining.hpp>

#include <functional>

namespace batten {

/// A search for few knots, at most so many control points; what it finds of corners it enters in
/// the task.
using CurveSearch = std::function<CurveWithin(CurveTask& task, Index most)>;

/// A search that goes by some of very many samples and is checked by all: those that break the
/// tolerance join the others until none does, as cuts do in [Kelley1960]. What is found is fitted
/// to all samples once more where that keeps the tolerance. The samples gone by grow where there
/// are too few for the knots that it takes; failing these, and where there are not so many samples,
/// it is the search itself.
CurveWithin by_exchange(CurveTask& task, Index most, const CurveSearch& search);

} // namespace batten
