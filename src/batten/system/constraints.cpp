#include <batten/system/constraints.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace batten {

void Constraints::add(const std::vector<KnotVector>& axes, std::span<const double> parameter,
                      std::span<const int> orders, std::span<const double> value,
                      std::string name) {
    std::vector<Entry> row{{0, 1.0}};
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const KnotVector& knots = axes[k];
        const double t = knots.wrapped(parameter[k]);
        const Index span = knots.span(t);
        const BasisValues basis = basis_derivatives(knots, span, t, orders.empty() ? 0 : orders[k]);
        std::vector<Entry> next;
        for (const Entry& entry : row)
            for (Index r = 0; r <= knots.degree(); ++r)
                next.push_back({entry.control * knots.free_count() +
                                    (span - knots.degree() + r) % knots.free_count(),
                                entry.value * basis[static_cast<std::size_t>(r)]});
        row = std::move(next);
    }
    std::erase_if(row, [](const Entry& entry) { return entry.value == 0; });
    const bool position = std::ranges::all_of(orders, [](int order) { return order == 0; });
    rows_.push_back(std::move(row));
    sums_.push_back(position ? 1 : 0);
    names_.push_back(std::move(name));
    values_.values().insert(values_.values().end(), value.begin(), value.end());
    values_ = PointSet(std::move(values_.values()), static_cast<Index>(value.size()));
}

PointSet Constraints::apply(const PointSet& control) const {
    PointSet result(size(), control.dim());
    for (Index k = 0; k < size(); ++k)
        for (const Entry& entry : rows_[static_cast<std::size_t>(k)])
            for (Index d = 0; d < control.dim(); ++d)
                result(k, d) += entry.value * control(entry.control, d);
    return result;
}

PointSet Constraints::apply_transposed(const PointSet& y, Index controls) const {
    PointSet result(controls, y.dim());
    for (Index k = 0; k < size(); ++k)
        for (const Entry& entry : rows_[static_cast<std::size_t>(k)])
            for (Index d = 0; d < y.dim(); ++d) result(entry.control, d) += entry.value * y(k, d);
    return result;
}

Constraints Constraints::centred(const std::vector<double>& centre) const {
    Constraints result = *this;
    for (Index k = 0; k < size(); ++k)
        for (Index d = 0; d < values_.dim(); ++d)
            result.values_(k, d) -=
                sums_[static_cast<std::size_t>(k)] * centre[static_cast<std::size_t>(d)];
    return result;
}

void Constraints::check_independent(Index controls) const {
    if (size() > controls)
        throw InvalidInput(fmt::format(
            "{} constraints on {} control points: at most as many are possible", size(), controls));
    // rows orthonormalised one by one; a row that vanishes depends on those before it
    std::vector<Eigen::VectorXd> basis;
    std::vector<Eigen::VectorXd> combination; // each basis vector in terms of the rows
    for (Index k = 0; k < size(); ++k) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(controls);
        Eigen::VectorXd how = Eigen::VectorXd::Zero(size());
        for (const Entry& entry : rows_[static_cast<std::size_t>(k)])
            row[entry.control] += entry.value;
        how[k] = 1;
        const double length = row.norm();
        for (int pass = 0; pass < 2; ++pass)
            for (std::size_t b = 0; b < basis.size(); ++b) {
                const double part = basis[b].dot(row);
                row -= part * basis[b];
                how -= part * combination[b];
            }
        if (row.norm() > 1e-10 * length) {
            combination.push_back(how / row.norm());
            basis.push_back(row / row.norm());
            continue;
        }
        std::vector<std::string> involved;
        Eigen::RowVectorXd clash = Eigen::RowVectorXd::Zero(values_.dim());
        double scale = 0;
        for (Index j = 0; j <= k; ++j) {
            if (std::abs(how[j]) <= 1e-8 * how.cwiseAbs().maxCoeff()) continue;
            involved.push_back(names_[static_cast<std::size_t>(j)]);
            for (Index d = 0; d < values_.dim(); ++d) {
                clash[d] += how[j] * values_(j, d);
                scale = std::max(scale, std::abs(how[j] * values_(j, d)));
            }
        }
        throw InvalidInput(fmt::format("constraints {}: {}",
                                       clash.norm() > 1e-9 * scale ? "contradict each other"
                                                                   : "depend on each other",
                                       fmt::join(involved, ", ")));
    }
}

std::vector<double> parameter_of(const Parameters& parameters, Index i) {
    if (parameters.is_scattered()) {
        const auto row = parameters.scattered[i];
        return {row.begin(), row.end()};
    }
    std::vector<double> t(parameters.axes.size());
    for (std::size_t k = t.size(); k-- > 0;) {
        const auto m = static_cast<Index>(parameters.axes[k].size());
        t[k] = parameters.axes[k][static_cast<std::size_t>(i % m)];
        i /= m;
    }
    return t;
}

Constraints interpolate_samples(const std::vector<KnotVector>& axes, const Samples& samples,
                                const Parameters& parameters, const std::vector<Index>& indices) {
    Constraints constraints(samples.dim());
    std::set<Index> seen;
    for (Index i : indices) {
        if (i < 0 || i >= samples.size())
            throw InvalidInput(fmt::format("interpolated sample {}: the samples are 0 to {}", i,
                                           samples.size() - 1));
        if (!seen.insert(i).second)
            throw InvalidInput(fmt::format("interpolated sample {} is given twice", i));
        constraints.add(axes, parameter_of(parameters, i), {}, samples.points[i],
                        fmt::format("sample {}", i));
    }
    return constraints;
}

} // namespace batten
