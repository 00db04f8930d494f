#pragma once

#include <batten/problem/problem.hpp>

#include <initializer_list>
#include <string_view>
#include <vector>

namespace batten {

/// What a fit can be asked for that not every driver can do.
enum class Request {
    size,       ///< a number of control points
    knots,      ///< given knots
    placement,  ///< a stated rule for knots
    parameters, ///< given parameters
    weights,
    tolerance,
    limit, ///< a largest number of control points
    corners,
    closed,     ///< a closed axis
    seam,       ///< a stated continuity at a closed curve's seam
    samples,    ///< samples to pass through
    tangents,   ///< directions and derivatives to have
    boundaries, ///< boundaries to have
    shape,      ///< a kept shape
    smoothing,
    outliers, ///< outliers set aside
    start,    ///< stated control points to start from
    local,    ///< only some control points move
    history,
    stop,   ///< a stated limit, gradient or deviation at which to stop
    memory, ///< the control points before those to start from
};

inline constexpr std::size_t request_count = static_cast<std::size_t>(Request::memory) + 1;

/// In words, such that "method X cannot ..." reads well.
std::string_view to_string(Request request);

/// Some of the requests.
class Requests {
  public:
    constexpr Requests() = default;
    constexpr Requests(std::initializer_list<Request> some) {
        for (Request r : some) bits_ |= bit(r);
    }
    constexpr bool has(Request r) const { return (bits_ & bit(r)) != 0; }
    constexpr bool covers(Requests others) const { return (others.bits_ & ~bits_) == 0; }
    constexpr bool empty() const { return bits_ == 0; }
    constexpr Requests operator|(Requests others) const { return Requests(bits_ | others.bits_); }
    constexpr Requests operator-(Requests others) const { return Requests(bits_ & ~others.bits_); }
    /// In the order of the enumeration.
    std::vector<Request> list() const;

  private:
    constexpr explicit Requests(unsigned bits) : bits_(bits) {}
    static constexpr unsigned bit(Request r) { return 1U << static_cast<unsigned>(r); }
    unsigned bits_ = 0;
};

/// What the problem asks for.
Requests requests_of(const Problem& problem);

/// What options ask for of samples of that kind, weighted or not, over these axes.
Requests requests_of(const FitOptions& options, const AxisPlan& axes, SampleKind kind,
                     bool weighted);

} // namespace batten
