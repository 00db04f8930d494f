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
    Index size(std::size_t k) const {
        return k < axes.size() ? static_cast<Index>(axes[k].size()) : 1;
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
    const std::array<Index, 3> n{s.size(0), s.size(1), s.size(2)};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (bool end : {false, true}) {
            const std::size_t e = (axis + 1) % 3;
            const std::size_t f = (axis + 2) % 3;
            add_face(
                triangles, s.points, n[e], n[f],
                [&](Index i, Index j) {
                    std::array<Index, 3> at{};
                    at[axis] = end ? n[axis] - 1 : 0;
                    at[e] = i;
                    at[f] = j;
                    return (at[0] * n[1] + at[1]) * n[2] + at[2];
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
                triangles, s.points, s.size(0), s.size(1),
                [&](Index i, Index j) { return i * s.size(1) + j; }, false);
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
    for (Index i = 0; i < s.points.size(); ++i) {
        Index rest = i;
        std::array<double, 3> t{};
        for (std::size_t k = axes; k-- > 0; rest /= s.size(k))
            t[k] = s.axes[k][static_cast<std::size_t>(rest % s.size(k))];
        for (std::size_t k = 0; k < axes; ++k) fmt::format_to(to, "{},", t[k]);
        fmt::format_to(to, "{}\n", fmt::join(s.points[i], ","));
    }
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
    void add_net(Index first, const std::vector<Index>& shape, bool filled) {
        constexpr int line = 3;
        constexpr int quad = 9;
        constexpr int hexahedron = 12;
        const Index n1 = shape.size() > 1 ? shape[1] : 1;
        const Index n2 = shape.size() > 2 ? shape[2] : 1;
        const auto at = [&](Index i, Index j, Index k) { return first + (i * n1 + j) * n2 + k; };
        for (Index i = 0; i < shape[0]; ++i)
            for (Index j = 0; j < n1; ++j)
                for (Index k = 0; k < n2; ++k) {
                    const bool a = i + 1 < shape[0];
                    const bool b = j + 1 < n1;
                    const bool c = k + 1 < n2;
                    if (filled && shape.size() == 3) {
                        if (a && b && c)
                            add({at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k),
                                 at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1),
                                 at(i, j + 1, k + 1)},
                                hexahedron);
                    } else if (filled && shape.size() == 2) {
                        if (a && b)
                            add({at(i, j, 0), at(i + 1, j, 0), at(i + 1, j + 1, 0),
                                 at(i, j + 1, 0)},
                                quad);
                    } else {
                        if (a) add({at(i, j, k), at(i + 1, j, k)}, line);
                        if (b) add({at(i, j, k), at(i, j + 1, k)}, line);
                        if (c) add({at(i, j, k), at(i, j, k + 1)}, line);
                    }
                }
    }
};

} // namespace

std::string vts_text(const Scene& scene) {
    check_space(scene.spline, "a .vts");
    const Sampled s(scene, scene.spline);
    // VTK's first axis is fastest, ours the last: the extents are turned round
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", s.size(s.axes.size() - 1) - 1,
                                           s.axes.size() > 1 ? s.size(s.axes.size() - 2) - 1 : 0,
                                           s.axes.size() > 2 ? s.size(0) - 1 : 0);
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
    cells.add_net(samples, scene.spline.control_shape(), false);
    std::vector<Index> shape;
    for (const auto& axis : s.axes) shape.push_back(static_cast<Index>(axis.size()));
    cells.add_net(samples + control.size(), shape, true);
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
