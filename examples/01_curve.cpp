// A planar curve through measured points, with 20 control points, to a file.
#include <batten/batten.hpp>
#include <iostream>

int main() {
    // [curve]
    const batten::Samples wing = batten::generate("naca2412");
    const batten::FitResult result = batten::fit(wing, {.shape = {.control_points = {20}}});
    std::cout << result.report.brief() << '\n';
    // [curve]
    batten::write_spline("wing.json", {result.spline, &wing, "NACA 2412"});
    return result.report.usable() ? 0 : 1;
}
