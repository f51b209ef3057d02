#include <algorithm>
#include <span>
#include <tuple>

#include "WallMender.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

auto orderOf(const Vec3& p) {
    return std::tuple(p.x, p.y, p.z);
}

Vec3 nearestOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 e = b - a;
    const double length2 = squaredNorm(e);
    return a + (length2 > 0 ? std::clamp(dot(p - a, e) / length2, 0.0, 1.0) : 0) * e;
}

}  // namespace

/// Maps one triangle after the other. A vertex is looked at once for those around it, an edge for
/// both beside it, as long as they come soon.
class WallMap::Mapper {
public:
    Mapper(const WallMap& whole, double limitMm)
        : whole_(whole),
          mesh_(whole.mesh_),
          map_(whole.to_.walkable(), limitMm * limitMm),
          limit2_(limitMm * limitMm) {}

    /// \return false when no map within the limit was found
    bool map(Id full) {
        const WallTriangle& t = whole_.collapser_.fullTriangle(full);
        std::array<const Map::Vertex*, 3> corners{};
        std::array<Map::Side, 3> sides{};
        bool isMapped = true;
        for (int i = 0; i < 3; ++i) {
            hasFoot_[i] = lookUpFoot(t.v[i], t.wall, foot_[i]);
            isMapped = isMapped && hasFoot_[i] && foot_[i].vertex.squared <= limit2_;
            corners[i] = &foot_[i].vertex;
        }
        for (int i = 0; i < 3; ++i) {
            hasWay_[i] = hasFoot_[i] && hasFoot_[(i + 1) % 3] && lookUpWay(t, i);
            isMapped = isMapped && hasWay_[i];
            sides[i] = {way_[i].count > 0 ? &way_[i] : nullptr, isForward(t, i)};
        }
        return isMapped && map_.map(corners, sides, limit2_);
    }

    std::span<const Map::Part> parts() const { return map_.parts(); }

    /// Calls f(place) for the places that the image of a side of the last triangle passes.
    template <class F>
    void forEachAlong(int side, const F& f) const {
        if (hasFoot_[side]) f(foot_[side].vertex.imageTriangle);
        if (hasFoot_[(side + 1) % 3]) f(foot_[(side + 1) % 3].vertex.imageTriangle);
        if (hasWay_[side]) map_.forEachAlong(way_[side], f);
    }

    /// The side ends the wall.
    bool isCurve(const WallTriangle& t, int side) const {
        const Id a = t.v[side], b = t.v[(side + 1) % 3];
        int own = 0, others = 0;
        for (const Id n : whole_.collapser_.fullAround(a)) {
            const WallTriangle& beside = whole_.collapser_.fullTriangle(n);
            if (beside.has(b)) ++(beside.wall == t.wall ? own : others);
        }
        return own != 2 || others != 0;
    }

private:
    static constexpr Id kNone = WallMesh::kNone;

    /// The image of a vertex of the full walls: in a wall, on an edge (p, q) that ends it, or the
    /// vertex p.
    struct Foot {
        Map::Vertex vertex;
        Id p, q;
        bool isVertex() const { return p != kNone && q == kNone; }
        bool isInWall() const { return p == kNone; }
        bool ends(Id v) const { return p == v || q == v; }
    };

    static bool isForward(const WallTriangle& t, int side) {
        return t.v[side] < t.v[(side + 1) % 3];
    }

    /// The place of the one triangle of a wall at an edge; kNone where there is another number.
    Id placeAtEdge(Id p, Id q, Id wall) const {
        Id found = kNone;
        for (const Id t : mesh_.around(p)) {
            if (mesh_.triangle(t).wall != wall || !mesh_.triangle(t).has(q)) continue;
            if (found != kNone) return kNone;
            found = whole_.places_[t];
        }
        return found;
    }
    Id placeAtVertex(Id p, Id wall) const {
        for (const Id t : mesh_.around(p)) {
            if (mesh_.triangle(t).wall == wall) return whole_.places_[t];
        }
        return kNone;
    }

    struct KnownFoot {
        Id vertex = kNone, wall = kNone;
        bool isThere = false;
        Foot foot;
    };
    struct KnownWay {
        Id from = kNone, to = kNone, wall = kNone;
        bool isThere = false;
        Map::Way way;
    };
    static constexpr std::size_t kKnownFeet = 1024, kKnownWays = 2048;  // powers of 2

    bool lookUpFoot(Id v, Id wall, Foot& foot) {
        KnownFoot& known = feet_[v % kKnownFeet];
        if (known.vertex != v || known.wall != wall) {
            known.vertex = v;
            known.wall = wall;
            known.isThere = findFoot(v, wall, known.foot);
        }
        foot = known.foot;
        return known.isThere;
    }
    bool lookUpWay(const WallTriangle& t, int side) {
        const auto [from, to] = std::minmax(t.v[side], t.v[(side + 1) % 3]);
        KnownWay& known = ways_[(2 * from + 3 * to) % kKnownWays];
        if (known.from != from || known.to != to || known.wall != t.wall) {
            known = {from, to, t.wall, findWay(t, side), way_[side]};
        }
        way_[side] = known.way;
        return known.isThere;
    }

    /// \return false if there are no more
    bool findFoot(Id v, Id wall, Foot& foot) const {
        const Vec3& point = mesh_.point(v);
        const WallAssignment assigned = whole_.collapser_.assignmentOf(v);
        foot.p = foot.q = kNone;
        if (assigned.triangle == kNone) {
            foot.p = mesh_.firstPoint() == 0 && mesh_.isAlive(v) ? v : whole_.stillAt(point);
            if (foot.p == kNone) return false;
            foot.vertex = {point, point, placeAtVertex(foot.p, wall), 0};
        } else if (assigned.slot == WallAssignment::kOnWall) {
            const Id place = whole_.places_[assigned.triangle];
            if (place == kNone || mesh_.triangle(assigned.triangle).wall != wall) return false;
            foot.vertex = map_.vertexAt(point, place);
        } else {
            const auto& c = mesh_.triangle(assigned.triangle).v;
            foot.p = c[assigned.slot];
            foot.q = c[(assigned.slot + 1) % 3];
            const Vec3 image = nearestOnSegment(point, mesh_.point(foot.p), mesh_.point(foot.q));
            foot.vertex = {point, image, placeAtEdge(foot.p, foot.q, wall),
                           squaredNorm(point - image)};
        }
        return foot.vertex.imageTriangle != kNone;
    }

    bool findWay(const WallTriangle& t, int side) {
        const int i = isForward(t, side) ? side : (side + 1) % 3;
        const Foot &a = foot_[i], &b = foot_[isForward(t, side) ? (side + 1) % 3 : side];
        Map::Way& way = way_[side];
        way = {0, 0, 0};
        if (!a.isInWall() && !b.isInWall() && isCurve(t, side)) {
            const auto along = wayAlongCurve(a, b, t.wall);
            if (along) way = *along;
            return along.has_value();
        }
        if (a.vertex.imageTriangle != b.vertex.imageTriangle)
            way = map_.wayAlong(a.vertex, b.vertex);
        return way.squared <= limit2_;
    }

    /// Along the edges that end the wall.
    std::optional<Map::Way> wayAlongCurve(const Foot& a, const Foot& b, Id wall) {
        const Id from = a.vertex.imageTriangle, to = b.vertex.imageTriangle;
        if (a.isVertex() && b.isVertex()) {
            const Id place = placeAtEdge(a.p, b.p, wall);
            if (place == kNone) return {};
            return map_.wayOver({{a.vertex.image, from, place}, {b.vertex.image, place, to}}, 0);
        }
        const bool isSame = a.p == b.p || a.p == b.q;
        if (a.isVertex() || b.isVertex()) {
            const Foot &end = a.isVertex() ? a : b, &on = a.isVertex() ? b : a;
            if (!on.ends(end.p)) return {};
            return map_.wayOver({{end.vertex.image, from, to}}, 0);
        }
        const bool isOther = a.q == b.p || a.q == b.q;
        if (isSame && isOther) return Map::Way{0, 0, 0};
        if (!isSame && !isOther) return {};
        const Vec3& turn = mesh_.point(isSame ? a.p : a.q);
        const double squared =
            squaredNorm(turn - nearestOnSegment(turn, a.vertex.point, b.vertex.point));
        if (squared > limit2_) return {};
        return map_.wayOver({{turn, from, to}}, squared);
    }

    const WallMap& whole_;
    const WallMesh& mesh_;
    Map map_;
    double limit2_;
    std::array<Foot, 3> foot_{};
    std::array<bool, 3> hasFoot_{}, hasWay_{};
    std::array<Map::Way, 3> way_;
    std::vector<KnownFoot> feet_{kKnownFeet};
    std::vector<KnownWay> ways_{kKnownWays};
};

WallMap::WallMap(const WallCollapser& collapser, const WallSurface& to)
    : collapser_(collapser),
      mesh_(collapser.mesh()),
      to_(to),
      places_(mesh_.triangleCount(), WallMesh::kNone),
      cover_(to.count()) {
    for (Id place = 0; place < to.count(); ++place) places_[to.numberOf(place)] = place;
    for (Id v = mesh_.firstPoint(); v < mesh_.pointCount(); ++v) {
        if (mesh_.isAlive(v) && mesh_.kind(v) == WallKind::Corner) {
            still_.push_back({mesh_.point(v), v});
        }
    }
    std::sort(still_.begin(), still_.end(),
              [](const Still& a, const Still& b) { return orderOf(a.point) < orderOf(b.point); });
}

WallMap::Id WallMap::stillAt(const Vec3& point) const {
    const auto at = std::lower_bound(
        still_.begin(), still_.end(), point,
        [](const Still& a, const Vec3& p) { return orderOf(a.point) < orderOf(p); });
    return at != still_.end() && at->point == point ? at->vertex : WallMesh::kNone;
}

WallMap::Result WallMap::map(const std::vector<Id>& full, bool areAll, double limitMm) {
    std::vector<std::uint8_t> isIn(areAll ? 0 : mesh_.fullTriangles(), 0);
    if (!areAll) {
        for (const Id t : full) isIn[t] = 1;
    }
    const auto endsHere = [&](const WallTriangle& t, int side) {
        const Id a = t.v[side], b = t.v[(side + 1) % 3];
        if (areAll) return !collapser_.isOwn(a) && !collapser_.isOwn(b);
        for (const Id n : collapser_.fullAround(a)) {
            const WallTriangle& beside = collapser_.fullTriangle(n);
            if (isIn[n] == 0 && beside.wall == t.wall && beside.has(b)) return true;
        }
        return false;
    };
    constexpr std::int64_t kPiece = 1024;
    const auto count = static_cast<std::int64_t>(full.size());
    std::vector<Result> pieces((count + kPiece - 1) / kPiece);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        Result& own = pieces[begin / kPiece];
        Mapper mapper(*this, limitMm);
        const auto addBorder = [&](Id place) { cover_.addBorder(place); };
        for (std::int64_t n = begin; n < end; ++n) {
            const bool isMapped = mapper.map(full[n]);
            own.isMapped.push_back(isMapped ? 1 : 0);
            const std::size_t first = own.witnesses.size();
            if (isMapped) {
                for (const Map::Part& part : mapper.parts()) {
                    cover_.add(part.triangle,
                               shareOf(part.area2, to_.walkable().cornersOf(part.triangle)));
                    own.witnesses.push_back(to_.numberOf(part.triangle));
                }
            }
            own.witnessCounts.push_back(static_cast<Id>(own.witnesses.size() - first));
            const WallTriangle& t = collapser_.fullTriangle(full[n]);
            for (int side = 0; side < 3; ++side) {
                if (isMapped && !endsHere(t, side)) continue;
                mapper.forEachAlong(side, addBorder);
            }
        }
    });
    Result all;
    for (const Result& own : pieces) {
        all.isMapped.insert(all.isMapped.end(), own.isMapped.begin(), own.isMapped.end());
        all.witnessCounts.insert(all.witnessCounts.end(), own.witnessCounts.begin(),
                                 own.witnessCounts.end());
        all.witnesses.insert(all.witnesses.end(), own.witnesses.begin(), own.witnesses.end());
    }
    return all;
}

}  // namespace adaptiso::detail
