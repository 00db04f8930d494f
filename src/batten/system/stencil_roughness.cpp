#include <batten/system/roughness.hpp>
#include <batten/system/stencil_system.hpp>

#include <algorithm>

namespace batten {

namespace {

constexpr int highest_order = 3;

/// Calls `visit(orders, count)` for every choice of derivative orders along the axes that add up to
/// `total`, and in how many ways it can be taken.
template <class Visit>
void for_each_choice(std::size_t axes, int total, Visit visit) {
    constexpr std::array<int, highest_order + 1> factorial{1, 1, 2, 6};
    std::vector<int> orders(axes, 0);
    const auto choose = [&](const auto& self, std::size_t axis, int left) -> void {
        if (axis + 1 == axes) {
            orders[axis] = left;
            int count = factorial[static_cast<std::size_t>(total)];
            for (int order : orders) count /= factorial[static_cast<std::size_t>(order)];
            return visit(orders, count);
        }
        for (orders[axis] = left; orders[axis] >= 0; --orders[axis])
            self(self, axis + 1, left - orders[axis]);
    };
    choose(choose, 0, total);
}

} // namespace

void StencilSystem::add_thin_plate(int order) {
    std::vector<std::vector<BandedMatrix>> rough(axes_.size()); // by axis and order
    for (std::size_t k = 0; k < axes_.size(); ++k)
        for (int r = 0; r <= order; ++r) rough[k].push_back(unit_roughness_matrix(axes_[k], r));
    for_each_choice(axes_.size(), order, [&](const std::vector<int>& orders, int count) {
        std::vector<BandedMatrix> matrices;
        for (std::size_t k = 0; k < axes_.size(); ++k)
            matrices.push_back(rough[k][static_cast<std::size_t>(orders[k])]);
        add_product(count, matrices);
    });
}

void StencilSystem::add_diagonal(const std::vector<double>& values, const std::vector<char>& held) {
    const auto is_held = [&](Index i) { return held[static_cast<std::size_t>(i)] != 0; };
    for (Index place = 0; place < places_.size(); ++place) {
        const GridIndex::Place& offset = offsets_[static_cast<std::size_t>(place)];
        const bool middle = std::ranges::all_of(offset, [](Index x) { return x == 0; });
        for (Index i = 0; i < size(); ++i) {
            double& value = at(place, i);
            if (middle)
                value = is_held(i) ? 1 : value + values[static_cast<std::size_t>(i)];
            else if (value != 0 && (is_held(i) || is_held(coupled(i, place))))
                value = 0;
        }
    }
}

} // namespace batten
