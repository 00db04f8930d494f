#include <batten/solve/direct.hpp>

#include <batten/solve/banded_cholesky.hpp>

namespace batten {

PointSet solve_direct(const NormalSystem& system) {
    PointSet control = system.rhs();
    const auto factors = system.factors();
    Index inner = control.dim();
    for (std::size_t k = factors.size(); k-- > 0;) {
        const Index n = factors[k]->size();
        const AxisLayout layout{static_cast<Index>(control.values().size()) / (n * inner), inner};
        BandedCholesky(*factors[k]).solve(control.data(), layout);
        inner *= n;
    }
    return control;
}

} // namespace batten
