#pragma once

#include <batten/samples/passes.hpp>
#include <batten/samples/scan.hpp>

namespace batten {

/// What is to be known of samples before anything is made of them.
class SampleScan {
  public:
    explicit SampleScan(Index dim) : box_(dim) {}

    /// Of a chunk whose points are scanned, in order. Throws InvalidInput for a coordinate that is
    /// not finite and a weight that is not positive and finite.
    void add(const SampleChunk& chunk, const PointScan& points);
    /// Once all are in. Throws InvalidInput where there are none, or weights are too far apart.
    void check(Index samples) const;

    /// Diagonal of the box.
    double size() const { return diagonal_of(box_.box()); }
    /// Whether weights differ.
    bool weighted() const { return weights_.least() < weights_.largest(); }
    /// The weight that all samples have, else 1.
    double weight() const { return weights_.largest() > 0 && !weighted() ? weights_.largest() : 1; }
    /// Whether nothing is to be scaled so that squares and products stay in the range of numbers.
    bool usual_numbers() const;

  private:
    PointScan box_;
    WeightScan weights_;
};

} // namespace batten
