#pragma once

#include <batten/core/core.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace batten {

/// What samples are.
enum class SampleKind {
    sequence, ///< points along a curve, in order
    grid,     ///< points over 2 or 3 axes
    cloud,    ///< points in no order
};

std::string_view to_string(SampleKind kind);

/// How points without a grid follow each other.
enum class Order {
    along_curve,
    none,   ///< as a scanner gives them: a cloud, seen in its best plane
    ground, ///< a cloud over the ground, whose plane is that of the first two coordinates
};

/// How a grid's points lie.
enum class Spacing {
    free,
    even, ///< a table of heights over an even grid: parameters are evenly spaced, too
};

/// Data points as a user brings them.
struct Samples {
    /// (m x dim), dim 1 to 16; of a grid row-major, last axis fastest.
    Points points{};
    /// Samples per axis of a grid (2 or 3 entries, product m); empty for a sequence or a cloud.
    std::vector<Index> grid{};
    /// One positive weight per sample, or empty when all are one.
    std::vector<double> weights{};
    Order order = Order::along_curve;
    Spacing spacing = Spacing::free;
    /// What was done to the data on the way in, one sentence each; shown in the report.
    std::vector<std::string> notes{};

    SampleKind kind() const {
        return !grid.empty()                 ? SampleKind::grid
               : order == Order::along_curve ? SampleKind::sequence
                                             : SampleKind::cloud;
    }
    Index size() const { return points.size(); }
    Index dim() const { return points.dim(); }
    Index axis_count() const { return grid.empty() ? 1 : static_cast<Index>(grid.size()); }
    /// Samples along each axis: the grid's shape, or {m}.
    std::vector<Index> shape() const { return grid.empty() ? std::vector<Index>{size()} : grid; }
};

/// Throws InvalidInput when there are no samples, dim is outside 1 to 16, the grid's shape does not
/// match, a coordinate is not finite (the sample is named) or a weight is not positive and finite.
void check(const Samples& samples);

/// What check() asks of samples without looking at a coordinate or a weight: how many there are,
/// their dimension, whether they make the grid. Throws InvalidInput.
void check_shape(const Samples& samples);

/// Throws InvalidInput, `what` first, unless i is one of so many samples.
void check_sample(std::string_view what, Index i, Index samples);

/// Makes the grid of heights h(i, j) (m1 x m2, one coordinate) the points (i dx, j dy, h).
Samples height_samples(const Points& heights, std::array<Index, 2> shape,
                       std::array<double, 2> spacing);

/// Indices of the ends: first and last sample of a sequence, the corners of a grid.
std::vector<Index> end_samples(const Samples& samples);

/// Lower and upper corner of the axis-parallel box of the points: (2 x dim).
PointSet bounding_box(const Points& points);

/// Length of the bounding box's diagonal, the size of the data.
double diagonal(const Points& points);

} // namespace batten
