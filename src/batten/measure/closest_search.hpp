#pragma once

#include <batten/measure/net_descent.hpp>
#include <batten/measure/piece_tree.hpp>
#include <batten/measure/squared_distance.hpp>

namespace batten {

/// Finds a spline's closest point to one point after another, certainly: by branch and bound over
/// its polynomial pieces [PieglTiller1997, section 6.1, with bounds]. What is left out cannot hold
/// a point nearer than the one found less 1e-12 of the spline's size (or of the distance itself,
/// when that is larger): its box, or the Bernstein coefficients of the squared distance, say so.
class ClosestSearch {
  public:
    /// Both must outlive it.
    ClosestSearch(const BezierPieces& pieces, const PieceTree& tree);

    struct Found {
        PlaceInPiece place;
        double distance = 0; ///< in the spline's own units
    };

    /// Starts from a place that is hoped to be near, or without one from where the last search
    /// ended: a near one makes it fast and never changes what is certain.
    Found operator()(std::span<const double> point, std::optional<PlaceInPiece> start);

  private:
    /// A piece's control points, kept while neighbouring points ask for the same few pieces.
    struct Kept {
        Index piece = -1;
        std::vector<double> values{};
    };
    /// A group of boxes yet to be opened, or a piece (level -1).
    struct Waiting {
        double square;
        Index level;
        Index at;
    };
    enum class Verdict { settled, open };

    void start_from(const PlaceInPiece& start);
    void search_tree();
    void open_group(const Waiting& group);
    void search_piece(Index piece);
    void load(Index piece, BezierNet& net);
    Verdict judge(Index piece, BezierNet& net);
    Verdict descend_on(Index piece, const BezierNet& net);
    void divide(BezierNet& net);
    void improve(Index piece, const BezierNet& net, const PerAxis<double>& at, double square);

    const BezierPieces& pieces_;
    const PieceTree& tree_;
    Index dim_;
    double relative_tolerance_;
    std::array<double, 16> point_{};
    std::vector<Kept> kept_;
    std::vector<Waiting> waiting_;
    std::vector<BezierNet> nets_; // parts of the piece that is searched, the first `parts_`
    std::size_t parts_ = 0;
    SquaredDistance squares_;
    PlaceInPiece best_;
    double best_square_ = 0;
    double tolerance_ = 0;
    double enough_ = 0; // squared distance that nothing has to be below
    bool any_ = false;  // whether a search has ended
};

} // namespace batten
