#pragma once

#include <batten/io/sampling.hpp>
#include <batten/io/spline_file.hpp>

namespace batten {

/// A spline's points over nets of parameters, numbered through. Points that are one in space,
/// across a seam or at a pole, share their vertex.
struct SampledNets {
    /// Positions first, first + 1, ... row-major over the grid of three axes, which has length 1
    /// along an axis that is held or not there.
    struct Net {
        GridIndex grid;
        Index first = 0;
        std::size_t held = 3; ///< the axis that is held of a volume's face, else 3
        bool at_end = false;  ///< of the held axis
        Index position(const GridIndex::Place& place) const { return first + grid.at(place); }
    };

    AxisPlaces places;
    std::vector<Net> nets;
    /// Per position, relative to the centre; positions of one vertex have the same.
    PointSet points;
    std::vector<double> centre;
    /// Per position the first position that is the same point.
    std::vector<Index> vertex;

    /// The points at all positions.
    PointSet all() const;
    /// The points without those that are one with an earlier one, and per position the number
    /// there.
    std::pair<PointSet, std::vector<Index>> distinct() const;
};

/// The chord that the scene's files keep: stated, or picture_chord.
double chord_of(const Scene& scene, const Spline& spline);

/// One net over all axes. Of a function its graph's points.
SampledNets sampled(const Spline& spline, AxisPlaces places);

/// A net for each face of a volume, none where it meets itself.
SampledNets sampled_skin(const Spline& volume, AxisPlaces places);

} // namespace batten
