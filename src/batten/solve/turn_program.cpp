#include <batten/solve/turn_program.hpp>

#include <batten/core/vectors.hpp>
#include <batten/solve/factorization.hpp>
#include <batten/solve/schur.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace batten {

namespace {

using Vector = std::vector<double>;

/// Coordinates side by side, x and y of the first point first: one vector of 2 n numbers.
class Program {
  public:
    Program(const BandedMatrix& gram, std::span<const TurnRow> rows, const Constraints& held)
        : rows_(rows.begin(), rows.end()),
          size_(2 * gram.size()),
          gram_(size_, std::max(2 * gram.bandwidth(), 5), gram.closure()),
          held_(1) {
        const std::vector<double> diagonal = gram.diagonal();
        const double scale = *std::ranges::max_element(diagonal);
        for (Index i = 0; i < gram.size(); ++i)
            for (int k = 0; k <= gram.bandwidth(); ++k)
                for (Index d = 0; d < 2; ++d) gram_.at(2 * i + d, 2 * k) = gram.at(i, k) / scale;
        for (TurnRow& row : rows_) { // of unit length: slacks are distances
            const double length = norm(row.part);
            for (double& part : row.part) part /= length;
            row.least /= length;
        }
        std::vector<std::vector<std::pair<Index, double>>> parts(
            static_cast<std::size_t>(held.size()));
        held.for_each_entry([&](Index row, Index control, double value) {
            parts[static_cast<std::size_t>(row)].emplace_back(control, value);
        });
        for (const auto& row : parts)
            for (Index d = 0; d < 2; ++d) {
                std::vector<std::pair<Index, double>> own;
                for (const auto& [control, value] : row) own.emplace_back(2 * control + d, value);
                held_.add_parts(own, std::array{0.0}, "");
            }
    }

    Index size() const { return size_; }
    std::size_t count() const { return rows_.size(); }
    const std::vector<TurnRow>& rows() const { return rows_; }

    /// H x.
    Vector apply(const Vector& x) const {
        Vector y(x.size());
        gram_.apply(x.data(), y.data(), {});
        return y;
    }
    /// G x.
    Vector sums(const Vector& x) const {
        Vector result;
        for (const TurnRow& row : rows_) {
            double sum = 0;
            for (Index j = 0; j < 6; ++j)
                sum += row.part[static_cast<std::size_t>(j)] * x[at(row, j)];
            result.push_back(sum);
        }
        return result;
    }
    /// G^T y.
    Vector pulls(const Vector& y) const {
        Vector result(static_cast<std::size_t>(size_), 0);
        for (std::size_t k = 0; k < rows_.size(); ++k)
            for (Index j = 0; j < 6; ++j)
                result[at(rows_[k], j)] += rows_[k].part[static_cast<std::size_t>(j)] * y[k];
        return result;
    }
    /// The answer to pulls of H + G^T D G that leaves what is held; D is diagonal.
    class Steps {
      public:
        Steps(const Program& program, const Vector& weights) : program_(program) {
            BandedMatrix matrix = program.gram_;
            for (std::size_t k = 0; k < weights.size(); ++k) {
                const TurnRow& row = program.rows_[k];
                for (Index i = 0; i < 6; ++i)
                    for (Index j = i; j < 6; ++j)
                        matrix.at(static_cast<Index>(program.at(row, i)),
                                  static_cast<int>(j - i)) +=
                            weights[k] * row.part[static_cast<std::size_t>(i)] *
                            row.part[static_cast<std::size_t>(j)];
            }
            normal_ = factorize({matrix}, GridIndex({program.size_}));
            if (normal_ && !program.held_.empty())
                schur_.emplace(*normal_, program.held_, program.size_);
        }
        explicit operator bool() const { return normal_ != nullptr; }
        Vector operator()(Vector pull) const {
            PointSet moves = normal_->solve(PointSet(std::move(pull), 1));
            if (schur_)
                add_scaled(moves, -1.0,
                           normal_->solve(program_.held_.apply_transposed(
                               schur_->solve(program_.held_.apply(moves)), program_.size_)));
            return std::move(moves.values());
        }

      private:
        const Program& program_;
        std::unique_ptr<Factorization> normal_;
        std::optional<SchurComplement> schur_;
    };

    /// With some inequalities as equations: the moves, and the multipliers of these, 0 elsewhere.
    std::optional<std::pair<Vector, Vector>> tight(const std::vector<bool>& active) const {
        Constraints all = held_;
        Vector values(static_cast<std::size_t>(all.size()), 0);
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            if (!active[k]) continue;
            std::array<std::pair<Index, double>, 6> parts;
            for (Index j = 0; j < 6; ++j)
                parts[static_cast<std::size_t>(j)] = {static_cast<Index>(at(rows_[k], j)),
                                                      rows_[k].part[static_cast<std::size_t>(j)]};
            all.add_parts(parts, std::array{rows_[k].least}, "");
        }
        const auto normal = factorize({gram_}, GridIndex({size_}));
        if (!normal) return {};
        try {
            const SchurComplement schur(*normal, all, size_);
            const PointSet y = schur.solve(all.values());
            PointSet x = normal->solve(all.apply_transposed(y, size_));
            Vector multipliers(rows_.size(), 0);
            Index next = held_.size();
            for (std::size_t k = 0; k < rows_.size(); ++k)
                if (active[k]) multipliers[k] = y(next++, 0);
            return std::pair{std::move(x.values()), std::move(multipliers)};
        } catch (const SolverError&) {
            return {};
        }
    }

  private:
    std::size_t at(const TurnRow& row, Index j) const {
        return static_cast<std::size_t>((2 * row.first + j) % size_);
    }

    std::vector<TurnRow> rows_;
    Index size_;
    BandedMatrix gram_;
    Constraints held_;
};

/// Moves, how far they are beyond the inequalities, and these ones' multipliers.
struct Place {
    Vector x;
    Vector slack;
    Vector pull;
};

/// The part of the way on which all numbers stay positive, at most 1.
double length_inside(const Vector& from, const Vector& step) {
    double length = 1;
    for (std::size_t k = 0; k < from.size(); ++k)
        if (step[k] < 0) length = std::min(length, -from[k] / step[k]);
    return length;
}

void move(Vector& from, double length, const Vector& step) {
    add_scaled(from.data(), length, step.data(), static_cast<Index>(from.size()));
}

/// One step of the interior point method towards slack times pull = `wanted`, each.
Place newton_step(const Program& program, const Program::Steps& steps, const Place& now,
                  const Vector& wanted) {
    const Vector sums = program.sums(now.x);
    Vector lacks(sums); // G x - slack - least
    Vector pulls(sums);
    for (std::size_t k = 0; k < lacks.size(); ++k) {
        lacks[k] -= now.slack[k] + program.rows()[k].least;
        pulls[k] = now.pull[k] + (wanted[k] - now.pull[k] * lacks[k]) / now.slack[k];
    }
    Vector right = program.pulls(pulls);
    move(right, -1, program.apply(now.x));
    Place step{steps(std::move(right)), {}, {}};
    step.slack = program.sums(step.x);
    move(step.slack, 1, lacks);
    for (std::size_t k = 0; k < lacks.size(); ++k)
        step.pull.push_back((wanted[k] - now.pull[k] * step.slack[k]) / now.slack[k]);
    return step;
}

Place interior(const Program& program, double largest) {
    constexpr int most_steps = 60;
    constexpr double enough = 1e-12; // of the squared distance to go at the start
    constexpr double inside = 0.995;
    const std::size_t count = program.count();
    const auto size = static_cast<double>(count);
    Place now{Vector(static_cast<std::size_t>(program.size()), 0), Vector(count),
              Vector(count, largest)};
    for (std::size_t k = 0; k < count; ++k)
        now.slack[k] = std::max(-program.rows()[k].least, largest);
    for (int round = 0; round < most_steps; ++round) {
        const double gap = dot(now.slack, now.pull) / size;
        if (gap <= enough * largest * largest) break;
        Vector weights(count);
        for (std::size_t k = 0; k < count; ++k) weights[k] = now.pull[k] / now.slack[k];
        const Program::Steps steps(program, weights);
        if (!steps) break;
        Vector wanted(count);
        for (std::size_t k = 0; k < count; ++k) wanted[k] = -now.slack[k] * now.pull[k];
        const Place straight = newton_step(program, steps, now, wanted);
        const double to = std::min(length_inside(now.slack, straight.slack),
                                   length_inside(now.pull, straight.pull));
        double left = 0;
        for (std::size_t k = 0; k < count; ++k)
            left += (now.slack[k] + to * straight.slack[k]) * (now.pull[k] + to * straight.pull[k]);
        const double centring = std::pow(left / size / gap, 3);
        for (std::size_t k = 0; k < count; ++k)
            wanted[k] += centring * gap - straight.slack[k] * straight.pull[k];
        const Place step = newton_step(program, steps, now, wanted);
        const double length = inside * std::min(length_inside(now.slack, step.slack),
                                                length_inside(now.pull, step.pull));
        if (!(length > 0)) break;
        move(now.x, length, step.x);
        move(now.slack, length, step.slack);
        move(now.pull, length, step.pull);
    }
    return now;
}

/// The moves by tight inequalities, from those of which the pull is greater than the slack on:
/// while some pull the wrong way or others are not had, these change sides.
std::optional<Vector> settled(const Program& program, const Place& near, double largest) {
    constexpr int most_rounds = 20;
    constexpr double rounding = 1e-12;
    std::vector<bool> active;
    for (std::size_t k = 0; k < program.count(); ++k)
        active.push_back(near.pull[k] > near.slack[k]);
    for (int round = 0; round < most_rounds; ++round) {
        auto found = program.tight(active);
        if (!found) return {};
        const Vector sums = program.sums(found->first);
        std::vector<bool> next(active);
        for (std::size_t k = 0; k < next.size(); ++k)
            next[k] = active[k] ? found->second[k] > 0
                                : sums[k] < program.rows()[k].least - rounding * largest;
        if (next == active) return std::move(found->first);
        active = std::move(next);
    }
    return {};
}

} // namespace

PointSet least_moves(const BandedMatrix& gram, std::span<const TurnRow> rows,
                     const Constraints& held) {
    const Program program(gram, rows, held);
    double largest = 0;
    for (const TurnRow& row : program.rows()) largest = std::max(largest, row.least);
    if (!(largest > 0)) return {gram.size(), 2}; // all are had without moves
    const Place near = interior(program, largest);
    std::optional<Vector> moves = settled(program, near, largest);
    return {moves ? std::move(*moves) : near.x, 2};
}

} // namespace batten
