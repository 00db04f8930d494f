// A program with the library alone: STEP is a format it does not know, and is told how to.
#include <batten/batten.hpp>
#include <iostream>
#include <string_view>

int main() {
    const batten::FitResult result =
        batten::fit(batten::generate("rose"), {.shape = {.control_points = {50}}});
    std::cout << result.report.brief() << '\n';
    try {
        batten::write_spline("rose.step", {.spline = result.spline});
        return 2;
    } catch (const batten::InvalidInput& error) {
        if (error.what() !=
            std::string_view("rose.step: .step files need batten::cad: link it and call "
                             "batten::cad::register_formats() first"))
            return 3;
    }
    return result.report.deviation.maximum < 2e-3 ? 0 : 1;
}
