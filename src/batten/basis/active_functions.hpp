#pragma once

#include <batten/basis/basis_functions.hpp>

#include <cassert>
#include <span>

namespace batten {

/// How the control points along an axis are counted: as stored, or without those that a closed axis
/// repeats.
enum class Numbering { stored, free };

/// The degree + 1 B-splines of one axis that do not vanish at a parameter, in a row: around the end
/// of a closed axis whose free control points are counted.
struct ActiveFunctions {
    Index first;    ///< index of the first one
    Index controls; ///< along the axis
    int degree;
    BasisValues value;

    /// Index of function r, 0 to degree.
    Index index(int r) const {
        const Index at = first + r;
        return at < controls ? at : at - controls;
    }
};

/// The active functions at t, or their derivatives of the given order. Parameters are wrapped on a
/// closed axis; outside an open domain the end piece continues.
inline ActiveFunctions active_functions(const KnotVector& knots, double t, Numbering numbering,
                                        int order = 0) {
    t = knots.wrapped(t);
    const Index span = knots.span(t);
    return {span - knots.degree(),
            numbering == Numbering::stored ? knots.control_count() : knots.free_count(),
            knots.degree(),
            order == 0 ? basis_values(knots, span, t) : basis_derivatives(knots, span, t, order)};
}

/// Calls `visit(control, value)` for every product of one active function per axis, in row-major
/// order of the control points; `row` and `value` come from the axes before.
template <std::size_t axis_count, class Visit>
inline void for_each_product(const ActiveFunctions* axis, Index row, double value, Visit& visit) {
    for (int r = 0; r <= axis->degree; ++r) {
        const Index control = row * axis->controls + axis->index(r);
        const double product = value * axis->value[static_cast<std::size_t>(r)];
        if constexpr (axis_count == 1)
            visit(control, product);
        else
            for_each_product<axis_count - 1>(axis + 1, control, product, visit);
    }
}

/// One row of the collocation matrix A over 1 to 3 axes, or of its derivative: the tensor product
/// B-splines that do not vanish at a parameter.
class ActiveRow {
  public:
    /// `parameter` has an entry per axis, `orders` too, or is empty for the functions themselves.
    ActiveRow(std::span<const KnotVector> axes, std::span<const double> parameter,
              Numbering numbering, std::span<const int> orders = {})
        : axis_count_(axes.size()) {
        assert(axis_count_ >= 1 && axis_count_ <= 3);
        for (std::size_t k = 0; k < axis_count_; ++k)
            axes_[k] =
                active_functions(axes[k], parameter[k], numbering, orders.empty() ? 0 : orders[k]);
    }

    std::span<const ActiveFunctions> axes() const { return {axes_, axis_count_}; }

    /// Calls `visit(control, value)` for every function, the last axis fastest.
    template <class Visit>
    void for_each_active(Visit visit) const {
        switch (axis_count_) {
        case 1:
            return for_each_product<1>(axes_, 0, 1.0, visit);
        case 2:
            return for_each_product<2>(axes_, 0, 1.0, visit);
        default:
            return for_each_product<3>(axes_, 0, 1.0, visit);
        }
    }

  private:
    std::size_t axis_count_;
    ActiveFunctions axes_[3]; // set for the axes that there are
};

} // namespace batten
