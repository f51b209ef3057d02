#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "../Certificate.h"
#include "PieceBound.h"

namespace adaptiso::detail {

/// A convex part of a triangle.
struct ConvexPiece {
    static constexpr int kMost = 12;
    int count = 0;
    std::array<Vec3, kMost> corner;

    ConvexPiece() = default;
    explicit ConvexPiece(const Corners& t) : count(3) { std::copy_n(t.begin(), 3, corner.begin()); }
};

/// A surface with the triangle across each edge, for walks from triangle to triangle.
template <class Index>
class WalkableSurface {
public:
    static constexpr Index kNone = std::numeric_limits<Index>::max();

    /// Keeps references to both.
    void assign(std::span<const Vec3> points, std::span<const std::array<Index, 3>> triangles) {
        points_ = points;
        triangles_ = triangles;
        leaving_.assign(points.size(), kNone);
        following_.resize(3 * triangles.size());
        across_.assign(3 * triangles.size(), kNone);
        normal_.resize(triangles.size());
        for (std::size_t h = 3 * triangles.size(); h-- > 0;) {
            following_[h] = leaving_[from(h)];
            leaving_[from(h)] = static_cast<Index>(h);
        }
        for (std::size_t h = 0; h < 3 * triangles.size(); ++h) {
            if (across_[h] != kNone) continue;
            for (Index g = leaving_[to(h)]; g != kNone; g = following_[g]) {
                if (to(g) != from(h) || across_[g] != kNone) continue;
                across_[h] = g / 3;
                across_[g] = static_cast<Index>(h / 3);
                break;
            }
        }
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const Corners c = cornersOf(static_cast<Index>(t));
            normal_[t] = normalized(areaVector2(c[0], c[1], c[2]));
        }
    }

    Corners cornersOf(Index t) const {
        const auto& v = triangles_[t];
        return {points_[v[0]], points_[v[1]], points_[v[2]]};
    }
    const Vec3& normalOf(Index t) const { return normal_[t]; }

    /// Across the edge from corner c to the next one; kNone where the surface ends.
    Index across(Index t, int c) const { return across_[3 * t + static_cast<Index>(c)]; }

    /// A triangle at a vertex; kNone for a vertex without one.
    Index triangleAt(Index vertex) const {
        return leaving_[vertex] == kNone ? kNone : leaving_[vertex] / 3;
    }

    /// The triangle with these corners in this order; kNone where there is none.
    Index find(Index a, Index b, Index c) const {
        for (Index h = leaving_[a]; h != kNone; h = following_[h]) {
            if (to(h) == b && triangles_[h / 3][(h + 2) % 3] == c) return h / 3;
        }
        return kNone;
    }

private:
    Index from(std::size_t h) const { return triangles_[h / 3][h % 3]; }
    Index to(std::size_t h) const { return triangles_[h / 3][(h + 1) % 3]; }

    std::span<const Vec3> points_;
    std::span<const std::array<Index, 3>> triangles_;
    std::vector<Index> leaving_, following_, across_;
    std::vector<Vec3> normal_;
};

/// Cuts pieces so that each part lies within a distance of one triangle of a surface: those that
/// lie over the triangle where the walk stands, up to the planes half-way to its neighbours, stay;
/// the rest goes on to the neighbours. A part lies within d of a triangle if its corners do, since
/// the distance to a convex set is a convex function.
class SurfaceWalk {
public:
    /// Parts of the last cover() that could not be shown to lie within the distance.
    const std::vector<ConvexPiece>& left() const { return left_; }

    /// \param steps  triangles that the walk may visit
    template <class Index>
    void cover(const ConvexPiece& piece, const WalkableSurface<Index>& surface, Index start,
               double squaredDistance, int steps) {
        left_.clear();
        todo_.clear();
        todo_.push_back({piece, static_cast<std::uint64_t>(start)});
        for (; !todo_.empty() && steps > 0; --steps) {
            const Task task = todo_.back();
            todo_.pop_back();
            step(task.piece, surface, static_cast<Index>(task.triangle), squaredDistance);
        }
        for (const Task& task : todo_) left_.push_back(task.piece);
    }

private:
    struct Task {
        ConvexPiece piece;
        std::uint64_t triangle;
    };
    using Sides = std::array<double, ConvexPiece::kMost>;

    static bool isWithin(const ConvexPiece& piece, const Corners& t, double squaredDistance) {
        for (int i = 0; i < piece.count; ++i) {
            if (!(squaredDistanceToTriangle(piece.corner[i], t) <= squaredDistance)) return false;
        }
        return true;
    }

    template <class Index>
    void step(ConvexPiece piece, const WalkableSurface<Index>& surface, Index t,
              double squaredDistance) {
        const Corners corners = surface.cornersOf(t);
        if (isWithin(piece, corners, squaredDistance)) return;
        bool isCut = false;
        for (int c = 0; c < 3; ++c) {
            const Index next = surface.across(t, c);
            if (next == WalkableSurface<Index>::kNone) continue;
            const Vec3 outward = cross(corners[(c + 1) % 3] - corners[c],
                                       surface.normalOf(t) + surface.normalOf(next));
            Sides side;
            double most = 0, least = 0;
            for (int i = 0; i < piece.count; ++i) {
                side[i] = dot(outward, piece.corner[i] - corners[c]);
                most = std::max(most, side[i]);
                least = std::min(least, side[i]);
            }
            const double hair = kHair * squaredNorm(corners[(c + 1) % 3] - corners[c]);
            if (most <= hair) continue;
            if (least >= -hair) {
                todo_.push_back({piece, static_cast<std::uint64_t>(next)});
                return;
            }
            if (piece.count + 2 > ConvexPiece::kMost) {
                left_.push_back(piece);
                return;
            }
            ConvexPiece inner, outer;
            cut(piece, side, inner, outer);
            todo_.push_back({outer, static_cast<std::uint64_t>(next)});
            piece = inner;
            isCut = true;
        }
        if (!isCut || !isWithin(piece, corners, squaredDistance)) left_.push_back(piece);
    }

    static void cut(const ConvexPiece& piece, const Sides& side, ConvexPiece& inner,
                    ConvexPiece& outer) {
        const auto add = [](ConvexPiece& to, const Vec3& p) { to.corner[to.count++] = p; };
        for (int i = 0; i < piece.count; ++i) {
            const int j = i + 1 == piece.count ? 0 : i + 1;
            add(side[i] > 0 ? outer : inner, piece.corner[i]);
            if ((side[i] > 0) == (side[j] > 0)) continue;
            const Vec3 p = piece.corner[i] +
                           side[i] / (side[i] - side[j]) * (piece.corner[j] - piece.corner[i]);
            add(inner, p);
            add(outer, p);
        }
    }

    /// Of a triangle's edge: what lies less than that beyond it stays.
    static constexpr double kHair = 1e-9;

    std::vector<Task> todo_;
    std::vector<ConvexPiece> left_;
};

}  // namespace adaptiso::detail
