#include <batten/measure/piece_tree.hpp>

#include <batten/core/vector_clones.hpp>

#include <algorithm>
#include <limits>

namespace batten {

namespace {

constexpr Index lanes = PieceTree::group_size;
constexpr double infinity = std::numeric_limits<double>::infinity();

BATTEN_VECTOR_CLONES
void box_squares(const double* boxes, Index dim, const double* point, double* square) {
    for (Index b = 0; b < lanes; ++b) square[b] = 0;
    for (Index d = 0; d < dim; ++d, boxes += 2 * lanes)
        for (Index b = 0; b < lanes; ++b) {
            const double below = boxes[b] - point[d];
            const double above = point[d] - boxes[lanes + b];
            double gap = below > above ? below : above;
            gap = gap > 0 ? gap : 0;
            square[b] += gap * gap;
        }
}

/// Neighbours that one group holds along each axis.
PerAxis<Index> block_shape(Index axis_count) {
    if (axis_count == 1) return {1, 1, lanes};
    if (axis_count == 2) return {1, 2, lanes / 2};
    return {2, 2, 2};
}

Index product(const PerAxis<Index>& shape) {
    return shape[0] * shape[1] * shape[2];
}

} // namespace

PieceTree::PieceTree(const BezierPieces& pieces) : dim_(pieces.dim()) {
    const PerAxis<Index> block = block_shape(pieces.axis_count());
    PerAxis<Index> below = pieces.shape();
    do {
        PerAxis<Index> shape{};
        for (std::size_t a = 0; a < 3; ++a) shape[a] = (below[a] + block[a] - 1) / block[a];
        add_level(below, shape, block);
        if (levels_.size() == 1)
            bound_pieces(pieces, levels_.back());
        else
            bound_groups(levels_[levels_.size() - 2], levels_.back());
        below = shape;
    } while (product(below) > 1);
}

void PieceTree::add_level(const PerAxis<Index>& below, const PerAxis<Index>& shape,
                          const PerAxis<Index>& block) {
    Level& level = levels_.emplace_back();
    level.below.assign(static_cast<std::size_t>(product(shape) * lanes), -1);
    level.boxes.assign(level.below.size() * static_cast<std::size_t>(2 * dim_), infinity);
    Index k = 0;
    for (Index i = 0; i < below[0]; ++i)
        for (Index j = 0; j < below[1]; ++j)
            for (Index l = 0; l < below[2]; ++l, ++k) {
                const Index group =
                    (i / block[0] * shape[1] + j / block[1]) * shape[2] + l / block[2];
                const Index box =
                    (i % block[0] * block[1] + j % block[1]) * block[2] + l % block[2];
                level.below[static_cast<std::size_t>(group * lanes + box)] = k;
            }
}

void PieceTree::bound_pieces(const BezierPieces& pieces, Level& level) const {
    const Index n = pieces.coefficients();
    for_each_chunk(static_cast<Index>(level.below.size()) / lanes, [&](Index group) {
        std::vector<double> net(static_cast<std::size_t>(n * dim_));
        for (Index b = 0; b < lanes; ++b) {
            const Index piece = level.below[static_cast<std::size_t>(group * lanes + b)];
            if (piece < 0) continue;
            pieces.load(piece, net);
            for (Index d = 0; d < dim_; ++d) {
                const auto [low, high] =
                    std::minmax_element(net.data() + d * n, net.data() + (d + 1) * n);
                double* box = level.boxes.data() + (group * dim_ + d) * 2 * lanes + b;
                box[0] = *low;
                box[lanes] = *high;
            }
        }
    });
}

void PieceTree::bound_groups(const Level& below, Level& level) const {
    for (std::size_t k = 0; k < level.below.size(); ++k) {
        if (level.below[k] < 0) continue;
        const double* inner = below.boxes.data() + level.below[k] * dim_ * 2 * lanes;
        double* box = level.boxes.data() + static_cast<Index>(k) / lanes * dim_ * 2 * lanes +
                      static_cast<Index>(k) % lanes;
        for (Index d = 0; d < dim_; ++d, inner += 2 * lanes, box += 2 * lanes) {
            double low = infinity;
            double high = -infinity;
            for (Index b = 0; b < lanes; ++b)
                if (inner[b] < infinity) {
                    low = std::min(low, inner[b]);
                    high = std::max(high, inner[lanes + b]);
                }
            box[0] = low;
            box[lanes] = high;
        }
    }
}

std::array<double, PieceTree::group_size> PieceTree::squares(Index level, Index group,
                                                             const double* point) const {
    std::array<double, group_size> result;
    box_squares(levels_[static_cast<std::size_t>(level)].boxes.data() + group * dim_ * 2 * lanes,
                dim_, point, result.data());
    return result;
}

} // namespace batten
