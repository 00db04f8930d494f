// batten's side of the race: loads the case's arrays once, then for every line "THREADS" on
// standard input runs the fit and prints milliseconds, rms and what it did. Reading files is
// outside the time.
#include <batten/batten.hpp>

#include <chrono>
#include <fmt/format.h>
#include <iostream>
#include <numeric>
#include <string>

namespace {

using namespace batten;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

/// Arrays of one case: points, per-axis parameters or scattered ones, knots.
struct Case {
    Samples samples;
    Parameters parameters;
    std::vector<KnotVector> axes;
    bool scattered = false;
};

Case load(const std::string& folder, Index axes, bool scattered) {
    Case c;
    c.scattered = scattered;
    c.samples = read_points(folder + "/q.npy");
    if (scattered) c.parameters.scattered = read_table(folder + "/uv.npy");
    for (Index k = 0; k < axes; ++k) {
        if (!scattered)
            c.parameters.axes.push_back(read_table(fmt::format("{}/t{}.npy", folder, k)).values());
        c.axes.emplace_back(3, read_table(fmt::format("{}/k{}.npy", folder, k)).values());
    }
    return c;
}

struct Answer {
    PointSet control;
    std::string how;
};

Answer solve(const Case& c) {
    const auto system = assemble(c.axes, c.samples, c.parameters);
    if (!c.scattered) return {uncentred(solve_direct(*system), system->centre()), "direct"};
    PointSet control(system->size(), system->dim());
    const auto method = make_method("cg", *system, {});
    const Summary summary =
        iterate(*method, control, {.max_iterations = 500, .relative_gradient = 1e-10});
    return {uncentred(control, system->centre()), fmt::format("cg, {} steps", summary.iterations)};
}

/// One thread's time of summing the case's memory once.
double read_once(const Case& c) {
    const auto start = std::chrono::steady_clock::now();
    double lanes[32] = {};
    const auto sum = [&](const double* x, Index count) {
        for (Index i = 0; i + 32 <= count; i += 32)
            for (Index k = 0; k < 32; ++k) lanes[k] += x[i + k];
    };
    sum(c.samples.points.data(), c.samples.size() * c.samples.dim());
    if (c.scattered)
        sum(c.parameters.scattered.data(), c.samples.size() * 2);
    else if (c.axes.size() == 1)
        sum(c.parameters.axes[0].data(), c.samples.size());
    const double time = milliseconds_since(start);
    if (std::accumulate(lanes, lanes + 32, 0.0) == 0.123)
        std::cerr << ' '; // the sum must not be thrown away
    return time;
}

} // namespace

int main(int, char** argv) {
    const Case c = load(argv[1], std::stoi(argv[2]), argv[3] == std::string("scattered"));
    for (std::string line; std::getline(std::cin, line);) {
        if (line == "read") {
            fmt::print("{}\n", read_once(c));
        } else {
            const ThreadLimit limit(std::stoi(line));
            const auto start = std::chrono::steady_clock::now();
            const Answer answer = solve(c);
            const double time = milliseconds_since(start);
            const Deviation d =
                summarise(parametric_deviations(Spline::from_free(c.axes, answer.control),
                                                c.samples, c.parameters),
                          DeviationKind::parametric);
            fmt::print("{} {:.17g} {}\n", time, d.rms, answer.how);
        }
        std::cout.flush();
        std::fflush(stdout);
    }
}
