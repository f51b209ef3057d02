#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"

namespace adaptiso::detail {

struct SegmentPair {
    Vec3 onFirst, onSecond;

    double squaredDistance() const { return squaredNorm(onFirst - onSecond); }
};

/// The points of two segments, p q and r s, that are nearest to each other [Ericson2005, section
/// 5.1.9].
inline SegmentPair nearestOnSegments(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    const Vec3 d = q - p, e = s - r, w = p - r;
    const double dd = squaredNorm(d), ee = squaredNorm(e), de = dot(d, e), dw = dot(d, w),
                 ew = dot(e, w);
    const auto part = [](double over, double under) {
        return under > 0 ? std::clamp(over / under, 0.0, 1.0) : 0.0;
    };
    const double first = part(de * ew - dw * ee, dd * ee - de * de);
    const double second = part(de * first + ew, ee);
    return {p + part(de * second - dw, dd) * d, r + second * e};
}

/// A vertex of a surface and its image on another one.
template <class Index>
struct MappedVertex {
    Vec3 point, image;
    Index imageTriangle;  ///< the other surface's triangle that the image lies on
    double squared;       ///< distance to the image
};

/// Maps a surface continuously to another one, triangle by triangle, so that no point goes farther
/// than a distance. Then the first surface lies within that distance of the second, and so does
/// each triangle of the second that the map covers: see SharedCover.
///
/// A vertex goes to the nearest point of the triangle that it is assigned to. An edge between
/// vertices of different ones is cut where it passes from one triangle to the next, and the cut
/// goes to a point that both have in common. The triangle is cut so that the corners of each part
/// go to one triangle of the other surface, and the part is mapped linearly: its points go no
/// farther than its corners do, as |x - f(x)| is a convex function of x.
template <class Index>
class SurfaceMap {
public:
    using Vertex = MappedVertex<Index>;

    /// The cuts of an edge, in the direction in which it was looked at.
    struct Way {
        std::uint32_t begin = 0, count = 0;
        double squared = -1;  ///< the largest distance of a cut to its image; -1: not looked at

        bool isKnown() const { return squared >= 0; }
    };

    /// Part of a triangle's image in one triangle of the other surface.
    struct Part {
        Index triangle;
        Vec3 area2;  ///< twice its area vector
    };

    /// Where an edge passes from one triangle to another.
    struct Cut {
        Vec3 image;
        Index before, after;
    };

    /// \param enough  squared distance below which cuts need not be nearer to their images
    SurfaceMap(const WalkableSurface<Index>& onto, double enough) : onto_(&onto), enough_(enough) {}

    /// Forgets all ways.
    void clear() { cuts_.clear(); }

    Vertex vertexAt(const Vec3& point, Index imageTriangle) const {
        const Corners t = onto_->cornersOf(imageTriangle);
        const Vec3 image = closestPointOnTriangle(point, t[0], t[1], t[2]);
        return {point, image, imageTriangle, squaredNorm(point - image)};
    }

    /// Cuts the edge from a to b.
    Way wayAlong(const Vertex& a, const Vertex& b) {
        Way way{static_cast<std::uint32_t>(cuts_.size()), 0, 0};
        if (!stepAlong(a, b, way)) search(a, b, way);
        way.count = static_cast<std::uint32_t>(cuts_.size()) - way.begin;
        return way;
    }

    /// The way of an edge whose cuts are known: a few, each in both of its triangles.
    /// \param squared  the largest distance of a cut to its image
    Way wayOver(std::initializer_list<Cut> cuts, double squared) {
        const Way way{static_cast<std::uint32_t>(cuts_.size()),
                      static_cast<std::uint32_t>(cuts.size()), squared};
        cuts_.insert(cuts_.end(), cuts);
        return way;
    }

    /// Calls f(triangle of the other surface) for those that the image of an edge passes.
    template <class F>
    void forEachAlong(const Way& way, const F& f) const {
        for (std::uint32_t i = way.begin; i < way.begin + way.count; ++i) {
            f(cuts_[i].before);
            f(cuts_[i].after);
        }
    }

    /// A side of a triangle: the way along its edge, and whether it goes in the side's direction.
    struct Side {
        const Way* way;  ///< null where both ends go to the same triangle
        bool isForward;
    };

    /// Maps a triangle.
    /// \param sides  from each corner to the next
    /// \return false when no map within the distance was found
    bool map(const std::array<const Vertex*, 3>& corners, const std::array<Side, 3>& sides,
             double squaredDistance) {
        count_ = parts_ = 0;
        int first = 0;  // the first side with cuts: there takeApart() begins
        for (int i = 2; i >= 0; --i) {
            if (corners[i]->squared > squaredDistance) return false;
            if (sides[i].way == nullptr) continue;
            if (sides[i].way->squared > squaredDistance) return false;
            if (sides[i].way->count > 0) first = i;
        }
        for (int i = first; i < first + 3; ++i) {
            if (sides[i % 3].way != nullptr) addCuts(*sides[i % 3].way, sides[i % 3].isForward);
            const Vertex& end = *corners[(i + 1) % 3];
            loop_[count_++] = {end.image, end.imageTriangle};
        }
        return takeApart(corners, squaredDistance);
    }
    /// Parts of the last triangle mapped; a triangle of the other surface may have several.
    std::span<const Part> parts() const { return {part_.data(), parts_}; }

private:
    static constexpr Index kNone = WalkableSurface<Index>::kNone;
    static constexpr std::size_t kMostCuts = 8, kFewCuts = 5, kMostStops = 32;
    static constexpr std::size_t kMostLoop = 3 * (1 + kMostCuts);

    static constexpr double kCostOfCut = 0.01;  ///< of the distance that is near enough

    /// A point of a triangle's border, and the triangle that the way from it to the next one goes
    /// to.
    struct LoopPoint {
        Vec3 image;
        Index triangle;
    };
    /// A triangle that the search for a way has come to.
    struct Stop {
        Index triangle;
        double squared;    ///< the largest distance of a cut on the way to it
        double cost;       ///< that, and something for each cut: of ways as near a short one
        std::size_t from;  ///< the stop before
        Vec3 image;        ///< of the cut on the way from there
        bool isDone = false;
    };

    void addCuts(const Way& way, bool isForward) {
        for (std::uint32_t i = 0; i < way.count; ++i) {
            const Cut& cut = cuts_[way.begin + (isForward ? i : way.count - 1 - i)];
            loop_[count_++] = {cut.image, isForward ? cut.after : cut.before};
        }
    }

    /// Where an edge comes nearest to a triangle's side.
    SegmentPair crossing(Index t, int side, const Vertex& a, const Vertex& b) const {
        const Corners c = onto_->cornersOf(t);
        return nearestOnSegments(a.point, b.point, c[side], c[(side + 1) % 3]);
    }

    /// From triangle to triangle over the nearest side, or over that to the last one.
    /// \return false when that is not near enough
    bool stepAlong(const Vertex& a, const Vertex& b, Way& way) {
        const double most = std::max({a.squared, b.squared, enough_});
        Index last = kNone;
        for (Index t = a.imageTriangle; t != b.imageTriangle;) {
            SegmentPair nearest;
            double least = std::numeric_limits<double>::max();
            Index next = kNone;
            const int towards = sideTowards(b.point, onto_->cornersOf(t));
            if (towards >= 0) {
                const Index beside = onto_->across(t, towards);
                if (beside != kNone && beside != last) {
                    nearest = crossing(t, towards, a, b);
                    least = nearest.squaredDistance();
                    next = beside;
                }
            }
            for (int side = 0; least > most && side < 3; ++side) {
                const Index beside = onto_->across(t, side);
                if (beside == kNone || beside == last || side == towards) continue;
                const SegmentPair pair = crossing(t, side, a, b);
                const double squared = pair.squaredDistance();
                if (squared < least) nearest = pair, least = squared, next = beside;
            }
            if (next == kNone || least > most || cuts_.size() == way.begin + kFewCuts) {
                cuts_.resize(way.begin);
                return false;
            }
            cuts_.push_back({nearest.onSecond, t, next});
            way.squared = std::max(way.squared, least);
            last = t;
            t = next;
        }
        return true;
    }

    /// The way whose farthest cut is nearest [Dijkstra1959, with the largest step in place of the
    /// sum]. Where there is none its distance is infinite.
    void search(const Vertex& a, const Vertex& b, Way& way) {
        way.squared = std::numeric_limits<double>::infinity();
        stops_[0] = {a.imageTriangle, 0, 0, 0, {}};
        stopCount_ = 1;
        for (std::size_t at = 0; at < stopCount_; at = nextStop()) {
            stops_[at].isDone = true;
            if (stops_[at].triangle == b.imageTriangle) {
                takeCuts(at, way);
                return;
            }
            for (int side = 0; side < 3; ++side) {
                if (!addStop(at, side, a, b)) return;
            }
        }
    }

    /// \return stopCount_ when all are done
    std::size_t nextStop() const {
        std::size_t best = stopCount_;
        for (std::size_t i = 0; i < stopCount_; ++i) {
            if (stops_[i].isDone) continue;
            if (best == stopCount_ || stops_[i].cost < stops_[best].cost) best = i;
        }
        return best;
    }

    /// Beyond a side of a stop's triangle.
    /// \return false when there are too many
    bool addStop(std::size_t from, int side, const Vertex& a, const Vertex& b) {
        const Index next = onto_->across(stops_[from].triangle, side);
        if (next == kNone) return true;
        std::size_t known = 0;
        while (known < stopCount_ && stops_[known].triangle != next) ++known;
        if (known == kMostStops) return false;
        if (known < stopCount_ && stops_[known].isDone) return true;
        const SegmentPair cut = crossing(stops_[from].triangle, side, a, b);
        const double squared = std::max(stops_[from].squared, cut.squaredDistance()),
                     cost = stops_[from].cost + (squared - stops_[from].squared) +
                            kCostOfCut * enough_;
        if (known < stopCount_ && stops_[known].cost <= cost) return true;
        if (known == stopCount_) ++stopCount_;
        stops_[known] = {next, squared, cost, from, cut.onSecond};
        return true;
    }

    /// The cuts on the way to a stop.
    void takeCuts(std::size_t stop, Way& way) {
        const double squared = stops_[stop].squared;
        for (; stop > 0; stop = stops_[stop].from) {
            const Stop& at = stops_[stop];
            cuts_.push_back({at.image, stops_[at.from].triangle, at.triangle});
        }
        if (cuts_.size() > way.begin + kMostCuts) {
            cuts_.resize(way.begin);
            return;
        }
        std::reverse(cuts_.begin() + way.begin, cuts_.end());
        way.squared = squared;
    }

    /// Cuts the mapped border into closed ways, each on one triangle.
    bool takeApart(const std::array<const Vertex*, 3>& corners, double squaredDistance) {
        const auto first = static_cast<std::ptrdiff_t>(firstChange());
        std::rotate(loop_.begin(), loop_.begin() + first,
                    loop_.begin() + static_cast<std::ptrdiff_t>(count_));
        while (takeOffOne()) {
        }
        if (endOfStretch(0) == count_) {
            addPart(0, count_, loop_[0].image);
            return true;
        }
        return takeApartAround(corners, squaredDistance);
    }

    /// A point where the way comes from another triangle.
    std::size_t firstChange() const {
        for (std::size_t i = 0; i < count_; ++i) {
            if (loop_[i].triangle != loop_[(i + count_ - 1) % count_].triangle) return i;
        }
        return 0;
    }

    /// Takes a stretch between two of the same triangle off: it is closed between the two cuts,
    /// which go to the side, or the vertex, that both triangles have in common.
    bool takeOffOne() {
        for (std::size_t begin = 0; begin < count_;) {
            const std::size_t end = endOfStretch(begin);
            const Index before = loop_[(begin + count_ - 1) % count_].triangle,
                        after = loop_[end % count_].triangle;
            if (loop_[begin].triangle != before && before == after) {
                addPart(begin, end - begin + 1, loop_[begin].image);
                loop_[begin].triangle = before;
                std::copy(loop_.begin() + static_cast<std::ptrdiff_t>(end),
                          loop_.begin() + static_cast<std::ptrdiff_t>(count_),
                          loop_.begin() + static_cast<std::ptrdiff_t>(begin + 1));
                count_ -= end - begin - 1;
                return true;
            }
            begin = end;
        }
        return false;
    }
    std::size_t endOfStretch(std::size_t begin) const {
        std::size_t end = begin + 1;
        while (end < count_ && loop_[end].triangle == loop_[begin].triangle) ++end;
        return end;
    }

    /// Closes every stretch through vertices of the other surface: one where it begins and one
    /// where it ends, each of which its triangle has in common with that of the stretch beside it
    /// and which lies near. What is left is a way along sides from vertex to vertex.
    bool takeApartAround(const std::array<const Vertex*, 3>& corners, double squaredDistance) {
        std::array<Index, kMostLoop> way;
        std::size_t stretches = 0;
        Index at = kNone;
        for (std::size_t begin = 0; begin < count_; begin = endOfStretch(begin)) {
            at = commonVertex(begin, at, corners, squaredDistance);
            if (at == kNone) return false;
            way[stretches++] = at;
        }
        std::size_t i = 0;
        for (std::size_t begin = 0; begin < count_; ++i) {
            const std::size_t end = endOfStretch(begin);
            const Vec3 &first = onto_->point(way[i]),
                       &last = onto_->point(way[(i + 1) % stretches]);
            addPart(begin, end - begin + 1, first);
            part_[parts_ - 1].area2 += cross(loop_[end % count_].image - first, last - first);
            begin = end;
        }
        return closeAlongSides(way, stretches);
    }

    /// A near vertex that the triangles before and after a cut have in common: the last one, where
    /// it is such a one.
    Index commonVertex(std::size_t cut, Index last, const std::array<const Vertex*, 3>& corners,
                       double squaredDistance) const {
        const Index after = loop_[cut].triangle,
                    before = loop_[(cut + count_ - 1) % count_].triangle;
        if (last != kNone && onto_->hasVertex(after, last)) return last;
        const Corners own{corners[0]->point, corners[1]->point, corners[2]->point};
        for (const Index v : onto_->verticesOf(after)) {
            if (onto_->hasVertex(before, v) &&
                squaredDistanceToTriangle(onto_->point(v), own) <= squaredDistance) {
                return v;
            }
        }
        return kNone;
    }

    /// Fills a closed way along sides: one that goes back as it came has nothing in it, one around
    /// a triangle has that.
    bool closeAlongSides(std::array<Index, kMostLoop>& way, std::size_t vertices) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < vertices; ++i) {
            if (count > 0 && way[count - 1] == way[i]) continue;
            if (count > 1 && way[count - 2] == way[i]) {
                --count;
            } else {
                way[count++] = way[i];
            }
        }
        if (count > 1 && way[count - 1] == way[0]) --count;
        if (count <= 2) return true;
        if (count > 3) return false;
        Index t = onto_->find(way[0], way[1], way[2]);
        if (t == kNone) t = onto_->find(way[0], way[2], way[1]);
        if (t == kNone) return false;
        const Vec3& first = onto_->point(way[0]);
        part_[parts_++] = {t, cross(onto_->point(way[1]) - first, onto_->point(way[2]) - first)};
        return true;
    }

    /// The way along some points, which is closed through another one.
    void addPart(std::size_t begin, std::size_t points, const Vec3& through) {
        Part& part = part_[parts_++];
        part = {loop_[begin].triangle, {}};
        for (std::size_t i = 1; i < points; ++i) {
            part.area2 += cross(loop_[begin + i - 1].image - through,
                                loop_[(begin + i) % count_].image - through);
        }
    }

    const WalkableSurface<Index>* onto_;
    double enough_;
    std::vector<Cut> cuts_;  ///< of all ways
    std::array<Stop, kMostStops> stops_;
    std::size_t stopCount_ = 0;
    std::array<LoopPoint, kMostLoop> loop_;
    std::size_t count_ = 0;
    std::array<Part, kMostLoop + 1> part_;
    std::size_t parts_ = 0;
};

/// The area of an image in a triangle over the triangle's own, with its sense. Where no border of
/// what is mapped goes to the triangle, the sum of them is a whole number: how often the map goes
/// round each of the triangle's points [Milnor1965, Topology from the Differentiable Viewpoint,
/// section 5]. Unless it is 0 each of them is the image of some point. Not a number for a triangle
/// so narrow that rounding counts.
inline double shareOf(const Vec3& area2, const Corners& triangle) {
    constexpr double kNarrow = 1e-9;
    const auto& [a, b, c] = triangle;
    const Vec3 own = areaVector2(a, b, c);
    const double longest = std::max({squaredNorm(b - a), squaredNorm(c - b), squaredNorm(a - c)}),
                 squared = squaredNorm(own);
    if (!(squared > kNarrow * kNarrow * longest * longest)) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return dot(area2, own) / squared;
}
/// How far from 1 rounding may take that sum.
inline constexpr double kCoverRounding = 1e-3;

/// Share of the other surface that a SurfaceMap's images cover, shareOf(). For pieces in parallel:
/// shares are summed as whole numbers of a small part, so that their order changes nothing.
class SharedCover {
public:
    explicit SharedCover(std::size_t triangles) : parts_(triangles, 0), hasBorder_(triangles, 0) {}

    void add(std::uint64_t triangle, double share) {
        if (std::abs(share) < kMostShare) {
            std::atomic_ref(parts_[triangle]).fetch_add(std::llround(kOne * share));
        } else {
            addBorder(triangle);
        }
    }
    /// The border of what is mapped passes it.
    void addBorder(std::uint64_t triangle) {
        std::atomic_ref(hasBorder_[triangle]).store(1, std::memory_order_relaxed);
    }
    /// Each point of the triangle is the image of a mapped one.
    bool covers(std::uint64_t triangle) const {
        const double sum = static_cast<double>(parts_[triangle]) / kOne;
        return hasBorder_[triangle] == 0 && std::abs(sum - 1) < kCoverRounding;
    }

private:
    static constexpr double kOne = 1LL << 40, kMostShare = 1 << 10;

    std::vector<std::int64_t> parts_;
    std::vector<std::uint8_t> hasBorder_;
};

}  // namespace adaptiso::detail
