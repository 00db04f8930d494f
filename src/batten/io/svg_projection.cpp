#include <batten/io/svg.hpp>

#include <batten/core/vectors.hpp>
#include <batten/io/cell_counts.hpp>
#include <batten/io/sampled_nets.hpp>
#include <batten/io/sampling.hpp>
#include <batten/io/svg_parts.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

using Vector = std::array<double, 3>;

constexpr double picture_size = 900; // pixels of the longer side, margin apart
constexpr double margin = 36;
constexpr double head = 24;      // for the legend
constexpr Index most_quads = 90; // along an axis
constexpr double least_quads = 24;
constexpr Index lines_per_face = 16; // iso-lines along an axis, at most

Vector in_space(std::span<const double> p) {
    return {p[0], p[1], p.size() > 2 ? p[2] : 0.0};
}

/// Seen from the front, the left and above, without perspective: as the HTML report shows it.
struct View {
    Vector right;
    Vector up;
    Vector towards; ///< the eye
    std::array<double, 2> low{1e300, 1e300};
    std::array<double, 2> high{-1e300, -1e300};

    View() {
        const double length = std::sqrt(0.55 * 0.55 + 0.8 * 0.8 + 0.62 * 0.62);
        towards = {-0.55 / length, -0.8 / length, 0.62 / length};
        const double flat = std::hypot(towards[0], towards[1]);
        right = {-towards[1] / flat, towards[0] / flat, 0};
        up = {towards[1] * right[2] - towards[2] * right[1],
              towards[2] * right[0] - towards[0] * right[2],
              towards[0] * right[1] - towards[1] * right[0]};
    }
    void include(const Vector& p) {
        const std::array<double, 2> at{dot(p, right), dot(p, up)};
        for (std::size_t d = 0; d < 2; ++d) {
            low[d] = std::min(low[d], at[d]);
            high[d] = std::max(high[d], at[d]);
        }
    }
    double scale() const {
        return picture_size / std::max({high[0] - low[0], high[1] - low[1], 1e-300});
    }
    std::string at(const Vector& p) const {
        return fmt::format("{:.2f} {:.2f}", margin + (dot(p, right) - low[0]) * scale(),
                           margin + head + (high[1] - dot(p, up)) * scale());
    }
};

/// Something to draw, the far ones first.
struct Piece {
    double depth;
    std::string svg;
};

/// A face as a net of points, and which of its rows and columns are iso-lines.
struct Face {
    Index rows = 0;
    Index columns = 0;
    std::vector<Vector> points;
    const Vector& at(Index i, Index j) const {
        return points[static_cast<std::size_t>(i * columns + j)];
    }
};

/// The spline's own chords and 24 even steps; of more than fit a picture, as many of these.
std::vector<double> places_of(const KnotVector& axis, const std::vector<Index>& cells) {
    const std::vector<double> breaks = axis.breakpoints();
    std::vector<Index> pieces;
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
        const double part = (breaks[b + 1] - breaks[b]) / axis.length();
        const auto even = static_cast<Index>(std::ceil(part * least_quads));
        pieces.push_back(std::max(even, cells[b]));
    }
    std::vector<double> fine = divided(breaks, pieces);
    const auto steps = static_cast<Index>(fine.size()) - 1;
    if (steps <= most_quads) return fine;
    std::vector<double> some;
    for (Index i = 0; i <= most_quads; ++i)
        some.push_back(fine[static_cast<std::size_t>(i * steps / most_quads)]);
    return some;
}

std::vector<Face> faces_of(const Spline& spline) {
    AxisPlaces places;
    const CellCounts cells = least_cells(spline, picture_chord(spline));
    for (std::size_t k = 0; k < cells.size(); ++k)
        places.push_back(places_of(spline.axes()[k], cells[k]));
    const SampledNets s =
        spline.axis_count() == 2 ? sampled(spline, places) : sampled_skin(spline, places);
    const PointSet points = s.all();
    std::vector<Face> faces;
    for (const SampledNets::Net& net : s.nets) {
        Face face{
            net.grid.length(net.held == 0 ? 1 : 0), net.grid.length(net.held < 2 ? 2 : 1), {}};
        for (Index i = 0; i < net.grid.size(); ++i)
            face.points.push_back(in_space(points[net.first + i]));
        faces.push_back(std::move(face));
    }
    return faces;
}

void add_face(const Face& face, const View& view, std::vector<Piece>& pieces) {
    const Index row_step = std::max<Index>(1, (face.rows - 1) / lines_per_face);
    const Index column_step = std::max<Index>(1, (face.columns - 1) / lines_per_face);
    for (Index i = 0; i + 1 < face.rows; ++i)
        for (Index j = 0; j + 1 < face.columns; ++j) {
            const std::array<Vector, 4> c{face.at(i, j), face.at(i + 1, j), face.at(i + 1, j + 1),
                                          face.at(i, j + 1)};
            Vector a{};
            Vector b{};
            double depth = 0;
            for (std::size_t d = 0; d < 3; ++d) {
                a[d] = c[2][d] - c[0][d];
                b[d] = c[3][d] - c[1][d];
                depth += (c[0][d] + c[1][d] + c[2][d] + c[3][d]) / 4 * view.towards[d];
            }
            const Vector n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                           a[0] * b[1] - a[1] * b[0]};
            const double length = norm(n);
            // light from over the left shoulder
            const Vector light{-0.25, -0.55, 0.8};
            const double bright = length > 0 ? 0.62 + 0.38 * std::abs(dot(n, light)) / length : 0.8;
            const auto shade = [&](double full) {
                return std::clamp(static_cast<int>(std::lround(full * bright)), 0, 255);
            };
            std::string svg =
                fmt::format("<path d=\"M {0} L {1} L {2} L {3} Z\" fill=\"rgb({4},{5},{6})\" "
                            "stroke=\"rgb({4},{5},{6})\"/>",
                            view.at(c[0]), view.at(c[1]), view.at(c[2]), view.at(c[3]), shade(198),
                            shade(215), shade(231));
            const auto edge = [&](const Vector& from, const Vector& to) {
                svg += fmt::format("<path class=\"iso\" d=\"M {} L {}\"/>", view.at(from),
                                   view.at(to));
            };
            if (i % row_step == 0) edge(c[0], c[3]);
            if (i + 2 == face.rows) edge(c[1], c[2]);
            if (j % column_step == 0) edge(c[0], c[1]);
            if (j + 2 == face.columns) edge(c[3], c[2]);
            pieces.push_back({depth, std::move(svg)});
        }
}

std::string curve_svg(const Spline& curve, const View& view) {
    const PointSet points =
        evaluate_grid(curve, sampling(curve, picture_chord(curve, 20 * picture_size)));
    std::string path = "M " + view.at(in_space(points[0]));
    for (Index i = points.size() > 1 ? 1 : 0; i < points.size(); ++i)
        path += " L " + view.at(in_space(points[i]));
    std::string polygon;
    const PointSet& control = curve.control_points();
    for (Index i = 0; i < control.size(); ++i)
        polygon += (i == 0 ? "M " : " L ") + view.at(in_space(control[i]));
    return fmt::format("  <path class=\"polygon\" d=\"{}\"/>\n  <path class=\"curve\" d=\"{}\"/>\n",
                       polygon, path);
}

/// Samples between the faces, each just before what lies behind it; of very many every other, and
/// so on.
void add_samples(const Scene& scene, const View& view, double largest, std::vector<Piece>& pieces) {
    constexpr Index most_dots = 20000;
    const Points& points = scene.samples->points;
    const Index stride = (points.size() + most_dots - 1) / most_dots;
    const double radius =
        std::clamp(90 / std::sqrt(static_cast<double>(points.size() / stride)), 1.0, 2.6);
    const double nearer = 8 * radius / view.scale();
    for (Index i = 0; i < points.size(); i += stride) {
        const Vector p = in_space(points[i]);
        const double part =
            largest > 0 ? (*scene.deviations)[static_cast<std::size_t>(i)] / largest : 0;
        pieces.push_back({dot(p, view.towards) + nearer,
                          fmt::format("<path class=\"dot\" d=\"M {} h 0\" stroke=\"{}\" "
                                      "stroke-width=\"{:.2g}\"/>",
                                      view.at(p), deviation_colour(part), 2 * radius)});
    }
}

} // namespace

std::string svg_projection(const Scene& scene) {
    const Spline& spline = scene.spline;
    View view;
    std::vector<Face> faces;
    if (spline.axis_count() > 1) faces = faces_of(spline);
    for (const Face& face : faces)
        for (const Vector& p : face.points) view.include(p);
    if (faces.empty())
        for (Index i = 0; i < spline.control_points().size(); ++i)
            view.include(in_space(spline.control_points()[i]));
    const bool dots = scene.samples != nullptr && scene.samples->dim() == spline.dim();
    if (dots)
        for (Index i = 0; i < scene.samples->size(); ++i)
            view.include(in_space(scene.samples->points[i]));
    const double largest =
        dots && scene.deviations != nullptr ? *std::ranges::max_element(*scene.deviations) : 0;
    std::vector<Piece> pieces;
    for (const Face& face : faces) add_face(face, view, pieces);
    if (dots) add_samples(scene, view, largest, pieces);
    std::ranges::stable_sort(pieces, {}, &Piece::depth);
    const double width = (view.high[0] - view.low[0]) * view.scale() + 2 * margin;
    const double height = (view.high[1] - view.low[1]) * view.scale() + 2 * margin + head;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.1f} {1:.1f}\" "
        "width=\"{0:.0f}\" height=\"{1:.0f}\">\n"
        "  <style>\n"
        "    .iso {{ stroke: #1f4e79; stroke-width: 0.7; stroke-opacity: 0.75; fill: none; "
        "stroke-linecap: round; }}\n"
        "    .dot {{ stroke-linecap: round; fill: none; }}\n"
        "    .curve {{ stroke: #1f4e79; stroke-width: 1.8; fill: none; stroke-linejoin: round; "
        "stroke-linecap: round; }}\n"
        "    .polygon {{ stroke: #9aa5b1; stroke-width: 0.8; fill: none; stroke-dasharray: 4 3; "
        "}}\n"
        "  </style>\n"
        "  <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        width, height);
    if (!scene.title.empty()) svg += fmt::format("  <title>{}</title>\n", svg_escaped(scene.title));
    if (spline.axis_count() == 1) svg += curve_svg(spline, view);
    if (view.low == view.high) // one point
        svg += fmt::format("  <path class=\"dot\" d=\"M {} h 0\" stroke=\"#1f4e79\" "
                           "stroke-width=\"6\"/>\n",
                           view.at(in_space(spline.control_points()[0])));
    svg += "  <g>\n";
    for (const Piece& piece : pieces) svg += piece.svg + "\n";
    svg += "  </g>\n";
    if (largest > 0) svg += deviation_legend(largest, 12, 8);
    return svg + "</svg>\n";
}

} // namespace batten
