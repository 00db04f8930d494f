// Every request with every driver on every kind of samples: it changes the answer as it should, or
// is refused in the one wording; and the requests of a column go together two by two.
#include "problems.hpp"

#include <batten/drivers/choose.hpp>
#include <batten/problem/initial.hpp>
#include <batten/shape/polygon.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace batten {
namespace {

/// A fit that is going to be asked.
struct Ask {
    Samples samples;
    FitOptions options;
};

constexpr Index marked = 25; ///< the sample that weights and tangents are about, hit with the next
constexpr Index also_hit = 30;
constexpr Index far_off = 41; ///< the outlier
constexpr Index bent = 12;    ///< the corner

Samples planar_curve(Index m) {
    PointSet q(m, 2);
    for (Index i = 0; i < m; ++i) {
        const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(m);
        q(i, 0) = 2 * std::cos(a) + 0.02 * std::sin(9 * a);
        q(i, 1) = std::sin(a) + 0.2 * std::cos(3 * a);
    }
    return testing::sequence(std::move(q));
}

/// A tube: closed along axis 0.
Samples tube() {
    Samples samples;
    samples.grid = {14, 12};
    PointSet q(14 * 12, 3);
    for (Index i = 0; i < q.size(); ++i) {
        const double a = 2 * std::numbers::pi * static_cast<double>(i / 12) / 14;
        const double h = static_cast<double>(i % 12) / 11;
        q(i, 0) = (1 + 0.2 * h) * std::cos(a);
        q(i, 1) = (1 + 0.1 * std::sin(5 * h)) * std::sin(a);
        q(i, 2) = 2 * h + 0.05 * std::cos(2 * a);
    }
    samples.points = Points(std::move(q));
    return samples;
}

Ask cloud() {
    Ask ask;
    PointSet uv(800, 2);
    const PointSet random = testing::random_points(800, 2, 7);
    for (std::size_t k = 0; k < uv.values().size(); ++k)
        uv.values()[k] = (random.values()[k] + 1) / 2;
    PointSet q(800, 3);
    for (Index i = 0; i < 800; ++i) {
        q(i, 0) = uv(i, 0);
        q(i, 1) = uv(i, 1);
        q(i, 2) =
            0.3 * std::sin(4 * uv(i, 0)) * std::cos(3 * uv(i, 1)) + 0.01 * std::sin(40 * uv(i, 0));
    }
    ask.samples.points = Points(std::move(q));
    ask.options.shape.parameters = Parameters{{}, std::move(uv)};
    return ask;
}

/// A problem that the driver answers, with as little said as it needs.
Ask plain(const Driver& driver, SampleKind kind) {
    Ask ask;
    if (kind == SampleKind::sequence) ask.samples = planar_curve(60);
    if (kind == SampleKind::grid) ask.samples = tube();
    if (kind == SampleKind::cloud) ask = cloud();
    FitOptions& options = ask.options;
    options.method.name = driver.name;
    const bool curve = kind == SampleKind::sequence;
    if (driver.name == "search")
        options.tolerance.value = 0.02;
    else if (driver.name == "epia" && kind != SampleKind::cloud)
        options.stop = {.max_iterations = 60, .relative_gradient = 0, .deviation = 0.02};
    else if (driver.name != "pia")
        options.shape.control_points = curve ? std::vector<Index>{12} : std::vector<Index>{7, 8};
    if (driver.name == "pia") options.stop.max_iterations = 20;
    if (driver.name == "clspia") options.stop.relative_gradient = 1e-6;
    if (driver.name == "rpia") options.stop.relative_gradient = 1e-4; // a block at a time
    return ask;
}

std::vector<double> knots_of(const KnotVector& axis) {
    return {axis.knots().begin(), axis.knots().end()};
}

/// Knots for the driver's number of control points, unlike those that it would place itself.
std::vector<std::vector<double>> other_knots(const Ask& ask) {
    const bool square = ask.options.method.name == "pia";
    const auto& given = ask.options.shape.parameters;
    if (ask.samples.kind() == SampleKind::sequence && !(given && given->is_scattered()))
        return {knots_of(
            square ? averaged_knots(
                         parametrize_sequence(ask.samples.points, Parametrization::chord), 3)
                   : uniform_knots(3, 13, 0, 1))};
    if (!square) return {knots_of(uniform_knots(3, 7, 0, 1)), knots_of(uniform_knots(3, 7, 0, 1))};
    const Parameters t =
        parametrize(ask.samples, Parametrization::chord, {Closure::open, Closure::open});
    return {knots_of(averaged_knots(t.axes[0], 3)), knots_of(averaged_knots(t.axes[1], 3))};
}

Parameters other_parameters(const Samples& samples) {
    Parameters t;
    for (Index m : samples.shape()) {
        t.axes.emplace_back();
        for (Index i = 0; i < m; ++i)
            t.axes.back().push_back(
                0.98 * std::pow(static_cast<double>(i) / static_cast<double>(m - 1), 1.15));
    }
    return t;
}

/// The curve that the first row of the grid along axis 1 is near to.
Spline first_row(const Samples& samples) {
    PointSet row(samples.grid[1], samples.dim());
    for (Index j = 0; j < row.size(); ++j) std::ranges::copy(samples.points[j], row[j].begin());
    return fit(testing::sequence(std::move(row)), {.shape = {.control_points = {6}}}).spline;
}

void add_to_space(Request request, Ask& ask) {
    ShapeOptions& shape = ask.options.shape;
    const bool scattered = shape.parameters && shape.parameters->is_scattered();
    const bool curve = ask.samples.kind() == SampleKind::sequence && !scattered;
    const bool square = ask.options.method.name == "pia";
    const bool epia = ask.options.method.name == "epia";
    switch (request) {
    case Request::size:
        shape.control_points = square  ? ask.samples.shape()
                               : curve ? std::vector<Index>{epia ? 40 : 15}
                                       : std::vector<Index>{8, epia && !scattered ? 11 : 9};
        return;
    case Request::knots:
        shape.knots = other_knots(ask);
        shape.control_points.clear();
        return;
    case Request::placement:
        shape.placement = scattered ? KnotPlacement::data : KnotPlacement::uniform;
        if (square) shape.parametrization = Parametrization::uniform; // else it may be singular
        return;
    case Request::parameters:
        shape.parameters = other_parameters(ask.samples);
        shape.parametrization.reset();
        return;
    case Request::closed:
        shape.closures = {Closure::closed};
        if (!curve) shape.closures.push_back(Closure::open);
        return;
    case Request::seam:
        shape.closures = {Closure::closed};
        shape.seam_continuity = 0;
        return;
    default:
        return;
    }
}

void add_held(Request request, Ask& ask) {
    HoldOptions& hold = ask.options.hold;
    switch (request) {
    case Request::samples:
        hold.interpolate = {marked, also_hit};
        return;
    case Request::tangents: {
        const auto a = ask.samples.points[marked - 1];
        const auto b = ask.samples.points[marked + 1];
        HeldTangent tangent{.sample = marked, .axis = ask.samples.grid.empty() ? 0 : 1};
        for (std::size_t d = 0; d < a.size(); ++d) tangent.value.push_back(b[d] - a[d]);
        tangent.value[0] += 0.1 * std::abs(tangent.value[1]);
        hold.tangents = {tangent};
        return;
    }
    case Request::boundaries:
        hold.boundaries = {{.axis = 0, .end = AxisEnd::begin, .spline = first_row(tube())}};
        return;
    case Request::shape:
        hold.preserve = Preserve::inflections;
        return;
    default:
        return;
    }
}

/// Where a method with memory starts by itself; any control points for one that is refused them.
PointSet start_of(const Ask& ask) {
    const SampleKind kind = problem_of(ask.samples, ask.options).kind;
    if (!driver(ask.options.method.name).takes(kind)->has(Request::memory))
        return PointSet(12, ask.samples.dim());
    FitOptions unmoved = ask.options;
    unmoved.stop.max_iterations = 0;
    unmoved.method.control = {};
    return fit(ask.samples, unmoved).spline.free_control_points();
}

void add(Request request, Ask& ask) {
    FitOptions& options = ask.options;
    add_to_space(request, ask);
    add_held(request, ask);
    switch (request) {
    case Request::weights:
        ask.samples.weights.assign(static_cast<std::size_t>(ask.samples.size()), 1.0);
        ask.samples.weights[marked] = 1e4;
        return;
    case Request::tolerance:
        options.tolerance.value = 0.01;
        return;
    case Request::limit:
        options.tolerance.max_control_points = 40;
        return;
    case Request::corners:
        options.tolerance.corners = Corners::given;
        options.tolerance.corner_samples = {bent};
        return;
    case Request::smoothing:
        options.smooth = {.wanted = true, .lambda = 1e-4};
        return;
    case Request::outliers: {
        PointSet q(ask.samples.points);
        q(far_off, 0) += 1.5;
        ask.samples.points = Points(std::move(q));
        options.outliers = Outliers::set_aside;
        return;
    }
    case Request::start:
        options.method.initial = Initial::zero;
        options.stop.max_iterations = 1;
        return;
    case Request::local:
        options.method.moving = {2, 3};
        return;
    case Request::history:
        options.keep_history = true;
        return;
    case Request::stop:
        options.stop.max_iterations = 2;
        return;
    case Request::memory: // the last of all, after what decides on the spline space
        options.method.control = start_of(ask);
        options.method.initial = Initial::given;
        options.method.before = options.method.control;
        for (double& x : options.method.before.values()) x *= 0.999;
        return;
    default:
        return;
    }
}

double sharpest_knot(const KnotVector& axis) {
    std::ptrdiff_t most = 0;
    for (double t : axis.breakpoints())
        if (t > axis.begin() && t < axis.end())
            most = std::max(most, std::ranges::count(axis.knots(), t));
    return static_cast<double>(most);
}

bool moved_only(const PointSet& control, const PointSet& start, const std::vector<Index>& moving) {
    for (Index i = 0; i < control.size(); ++i)
        if (std::ranges::count(moving, i) == 0 && distance(control[i], start[i]) > 1e-12)
            return false;
    return true;
}

double deviation_of(const FitResult& result, const Ask& ask, Index i) {
    const std::vector<double> at = parameter_of(result.parameters, i);
    return distance(result.spline(at), ask.samples.points[i]);
}

bool parallel(const FitResult& result, const HeldTangent& tangent) {
    std::vector<int> orders(static_cast<std::size_t>(result.spline.axis_count()), 0);
    orders[static_cast<std::size_t>(tangent.axis)] = 1;
    const auto got = result.spline(parameter_of(result.parameters, tangent.sample), orders);
    double gg = 0, vv = 0, gv = 0;
    for (std::size_t d = 0; d < got.size(); ++d) {
        gg += got[d] * got[d];
        vv += tangent.value[d] * tangent.value[d];
        gv += got[d] * tangent.value[d];
    }
    return gv > 0 && gg * vv - gv * gv <= 1e-12 * gg * vv;
}

/// Whether what was asked for shows in the answer, by looking at the answer alone.
bool shows(Request request, const Ask& ask, const FitResult& result) {
    const Spline& spline = result.spline;
    const FitReport& report = result.report;
    const bool open = spline.axis(0).closure() == Closure::open;
    switch (request) {
    case Request::size: {
        const std::vector<Index> free = free_shape(spline.axes());
        if (report.method != "epia" || result.parameters.is_scattered())
            return free == ask.options.shape.control_points;
        for (std::size_t k = 0; k < free.size(); ++k) // its start may have more: then none is added
            if (free[k] > ask.options.shape.control_points[k] + 1 && report.notes.size() != 1)
                return false;
        return true;
    }
    case Request::knots:
        return knots_of(spline.axis(0)) == ask.options.shape.knots[0];
    case Request::placement: {
        const std::vector<double> breaks = spline.axis(0).breakpoints();
        const double step = spline.axis(0).length() / static_cast<double>(breaks.size() - 1);
        return !ask.options.shape.knots.empty() || ask.options.shape.seam_continuity >= 0 ||
               std::abs(breaks[1] - breaks[0] - step) < 1e-12;
    }
    case Request::closed:
        return !open;
    case Request::seam: // a kink is allowed: the seam's knot has full multiplicity, if it is needed
        return report.method == "search" ||
               std::ranges::count(spline.axis(0).knots(), spline.axis(0).begin()) >=
                   spline.axis(0).degree();
    case Request::samples:
        if (report.method == "epia" || report.termination == Termination::iteration_limit)
            return report.goals_met() ==
                   (deviation_of(result, ask, marked) < 2e-9 &&
                    deviation_of(result, ask, also_hit) < 2e-9 &&
                    (ask.options.stop.deviation == 0 || report.deviation.maximum <= 0.02) &&
                    (!ask.options.tolerance.stated() || report.tolerance_ratio <= 1));
        return !report.goals_met() || (deviation_of(result, ask, also_hit) < 1e-8 &&
                                       deviation_of(result, ask, marked) < 1e-8);
    case Request::tangents:
        return report.termination == Termination::iteration_limit ||
               parallel(result, ask.options.hold.tangents[0]);
    case Request::boundaries: {
        const Spline& wanted = ask.options.hold.boundaries[0].spline;
        return report.termination == Termination::iteration_limit ||
               distance(spline(std::array{spline.axis(0).begin(), 0.37 * spline.axis(1).end()}),
                        wanted(std::array{0.37})) < 1e-8;
    }
    case Request::tolerance:
        return (report.termination == Termination::tolerance_met) == report.goals_met();
    case Request::limit:
        return spline.free_control_points().size() <= 40;
    case Request::corners: // they may bend, as far as that saves control points
        return sharpest_knot(spline.axis(0)) <= spline.axis(0).degree();
    case Request::shape:
        return report.allowed_inflections >= 0 &&
               (inflection_count(spline.free_control_points(), spline.axis(0).closure()) <=
                    report.allowed_inflections ||
                !report.goals_met());
    case Request::smoothing:
        return report.smoothing == 1e-4;
    case Request::outliers:
        return std::ranges::count(report.set_aside, far_off) == 1;
    case Request::start:
    case Request::stop:
        return report.iterations <= 2;
    case Request::local: {
        if (ask.options.method.initial != Initial::data) return true;
        Ask unmoved = ask;
        unmoved.options.stop.max_iterations = 0;
        const Spline start = fit(unmoved.samples, unmoved.options).spline;
        return moved_only(spline.free_control_points(), start.free_control_points(),
                          ask.options.method.moving);
    }
    case Request::history:
        return static_cast<Index>(report.history.size()) == report.iterations + 1;
    case Request::parameters:
    case Request::weights:
    case Request::memory:
        return true; // seen beside the answer without it only
    }
    return false;
}

/// Requests after which the answer must be another one.
bool must_change(Request request, const Driver& driver) {
    switch (request) {
    case Request::history:
    case Request::limit:
    case Request::outliers:
    case Request::shape:
        return false;
    case Request::start:
        return driver.name != "direct";
    case Request::stop:
        return driver.name != "direct" && driver.name != "cg";
    case Request::size:
        return driver.name != "pia" && driver.name != "epia";
    case Request::knots:
        return driver.name != "pia";
    case Request::samples:
    case Request::tolerance: // of a fixed size the iteration goes on where it went
        return driver.name != "epia";
    default:
        return true;
    }
}

bool same(const Spline& a, const Spline& b) {
    return a.axes() == b.axes() && a.control_points().values() == b.control_points().values();
}

/// Rules on the samples themselves that come before any driver's column.
bool ruled_by_kind(Request request, SampleKind kind) {
    if (request == Request::boundaries) return kind != SampleKind::grid;
    if (request == Request::seam) return kind != SampleKind::sequence;
    return false;
}

template <class Visit>
void for_each_cell(Visit visit) {
    for (const Driver& driver : drivers())
        for (SampleKind kind : {SampleKind::sequence, SampleKind::grid, SampleKind::cloud})
            if (driver.takes(kind)) visit(driver, kind, *driver.takes(kind));
}

TEST(DriverTable, every_request_shows_in_the_answer_or_is_refused) {
    for_each_cell([](const Driver& driver, SampleKind kind, Requests column) {
        const Ask base = plain(driver, kind);
        const FitResult without = fit(base.samples, base.options);
        for (std::size_t k = 0; k < request_count; ++k) {
            const auto request = static_cast<Request>(k);
            if (kind == SampleKind::cloud && request == Request::parameters)
                continue; // it has them
            const std::string where =
                fmt::format("{} of a {}: {}", driver.name, to_string(kind), to_string(request));
            Ask ask = base;
            add(request, ask);
            if (column.has(request)) {
                const FitResult with = fit(ask.samples, ask.options);
                EXPECT_TRUE(shows(request, ask, with)) << where << "\n" << with.report.full();
                EXPECT_FALSE(must_change(request, driver) && same(with.spline, without.spline))
                    << where;
                continue;
            }
            const std::string words =
                testing::message_of<InvalidInput>([&] { fit(ask.samples, ask.options); });
            if (ruled_by_kind(request, kind)) continue;
            const Requests lacking = requests_of(problem_of(ask.samples, ask.options)) - column;
            ASSERT_FALSE(lacking.empty()) << where;
            EXPECT_NE(words.find(fmt::format("cannot {}", to_string(lacking.list().front()))),
                      std::string::npos)
                << where << ": " << words;
        }
    });
}

TEST(DriverTable, a_refusal_names_drivers_that_can) {
    for_each_cell([](const Driver& driver, SampleKind kind, Requests column) {
        for (std::size_t k = 0; k < request_count; ++k) {
            const auto request = static_cast<Request>(k);
            if (column.has(request)) continue;
            const std::string words = testing::message_of<InvalidInput>(
                [&] { check_column(driver, kind, Requests{request}); });
            const std::string names = words.substr(words.find("; ") + 2);
            bool any = false;
            for (const Driver& other : drivers()) {
                const bool named =
                    (", " + names).find(fmt::format(", {}", other.name)) != std::string::npos;
                any = any || named;
                EXPECT_TRUE(!named || (other.takes(kind) && other.takes(kind)->has(request)))
                    << words;
            }
            EXPECT_EQ(any, names != "nothing can") << words;
        }
    });
}

/// Under a sanitizer, where a fit takes ten times as long, a part of the pairs is tried.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::size_t pair_step = 13;
#else
constexpr std::size_t pair_step = 1;
#endif

using Pairs = std::vector<std::pair<Request, Request>>;

/// The pairs of a column's requests that are tried: every request with every step-th of the others,
/// from column to column with another of them. A column of less than twice as many requests has a
/// smaller step, so that none is left out.
Pairs tried_pairs(Requests column, std::size_t number, std::size_t step) {
    const std::vector<Request> all = column.list();
    step = std::clamp<std::size_t>(step, 1, all.size() / 2);
    Pairs pairs;
    for (std::size_t a = 0; a < all.size(); ++a)
        for (std::size_t b = a + 1; b < all.size(); ++b)
            if ((a + b + number) % step == 0) pairs.emplace_back(all[a], all[b]);
    return pairs;
}

/// Pairs that say two things of one, or that one of the two cannot answer together.
bool contradict(const Driver& driver, SampleKind kind, Request a, Request b) {
    using enum Request;
    const auto are = [&](Request first, std::initializer_list<Request> seconds) {
        return a == first && std::ranges::count(seconds, b) > 0;
    };
    if (are(knots, {placement, closed, seam}) || are(size, {knots}) || are(closed, {boundaries}))
        return true;
    if (driver.name == "pia") // parameters: may be singular
        return are(knots, {parameters}) || are(placement, {parameters}) || b == shape;
    return driver.name == "search" && kind == SampleKind::grid &&
           are(limit, {boundaries}); // the boundary alone takes more
}

TEST(DriverTable, requests_of_a_column_go_together_two_by_two) {
    std::size_t number = 0;
    for_each_cell([&](const Driver& driver, SampleKind kind, Requests column) {
        for (const auto& [a, b] : tried_pairs(column, number++, pair_step)) {
            if (contradict(driver, kind, a, b)) continue;
            const std::string where = fmt::format("{} of a {}: {}, {}", driver.name,
                                                  to_string(kind), to_string(a), to_string(b));
            Ask ask = plain(driver, kind);
            add(a, ask);
            add(b, ask);
            try {
                const FitResult result = fit(ask.samples, ask.options);
                for (Request request : {a, b})
                    EXPECT_TRUE(shows(request, ask, result))
                        << where << ": " << to_string(request) << "\n"
                        << result.report.full();
            } catch (const std::exception& error) {
                ADD_FAILURE() << where << ": " << error.what();
            }
        }
    });
}

TEST(DriverTable, pairs_tried_in_steps_leave_no_request_out) {
    std::size_t number = 0;
    for_each_cell([&](const Driver& driver, SampleKind kind, Requests column) {
        const std::size_t count = column.list().size();
        EXPECT_EQ(tried_pairs(column, number, 1).size(), count * (count - 1) / 2);
        Requests seen;
        for (const auto& [a, b] : tried_pairs(column, number++, 13)) seen = seen | Requests{a, b};
        EXPECT_TRUE(seen.covers(column)) << driver.name << " " << to_string(kind);
    });
}

} // namespace
} // namespace batten
