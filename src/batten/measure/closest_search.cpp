#include <batten/measure/closest_search.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace batten {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kept_pieces = 8;
constexpr int few_steps = 6;   // from where a neighbour's search ended
constexpr int most_steps = 30; // where there is one minimum

/// Euclidean length without overflow.
double length(std::span<const double> v) {
    double largest = 0;
    for (double x : v) largest = std::max(largest, std::abs(x));
    if (!(largest > 0)) return largest;
    double sum = 0;
    for (double x : v) sum += x / largest * (x / largest);
    return largest * std::sqrt(sum);
}

} // namespace

ClosestSearch::ClosestSearch(const BezierPieces& pieces, const PieceTree& tree)
    : pieces_(pieces), tree_(tree), dim_(pieces.dim()), kept_(kept_pieces) {
    // nothing finer is asked than the coefficients of the squared distance can show
    const auto terms = static_cast<double>(pieces.coefficients() * dim_);
    relative_tolerance_ = std::max(1e-12, 8 * terms * epsilon);
}

ClosestSearch::Found ClosestSearch::operator()(std::span<const double> point,
                                               std::optional<PlaceInPiece> start) {
    const std::span<double> local(point_.data(), point.size());
    pieces_.localise(point, local);
    double reach = 0;
    for (double x : local) reach = std::max(reach, std::abs(x));
    constexpr double far = 0x1p100; // sizes: the whole spline is one point from there
    if (!(reach <= far * pieces_.size())) return {{}, pieces_.in_own_units(length(local))};
    best_square_ = infinity;
    tolerance_ = enough_ = infinity;
    if (!start && any_) start = best_;
    if (start) start_from(*start);
    search_tree();
    any_ = true;
    return {best_, pieces_.in_own_units(std::sqrt(best_square_))};
}

void ClosestSearch::start_from(const PlaceInPiece& start) {
    if (nets_.empty()) nets_.emplace_back();
    load(start.piece, nets_[0]);
    const Descent found = descend(nets_[0], pieces_.axis_count(), dim_, start.local, few_steps);
    improve(start.piece, nets_[0], found.at, found.square);
}

void ClosestSearch::search_tree() {
    waiting_.assign(1, {0, tree_.height() - 1, 0});
    while (!waiting_.empty()) {
        const Waiting next = waiting_.back();
        waiting_.pop_back();
        if (next.square >= enough_) continue;
        if (next.level < 0)
            search_piece(next.at);
        else
            open_group(next);
    }
}

void ClosestSearch::open_group(const Waiting& group) {
    const auto squares = tree_.squares(group.level, group.at, point_.data());
    const std::size_t before = waiting_.size();
    for (std::size_t b = 0; b < squares.size(); ++b)
        if (squares[b] < enough_ && squares[b] < infinity)
            waiting_.push_back({squares[b], group.level - 1,
                                tree_.below(group.level, group.at, static_cast<Index>(b))});
    std::sort(waiting_.begin() + static_cast<Index>(before), waiting_.end(),
              [](const Waiting& a, const Waiting& b) { return a.square > b.square; });
}

void ClosestSearch::load(Index piece, BezierNet& net) {
    const auto size = static_cast<std::size_t>(pieces_.coefficients() * dim_);
    Kept& kept = kept_[static_cast<std::size_t>(piece) % kept_pieces];
    if (kept.piece != piece) {
        kept.values.resize(size);
        pieces_.load(piece, kept.values);
        kept.piece = piece;
    }
    net.degrees = pieces_.degrees();
    net.begin = {};
    net.width = {1, 1, 1};
    net.values.resize(size);
    const auto n = static_cast<std::size_t>(pieces_.coefficients());
    for (std::size_t k = 0; k < size; ++k) net.values[k] = kept.values[k] - point_[k / n];
}

void ClosestSearch::search_piece(Index piece) {
    if (nets_.empty()) nets_.emplace_back();
    load(piece, nets_[0]);
    parts_ = 1;
    while (parts_ > 0) {
        BezierNet& net = nets_[parts_ - 1];
        if (judge(piece, net) == Verdict::settled)
            --parts_;
        else
            divide(net);
    }
}

/// Whether the net holds nothing nearer than the best that is known then. Changes the net to its
/// face where that holds the minimum.
ClosestSearch::Verdict ClosestSearch::judge(Index piece, BezierNet& net) {
    while (true) {
        // of steep surfaces the box is the better bound, and cheap
        if (box_square(net, dim_) >= enough_) return Verdict::settled;
        squares_.assign(net, dim_);
        improve(piece, net, squares_.corner(), squares_.least_corner());
        if (squares_.least() >= enough_ || net.coefficients() == 1) return Verdict::settled;
        const std::optional<Face> face = squares_.downhill_face();
        if (!face) break;
        collapse(net, dim_, *face);
    }
    if (descend_on(piece, net) == Verdict::settled) return Verdict::settled;
    const PerAxis<double> extent = extents(net, dim_);
    const bool tiny = extent[0] + extent[1] + extent[2] <= tolerance_ / 2;
    return squares_.least() >= enough_ || tiny ? Verdict::settled : Verdict::open;
}

/// Descends where there is one minimum, or from a corner that is nearer than all before.
ClosestSearch::Verdict ClosestSearch::descend_on(Index piece, const BezierNet& net) {
    const bool convex = squares_.is_convex();
    if (!convex && squares_.least_corner() > best_square_) return Verdict::open;
    const bool holds_best = best_.piece == piece && net.contains(best_.local);
    const PerAxis<double> start = holds_best ? net.in_net(best_.local) : squares_.least_at();
    const Descent found =
        descend(net, pieces_.axis_count(), dim_, start, convex ? most_steps : few_steps);
    improve(piece, net, found.at, found.square);
    if (!convex) return Verdict::open;
    const double distance = std::sqrt(found.square);
    const double slack = tolerance_ / 4;
    const bool ended = distance <= slack || found.gain <= slack * (2 * distance - slack);
    return ended ? Verdict::settled : Verdict::open;
}

/// Puts the halves along the longest axis in the net's place, the more promising one last.
void ClosestSearch::divide(BezierNet& net) {
    const PerAxis<double> extent = extents(net, dim_);
    const auto axis =
        static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const AxisEnd near = squares_.least_at()[axis] < 0.5 ? AxisEnd::begin : AxisEnd::end;
    if (parts_ == nets_.size()) nets_.emplace_back();
    BezierNet& farther = nets_[parts_ - 1];
    halve(farther, dim_, axis, near == AxisEnd::begin ? AxisEnd::end : AxisEnd::begin,
          nets_[parts_]);
    ++parts_;
}

void ClosestSearch::improve(Index piece, const BezierNet& net, const PerAxis<double>& at,
                            double square) {
    if (!(square < best_square_)) return;
    best_square_ = square;
    best_ = {piece, net.in_piece(at)};
    const double distance = std::sqrt(square);
    tolerance_ = relative_tolerance_ * std::max(pieces_.size(), distance);
    const double least = distance - tolerance_;
    enough_ = least > 0 ? least * least : -infinity;
}

} // namespace batten
