#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/SurfaceProof/HalfEdges.h"
#include "adaptiso/SurfaceProof/NearTriangle.h"
#include "adaptiso/SurfaceProof/Parameters.h"

namespace adaptiso::detail {

/// A convex part of a triangle. Copies what there is of it alone: walks copy a lot.
class ConvexPiece {  // NOLINT: to move it is to copy it
public:
    static constexpr int kMost = 12;

    ConvexPiece() {}  // NOLINT: numbers without a corner mean nothing
    explicit ConvexPiece(const Corners& t) {
        for (const Vec3& p : t) add(p);
    }
    ConvexPiece(const ConvexPiece& o) { *this = o; }  // NOLINT: as above
    ConvexPiece& operator=(const ConvexPiece& o) {
        count_ = o.count_;
        std::copy_n(o.number_.begin(), 3 * count_, number_.begin());
        return *this;
    }
    ~ConvexPiece() = default;

    int count() const { return count_; }
    Vec3 corner(int i) const {
        const auto at = 3 * static_cast<std::size_t>(i);
        return {number_[at], number_[at + 1], number_[at + 2]};
    }
    /// \pre count() < kMost
    void add(const Vec3& p) {
        const auto at = 3 * static_cast<std::size_t>(count_++);
        number_[at] = p.x, number_[at + 1] = p.y, number_[at + 2] = p.z;
    }

private:
    int count_ = 0;
    std::array<double, std::size_t{3} * kMost> number_;
};

/// A surface with the triangle across each edge, for walks from triangle to triangle.
template <class Index>
class WalkableSurface {
public:
    static constexpr Index kNone = std::numeric_limits<Index>::max();

    /// Keeps references to points and triangles.
    /// \param some  triangles, ascending, beyond which no walk need go; empty: all
    void assign(std::span<const Vec3> points, std::span<const std::array<Index, 3>> triangles,
                std::span<const Index> some = {}) {
        points_ = points;
        triangles_ = triangles;
        normals_.clear();
        firstAt_.clear();
        halfEdges_.assign(points.size(), triangles, some);
        halfEdges_.match(twin_);
    }

    /// Keeps one triangle at each vertex in place of all, in a quarter of the memory.
    /// \pre the surface is a 2-manifold, all of it was assigned
    void forgetFans() {
        std::vector<Index> firstAt;
        assignInHugePages(firstAt, points_.size());
        for (std::size_t v = 0; v < firstAt.size(); ++v) {
            firstAt[v] = triangleAt(static_cast<Index>(v));
        }
        firstAt_ = std::move(firstAt);
        halfEdges_ = {};
    }

    std::size_t triangleCount() const { return triangles_.size(); }

    Corners cornersOf(Index t) const {
        const auto& v = triangles_[t];
        return {points_[v[0]], points_[v[1]], points_[v[2]]};
    }
    Vec3 normalOf(Index t) const {
        if (!normals_.empty()) return normals_[t];
        const Corners c = cornersOf(t);
        return normalized(areaVector2(c[0], c[1], c[2]));
    }
    /// For many walks: each step asks for four normals.
    void keepNormals() {
        std::vector<Vec3> normals(triangles_.size());
        for (Index t = 0; t < triangles_.size(); ++t) normals[t] = normalOf(t);
        normals_ = std::move(normals);
    }

    /// Across the edge from corner c to the next one; kNone where the surface ends.
    Index across(Index t, int c) const {
        const Index h = twin_[3 * t + static_cast<Index>(c)];
        return h == kNone ? kNone : h / 3;
    }

    /// The half-edge along the same edge in the other direction; kNone where the surface ends.
    Index twin(Index halfEdge) const { return twin_[halfEdge]; }

    /// A triangle at a vertex; kNone for a vertex without one.
    Index triangleAt(Index vertex) const {
        if (!firstAt_.empty()) return firstAt_[vertex];
        const auto leaving = halfEdges_.from(vertex);
        return leaving.empty() ? kNone : leaving.front() / 3;
    }

    bool isEmpty() const { return triangles_.empty(); }

    const Vec3& point(Index vertex) const { return points_[vertex]; }
    const std::array<Index, 3>& verticesOf(Index t) const { return triangles_[t]; }
    bool hasVertex(Index t, Index vertex) const {
        const auto& v = triangles_[t];
        return v[0] == vertex || v[1] == vertex || v[2] == vertex;
    }

    /// The triangle with these corners in this order; kNone where there is none.
    Index find(Index a, Index b, Index c) const {
        if (!firstAt_.empty()) return findRound(a, b, c);
        for (const Index h : halfEdges_.from(a)) {
            if (halfEdges_.to(h) == b && triangles_[h / 3][(h + 2) % 3] == c) return h / 3;
        }
        return kNone;
    }

private:
    static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static Index previous(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }

    /// find() round a: one way until it is there again or the surface ends, then the other way.
    Index findRound(Index a, Index b, Index c) const {
        const Index first = firstAt_[a];
        if (first == kNone) return kNone;
        const auto isIt = [&](Index h) {
            const auto& t = triangles_[h / 3];
            return t[(h + 1) % 3] == b && t[(h + 2) % 3] == c;
        };
        const auto& corners = triangles_[first];
        const Index begin = 3 * first + (corners[0] == a ? 0 : corners[1] == a ? 1 : 2);
        Index h = begin;
        do {
            if (isIt(h)) return h / 3;
            h = twin_[previous(h)];
        } while (h != kNone && h != begin);
        if (h == begin) return kNone;
        for (h = twin_[begin]; h != kNone; h = twin_[h]) {
            h = next(h);
            if (isIt(h)) return h / 3;
        }
        return kNone;
    }

    std::span<const Vec3> points_;
    std::span<const std::array<Index, 3>> triangles_;
    HalfEdges<Index> halfEdges_;
    std::vector<Index> twin_;
    std::vector<Index> firstAt_;  ///< of each vertex; empty: halfEdges_ has all
    std::vector<Vec3> normals_;   ///< of the triangles, where they are kept
};

/// Cuts pieces so that each part lies within a distance of one triangle of a surface: those that
/// lie over the triangle where the walk stands, up to the planes half-way to its neighbours, stay;
/// the rest goes on to the neighbours. A part lies within d of a triangle if its corners do, since
/// the distance to a convex set is a convex function.
class SurfaceWalk {
public:
    /// Parts of the last cover() that could not be shown to lie within the distance.
    const std::vector<ConvexPiece>& left() const { return left_; }
    /// Triangles of the surface that the other parts lie near; some of them several times.
    const std::vector<std::uint64_t>& witnesses() const { return witnesses_; }

    /// \param steps  triangles that the walk may visit
    template <class Index>
    void cover(const ConvexPiece& piece, const WalkableSurface<Index>& surface, Index start,
               double squaredDistance, int steps) {
        left_.clear();
        witnesses_.clear();
        walk(piece, surface, start, squaredDistance, steps);
    }

private:
    template <class Index>
    void walk(const ConvexPiece& piece, const WalkableSurface<Index>& surface, Index start,
              double squaredDistance, int steps) {
        todo_.clear();
        todo_.push_back({piece, static_cast<std::uint64_t>(start)});
        Circle circle;
        for (; !todo_.empty() && steps > 0; --steps) {
            const Task task = todo_.back();
            todo_.pop_back();
            const bool goesOn =
                step(task.piece, surface, static_cast<Index>(task.triangle), squaredDistance);
            if (!goesOn) {
                circle = {};
            } else if (circle.isClosedAt(todo_.back().triangle)) {
                break;
            }
        }
        for (const Task& task : todo_) left_.push_back(task.piece);
    }

    /// Where a piece that goes on whole has been: it goes in circles once it is there again.
    struct Circle {
        std::uint64_t mark = ~std::uint64_t{0};
        int steps = 0, most = 1;  ///< since the mark; before the next one [Brent1980]

        bool isClosedAt(std::uint64_t triangle) {
            if (triangle == mark) return true;
            if (++steps == most) *this = {triangle, 0, 2 * most};
            return false;
        }
    };
    struct Task {
        ConvexPiece piece;
        std::uint64_t triangle;
    };
    static bool has(const NearTriangle& near, const ConvexPiece& piece) {
        for (int i = 0; i < piece.count(); ++i) {
            if (!near.has(piece.corner(i))) return false;
        }
        return true;
    }

    /// \return whether all of the piece went on to a neighbour
    template <class Index>
    bool step(ConvexPiece piece, const WalkableSurface<Index>& surface, Index t,
              double squaredDistance) {
        const Corners corners = surface.cornersOf(t);
        const NearTriangle near(corners, squaredDistance);
        if (has(near, piece)) {
            witnesses_.push_back(t);
            return false;
        }
        const Vec3 normal = surface.normalOf(t);
        bool isCut = false;
        for (int c = 0; c < 3; ++c) {
            const Index next = surface.across(t, c);
            if (next == WalkableSurface<Index>::kNone) continue;
            const Vec3 edge = corners[(c + 1) % 3] - corners[c];
            const Vec3 outward = cross(edge, normal + surface.normalOf(next));
            double most = 0, least = 0;
            for (int i = 0; i < piece.count(); ++i) {
                side_[i] = dot(outward, piece.corner(i) - corners[c]);
                most = std::max(most, side_[i]);
                least = std::min(least, side_[i]);
            }
            const double hair = kHair * squaredNorm(edge);
            if (most <= hair) continue;
            if (least >= -hair) {
                todo_.push_back({piece, static_cast<std::uint64_t>(next)});
                return !isCut;
            }
            if (piece.count() + changesOfSide(piece.count()) > ConvexPiece::kMost) {
                left_.push_back(piece);
                return false;
            }
            todo_.push_back({ConvexPiece(), static_cast<std::uint64_t>(next)});
            piece = cut(piece, todo_.back().piece);
            isCut = true;
        }
        if (isCut && has(near, piece)) {
            witnesses_.push_back(t);
        } else {
            left_.push_back(piece);
        }
        return false;
    }

    /// Two where the piece is convex; more where rounding has bent it.
    int changesOfSide(int count) const {
        int changes = 0;
        for (int i = 0; i < count; ++i) {
            const int j = i + 1 == count ? 0 : i + 1;
            changes += static_cast<int>((side_[i] > 0) != (side_[j] > 0));
        }
        return changes;
    }

    /// \param outer  gets the part on the positive sides \return the other part
    ConvexPiece cut(const ConvexPiece& piece, ConvexPiece& outer) const {
        ConvexPiece inner;
        for (int i = 0; i < piece.count(); ++i) {
            const int j = i + 1 == piece.count() ? 0 : i + 1;
            (side_[i] > 0 ? outer : inner).add(piece.corner(i));
            if ((side_[i] > 0) == (side_[j] > 0)) continue;
            const Vec3 from = piece.corner(i);
            const Vec3 p = from + side_[i] / (side_[i] - side_[j]) * (piece.corner(j) - from);
            inner.add(p);
            outer.add(p);
        }
        return inner;
    }

    /// As a fraction of a triangle's edge: points less than that beyond it stay.
    static constexpr double kHair = 1e-9;

    std::array<double, ConvexPiece::kMost> side_{};  ///< of the corners to the plane at an edge
    std::vector<Task> todo_;
    std::vector<ConvexPiece> left_;
    std::vector<std::uint64_t> witnesses_;
};

}  // namespace adaptiso::detail
