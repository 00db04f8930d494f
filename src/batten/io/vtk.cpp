#include <batten/io/exchange_formats.hpp>
#include <batten/io/graph_scene.hpp>
#include <batten/io/sampled_nets.hpp>
#include <batten/io/text_blocks.hpp>
#include <batten/spline/graph.hpp>

#include <algorithm>
#include <array>
#include <fmt/compile.h>

namespace batten {

namespace {

void add_points(std::string& text, const PointSet& points) {
    append_text(text, points.size(), [&](Index i, fmt::memory_buffer& out) {
        const auto p = points[i];
        fmt::format_to(std::back_inserter(out), FMT_COMPILE("{} {} {}\n"), p[0],
                       p.size() > 1 ? p[1] : 0.0, p.size() > 2 ? p[2] : 0.0);
    });
}

/// A data array: its head, `entry(i, buffer)` for each, its end.
template <class Entry>
void add_array(std::string& text, std::string_view type, std::string_view name, Index count,
               const Entry& entry) {
    text += fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">\n", type, name);
    append_text(text, count, entry);
    text += "\n</DataArray>\n";
}

constexpr std::string_view vtk_head =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"0.1\" "
    "byte_order=\"LittleEndian\">\n<{0}{1}>\n<Piece {2}>\n";

constexpr std::string_view points_head =
    "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";

/// Cells of a VTK unstructured grid, each of up to eight points.
class Cells {
  public:
    enum Type : std::uint8_t { vertex = 1, line = 3, triangle = 5, quad = 9, hexahedron = 12 };

    void add(std::initializer_list<Index> points, Type type) {
        points_.insert(points_.end(), points);
        ends_.push_back(static_cast<Index>(points_.size()));
        types_.push_back(type);
    }
    Index count() const { return static_cast<Index>(types_.size()); }
    void append(std::string& text) const {
        text += "<Cells>\n";
        add_array(text, "Int64", "connectivity", count(), [&](Index i, fmt::memory_buffer& out) {
            const auto at = static_cast<std::size_t>(i);
            for (auto k = i > 0 ? ends_[at - 1] : 0; k < ends_[at]; ++k)
                fmt::format_to(std::back_inserter(out), FMT_COMPILE("{} "),
                               points_[static_cast<std::size_t>(k)]);
            out.push_back('\n');
        });
        const auto each = [](const auto& values) {
            return [&values](Index i, fmt::memory_buffer& out) {
                fmt::format_to(std::back_inserter(out), FMT_COMPILE("{} "),
                               static_cast<Index>(values[static_cast<std::size_t>(i)]));
            };
        };
        add_array(text, "Int64", "offsets", count(), each(ends_));
        add_array(text, "UInt8", "types", count(), each(types_));
        text += "</Cells>\n";
    }

  private:
    std::vector<Index> points_;
    std::vector<Index> ends_;
    std::vector<Type> types_;
};

/// The four corners in order, those that follow an equal one left out: a quadrilateral, a triangle,
/// a line or nothing.
void add_quad(Cells& cells, const std::array<Index, 4>& corner) {
    std::array<Index, 4> c{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k)
        if (corner[k] != corner[(k + 1) % 4]) c[count++] = corner[k];
    if (count == 4) cells.add({c[0], c[1], c[2], c[3]}, Cells::quad);
    if (count == 3) cells.add({c[0], c[1], c[2]}, Cells::triangle);
    if (count == 2) cells.add({c[0], c[1]}, Cells::line);
}

/// The lines along all axes of a net of points.
void add_lines(Cells& cells, Index first, const GridIndex& grid) {
    grid.for_each([&](const GridIndex::Place& place, Index here) {
        for (std::size_t axis = 0; axis < grid.axis_count(); ++axis)
            if (place[axis] + 1 < grid.length(axis))
                cells.add({first + here, first + here + grid.stride(axis)}, Cells::line);
    });
}

/// A hexahedron between vertices, unless it is flat.
void add_hexahedron(Cells& cells, const std::array<Index, 8>& corner) {
    std::array<Index, 8> sorted = corner;
    std::ranges::sort(sorted);
    if (std::unique(sorted.begin(), sorted.end()) - sorted.begin() < 4) return;
    cells.add(
        {corner[0], corner[1], corner[2], corner[3], corner[4], corner[5], corner[6], corner[7]},
        Cells::hexahedron);
}

/// The net's lines, quadrilaterals or hexahedra between vertices; a vertex where all are one.
void add_cells(Cells& cells, const GridIndex& grid, const std::vector<Index>& vertex, Index first) {
    const Index before = cells.count();
    const auto at = [&](Index i) { return first + vertex[static_cast<std::size_t>(i)]; };
    const Index up = grid.stride(0);
    const Index across = grid.stride(1);
    const auto last = [&](const GridIndex::Place& place, std::size_t axis) {
        return grid.length(axis) > 1 && place[axis] + 1 == grid.length(axis);
    };
    grid.for_each([&](const GridIndex::Place& place, Index i) {
        if (last(place, 0) || last(place, 1) || last(place, 2) || grid.size() == 1) return;
        if (grid.length(1) == 1) {
            if (at(i) != at(i + up)) cells.add({at(i), at(i + up)}, Cells::line);
        } else if (grid.length(2) == 1) {
            add_quad(cells, {at(i), at(i + up), at(i + up + across), at(i + across)});
        } else {
            add_hexahedron(cells,
                           {at(i), at(i + up), at(i + up + across), at(i + across), at(i + 1),
                            at(i + up + 1), at(i + up + across + 1), at(i + across + 1)});
        }
    });
    if (cells.count() == before) cells.add({at(0)}, Cells::vertex);
}

/// The values of a function, the last coordinates of its graph's points.
void add_values(std::string& text, const PointSet& points) {
    add_array(text, "Float64", "value", points.size(), [&](Index i, fmt::memory_buffer& out) {
        fmt::format_to(std::back_inserter(out), FMT_COMPILE("{} "), points(i, points.dim() - 1));
    });
}

} // namespace

std::string vts_text(const Scene& scene) {
    check(vts_limits, scene.spline.axis_count(), scene.spline.dim());
    const SampledNets s =
        sampled(scene.spline, sampling(scene.spline, chord_of(scene, scene.spline)));
    const GridIndex& grid = s.nets.front().grid;
    // VTK's first axis is fastest, ours the last: the extents are turned round
    const std::size_t axes = s.places.size();
    const auto steps = [&](std::size_t from_last) {
        return from_last <= axes ? grid.length(axes - from_last) - 1 : 0;
    };
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", steps(1), steps(2), steps(3));
    std::string text = fmt::format(fmt::runtime(vtk_head), "StructuredGrid",
                                   fmt::format(" WholeExtent=\"{}\"", extent),
                                   fmt::format("Extent=\"{}\"", extent));
    const PointSet points = s.all();
    if (is_function(scene.spline)) {
        text += "<PointData Scalars=\"value\">\n";
        add_values(text, points);
        text += "</PointData>\n";
    }
    text += points_head;
    add_points(text, points);
    text += "</DataArray>\n</Points>\n</Piece>\n</StructuredGrid>\n</VTKFile>\n";
    return text;
}

std::string vtu_text(const Scene& scene) {
    check(vtu_limits, scene.spline.axis_count(), scene.spline.dim());
    const auto s = sampled(scene.spline, sampling(scene.spline, chord_of(scene, scene.spline)));
    const auto [vertices, vertex] = s.distinct();
    PointSet points = drawn_samples(scene);
    const Index samples = points.size();
    const Spline net = drawn(scene.spline);
    const Index control = net.control_points().size();
    Cells cells;
    for (Index i = 0; i < samples; ++i) cells.add({i}, Cells::vertex);
    add_lines(cells, samples, GridIndex(net.control_shape()));
    add_cells(cells, s.nets.front().grid, vertex, samples + control);
    std::vector<double>& values = points.values();
    values.reserve(values.size() + net.control_points().values().size() + vertices.values().size());
    for (const PointSet* more : {&net.control_points(), &vertices})
        values.insert(values.end(), more->values().begin(), more->values().end());
    points = PointSet(std::move(values), net.dim());
    std::string text = fmt::format(
        fmt::runtime(vtk_head), "UnstructuredGrid", "",
        fmt::format("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", points.size(), cells.count()));
    text += "<PointData Scalars=\"deviation\">\n";
    add_array(text, "Float64", "deviation", points.size(), [&](Index i, fmt::memory_buffer& out) {
        fmt::format_to(std::back_inserter(out), FMT_COMPILE("{} "),
                       i < samples && scene.deviations != nullptr
                           ? (*scene.deviations)[static_cast<std::size_t>(i)]
                           : 0.0);
    });
    add_array(text, "Int32", "part", points.size(), [&](Index i, fmt::memory_buffer& out) {
        out.append(std::string_view(i < samples ? "0 " : i < samples + control ? "1 " : "2 "));
    });
    if (is_function(scene.spline)) add_values(text, points);
    text += "</PointData>\n";
    text += points_head;
    add_points(text, points);
    text += "</DataArray>\n</Points>\n";
    cells.append(text);
    text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    return text;
}

} // namespace batten
