#include <batten/solve/nested_cholesky.hpp>

#include <Eigen/Dense>

namespace batten {

namespace {

using Matrix = Eigen::MatrixXd;
using Columns = Eigen::Map<Matrix>;
using ConstColumns = Eigen::Map<const Matrix>;
using Part = NetDissection::Part;

constexpr double smallest_pivot = 1e-14; // of the diagonal entry: below it rounding made the pivot

Index reach_of(const Part& part) {
    return static_cast<Index>(part.border.size());
}

ConstColumns columns_of(const Part& part, const std::vector<double>& values) {
    return {values.data(), part.count + reach_of(part), part.count};
}

} // namespace

/// A system's entries on and below the diagonal, its rows and columns in another order.
class OrderedEntries {
  public:
    struct Entry {
        Index row;
        double value;
    };

    OrderedEntries(const NormalSystem& system, const std::vector<Index>& place)
        : begin_(place.size() + 1) {
        const auto each = [&](auto visit) {
            system.for_each_entry([&](Index i, Index j, double value) {
                const Index row = place[static_cast<std::size_t>(i)];
                const Index column = place[static_cast<std::size_t>(j)];
                if (row >= column && value != 0)
                    visit(row, static_cast<std::size_t>(column), value);
            });
        };
        each([&](Index, std::size_t column, double) { ++begin_[column + 1]; });
        for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
        entries_.resize(begin_.back());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        each([&](Index row, std::size_t column, double value) {
            entries_[next[column]++] = {row, value};
        });
    }
    std::span<const Entry> column(Index column) const {
        const auto at = static_cast<std::size_t>(column);
        return std::span(entries_).subspan(begin_[at], begin_[at + 1] - begin_[at]);
    }

  private:
    std::vector<std::size_t> begin_;
    std::vector<Entry> entries_;
};

namespace {

/// The part's columns of L from its entries and its children's updates, and its own update of its
/// border.
void factor_part(const NetDissection& net, Index index, const OrderedEntries& entries,
                 std::vector<double>& values, std::vector<Matrix>& updates) {
    const Part& own = net.parts[static_cast<std::size_t>(index)];
    const Index reach = reach_of(own);
    values.assign(static_cast<std::size_t>((own.count + reach) * own.count), 0.0);
    Columns l(values.data(), own.count + reach, own.count);
    Matrix& update = updates[static_cast<std::size_t>(index)];
    update = Matrix::Zero(reach, reach);
    for (Index j = 0; j < own.count; ++j)
        for (const auto& [row, value] : entries.column(own.first + j)) {
            const Index i = row - own.first;
            l(i < own.count
                  ? i
                  : own.count + (std::ranges::lower_bound(own.border, row) - own.border.begin()),
              j) += value;
        }
    const Eigen::VectorXd diagonal = l.topRows(own.count).diagonal();
    for (const Index child : own.children) {
        const std::vector<Index>& rows = net.parts[static_cast<std::size_t>(child)].in_parent;
        Matrix& from = updates[static_cast<std::size_t>(child)];
        for (Index j = 0; j < from.cols(); ++j) {
            const Index column = rows[static_cast<std::size_t>(j)];
            double* to = column < own.count ? l.col(column).data()
                                            : update.col(column - own.count).data() - own.count;
            for (Index i = j; i < from.rows(); ++i)
                to[rows[static_cast<std::size_t>(i)]] += from(i, j);
        }
        from.resize(0, 0);
    }
    Eigen::Ref<Matrix> top = l.topRows(own.count);
    const Eigen::LLT<Eigen::Ref<Matrix>> factor(top);
    if (factor.info() != Eigen::Success ||
        !(top.diagonal().array().square() > smallest_pivot * diagonal.array()).all())
        throw SolverError("the normal equations are singular: some control points are not "
                          "determined by the samples");
    if (reach == 0) return;
    auto below = l.bottomRows(reach);
    top.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    update.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
}

/// L^{-1} for the part's own rows; `sums` holds what parts add to their borders' right-hand sides.
void forward(const NetDissection& net, Index index, const ConstColumns& l, Matrix& x,
             std::vector<Matrix>& sums) {
    const Part& own = net.parts[static_cast<std::size_t>(index)];
    const Index reach = reach_of(own);
    Matrix& sum = sums[static_cast<std::size_t>(index)];
    sum = Matrix::Zero(reach, x.cols());
    auto mine = x.middleRows(own.first, own.count);
    for (const Index child : own.children) {
        const std::vector<Index>& rows = net.parts[static_cast<std::size_t>(child)].in_parent;
        Matrix& from = sums[static_cast<std::size_t>(child)];
        for (Index d = 0; d < x.cols(); ++d)
            for (Index i = 0; i < from.rows(); ++i) {
                const Index row = rows[static_cast<std::size_t>(i)];
                (row < own.count ? mine(row, d) : sum(row - own.count, d)) += from(i, d);
            }
        from.resize(0, 0);
    }
    l.topRows(own.count).triangularView<Eigen::Lower>().solveInPlace(mine);
    if (reach > 0) sum.noalias() -= l.bottomRows(reach) * mine;
}

/// L^{-T} for the part's own rows, those of its border known.
void backward(const Part& own, const ConstColumns& l, Matrix& x) {
    const Index reach = reach_of(own);
    auto mine = x.middleRows(own.first, own.count);
    if (reach > 0) {
        Matrix beside(reach, x.cols());
        for (Index d = 0; d < x.cols(); ++d)
            for (Index i = 0; i < reach; ++i)
                beside(i, d) = x(own.border[static_cast<std::size_t>(i)], d);
        mine.noalias() -= l.bottomRows(reach).transpose() * beside;
    }
    l.topRows(own.count).triangularView<Eigen::Lower>().transpose().solveInPlace(mine);
}

} // namespace

NestedCholesky::NestedCholesky(const std::vector<KnotVector>& axes)
    : net_(dissected(axes)), columns_(net_.parts.size()) {}

void NestedCholesky::factor(const NormalSystem& system) {
    const OrderedEntries entries(system, net_.place);
    std::vector<Matrix> updates(net_.parts.size());
    for (const auto& level : net_.levels)
        for_each_chunk(static_cast<Index>(level.size()), [&](Index k) {
            const NetDissection::Run& run = level[static_cast<std::size_t>(k)];
            for (Index i = run.begin; i < run.end; ++i)
                factor_part(net_, i, entries, columns_[static_cast<std::size_t>(i)], updates);
        });
}

PointSet NestedCholesky::solve(PointSet b) const {
    Matrix x(b.size(), b.dim());
    for (Index i = 0; i < b.size(); ++i)
        for (Index d = 0; d < b.dim(); ++d) x(net_.place[static_cast<std::size_t>(i)], d) = b(i, d);
    std::vector<Matrix> sums(net_.parts.size());
    const auto columns = [&](Index i) {
        const auto at = static_cast<std::size_t>(i);
        return columns_of(net_.parts[at], columns_[at]);
    };
    for (const auto& level : net_.levels)
        for_each_chunk(static_cast<Index>(level.size()), [&](Index k) {
            const NetDissection::Run& run = level[static_cast<std::size_t>(k)];
            for (Index i = run.begin; i < run.end; ++i) forward(net_, i, columns(i), x, sums);
        });
    for (std::size_t l = net_.levels.size(); l-- > 0;)
        for_each_chunk(static_cast<Index>(net_.levels[l].size()), [&](Index k) {
            const NetDissection::Run& run = net_.levels[l][static_cast<std::size_t>(k)];
            for (Index i = run.end; i-- > run.begin;)
                backward(net_.parts[static_cast<std::size_t>(i)], columns(i), x);
        });
    for (Index i = 0; i < b.size(); ++i)
        for (Index d = 0; d < b.dim(); ++d) b(i, d) = x(net_.place[static_cast<std::size_t>(i)], d);
    return b;
}

} // namespace batten
