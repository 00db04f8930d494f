#pragma once

#include <batten/core/core.hpp>

namespace batten {

/// Parameters of a cloud (m x 1 to 3), each in the data's length along it: what is near each other
/// among the points (m x dim) is near there, whatever the parameters' units. As they are where the
/// points have no lengths: fewer coordinates than parameters, or one.
Points places_in_lengths(const Points& points, const Points& places);

} // namespace batten
