#include <batten/search/search.hpp>

namespace batten {

Fitted fit_by_search(const Problem& problem, std::string_view) {
    return problem.kind == SampleKind::sequence ? curve_within(problem) : surface_within(problem);
}

} // namespace batten
