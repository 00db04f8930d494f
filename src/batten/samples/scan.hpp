#pragma once

#include <batten/core/lanes.hpp>
#include <batten/samples/samples.hpp>

#include <limits>
#include <span>

namespace batten {

/// The box of points that pass by, and the first that is not finite.
class PointScan {
  public:
    explicit PointScan(Index dim);

    /// Forgets all points.
    void clear();
    /// Points (count x dim) that follow those before.
    void add(const double* points, Index count);
    /// What another scan saw after this one.
    void add(const PointScan& next);

    /// Index of the first point with a coordinate that is not finite; -1 where all are.
    Index first_bad() const { return first_bad_; }
    Index dim() const { return dim_; }
    /// (2 x dim): infinite and negative where there was no number.
    PointSet box() const;

  private:
    Index dim_;
    Index count_ = 0;
    Index first_bad_ = -1;
    /// Coordinates as they lie in memory, eight points at a time: dim vectors of eight.
    std::vector<Lanes> least_;
    std::vector<Lanes> largest_;
};

/// Points taken block by block, on all threads.
PointScan scanned(const Points& points);

/// Throws InvalidInput when there are no samples (-1: it is not known how many), or dim is outside
/// 1 to 16.
void check_extent(Index samples, Index dim);

/// Throws InvalidInput as check(samples) does, by the scan of their points.
void check(const Samples& samples, const PointScan& scan);

/// What to throw for a sample with a coordinate that is not finite.
InvalidInput not_finite(Index sample, std::span<const double> point);

/// The range of weights that pass by.
class WeightScan {
  public:
    /// Weights that follow those before; throws InvalidInput for one that is not positive and
    /// finite.
    void add(std::span<const double> weights);
    /// Throws InvalidInput when the largest and the least are too far apart for their products.
    void check_range() const;

    double least() const { return least_; }
    double largest() const { return largest_; }

  private:
    Index count_ = 0;
    double least_ = std::numeric_limits<double>::infinity();
    double largest_ = 0;
};

/// The power of two by which lengths in a box (2 x dim corners) are multiplied so that their
/// squares and products stay in the range of numbers; 1 for coordinates of usual sizes, 2^-200 to
/// 2^200.
double usual_unit(const PointSet& box);

/// Length of a box's diagonal, where its square leaves the range of numbers, too.
double diagonal_of(const PointSet& box);

} // namespace batten
