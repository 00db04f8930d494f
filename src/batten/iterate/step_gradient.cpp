#include <batten/iterate/step_gradient.hpp>

#include <batten/iterate/lin2018.hpp>

#include <fmt/format.h>

namespace batten {

void StepGradient::start() {
    over_sums_.clear();
    products_ = 0;
    if (row_sums_ != RowSums::always) {
        working_ = working_eigenvalues(system_, tolerance_);
        products_ = working_.values.products;
        if (row_sums_ == RowSums::never || !working_.ill_determined) return;
    }
    over_sums_ = diagonal_steps(system_);
    working_ = row_scaled_eigenvalues(system_, tolerance_);
    products_ += working_.values.products;
    if (row_sums_ == RowSums::always) return;
    const std::string_view why = working_.note.empty() ? "ill-determined" : "";
    working_.note = fmt::format("{}{}; each control point's gradient counts over its row sum of "
                                "A^T A, as in Lin, Cao, Zhang 2018",
                                why, working_.note);
}

void StepGradient::scale(PointSet& rows) const {
    if (!over_sums_.empty()) scale_rows(rows, over_sums_);
}

PointSet StepGradient::at(const PointSet& control) {
    PointSet gradient = system_.gradient(control);
    norm_ = frobenius_norm(gradient);
    scale(gradient);
    return gradient;
}

PointSet StepGradient::image(const PointSet& moves) const {
    PointSet result(system_.size(), moves.dim());
    system_.apply(moves, result);
    scale(result);
    return result;
}

} // namespace batten
