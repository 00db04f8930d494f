#pragma once

#include <batten/samples/samples.hpp>

#include <span>
#include <vector>

namespace batten {

/// Parameters of the samples.
struct Parameters {
    /// One ascending array per axis, for a sequence or a grid.
    std::vector<std::vector<double>> axes{};
    /// (m x axes) for a cloud, else empty.
    PointSet scattered{};

    bool is_scattered() const { return !scattered.empty(); }
    Index axis_count() const {
        return is_scattered() ? scattered.dim() : static_cast<Index>(axes.size());
    }
    /// Where the samples of a sequence or grid lie in their order.
    GridIndex grid() const;
};

/// How the parameters follow from the points.
enum class Parametrization {
    uniform,     ///< evenly spaced
    chord,       ///< normalised accumulated chord length [PieglTiller1997, eq. 9.5]
    centripetal, ///< the same with square roots of the chords [PieglTiller1997, eq. 9.6]
};

/// Parameters from 0 to 1 of a sequence of at least 2 points. Identical consecutive points get
/// equal parameters. Closed: the chord from the last point back to the first counts, and 1 stands
/// for the first point again. Throws InvalidInput when all points are identical (uniform excepted).
std::vector<double> parametrize_sequence(const Points& points, Parametrization rule,
                                         Closure closure = Closure::open);

/// Parameters of a sequence, or of a grid: along each axis the normalised parameters of its rows,
/// averaged [LinZhang2011, eq. 27 and 28]; rows of no length do not count.
/// `closures` has one entry per axis. Throws InvalidInput as above, naming the axis.
Parameters parametrize(const Samples& samples, Parametrization rule,
                       const std::vector<Closure>& closures);

/// Parameter of sample `i`, one per axis.
std::vector<double> parameter_of(const Parameters& parameters, Index i);

/// The parameters as a cloud's: (m x axes), one row per sample.
PointSet parameter_rows(const Parameters& parameters);

/// Throws InvalidInput unless the parameters fit the samples in number and are finite, ascending
/// and, per axis, not all equal.
void check(const Parameters& parameters, const Samples& samples);

/// The parts of it along an axis: the number of parameters, those from `begin` to before `end`
/// (finite and not less than the ones before them), and that not all are equal.
void check_parameter_count(Index given, Index samples, std::size_t axis);
void check_ascending(std::span<const double> t, Index begin, Index end, std::size_t axis);
void check_range(std::span<const double> t, std::size_t axis);

/// Throws InvalidInput unless there are at least two samples along the axis.
void check_strand(Index samples, std::size_t axis);
/// What to throw where all samples along an axis are one point.
InvalidInput no_length(std::size_t axis);

} // namespace batten
