// [Meisters1975] G. H. Meisters, Polygons Have Ears, The American Mathematical Monthly 82:648-651.
// A triangulation without triangles of zero area is a tree of triangles, and its leaves are ears:
// so a ring that has one has an ear, and cutting it off leaves a ring that has one.
#include "adaptiso/Core/PolygonTriangulation.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

namespace adaptiso {
namespace {

using Index = std::uint32_t;
using Indices = std::array<Index, 3>;

/// Cotangent of a triangle's smallest angle: the smaller, the better. One that is too thin for
/// its rounded area comes last.
double cotangentOfSmallestAngle(const Point2& a, const Point2& b, const Point2& c) {
    const double area2 = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (!(area2 > 0)) return std::numeric_limits<double>::infinity();
    const auto cosine = [](const Point2& at, const Point2& p, const Point2& q) {
        return (p[0] - at[0]) * (q[0] - at[0]) + (p[1] - at[1]) * (q[1] - at[1]);
    };
    return std::max({cosine(a, b, c), cosine(b, c, a), cosine(c, a, b)}) / area2;
}

class EarClipping {
public:
    explicit EarClipping(std::span<const Point2> ring) : ring_(ring), corners_(ring.size()) {
        const auto count = static_cast<Index>(ring.size());
        for (Index i = 0; i < count; ++i) {
            corners_[i].previous = (i + count - 1) % count;
            corners_[i].next = (i + 1) % count;
        }
        left_ = count;
    }

    std::vector<Indices> run() {
        triangles_.reserve(ring_.size() - 2);
        cutRepeats();
        if (isOnLine()) {
            while (left_ > 2) cut(corners_[first_].next);
            return std::move(triangles_);
        }
        for (Index i = first_, n = 0; n < left_; ++n, i = corners_[i].next) enter(i);
        while (left_ > 2 && !candidates_.empty()) {
            const Candidate best = candidates_.top();
            candidates_.pop();
            if (best.version != corners_[best.corner].version) continue;
            if (const auto blocker = blockerOf(best.corner)) {
                corners_[*blocker].blocked.push_back(best);
            } else {
                cutEar(best.corner);
            }
        }
        return left_ > 2 ? std::vector<Indices>() : std::move(triangles_);
    }

private:
    struct Candidate {
        double cotangent;
        Index corner;
        std::uint32_t version;

        friend bool operator<(const Candidate& a, const Candidate& b) {  // the best on top
            return std::tie(a.cotangent, a.corner) > std::tie(b.cotangent, b.corner);
        }
    };

    struct Corner {
        Index previous = 0, next = 0;
        std::uint32_t version = 0;         ///< counts its neighbors
        std::vector<Candidate> blocked{};  ///< those that the edge to `next` keeps from being ears
    };

    int side(Index a, Index b, Index c) const { return orient2d(ring_[a], ring_[b], ring_[c]); }

    void cut(Index corner) {
        auto& [previous, next, version, blocked] = corners_[corner];
        triangles_.push_back({previous, corner, next});
        corners_[previous].next = next;
        corners_[next].previous = previous;
        ++version;
        if (corner == first_) first_ = next;
        --left_;
    }

    /// Cuts corners off that lie where the one before them lies.
    void cutRepeats() {
        for (Index n = left_, i = first_; n > 0 && left_ > 2; --n) {
            const Index next = corners_[i].next;
            if (ring_[corners_[i].previous] == ring_[i]) cut(i);
            i = next;
        }
    }

    bool isOnLine() const {
        const auto differs = [&](const Point2& p) { return p != ring_[first_]; };
        const auto other = std::ranges::find_if(ring_, differs);
        const auto isOn = [&](const Point2& p) { return orient2d(ring_[first_], *other, p) == 0; };
        return other == ring_.end() || std::ranges::all_of(ring_, isOn);
    }

    void enter(Index corner) {
        const auto& [previous, next, version, blocked] = corners_[corner];
        if (side(previous, corner, next) <= 0) return;
        candidates_.push({cotangentOfSmallestAngle(ring_[previous], ring_[corner], ring_[next]),
                          corner, version});
    }

    void cutEar(Index corner) {
        const Index previous = corners_[corner].previous, next = corners_[corner].next;
        cut(corner);
        for (const Index neighbor : {previous, next}) {
            ++corners_[neighbor].version;
            enter(neighbor);
        }
        for (const Index gone : {previous, corner}) {  // the edges that went with it
            for (const Candidate& freed : std::exchange(corners_[gone].blocked, {})) {
                candidates_.push(freed);
            }
        }
    }

    /// The edge that keeps a corner from being an ear, by where it begins: one in the triangle, or
    /// one that begins on its third side.
    std::optional<Index> blockerOf(Index corner) const {
        const Index previous = corners_[corner].previous, next = corners_[corner].next;
        if (left_ == 3) return std::nullopt;
        const Ear ear(ring_[previous], ring_[corner], ring_[next]);
        for (Index a = next; a != previous; a = corners_[a].next) {
            if (ear.isBlocked(ring_[a], ring_[corners_[a].next])) return a;
        }
        return std::nullopt;
    }

    /// Triangle a, b, c; side c -> a is the cut.
    class Ear {
    public:
        Ear(const Point2& a, const Point2& b, const Point2& c)
            : a_(a),
              b_(b),
              c_(c),
              low_(minimum(minimum(a, b), c)),
              high_(maximum(maximum(a, b), c)) {}

        bool isBlocked(const Point2& p, const Point2& q) const {
            const Point2 low = minimum(p, q), high = maximum(p, q);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                if (high[axis] < low_[axis] || low[axis] > high_[axis]) return false;
            }
            const Sides ofP = sidesOf(p), ofQ = sidesOf(q);
            if (ofP[0] > 0 && ofP[1] > 0 && ofP[2] >= 0) return true;
            // The cut along an edge that has its inside where the ear is: both would cover it.
            if (ofP[2] == 0 && ofQ[2] == 0) {
                return (p < q) == (c_ < a_) && std::max(std::min(p, q), std::min(a_, c_)) <
                                                   std::min(std::max(p, q), std::max(a_, c_));
            }
            for (std::size_t s = 0; s < 3; ++s) {
                if (ofP[s] <= 0 && ofQ[s] <= 0) return false;
            }
            const int a = orient2d(p, q, a_), b = orient2d(p, q, b_), c = orient2d(p, q, c_);
            return std::max({a, b, c}) > 0 && std::min({a, b, c}) < 0;
        }

    private:
        using Sides = std::array<int, 3>;

        static Point2 minimum(const Point2& p, const Point2& q) {
            return {std::min(p[0], q[0]), std::min(p[1], q[1])};
        }
        static Point2 maximum(const Point2& p, const Point2& q) {
            return {std::max(p[0], q[0]), std::max(p[1], q[1])};
        }

        Sides sidesOf(const Point2& p) const {
            return {orient2d(a_, b_, p), orient2d(b_, c_, p), orient2d(c_, a_, p)};
        }

        Point2 a_, b_, c_, low_, high_;
    };

    std::span<const Point2> ring_;
    std::vector<Corner> corners_;
    Index first_ = 0, left_ = 0;
    std::priority_queue<Candidate> candidates_;
    std::vector<Indices> triangles_;
};

}  // namespace

std::vector<Indices> triangulatePolygon(std::span<const Point2> ring) {
    return ring.size() < 3 ? std::vector<Indices>() : EarClipping(ring).run();
}

}  // namespace adaptiso
