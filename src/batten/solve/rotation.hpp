#pragma once

#include <cmath>
#include <limits>

namespace batten {

/// What orthogonal factors are computed in: with its 64 bits a row's digits outlast rotations
/// against rows of much larger weight.
using Extended = long double;

/// A rotation of two numbers that leaves nothing of the second; none where both have decayed so far
/// from row to row that their squares are nothing: then the second may be dropped.
struct Rotation {
    Extended cosine = 1;
    Extended sine = 0;

    Rotation(Extended kept, Extended gone) {
        const Extended squares = kept * kept + gone * gone;
        if (squares < std::numeric_limits<Extended>::min()) return;
        const Extended length = std::sqrt(squares);
        cosine = kept / length;
        sine = gone / length;
    }
    void apply(Extended& a, Extended& b) const {
        const Extended kept = cosine * a + sine * b;
        b = cosine * b - sine * a;
        a = kept;
    }
};

} // namespace batten
