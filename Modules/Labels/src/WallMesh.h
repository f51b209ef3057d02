#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/SurfaceProof/Quadric.h"

namespace adaptiso::detail {

/// Where a vertex lies: in a wall, on a curve where walls meet, where curves end or meet.
enum class WallKind : std::uint8_t { Wall, Curve, Corner };

struct WallTriangle {
    std::array<std::uint32_t, 3> v;
    std::uint32_t wall;  ///< number of its two labels
    bool has(std::uint32_t vertex) const {
        return v[0] == vertex || v[1] == vertex || v[2] == vertex;
    }
};

/// Where a sample of the full walls is assigned to: a triangle of the walls as they are, and where
/// on it.
struct WallAssignment {
    static constexpr std::uint8_t kOnWall = 3;

    std::uint32_t triangle = ~std::uint32_t{0};  ///< unset at first
    float tightness = 0.8F;  ///< part of the limit that it may use: between samples it may be more
    std::uint8_t slot = kOnWall;  ///< or the edge, on a curve, by the corner that it starts from
};

/// A part of the walls that is simplified alone: what lies in a cube, and what reaches into it.
///
/// Vertices and triangles have numbers of their own here.
struct WallPatch {
    using Id = std::uint32_t;

    // the walls at full resolution
    std::vector<Vec3> fullPoints;
    std::vector<WallTriangle> fullTriangles;
    // the present walls; if empty, the full ones are
    std::vector<Vec3> points;
    std::vector<WallKind> kinds;
    std::vector<Quadric> quadrics;
    std::vector<Id> origins;            ///< of each vertex, one of the full walls near it
    std::vector<std::uint8_t> isTried;  ///< of vertices: no edge there can collapse as they are
    std::vector<WallTriangle> triangles;
    std::vector<WallAssignment> assignments;  ///< of the full walls' vertices

    std::vector<std::uint8_t> isOwn;     ///< of vertices: in the cube
    std::vector<std::uint8_t> isFrozen;  ///< of vertices: do not move
    // the cube, in voxel indices
    Vec3 low, high;

    bool isFull() const { return points.empty(); }
};

/// Walls that edge collapses change, each of which can be taken back later.
///
/// A change replaces the triangles round an edge by those of one new vertex. To take one back,
/// first take back the later ones that replaced some of its triangles; so what is left is always
/// what some of the changes make of the full walls.
class WallMesh {
public:
    using Id = std::uint32_t;
    static constexpr Id kNone = ~Id{0};

    using Kind = WallKind;
    using WallTriangle = detail::WallTriangle;

    /// The walls of a patch as they are. Its full ones come first in the numbers of vertices and
    /// triangles; where the walls are others, these are gone from the start.
    explicit WallMesh(const WallPatch& patch);

    Id fullPoints() const { return fullPoints_; }
    Id fullTriangles() const { return fullTriangles_; }
    /// Counts of the walls at the beginning: new numbers go on from here.
    Id firstPoint() const { return firstPoint_; }
    Id firstTriangle() const { return firstTriangle_; }
    std::size_t pointCount() const { return points_.size(); }
    std::size_t triangleCount() const { return triangles_.size(); }  ///< with those that are gone
    std::int64_t aliveTriangles() const { return alive_; }

    const Vec3& point(Id v) const { return points_[v]; }
    std::span<const Vec3> points() const { return points_; }
    Kind kind(Id v) const { return kinds_[v]; }
    bool isAlive(Id v) const { return count_[v] > 0; }
    const WallTriangle& triangle(Id t) const { return triangles_[t]; }
    bool isTriangleAlive(Id t) const { return killer_[t] == kNone; }
    /// The change that took it away; kNone - 1 of what was gone from the start. \pre not alive
    Id killerOf(Id t) const { return killer_[t]; }
    /// The change that made it; kNone for a triangle of the full walls.
    Id makerOf(Id t) const { return maker_[t]; }
    std::span<const Id> around(Id v) const {
        return std::span(entries_).subspan(begin_[v], count_[v]);
    }
    std::array<Vec3, 3> cornersOf(Id t) const {
        const auto& v = triangles_[t].v;
        return {points_[v[0]], points_[v[1]], points_[v[2]]};
    }
    /// Triangles at the edge; where two walls meet there, with the wall between their other
    /// regions, which is left out if neither is wanted.
    int orderOf(Id u, Id v) const;

    struct Change {
        Id u, v, w;
        std::uint64_t removedBegin, removedEnd;  ///< in removed()
        Id madeBegin, madeEnd;
    };
    std::span<const Id> removedBy(const Change& c) const {
        return std::span(removed_).subspan(c.removedBegin, c.removedEnd - c.removedBegin);
    }
    const Change& change(Id n) const { return changes_[n]; }
    /// It was not taken back.
    bool isChangeStanding(Id n) const { return killer_[changes_[n].madeBegin] != n; }
    std::size_t changeCount() const { return changes_.size(); }

    /// Replaces `star`, all triangles round u and v, those round the edge at its end. The new
    /// triangles are, in this order, those of the star's first `kept` with u and v replaced.
    /// \return the number of the change
    Id collapse(Id u, Id v, const Vec3& point, Kind kind, std::span<const Id> star,
                std::size_t kept);

    /// Takes back a change and what rests on it. Calls f(change) for each, before it goes.
    template <class F>
    void undo(Id change, const F& f);

private:
    void undoOne(const Change& change);
    void replaceEntry(Id vertex, Id from, Id to);
    void findKinds();

    Id fullPoints_, fullTriangles_, firstPoint_, firstTriangle_;
    std::int64_t alive_ = 0;
    std::vector<Vec3> points_;
    std::vector<Kind> kinds_;
    std::vector<WallTriangle> triangles_;
    std::vector<Id> maker_, killer_;
    std::vector<std::uint64_t> begin_;
    std::vector<Id> count_, entries_;
    std::vector<Change> changes_;
    std::vector<Id> removed_;
    std::vector<Id> stack_;
};

template <class F>
void WallMesh::undo(Id change, const F& f) {
    stack_.assign(1, change);
    while (!stack_.empty()) {
        const Id n = stack_.back();
        const Change& c = changes_[n];
        Id later = kNone;
        for (Id t = c.madeBegin; t < c.madeEnd && later == kNone; ++t) {
            if (killer_[t] != kNone && killer_[t] != n) later = killer_[t];
        }
        if (later != kNone) {
            stack_.push_back(later);
            continue;
        }
        stack_.pop_back();
        if (c.madeBegin < c.madeEnd && killer_[c.madeBegin] == n) continue;  // gone already
        f(c);
        undoOne(c);
        for (Id t = c.madeBegin; t < c.madeEnd; ++t) killer_[t] = n;  // killed by its own maker
    }
}

}  // namespace adaptiso::detail
