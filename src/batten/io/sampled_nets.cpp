#include <batten/io/sampled_nets.hpp>

#include <batten/io/exchange_formats.hpp>
#include <batten/io/text_blocks.hpp>
#include <batten/spline/graph.hpp>

#include <algorithm>
#include <fmt/compile.h>
#include <numeric>

namespace batten {

namespace {

/// Sets of positions that are one point, each known by its first position.
class Vertices {
  public:
    explicit Vertices(Index count) : first_(static_cast<std::size_t>(count)) {
        std::iota(first_.begin(), first_.end(), Index{0});
    }
    Index of(Index position) {
        Index& first = first_[static_cast<std::size_t>(position)];
        if (first != position) first = of(first);
        return first;
    }
    void unite(Index a, Index b) {
        a = of(a);
        b = of(b);
        first_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
    std::vector<Index> all() {
        for (Index i = 0; i < static_cast<Index>(first_.size()); ++i) of(i);
        return std::move(first_);
    }

  private:
    std::vector<Index> first_; // never after the position itself
};

using Net = SampledNets::Net;

/// Unites neighbours along the axis that are one point.
void join_neighbours(const Net& net, std::size_t axis, const PointSet& points, double apart,
                     Vertices& vertices) {
    net.grid.for_each_strand(axis, [&](const GridIndex::Strand& strand) {
        for (Index i = 1; i < strand.count; ++i) {
            const Index before = vertices.of(net.first + strand[i - 1]);
            const Index here = net.first + strand[i];
            if (is_same_point(points[before], points[here], apart)) vertices.unite(before, here);
        }
    });
}

/// Unites both ends of every strand along the axis.
void join_ends(const Net& net, std::size_t axis, Vertices& vertices) {
    net.grid.for_each_strand(axis, [&](const GridIndex::Strand& strand) {
        vertices.unite(net.first + strand[0], net.first + strand[strand.count - 1]);
    });
}

/// Unites the edge that two faces of a volume share, where they do.
void join_edge(const Net& a, const Net& b, Vertices& vertices) {
    if (a.held == b.held) return;
    const std::size_t along = 3 - a.held - b.held;
    const auto end = [](const Net& net, std::size_t axis, bool last) {
        return last ? net.grid.length(axis) - 1 : 0;
    };
    GridIndex::Place in_a{};
    GridIndex::Place in_b{};
    in_a[b.held] = end(a, b.held, b.at_end);
    in_b[a.held] = end(b, a.held, a.at_end);
    for (Index i = 0; i < a.grid.length(along); ++i) {
        in_a[along] = in_b[along] = i;
        vertices.unite(a.position(in_a), b.position(in_b));
    }
}

/// Evaluates the nets of `result`, whose places are `held` or all, and finds the vertices.
void fill(const Spline& spline, SampledNets& result) {
    const Spline shown = drawn(spline);
    result.centre = centre_of(shown);
    const Spline local = about(shown, result.centre);
    std::vector<double> values;
    for (const Net& net : result.nets) {
        AxisPlaces places = result.places;
        if (net.held < 3)
            places[net.held] = {net.at_end ? places[net.held].back() : places[net.held].front()};
        PointSet points = evaluate_grid(local, places);
        if (result.nets.size() == 1)
            values = std::move(points.values());
        else
            values.insert(values.end(), points.values().begin(), points.values().end());
    }
    result.points = PointSet(std::move(values), local.dim());
    Vertices vertices(result.points.size());
    // two places of a graph are never one
    const double apart = is_function(spline) ? -1 : same_point_distance(local);
    for (const Net& net : result.nets) {
        for (const Net& other : result.nets)
            if (&other > &net) join_edge(net, other, vertices);
        for (std::size_t k = 0; k < result.places.size(); ++k) {
            if (k == net.held) continue;
            if (!is_function(spline) && meets_itself(local, static_cast<Index>(k)))
                join_ends(net, k, vertices);
            join_neighbours(net, k, result.points, apart, vertices);
        }
    }
    result.vertex = vertices.all();
    for (Index i = 0; i < result.points.size(); ++i)
        if (const Index first = result.vertex[static_cast<std::size_t>(i)]; first != i)
            std::ranges::copy(result.points[first], result.points[i].begin());
}

/// Lengths of the three axes, 1 where there is none.
std::array<Index, 3> lengths(const AxisPlaces& places) {
    std::array<Index, 3> result{1, 1, 1};
    for (std::size_t k = 0; k < places.size(); ++k)
        result[k] = static_cast<Index>(places[k].size());
    return result;
}

} // namespace

PointSet SampledNets::all() const {
    PointSet result = points;
    for (Index i = 0; i < result.size(); ++i)
        for (std::size_t d = 0; d < centre.size(); ++d)
            result(i, static_cast<Index>(d)) += centre[d];
    return result;
}

std::pair<PointSet, std::vector<Index>> SampledNets::distinct() const {
    std::vector<Index> number(vertex.size());
    std::vector<double> values;
    Index count = 0;
    for (Index i = 0; i < points.size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (vertex[at] != i) {
            number[at] = number[static_cast<std::size_t>(vertex[at])];
            continue;
        }
        number[at] = count++;
        for (std::size_t d = 0; d < centre.size(); ++d)
            values.push_back(points(i, static_cast<Index>(d)) + centre[d]);
    }
    return {PointSet(std::move(values), points.dim()), std::move(number)};
}

double chord_of(const Scene& scene, const Spline& spline) {
    return scene.chord_tolerance > 0 ? scene.chord_tolerance : picture_chord(spline);
}

SampledNets sampled(const Spline& spline, AxisPlaces places) {
    SampledNets result{
        .places = std::move(places), .nets = {}, .points = {}, .centre = {}, .vertex = {}};
    result.nets.push_back({.grid = GridIndex(lengths(result.places))});
    fill(spline, result);
    return result;
}

SampledNets sampled_skin(const Spline& volume, AxisPlaces places) {
    SampledNets result{
        .places = std::move(places), .nets = {}, .points = {}, .centre = {}, .vertex = {}};
    Index first = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (meets_itself(volume, static_cast<Index>(k))) continue;
        std::array<Index, 3> shape = lengths(result.places);
        shape[k] = 1;
        for (bool at_end : {false, true}) {
            result.nets.push_back({GridIndex(shape), first, k, at_end});
            first += result.nets.back().grid.size();
        }
    }
    fill(volume, result);
    return result;
}

std::string evaluated_text(const Scene& scene) {
    constexpr std::string_view parameters[] = {"u", "v", "w"};
    const Spline& spline = scene.spline;
    const AxisPlaces places = sampling(spline, chord_of(scene, spline));
    const std::size_t axes = places.size();
    // a function's values stand beside their parameters as they are
    const PointSet points =
        is_function(spline) ? evaluate_grid(spline, places) : sampled(spline, places).all();
    std::string text;
    for (std::size_t k = 0; k < axes; ++k) text += fmt::format("{},", parameters[k]);
    for (Index d = 0; d < points.dim(); ++d)
        text += fmt::format("{}{}",
                            points.dim() <= 3 ? std::string(1, "xyz"[d]) : fmt::format("x{}", d),
                            d + 1 < points.dim() ? ',' : '\n');
    const GridIndex grid(lengths(places));
    append_text(text, points.size(), [&](Index i, fmt::memory_buffer& out) {
        const auto to = std::back_inserter(out);
        const GridIndex::Place place = grid.place(i);
        for (std::size_t k = 0; k < axes; ++k)
            fmt::format_to(to, FMT_COMPILE("{},"), places[k][static_cast<std::size_t>(place[k])]);
        for (Index d = 0; d < points.dim(); ++d)
            fmt::format_to(to, FMT_COMPILE("{}{}"), points(i, d),
                           d + 1 < points.dim() ? ',' : '\n');
    });
    return text;
}

} // namespace batten
