// Fits, writes STEP and IGES and reads them back, in a folder given by the caller.
#include <batten/batten.hpp>
#include <batten/cad/cad.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    batten::cad::register_formats();
    const batten::FitResult result =
        batten::fit(batten::generate("rose"), {.shape = {.control_points = {50}}});
    const batten::PointSet& control = result.spline.control_points();
    for (const char* name : {"a.step", "a.igs"}) {
        const std::filesystem::path path = std::filesystem::path(argv[1]) / name;
        batten::write_spline(path, {.spline = result.spline});
        const batten::Spline back = batten::read_spline(path);
        std::cout << path << ": " << back.control_points().size() << " control points\n";
        if (back.control_points().size() != control.size()) return 1;
        for (batten::Index i = 0; i < control.size(); ++i)
            for (batten::Index d = 0; d < control.dim(); ++d)
                if (!(std::abs(back.control_points()(i, d) - control(i, d)) < 1e-14)) return 1;
    }
}
