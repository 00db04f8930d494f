#include "papers.hpp"

#include <batten/samples/generate.hpp>
#include <batten/solve/extreme_eigenvalues.hpp>
#include <batten/system/normal_system.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <random>

namespace batten::command {

namespace {

constexpr double printed_digits = 1e-12; // accuracy of the eigenvalues behind the printed weights
constexpr double stop = 1e-8;            // the paper prints 1e-7, its counts are those of this

/// A line of Table 2: counts, weights, LSPIA's time over MLSPIA's and the largest deviation.
struct Weighed {
    const char *omega, *nu, *mu, *fast, *slow, *deviation;
    double times;
};

/// An example, what stands in for it, and what is printed of it.
struct Example {
    int number;
    Samples samples;
    const char* stand_in; ///< empty: the paper's own
    Index n;              ///< control points of Tables 2 and 3, along each axis
    std::array<const char*, 7> zero;
    std::array<const char*, 7> data; ///< Table 1, I and II
    Weighed weighed;
    const char *least, *most, *smallest, *largest; ///< Table 3: iterations and errors

    std::string name(const char* table) const {
        return fmt::format("{}, Example {}", table, number);
    }
    Table table(const char* of) const {
        return {name(of), {}, *stand_in == 0 ? Data::the_papers : Data::stand_in, stand_in};
    }
};

std::vector<Example> examples(Workshop& workshop) {
    const auto section = workshop.real("profile205.csv");
    return {
        {1,
         section ? *section : generate("naca2412", {205}),
         section ? "the section of 205 points that goes with Chang, Ma, Deng 2023" : "NACA 2412",
         20,
         {"63", "63", "62", "60", "59", "84", "531"},
         {"58", "57", "55", "53", "51", "71", "453"},
         {"0.564044574432", "0.410174207181", "0.161116795141", "57", "224", "5.7533e-11",
          0.0030 / 0.00094},
         "86",
         "95",
         "6.7986e-9",
         "9.8944e-9"},
        {2,
         generate("circle", {305}),
         "305 points of a circle",
         30,
         {"78", "72", "72", "74", "70", "100", "979"},
         {"69", "64", "62", "61", "54", "75", "946"},
         {"0.540473573417", "0.441899756336", "0.163638791357", "64", "268", "8.0937e-10",
          0.0188 / 0.0043},
         "92",
         "100",
         "6.9669e-9",
         "9.8188e-9"},
        {3,
         generate("rose", {501}),
         "",
         50,
         {"56", "55", "55", "55", "55", "85", "696"},
         {"49", "47", "48", "48", "49", "74", "570"},
         {"0.589932226424", "0.418520492365", "0.175097063057", "47", "156", "1.1266e-9",
          0.0109 / 0.0045},
         "82",
         "87",
         "7.1887e-9",
         "9.6780e-9"},
        {4,
         generate("letter", {269}),
         "a letter G with sharp corners",
         35,
         {"73", "70", "69", "67", "69", "75", "426"},
         {"67", "63", "63", "59", "56", "57", "331"},
         {"0.524388806864", "0.572453504530", "0.203433134434", "63", "272", "2.5985e-10",
          0.0124 / 0.0058},
         "96",
         "104",
         "7.4159e-9",
         "9.7002e-9"},
        {5,
         generate("peaks", {81, 81}),
         "81 x 81 points of peaks",
         35,
         {"396", "384", "362", "340", "319", "582", "32172"},
         {"407", "388", "364", "339", "313", "551", "32014"},
         {"0.132873535878", "4.404202175610", "0.313423823743", "362", "7576", "1.8688e-10",
          130.6242 / 5.4167},
         "533",
         "558",
         "9.3723e-9",
         "9.8929e-9"},
    };
}

FitOptions as_printed(const Example& example, const char* method, Index n, Initial initial) {
    FitOptions options;
    options.shape.control_points = std::vector<Index>(example.samples.shape().size(), n);
    options.method = {.name = method,
                      .settings = {{"eigenvalue_tolerance", printed_digits}, {"row_sums", 0}},
                      .initial = initial};
    options.stop = {.max_iterations = 200000, .gradient = stop, .relative_gradient = 0};
    return options;
}

double iterations(const FitResult& result) {
    return static_cast<double>(result.report.iterations);
}

/// Iterations from zero (I) and from samples (II) for numbers of control points.
Table table_1(const Example& example) {
    const Index m = example.samples.shape()[0];
    const std::array<Index, 7> n{m / 12, m / 10, m / 8, m / 6, m / 4, m / 2, 2 * m / 3};
    Table table = example.table("Table 1");
    for (std::size_t k = 0; k < n.size(); ++k)
        for (const Initial initial : {Initial::zero, Initial::data}) {
            const bool zero = initial == Initial::zero;
            table.rows.push_back(
                {fmt::format("{} control points, {}", n[k], zero ? "I" : "II"),
                 zero ? example.zero[k] : example.data[k],
                 iterations(fit(example.samples, as_printed(example, "mlspia", n[k], initial)))});
        }
    return table;
}

/// The largest distance between two splines over the same knots, at 20 parameters a control point.
double largest_difference(const FitResult& a, const FitResult& b) {
    constexpr Index parts = 20;
    PointSet off = a.spline.control_points();
    add_scaled(off, -1, b.spline.control_points());
    std::vector<std::vector<double>> at;
    for (const KnotVector& axis : a.spline.axes()) {
        const Index steps = parts * axis.free_count();
        at.emplace_back();
        for (Index k = 0; k <= steps; ++k)
            at.back().push_back(axis.begin() + axis.length() * static_cast<double>(k) /
                                                   static_cast<double>(steps));
    }
    return largest_length(evaluate_grid(Spline(a.spline.axes(), off), at));
}

/// The largest singular value of the matrix of the points' coordinates.
double two_norm(const PointSet& points) {
    const VectorOperator gram = [&](const std::vector<double>& in, std::vector<double>& out) {
        std::ranges::fill(out, 0.0);
        for (Index i = 0; i < points.size(); ++i) {
            double along = 0;
            for (std::size_t d = 0; d < in.size(); ++d) along += points[i][d] * in[d];
            for (std::size_t d = 0; d < in.size(); ++d) out[d] += along * points[i][d];
        }
    };
    return std::sqrt(lanczos(gram, points.dim(), printed_digits, SpectrumEnds::largest).largest);
}

/// The first iteration whose gradient is below the stop in the 2-norm of its matrix (39), where the
/// library's stop, in the Frobenius norm, comes at the same iteration or a later one.
double iterations_by_two_norm(const Example& example, FitOptions options, const FitResult& whole) {
    const auto system = assemble(whole.spline.axes(), example.samples, whole.parameters);
    Index first = whole.report.iterations;
    options.observer = [&](const Iteration& now) {
        const PointSet gradient = system->gradient(centred(now.control, system->centre()));
        if (two_norm(gradient) >= stop) return Continue::yes;
        first = now.number;
        return Continue::no;
    };
    fit(example.samples, options);
    return static_cast<double>(first);
}

double solving_seconds(const FitReport& report) {
    double sum = 0;
    for (const auto& [stage, seconds] : report.seconds) sum += stage == "solve" ? seconds : 0;
    return sum;
}

Table table_2(const Example& example, Workshop& workshop) {
    const auto options = [&](const char* method) {
        return as_printed(example, method, example.n, Initial::data);
    };
    const std::vector<Index> steps =
        example.number == 5 ? std::vector<Index>{0, 200} : std::vector<Index>{0, 5, 10};
    const auto stem = [&](const char* method) {
        return fmt::format("{}_example{}", method, example.number);
    };
    drawn_fit(example.samples, options("mlspia"), workshop, stem("mlspia"), steps);
    const FitResult fast = fit(example.samples, options("mlspia"));
    const FitResult slow = fit(example.samples, options("lspia"));
    const Weighed& printed = example.weighed;
    Table table = example.table("Table 2");
    table.rows = {
        {"omega* = gamma*", printed.omega, fast.report.settings.at("omega")},
        {"nu*", printed.nu, fast.report.settings.at("nu")},
        {"mu* of LSPIA", printed.mu, slow.report.settings.at("mu")},
        {"iterations of MLSPIA, Frobenius norm", printed.fast, iterations(fast)},
        {"the same, 2-norm as in eq. 39", printed.fast,
         iterations_by_two_norm(example, options("mlspia"), fast)},
        {"iterations of LSPIA, Frobenius norm", "", iterations(slow)},
        {"the same, 2-norm as in eq. 39", printed.slow,
         iterations_by_two_norm(example, options("lspia"), slow)},
        {"MaxDeviations, both stopped by the Frobenius norm", printed.deviation,
         largest_difference(fast, slow)},
        {fmt::format("LSPIA's time over MLSPIA's (printed: {:.2g})", printed.times), "",
         solving_seconds(slow.report) / solving_seconds(fast.report)},
    };
    table.pictures = stem("mlspia") + "_*.svg";
    return table;
}

/// The fewest and most iterations, and errors, of ten starts in a box.
Table table_3(const Example& example, double high, bool as_is) {
    const bool surface = example.samples.shape().size() > 1;
    const double low = surface ? -20000 : -200000;
    Index total = 1;
    for (std::size_t axis = 0; axis < example.samples.shape().size(); ++axis) total *= example.n;
    double least = std::numeric_limits<double>::infinity();
    double most = 0;
    double smallest = least;
    double largest = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        FitOptions options = as_printed(example, "mlspia", example.n, Initial::given);
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> value(low, high);
        options.method.control = PointSet(total, example.samples.dim());
        for (double& x : options.method.control.values()) x = value(random);
        const FitResult result = fit(example.samples, options);
        least = std::min(least, iterations(result));
        most = std::max(most, iterations(result));
        smallest = std::min(smallest, result.report.gradient_norm);
        largest = std::max(largest, result.report.gradient_norm);
    }
    Table table = example.table("Table 3");
    table.name += surface ? ", random starts"
                  : as_is ? ", starts in the box as printed"
                          : ", starts in the symmetric box";
    table.why += (table.why.empty() ? "" : "; ") +
                 fmt::format("ten starts in [{:g}, {:g}] of other random numbers", low, high);
    table.data = Data::stand_in;
    table.rows = {{"fewest iterations", example.least, least},
                  {"most iterations", example.most, most},
                  {"smallest error at the end", example.smallest, smallest},
                  {"largest error at the end", example.largest, largest}};
    return table;
}

} // namespace

std::vector<Table> huang_wang(Workshop& workshop) {
    std::vector<Table> tables;
    const std::vector<Example> all = examples(workshop);
    for (const Example& example : all) tables.push_back(table_1(example));
    for (const Example& example : all) tables.push_back(table_2(example, workshop));
    for (const Example& example : all) {
        const bool surface = example.samples.shape().size() > 1;
        tables.push_back(table_3(example, 20000, true));
        if (!surface) tables.push_back(table_3(example, 200000, false));
    }
    tables.push_back({"Figs. 1 to 5",
                      {},
                      Data::stand_in,
                      "the examples as in Table 2, Example 3 the paper's",
                      "mlspia_*_limit.svg"});
    tables.push_back({"Fig. 6, curvature combs",
                      {},
                      Data::stand_in,
                      "the examples as in Table 2; no zebra map of Example 5",
                      "mlspia_*_comb.svg"});
    return tables;
}

} // namespace batten::command
