#include <batten/core/vectors.hpp>
#include <batten/io/exchange_formats.hpp>
#include <batten/io/sampled_nets.hpp>
#include <batten/spline/graph.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>

namespace batten {

namespace {

constexpr double epsilon = std::numeric_limits<float>::epsilon() / 2; // relative rounding

void check_surface(const Spline& spline) {
    check(stl_limits, spline.axis_count(), spline.dim());
    const Spline shown = drawn(spline);
    for (double x : shown.control_points().values())
        if (std::abs(x) > std::numeric_limits<float>::max())
            throw InvalidInput(
                fmt::format("an .stl holds single precision, a coordinate of {} is beyond it", x));
}

using Net = SampledNets::Net;
using Corners = std::array<Index, 3>;

/// Calls `visit(corners)` for both triangles of every cell of all nets, those without extent left
/// out; counterclockwise as seen from where the first axis times the second points, of a volume's
/// faces from outside of a right-handed one.
template <class Visit>
void for_each_triangle(const SampledNets& s, Visit visit) {
    const auto triangle = [&](Index a, Index b, Index c) {
        const auto vertex = [&](Index i) { return s.vertex[static_cast<std::size_t>(i)]; };
        const Corners corners{vertex(a), vertex(b), vertex(c)};
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            visit(corners);
    };
    for (const Net& net : s.nets) {
        std::size_t e = net.held < 3 ? (net.held + 1) % 3 : 0;
        std::size_t f = net.held < 3 ? (net.held + 2) % 3 : 1;
        if (net.held < 3 && !net.at_end) std::swap(e, f);
        const Index across = net.grid.stride(e);
        const Index beside = net.grid.stride(f);
        for (Index i = 0; i + 1 < net.grid.length(e); ++i)
            for (Index j = 0; j + 1 < net.grid.length(f); ++j) {
                const Index a = net.first + i * across + j * beside;
                triangle(a, a + across, a + across + beside);
                triangle(a, a + across + beside, a + beside);
            }
    }
}

using Vector = std::array<double, 3>;

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Whether the triangles have no boundary: a volume's faces, or a surface that meets itself or ends
/// in a point at all its ends.
bool encloses(const SampledNets& s) {
    if (s.nets.size() != 1) return true;
    const GridIndex& grid = s.nets.front().grid;
    const auto vertex = [&](Index i) { return s.vertex[static_cast<std::size_t>(i)]; };
    for (std::size_t k : {0, 1}) {
        const Index beside = grid.stride(1 - k);
        const Index last = (grid.length(k) - 1) * grid.stride(k);
        bool one = true;
        bool poles = true;
        for (Index j = 0; j < grid.length(1 - k); ++j) {
            one = one && vertex(j * beside) == vertex(last + j * beside);
            poles = poles && vertex(j * beside) == vertex(0) &&
                    vertex(last + j * beside) == vertex(last);
        }
        if (!one && !poles) return false;
    }
    return true;
}

/// A binary STL's facets, of one spline after the other.
class Facets {
  public:
    /// Adds the triangles, outwards where they enclose something. Those that rounding leaves no
    /// extent are left out.
    void add(const SampledNets& s) {
        take_points(s);
        double volume = 0;
        if (encloses(s))
            for_each_triangle(s, [&](const Corners& c) {
                volume += dot(place(c[0]), cross(place(c[1]), place(c[2])));
            });
        for_each_triangle(s, [&](Corners c) {
            if (volume < 0) std::swap(c[1], c[2]);
            add_facet(c);
        });
    }
    std::string finish(const std::string& title) {
        if (content_.size() == head_size)
            throw InvalidInput("an .stl holds facets, this spline has none: its points lie on a "
                               "line, or are one in single precision");
        std::string head = title;
        head.resize(head_size - sizeof(std::uint32_t), '\0');
        put(static_cast<std::uint32_t>((content_.size() - head_size) / facet_size), head);
        return std::move(content_.replace(0, head_size, head));
    }

  private:
    static constexpr std::size_t head_size = 84;
    static constexpr std::size_t facet_size = 50;

    const Vector& place(Index i) const { return place_[static_cast<std::size_t>(i)]; }

    /// Points in parts of their size, and in single precision.
    void take_points(const SampledNets& s) {
        double size = 0;
        for (double x : s.points.values()) size = std::max(size, std::abs(x));
        place_.assign(static_cast<std::size_t>(s.points.size()), {});
        rounded_.assign(place_.size(), {});
        for (std::size_t i = 0; i < place_.size(); ++i)
            for (std::size_t d = 0; d < 3; ++d) {
                const double x = s.points(static_cast<Index>(i), static_cast<Index>(d));
                if (size > 0) place_[i][d] = x / size;
                rounded_[i][d] = static_cast<float>(x + s.centre[d]);
            }
    }
    void add_facet(const Corners& c) {
        std::array<std::array<float, 3>, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = rounded_[static_cast<std::size_t>(c[k])];
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return;
        Vector a{};
        Vector b{};
        for (std::size_t d = 0; d < 3; ++d) {
            a[d] = place(c[1])[d] - place(c[0])[d];
            b[d] = place(c[2])[d] - place(c[0])[d];
        }
        Vector normal = cross(a, b);
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        for (double x : normal)
            put(std::bit_cast<std::uint32_t>(static_cast<float>(length > 0 ? x / length : 0)),
                content_);
        for (const auto& point : corner)
            for (float x : point) put(std::bit_cast<std::uint32_t>(x), content_);
        content_ += std::string_view("\0\0", 2);
    }
    /// Little-endian.
    static void put(std::uint32_t bits, std::string& text) {
        const std::array<char, 4> bytes{
            static_cast<char>(bits & 0xFFU), static_cast<char>(bits >> 8U & 0xFFU),
            static_cast<char>(bits >> 16U & 0xFFU), static_cast<char>(bits >> 24U)};
        text.append(bytes.data(), bytes.size());
    }

    std::vector<Vector> place_;
    std::vector<std::array<float, 3>> rounded_;
    std::string content_ = std::string(head_size, '\0');
};

/// The largest distance that rounding moves a point of the scene's.
double largest_rounding(const Scene& scene) {
    double largest = 0;
    for (const Spline* spline : scene.splines())
        largest = std::max(largest, rounding(drawn(*spline), epsilon));
    return largest;
}

} // namespace

std::string stl_binary(const Scene& scene) {
    Facets facets;
    for (const Spline* spline : scene.splines()) {
        check_surface(*spline);
        const double chord = chord_of(scene, *spline);
        const double moved = rounding(drawn(*spline), epsilon);
        facets.add(spline->axis_count() == 3
                       ? sampled_skin(*spline, skin_sampling(*spline, chord, moved))
                       : sampled(*spline, sampling(*spline, chord, moved)));
    }
    return facets.finish(
        fmt::format("batten, points rounded by up to {:.2g}", largest_rounding(scene)));
}

std::string stl_note(const Scene& scene) {
    double chord = std::numeric_limits<double>::infinity();
    for (const Spline* spline : scene.splines()) chord = std::min(chord, chord_of(scene, *spline));
    const double moved = largest_rounding(scene);
    if (!(moved > chord / 2)) return {};
    return fmt::format("single precision moves points by up to {:.2g}, beside a chord tolerance of "
                       "{:.2g}",
                       moved, chord);
}

} // namespace batten
