#include <batten/system/constraints.hpp>

#include <batten/basis/active_functions.hpp>
#include <batten/core/vectors.hpp>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace batten {

void Constraints::add(const std::vector<KnotVector>& axes, std::span<const double> parameter,
                      std::span<const int> orders, std::span<const double> value,
                      std::string name) {
    std::vector<Entry> row;
    ActiveRow(axes, parameter, Numbering::free, orders)
        .for_each_active([&](Index control, double entry) {
            if (entry != 0) row.push_back({control, entry});
        });
    const bool position = std::ranges::all_of(orders, [](int order) { return order == 0; });
    add_row(std::move(row), position ? 1 : 0, value, std::move(name));
}

void Constraints::add_direction(const std::vector<KnotVector>& axes,
                                std::span<const double> parameter, std::span<const int> orders,
                                std::span<const double> direction, std::string name) {
    directions_.push_back(size());
    const double length = norm(direction);
    std::vector<double> unit(direction.begin(), direction.end());
    for (double& x : unit) x /= length;
    add(axes, parameter, orders, unit, std::move(name));
}

void Constraints::fix(Index control, std::span<const double> value, std::string name) {
    add_row({{control, 1.0}}, 1, value, std::move(name));
}

void Constraints::add_parts(std::span<const std::pair<Index, double>> parts,
                            std::span<const double> value, std::string name) {
    std::vector<Entry> row;
    double sum = 0;
    for (const auto& [control, part] : parts) {
        row.push_back({control, part});
        sum += part;
    }
    add_row(std::move(row), sum, value, std::move(name));
}

Constraints Constraints::with_lengths(std::span<const double> lengths) const {
    Constraints result = *this;
    result.directions_.clear();
    for (std::size_t k = 0; k < directions_.size(); ++k)
        scale(result.values_[directions_[k]], lengths[k]);
    return result;
}

Constraints Constraints::balanced() const {
    Constraints result = *this;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        if (is_position(static_cast<Index>(k))) continue;
        double square = 0;
        for (const Entry& entry : rows_[k]) square += entry.value * entry.value;
        const double factor = 1 / std::sqrt(square);
        for (Entry& entry : result.rows_[k]) entry.value *= factor;
        scale(result.values_[static_cast<Index>(k)], factor);
    }
    return result;
}

void Constraints::add_row(std::vector<Entry> row, double sum, std::span<const double> value,
                          std::string name) {
    rows_.push_back(std::move(row));
    sums_.push_back(sum);
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

bool Constraints::certainly_independent(Index controls) const {
    constexpr double enough = 1e-8; // squared distance of a unit row from the span of those before
    if (size() == 0) return true;
    if (size() > controls) return false;
    std::vector<double> squares(static_cast<std::size_t>(size()), 0);
    for_each_entry([&](Index k, Index, double value) {
        squares[static_cast<std::size_t>(k)] += value * value;
    });
    std::vector<Eigen::Triplet<double>> entries;
    for_each_entry([&](Index k, Index control, double value) {
        entries.emplace_back(k, control, value / std::sqrt(squares[static_cast<std::size_t>(k)]));
    });
    Eigen::SparseMatrix<double> rows(size(), controls);
    rows.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseMatrix<double> products =
        rows * Eigen::SparseMatrix<double>(rows.transpose());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(products);
    return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > enough;
}

Constraints Constraints::independent(Index controls) const {
    if (certainly_independent(controls)) return *this;
    Constraints result(values_.dim());
    // rows orthonormalised one by one; a row that vanishes depends on those before it
    using Vector = Eigen::SparseVector<double>;
    std::vector<Vector> basis;
    std::vector<Vector> combination; // each basis vector in terms of the rows
    for (Index k = 0; k < size(); ++k) {
        Vector row(controls);
        Vector how(size());
        const auto at = static_cast<std::size_t>(k);
        for (const Entry& entry : rows_[at]) row.coeffRef(entry.control) += entry.value;
        how.coeffRef(k) = 1;
        const double length = row.norm();
        for (int pass = 0; pass < 2; ++pass)
            for (std::size_t b = 0; b < basis.size(); ++b) {
                const double part = basis[b].dot(row);
                if (part == 0) continue;
                row = (row - part * basis[b]).pruned();
                how = how - part * combination[b];
            }
        const double rest = row.norm();
        if (rest > 1e-10 * length) {
            combination.push_back(how / rest);
            basis.push_back(row / rest);
            if (std::ranges::binary_search(directions_, k))
                result.directions_.push_back(result.size());
            result.add_row(rows_[at], sums_[at], values_[k], names_[at]);
            continue;
        }
        const Eigen::VectorXd dense(how);
        if (const std::string clash =
                clash_words({dense.data(), static_cast<std::size_t>(size())}, k);
            !clash.empty())
            throw ConstraintConflict(
                size() > controls
                    ? fmt::format(
                          "{} constraints on {} control points: at most as many are possible",
                          size(), controls)
                    : clash);
    }
    return result;
}

std::string Constraints::clash_words(std::span<const double> how, Index last) const {
    std::vector<std::string> involved;
    std::vector<double> clash(static_cast<std::size_t>(values_.dim()));
    double gap = 0;
    double scale = 0;
    double largest = 0;
    std::vector<std::pair<Index, double>> free_rows; // rows of free length and their parts
    for (double part : how) largest = std::max(largest, std::abs(part));
    for (Index j = 0; j <= last; ++j) {
        const double part = how[static_cast<std::size_t>(j)];
        if (std::abs(part) <= 1e-8 * largest) continue;
        involved.push_back(names_[static_cast<std::size_t>(j)]);
        if (std::ranges::binary_search(directions_, j)) free_rows.emplace_back(j, part);
        for (std::size_t d = 0; d < clash.size(); ++d) {
            const double value = part * values_(j, static_cast<Index>(d));
            clash[d] += value;
            scale = std::max(scale, std::abs(value));
        }
    }
    for (double x : clash) gap = std::max(gap, std::abs(x));
    // two directions at one place follow from each other when they are the same
    const bool same_direction = free_rows.size() == 2 && involved.size() == 2 &&
                                free_rows[0].second * free_rows[1].second < 0;
    if (gap <= 1e-9 * scale && (free_rows.empty() || same_direction)) return {};
    return fmt::format("constraints contradict each other: {}", fmt::join(involved, ", "));
}

void check_interpolated(const std::vector<Index>& indices, Index samples) {
    std::set<Index> seen;
    for (Index i : indices) {
        check_sample("interpolated sample", i, samples);
        if (!seen.insert(i).second)
            throw InvalidInput(fmt::format("interpolated sample {} is given twice", i));
    }
}

Constraints interpolate_samples(const std::vector<KnotVector>& axes, const Samples& samples,
                                const Parameters& parameters, const std::vector<Index>& indices) {
    check_interpolated(indices, samples.size());
    Constraints constraints(samples.dim());
    for (Index i : indices)
        constraints.add(axes, parameter_of(parameters, i), {}, samples.points[i],
                        fmt::format("sample {}", i));
    return constraints;
}

} // namespace batten
