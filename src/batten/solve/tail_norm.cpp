#include <batten/solve/tail_norm.hpp>

#include <algorithm>

namespace batten {

TailNorm::TailNorm(int degree, Index border)
    : degree_(degree),
      border_(border),
      width_(degree + border),
      triangle_(static_cast<std::size_t>((width_ + 1) * width_)) {}

void TailNorm::prepend_border(Index c, const Extended* row) {
    Extended* own = triangle(degree_ + c) + degree_;
    for (Index k = c + 1; k < border_; ++k) {
        Extended* other = triangle(degree_ + k) + degree_;
        Extended sum = 0;
        for (Index l = c + 1; l < border_; ++l) sum += other[l] * row[l];
        other[c] = -sum / row[c];
    }
    own[c] = 1 / row[c];
}

Extended TailNorm::product(Index k, const Extended* row) const {
    const Extended* own = triangle(k);
    Extended sum = 0;
    for (Index j = 0; j < width_; ++j) sum += own[j] * row[j + 1];
    return sum;
}

void TailNorm::prepend(const Extended* row) {
    // v's first entry is solved for; the others go down one place
    for (Index k = 0; k < width_; ++k) {
        Extended* own = triangle(k);
        const Extended first = -product(k, row) / row[0];
        std::copy_backward(own, own + degree_ - 1, own + degree_);
        own[0] = first;
    }
    std::fill_n(triangle(width_), width_, Extended{0});
    triangle(width_)[0] = 1 / row[0];
    for (Index j = 0; j < width_; ++j)
        for (Index k = j + 1; k <= width_; ++k) {
            if (triangle(k)[j] == 0) continue;
            const Rotation turn(triangle(j)[j], triangle(k)[j]);
            for (Index l = j; l < width_; ++l) turn.apply(triangle(j)[l], triangle(k)[l]);
        }
}

Extended TailNorm::squares_of(const Extended* row, const Extended* v) const {
    const Extended first = v[0] / row[0];
    Extended sum = first * first;
    for (Index k = 0; k < width_; ++k) {
        const Extended rest = product(k, v) - first * product(k, row);
        sum += rest * rest;
    }
    return sum;
}

Extended TailNorm::squares_of_border(const Extended* v) const {
    Extended sum = 0;
    for (Index k = degree_; k < width_; ++k) {
        Extended rest = 0;
        for (Index c = 0; c < border_; ++c) rest += triangle(k)[degree_ + c] * v[c];
        sum += rest * rest;
    }
    return sum;
}

} // namespace batten
