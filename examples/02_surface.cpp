// A grid of points to a surface, and its normal at a parameter.
#include <array>
#include <batten/batten.hpp>
#include <iostream>

int main() {
    const batten::FitResult result =
        batten::fit(batten::generate("peaks"),
                    {.shape = {.control_points = {41, 41},
                               .parametrization = batten::Parametrization::uniform}});
    const std::array at{0.5, 0.5};
    const auto du = result.spline(at, std::array{1, 0});
    const auto dv = result.spline(at, std::array{0, 1});
    std::cout << result.report.full() << "normal at the middle: (" << du[1] * dv[2] - du[2] * dv[1]
              << ", " << du[2] * dv[0] - du[0] * dv[2] << ", " << du[0] * dv[1] - du[1] * dv[0]
              << ")\n";
    return result.report.deviation.maximum < 0.01 ? 0 : 1;
}
