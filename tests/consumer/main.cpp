#include <batten/batten.hpp>
#include <iostream>

int main() {
    const batten::FitResult result = batten::fit(batten::generate("rose"), {.shape = {.control_points = {50}}});
    std::cout << result.report.brief() << '\n';
    return result.report.deviation.maximum < 2e-3 ? 0 : 1;
}
