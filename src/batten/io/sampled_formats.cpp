#include <batten/io/exchange_formats.hpp>
#include <batten/io/sampling.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace batten {

namespace {

double chord_of(const Scene& scene, const Spline& spline) {
    return scene.chord_tolerance > 0 ? scene.chord_tolerance : picture_chord(spline);
}

/// A spline's points over its sampling.
struct Sampled {
    std::vector<std::vector<double>> axes;
    PointSet points;

    explicit Sampled(const Scene& scene, const Spline& spline)
        : axes(sampling(spline, chord_of(scene, spline))), points(evaluate_grid(spline, axes)) {}
    GridIndex grid() const {
        std::vector<Index> shape;
        for (const auto& t : axes) shape.push_back(static_cast<Index>(t.size()));
        return GridIndex(shape);
    }
};

std::array<double, 3> in_space(std::span<const double> p) {
    std::array<double, 3> result{};
    for (std::size_t d = 0; d < std::min<std::size_t>(3, p.size()); ++d) result[d] = p[d];
    return result;
}

void check_space(const Spline& spline, std::string_view format) {
    if (spline.dim() > 3)
        throw InvalidInput(fmt::format("{} holds points in space, this spline is of dimension {}",
                                       format, spline.dim()));
}

class Triangles {
  public:
    void add(const std::array<double, 3>& a, const std::array<double, 3>& b,
             const std::array<double, 3>& c) {
        std::array<double, 3> normal{};
        for (std::size_t d = 0; d < 3; ++d) {
            const std::size_t e = (d + 1) % 3;
            const std::size_t f = (d + 2) % 3;
            normal[d] = (b[e] - a[e]) * (c[f] - a[f]) - (b[f] - a[f]) * (c[e] - a[e]);
        }
        const double length = std::hypot(normal[0], normal[1], normal[2]);
        if (!(length > 0)) return; // at a pole
        for (double& x : normal) x /= length;
        for (const auto& vector : {normal, a, b, c})
            for (double x : vector) put(static_cast<float>(x));
        content_ += std::string(2, '\0');
        ++count_;
    }
    std::string finish() {
        std::string head = "batten";
        head.resize(80, '\0');
        for (unsigned k = 0; k < 4; ++k) head += static_cast<char>(count_ >> (8 * k) & 0xFFU);
        return head + content_;
    }

  private:
    void put(float x) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &x, sizeof bits);
        for (unsigned k = 0; k < 4; ++k) content_ += static_cast<char>(bits >> (8 * k) & 0xFFU);
    }
    std::string content_;
    std::uint32_t count_ = 0;
};

/// Both triangles of every cell of a face: points at place(i, j), the normals one way or the other.
template <class Place>
void add_face(Triangles& triangles, const PointSet& points, Index rows, Index columns, Place place,
              bool turned) {
    for (Index i = 0; i + 1 < rows; ++i)
        for (Index j = 0; j + 1 < columns; ++j) {
            const auto a = in_space(points[place(i, j)]);
            const auto b = in_space(points[place(i + 1, j)]);
            const auto c = in_space(points[place(i + 1, j + 1)]);
            const auto d = in_space(points[place(i, j + 1)]);
            if (turned) {
                triangles.add(a, c, b);
                triangles.add(a, d, c);
            } else {
                triangles.add(a, b, c);
                triangles.add(a, c, d);
            }
        }
}

void add_volume(Triangles& triangles, const Sampled& s) {
    const GridIndex grid = s.grid();
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (bool end : {false, true}) {
            const std::size_t e = (axis + 1) % 3;
            const std::size_t f = (axis + 2) % 3;
            add_face(
                triangles, s.points, grid.length(e), grid.length(f),
                [&](Index i, Index j) {
                    GridIndex::Place at{};
                    at[axis] = end ? grid.length(axis) - 1 : 0;
                    at[e] = i;
                    at[f] = j;
                    return grid.at(at);
                },
                !end);
        }
}

} // namespace

std::string stl_binary(const Scene& scene) {
    Triangles triangles;
    for (const Spline* spline : scene.splines()) {
        if (spline->axis_count() == 1 || spline->dim() != 3)
            throw InvalidInput(fmt::format(
                "an .stl holds surfaces in space, this spline has {} {} in dimension {}",
                spline->axis_count(), spline->axis_count() == 1 ? "axis" : "axes", spline->dim()));
        const Sampled s(scene, *spline);
        if (spline->axis_count() == 2)
            add_face(
                triangles, s.points, s.grid().length(0), s.grid().length(1),
                [grid = s.grid()](Index i, Index j) {
                    return grid.at({i, j});
                },
                false);
        else
            add_volume(triangles, s);
    }
    return triangles.finish();
}

std::string evaluated_text(const Scene& scene) {
    constexpr std::string_view parameters[] = {"u", "v", "w"};
    const Sampled s(scene, scene.spline);
    const std::size_t axes = s.axes.size();
    fmt::memory_buffer out;
    const auto to = std::back_inserter(out);
    for (std::size_t k = 0; k < axes; ++k) fmt::format_to(to, "{},", parameters[k]);
    for (Index d = 0; d < s.points.dim(); ++d)
        fmt::format_to(to, "{}{}",
                       s.points.dim() <= 3 ? std::string(1, "xyz"[d]) : fmt::format("x{}", d),
                       d + 1 < s.points.dim() ? ',' : '\n');
    s.grid().for_each([&](const GridIndex::Place& place, Index i) {
        for (std::size_t k = 0; k < axes; ++k)
            fmt::format_to(to, "{},", s.axes[k][static_cast<std::size_t>(place[k])]);
        fmt::format_to(to, "{}\n", fmt::join(s.points[i], ","));
    });
    return fmt::to_string(out);
}

namespace {

void add_points(std::string& text, const Points& points) {
    for (Index i = 0; i < points.size(); ++i) {
        const auto p = in_space(points[i]);
        text += fmt::format("{} {} {}\n", p[0], p[1], p[2]);
    }
}

constexpr std::string_view vtk_head =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"0.1\" "
    "byte_order=\"LittleEndian\">\n<{0}{1}>\n<Piece {2}>\n";

constexpr std::string_view points_head =
    "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";

/// Cells of a VTK unstructured grid.
struct Cells {
    std::string connectivity;
    std::string offsets;
    std::string types;
    Index count = 0;
    Index used = 0;

    void add(std::initializer_list<Index> points, int type) {
        for (Index p : points) connectivity += fmt::format("{} ", p);
        used += static_cast<Index>(points.size());
        connectivity += '\n';
        offsets += fmt::format("{} ", used);
        types += fmt::format("{} ", type);
        ++count;
    }
    /// Lines along every axis of a net of points, or its cells where it has them.
    void add_net(Index first, const GridIndex& grid, bool filled) {
        constexpr int line = 3;
        constexpr int quad = 9;
        constexpr int hexahedron = 12;
        grid.for_each([&](const GridIndex::Place& place, Index position) {
            const Index here = first + position;
            const auto next = [&](std::size_t axis) { return here + grid.stride(axis); };
            const auto more = [&](std::size_t axis) { return place[axis] + 1 < grid.length(axis); };
            if (filled && grid.axis_count() == 3) {
                const Index up = grid.stride(0);
                const Index across = grid.stride(1);
                if (more(0) && more(1) && more(2))
                    add({here, here + up, here + up + across, here + across, here + 1,
                         here + up + 1, here + up + across + 1, here + across + 1},
                        hexahedron);
            } else if (filled && grid.axis_count() == 2) {
                if (more(0) && more(1)) add({here, next(0), next(0) + 1, next(1)}, quad);
            } else {
                for (std::size_t axis = 0; axis < grid.axis_count(); ++axis)
                    if (more(axis)) add({here, next(axis)}, line);
            }
        });
    }
};

} // namespace

std::string vts_text(const Scene& scene) {
    check_space(scene.spline, "a .vts");
    const Sampled s(scene, scene.spline);
    const GridIndex grid = s.grid();
    // VTK's first axis is fastest, ours the last: the extents are turned round
    const auto steps = [&](std::size_t from_last) {
        return from_last <= grid.axis_count() ? grid.length(grid.axis_count() - from_last) - 1 : 0;
    };
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", steps(1), steps(2), steps(3));
    std::string text = fmt::format(fmt::runtime(vtk_head), "StructuredGrid",
                                   fmt::format(" WholeExtent=\"{}\"", extent),
                                   fmt::format("Extent=\"{}\"", extent));
    text += points_head;
    add_points(text, s.points);
    return text + "</DataArray>\n</Points>\n</Piece>\n</StructuredGrid>\n</VTKFile>\n";
}

std::string vtu_text(const Scene& scene) {
    check_space(scene.spline, "a .vtu");
    const Sampled s(scene, scene.spline);
    const Index samples = scene.samples == nullptr ? 0 : scene.samples->size();
    const PointSet& control = scene.spline.control_points();
    Cells cells;
    for (Index i = 0; i < samples; ++i) cells.add({i}, 1);
    cells.add_net(samples, GridIndex(scene.spline.control_shape()), false);
    cells.add_net(samples + control.size(), s.grid(), true);
    const Index total = samples + control.size() + s.points.size();
    std::string text =
        fmt::format(fmt::runtime(vtk_head), "UnstructuredGrid", "",
                    fmt::format("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", total, cells.count));
    text += "<PointData Scalars=\"deviation\">\n<DataArray type=\"Float64\" Name=\"deviation\" "
            "format=\"ascii\">\n";
    for (Index i = 0; i < total; ++i)
        text += fmt::format("{} ", i < samples && scene.deviations != nullptr
                                       ? (*scene.deviations)[static_cast<std::size_t>(i)]
                                       : 0.0);
    text += "\n</DataArray>\n<DataArray type=\"Int32\" Name=\"part\" format=\"ascii\">\n";
    for (Index i = 0; i < total; ++i)
        text += fmt::format("{} ", i < samples ? 0 : i < samples + control.size() ? 1 : 2);
    text += "\n</DataArray>\n</PointData>\n";
    text += points_head;
    if (samples > 0) add_points(text, scene.samples->points);
    add_points(text, control);
    add_points(text, s.points);
    text += fmt::format("</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" "
                        "Name=\"connectivity\" format=\"ascii\">\n{}</DataArray>\n"
                        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n{}\n"
                        "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n"
                        "{}\n</DataArray>\n</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n",
                        cells.connectivity, cells.offsets, cells.types);
    return text;
}

} // namespace batten
