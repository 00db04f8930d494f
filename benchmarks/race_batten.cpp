// batten's side of the race: loads the case's arrays once, then for every line on standard input
// prints milliseconds (with the processor's in brackets below), rms and what it did. "THREADS": the
// kernel, assembly and solution; "fit THREADS": the whole call fit() for the same knots and
// parameters, deviation included; "chord THREADS N": the same by chord length and for N control
// points, knots by rule; "read": one thread reads the memory. Reading files is outside the time.
#include <batten/batten.hpp>

#include <chrono>
#include <ctime>
#include <fmt/format.h>
#include <iostream>
#include <numeric>
#include <sstream>
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

/// The case as a caller of fit() states it: the samples stay where they are and nothing is wanted
/// for each of them.
FitOptions options_for(const Case& c, int threads, Index control_points) {
    FitOptions options;
    options.threads = threads;
    options.keep_per_sample = false;
    if (!c.scattered) options.method.name = "direct";
    if (control_points > 0) {
        options.shape.control_points = {control_points};
        return options;
    }
    options.shape.parameters = c.parameters;
    for (const KnotVector& axis : c.axes)
        options.shape.knots.emplace_back(axis.knots().begin(), axis.knots().end());
    return options;
}

/// A whole call, `rounds` times over where it is short.
void time_fit(const Case& c, const FitOptions& options, int rounds) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t busy = std::clock();
    FitReport report;
    for (int k = 0; k < rounds; ++k) report = fit(c.samples, options).report;
    const double used = 1e3 * static_cast<double>(std::clock() - busy) / CLOCKS_PER_SEC;
    const double time = milliseconds_since(start);
    std::string stages;
    for (const auto& [stage, seconds] : report.seconds)
        stages += fmt::format(" {} {:.1f}", stage, 1e3 * seconds);
    fmt::print("{} {:.17g} {} [{:.4g} ms of processor];{}\n", time / rounds, report.deviation.rms,
               report.method, used / rounds, stages);
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
        std::istringstream words(line);
        std::string word;
        int threads = 0;
        Index size = 0;
        int rounds = 1;
        words >> word;
        if (word == "read") {
            fmt::print("{}\n", read_once(c));
        } else if (word == "fit" || word == "chord") {
            words >> threads;
            if (word == "chord") words >> size;
            words >> rounds;
            time_fit(c, options_for(c, threads, size), rounds);
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
