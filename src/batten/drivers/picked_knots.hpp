#pragma once

#include <batten/basis/place_knots.hpp>

#include <optional>
#include <span>

namespace batten {

/// Knots that a rule places among a sequence's parameters, of which two for each knot are picked
/// while the samples pass by.
class PickedKnots {
  public:
    /// For `n` free control points among so many samples. Throws as knots_from_parameters does.
    PickedKnots(Index samples, int degree, Index n, Closure closure, KnotPlacement rule);

    /// Samples whose parameters are needed, ascending.
    std::span<const Index> needed() const { return needed_; }
    /// Of samples that begin with number `first`, in order: parameters, or lengths of the way after
    /// `before`.
    void take(Index first, std::span<const double> values, double before);
    /// One that is no value of samples passing by.
    void take(double parameter) { values_.push_back(parameter); }
    /// Makes the lengths parameters.
    void divide(double whole);

    /// Over the domain from the first parameter to the last; closed: from 0 to 1.
    KnotVector knots(double front, double back) const;

  private:
    int degree_;
    Closure closure_;
    Index samples_;
    std::vector<KnotPlace> places_;
    std::vector<Index> needed_;
    std::vector<double> values_;
};

} // namespace batten
