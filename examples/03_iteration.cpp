// Watches MLSPIA improve a curve step by step and stops it when the gradient is small enough.
#include <batten/batten.hpp>
#include <iostream>

int main() {
    batten::FitOptions options;
    options.shape.control_points = {50};
    options.method.name = "mlspia";
    options.observer = [](const batten::Iteration& now) {
        std::cout << now.number << ' ' << now.gradient_norm << '\n';
        return now.gradient_norm > 1e-6 ? batten::Continue::yes : batten::Continue::no;
    };
    const batten::FitResult result = batten::fit(batten::generate("rose"), options);
    return result.report.termination == batten::Termination::cancelled ? 0 : 1;
}
