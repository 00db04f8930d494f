#include <batten/measure/inflections.hpp>

#include <batten/core/errors.hpp>

#include <algorithm>
#include <cmath>
#include <queue>

namespace batten {

namespace {

/// A stretch of vertices that turn one way, in a ring or row of such.
struct Bend {
    Index first;
    Index last; ///< beyond the ring's end by one turn where it goes over the seam
    int sign;
    Index before; ///< -1 at the end of a row
    Index after;
    int version = 0;
    bool gone = false;
};

/// Distinct consecutive points of a polyline, and the bends between them.
class Bends {
  public:
    Bends(const Points& polyline, Closure closure) : closed_(closure == Closure::closed) {
        for (Index i = 0; i < polyline.size(); ++i)
            if (points_.empty() || distance(points_.back(), polyline[i]) > 0)
                points_.push_back(polyline[i]);
        while (closed_ && points_.size() > 1 && distance(points_.back(), points_.front()) == 0)
            points_.pop_back();
        collect();
    }

    Index count() const { return left_; }

    /// Flattens bends lower than `height`.
    void flatten(double height) {
        using Entry = std::tuple<double, Index, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        const auto push = [&](Index b) {
            const double h = height_of(at(b));
            if (h < height) queue.emplace(h, b, at(b).version);
        };
        for (Index b = 0; b < static_cast<Index>(bends_.size()); ++b) push(b);
        while (!queue.empty() && left_ > 1) {
            const auto [h, b, version] = queue.top();
            queue.pop();
            if (at(b).gone || at(b).version != version) continue;
            push(merge(b));
        }
    }

  private:
    Bend& at(Index b) { return bends_[static_cast<std::size_t>(b)]; }
    std::span<const double> point(Index i) const {
        const auto n = static_cast<Index>(points_.size());
        return points_[static_cast<std::size_t>((i % n + n) % n)];
    }

    void collect() {
        const auto n = static_cast<Index>(points_.size());
        if (n < 3) return;
        for (Index i = closed_ ? 0 : 1; i + (closed_ ? 0 : 1) < n; ++i) {
            const auto a = point(i - 1);
            const auto b = point(i);
            const auto c = point(i + 1);
            const double turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
            const int sign = turn > 0 ? 1 : turn < 0 ? -1 : 0;
            if (!bends_.empty() && (sign == 0 || sign == bends_.back().sign))
                bends_.back().last = i;
            else if (sign != 0)
                bends_.push_back({i, i, sign, 0, 0});
        }
        if (closed_ && bends_.size() > 1 && bends_.front().sign == bends_.back().sign) {
            bends_.front().first = bends_.back().first - n;
            bends_.pop_back();
        }
        left_ = static_cast<Index>(bends_.size());
        for (Index b = 0; b < left_; ++b) {
            at(b).before = b > 0 ? b - 1 : closed_ ? left_ - 1 : -1;
            at(b).after = b + 1 < left_ ? b + 1 : closed_ ? 0 : -1;
        }
    }

    double height_of(const Bend& bend) const {
        const auto a = point(bend.first - 1);
        const auto b = point(bend.last + 1);
        const double x = b[0] - a[0];
        const double y = b[1] - a[1];
        const double chord = std::hypot(x, y);
        double height = 0;
        for (Index i = bend.first; i <= bend.last; ++i) {
            const auto p = point(i);
            const double u = p[0] - a[0];
            const double v = p[1] - a[1];
            height =
                std::max(height, chord > 0 ? std::abs(x * v - y * u) / chord : std::hypot(u, v));
        }
        return height;
    }

    /// Makes one bend of this one and its neighbours, which turn the other way; returns it.
    Index merge(Index b) {
        const Index before = at(b).before;
        const Index after = at(b).after;
        at(b).gone = true;
        --left_;
        const Index stays = before >= 0 ? before : after;
        const Bend flat = at(b);
        if (before < 0 || after < 0 || before == after) { // at an end, or the only other one
            Bend& other = at(stays);
            other.first = before < 0 ? flat.first : other.first;
            other.last = before < 0 ? other.last : std::max(flat.last, other.last);
            (before < 0 ? other.before : other.after) = before == after ? stays : -1;
        } else {
            Bend& kept = at(before);
            const auto n = static_cast<Index>(points_.size());
            kept.last = at(after).last;
            while (kept.last < kept.first) kept.last += n;
            kept.after = at(after).after == before ? before : at(after).after;
            if (at(after).after >= 0) at(at(after).after).before = before;
            at(after).gone = true;
            --left_;
        }
        ++at(stays).version;
        return stays;
    }

    bool closed_;
    std::vector<std::span<const double>> points_;
    std::vector<Bend> bends_;
    Index left_ = 0;
};

} // namespace

Index visible_inflections(const Points& polyline, double height, Closure closure) {
    if (polyline.dim() != 2) throw InvalidInput("inflections: a line in the plane is needed");
    Bends bends(polyline, closure);
    bends.flatten(height);
    if (bends.count() <= 1) return 0;
    return closure == Closure::closed ? bends.count() : bends.count() - 1;
}

} // namespace batten
