#include <batten/io/cell_counts.hpp>

#include <batten/spline/bezier_pieces.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace batten {

namespace {

/// The bound of a piece that has n_a cells along axis a is the sum of bend(a, b) / (n_a n_b) over
/// all a and b.
using Bend = std::array<std::array<double, 3>, 3>;

/// Largest length of v(x) - v(x + s) - v(x + t) + v(x + s + t), s and t steps along axes a and b.
double largest_difference(const std::vector<double>& net, Index dim, const PerAxis<Index>& order,
                          std::size_t a, std::size_t b) {
    const PerAxis<Index> stride{order[1] * order[2], order[2], 1};
    PerAxis<Index> last = order;
    --last[a];
    --last[b];
    const Index coefficients = order[0] * stride[0];
    double largest = 0;
    for (Index i = 0; i < last[0]; ++i)
        for (Index j = 0; j < last[1]; ++j)
            for (Index k = 0; k < last[2]; ++k) {
                double square = 0;
                for (Index d = 0; d < dim; ++d) {
                    const double* v = net.data() + d * coefficients + i * stride[0] +
                                      j * stride[1] + k * stride[2];
                    const double x = v[0] - v[stride[a]] - v[stride[b]] + v[stride[a] + stride[b]];
                    square += x * x;
                }
                largest = std::max(largest, square);
            }
    return std::sqrt(largest);
}

Bend bend_of(const std::vector<double>& net, Index dim, const PerAxis<int>& degrees) {
    const PerAxis<Index> order{degrees[0] + 1, degrees[1] + 1, degrees[2] + 1};
    Bend bend{};
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = a; b < 3; ++b) {
            const double factor =
                static_cast<double>(degrees[a]) * (a == b ? degrees[a] - 1 : degrees[b]) / 8;
            // a volume's cells are trilinear: no twist parts them from it
            if (factor > 0 && (a == b || degrees[0] == 0))
                bend[a][b] = bend[b][a] = factor * largest_difference(net, dim, order, a, b);
        }
    return bend;
}

/// The bends of all pieces, in the coordinates of BezierPieces.
std::vector<Bend> bends_of(const BezierPieces& pieces) {
    std::vector<Bend> bends(static_cast<std::size_t>(pieces.count()));
    constexpr Index block_size = 64;
    for_each_block(pieces.count(), block_size, [&](const Block& block) {
        std::vector<double> net(static_cast<std::size_t>(pieces.dim() * pieces.coefficients()));
        for (Index k = block.begin; k < block.end; ++k) {
            pieces.load(k, net);
            bends[static_cast<std::size_t>(k)] = bend_of(net, pieces.dim(), pieces.degrees());
        }
    });
    return bends;
}

/// Chooses the cells of every span along every axis.
class Counting {
  public:
    Counting(const BezierPieces& pieces, double chord)
        : shape_(pieces.shape()), bends_(bends_of(pieces)), chord_(chord) {}

    /// Starts with the axes after the first `part` times as fine as their own bends ask, and then
    /// gives each axis the fewest cells that the others leave.
    PerAxis<std::vector<double>> counts(const PerAxis<double>& part) const {
        PerAxis<std::vector<double>> n;
        for (std::size_t a = 0; a < 3; ++a) n[a] = own_counts(a, part[a]);
        for (std::size_t a : {0, 1, 2, 0, 1}) n[a] = least_counts(a, n);
        return n;
    }

  private:
    static constexpr double most = 1e9;

    template <class Visit>
    void for_each_piece(Visit visit) const {
        std::size_t k = 0;
        PerAxis<std::size_t> at{};
        for (at[0] = 0; at[0] < size(0); ++at[0])
            for (at[1] = 0; at[1] < size(1); ++at[1])
                for (at[2] = 0; at[2] < size(2); ++at[2]) visit(at, bends_[k++]);
    }
    std::size_t size(std::size_t axis) const { return static_cast<std::size_t>(shape_[axis]); }

    std::vector<double> own_counts(std::size_t a, double part) const {
        std::vector<double> n(size(a), 1);
        for_each_piece([&](const PerAxis<std::size_t>& at, const Bend& bend) {
            const double all = bend[a][0] + bend[a][1] + bend[a][2];
            n[at[a]] = std::max(n[at[a]], part * std::sqrt(2 * all / chord_));
        });
        return n;
    }

    /// Per span of the axis the least whole n that keeps the bound of all its pieces: with x = 1 /
    /// n the largest x where square x^2 + 2 linear x <= room.
    std::vector<double> least_counts(std::size_t a, const PerAxis<std::vector<double>>& n) const {
        std::vector<double> result(size(a), 1);
        const std::size_t b = (a + 1) % 3;
        const std::size_t c = (a + 2) % 3;
        for_each_piece([&](const PerAxis<std::size_t>& at, const Bend& bend) {
            if (bend[a] == std::array<double, 3>{}) return; // straight, or no axis of this spline
            const double y = 1 / n[b][at[b]];
            const double z = 1 / n[c][at[c]];
            const double room =
                chord_ - (bend[b][b] * y * y + 2 * bend[b][c] * y * z + bend[c][c] * z * z);
            const double linear = bend[a][b] * y + bend[a][c] * z;
            double needed = most;
            if (room > 0) needed = (linear + std::sqrt(linear * linear + bend[a][a] * room)) / room;
            result[at[a]] = std::clamp(std::ceil(needed), result[at[a]], most);
        });
        return result;
    }

    PerAxis<Index> shape_;
    std::vector<Bend> bends_;
    double chord_;
};

double total(const PerAxis<std::vector<double>>& n) {
    double points = 1;
    for (const std::vector<double>& axis : n)
        points *= std::accumulate(axis.begin(), axis.end(), 0.0);
    return points;
}

} // namespace

CellCounts least_cells(const Spline& spline, double chord) {
    const BezierPieces pieces(spline);
    const Counting counting(pieces, chord / pieces.in_own_units(1));
    const auto axes = static_cast<std::size_t>(spline.axis_count());
    // how the tolerance is best shared between the axes is found by trial, from even shares on
    const std::vector<double> parts = axes == 1 ? std::vector{1.0}
                                      : axes == 2
                                          ? std::vector{1.0, 0.75, 0.85, 1.4, 2.0, 4.0, 16.0}
                                          : std::vector{1.0, 0.75, 1.4, 4.0};
    constexpr double worth = 0.95; // of cells that are longer one way
    PerAxis<std::vector<double>> best;
    double fewest = std::numeric_limits<double>::infinity();
    for (double p : parts)
        for (double q : axes == 3 ? parts : std::vector{p}) {
            auto n = counting.counts({1, q, p});
            if (const double points = total(n); points < worth * fewest || best[0].empty()) {
                fewest = points;
                best = std::move(n);
            }
        }
    CellCounts result;
    for (std::size_t a = 3 - axes; a < 3; ++a) result.emplace_back(best[a].begin(), best[a].end());
    return result;
}

} // namespace batten
