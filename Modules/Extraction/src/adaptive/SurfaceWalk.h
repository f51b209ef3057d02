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

/// A convex part of a triangle. Copies what there is of it alone: walks copy a lot.
class ConvexPiece {
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
        const auto at = static_cast<std::size_t>(3 * i);
        return {number_[at], number_[at + 1], number_[at + 2]};
    }
    /// \pre count() < kMost
    void add(const Vec3& p) {
        const auto at = static_cast<std::size_t>(3 * count_++);
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
    /// A triangle, ready for many points' distances.
    class Near {
    public:
        Near(const Corners& t, const Vec3& normal, double squaredDistance)
            : t_(t), normal_(normal), squared_(squaredDistance), e_(t[1] - t[0]), f_(t[2] - t[0]) {
            const double ee = squaredNorm(e_), ef = dot(e_, f_), ff = squaredNorm(f_);
            const double inverse = 1 / (ee * ff - ef * ef);
            ee_ = inverse * ee, ef_ = inverse * ef, ff_ = inverse * ff;
        }
        bool has(const Vec3& p) const {
            const Vec3 q = p - t_[0];
            const double height = dot(normal_, q);
            if (height * height > squared_) return false;
            const double d = dot(q, e_), g = dot(q, f_);
            const double u = ff_ * d - ef_ * g, v = ee_ * g - ef_ * d;
            if (u >= 0 && v >= 0 && u + v <= 1) return true;  // above the triangle
            return squaredDistanceToTriangle(p, t_) <= squared_;
        }
        bool has(const ConvexPiece& piece) const {
            for (int i = 0; i < piece.count(); ++i) {
                if (!has(piece.corner(i))) return false;
            }
            return true;
        }

    private:
        const Corners& t_;
        const Vec3& normal_;
        double squared_;
        Vec3 e_, f_;
        double ee_, ef_, ff_;
    };

    template <class Index>
    void step(ConvexPiece piece, const WalkableSurface<Index>& surface, Index t,
              double squaredDistance) {
        const Corners corners = surface.cornersOf(t);
        const Vec3& normal = surface.normalOf(t);
        const Near near(corners, normal, squaredDistance);
        if (near.has(piece)) return;
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
                return;
            }
            if (piece.count() + 2 > ConvexPiece::kMost) {
                left_.push_back(piece);
                return;
            }
            todo_.push_back({ConvexPiece(), static_cast<std::uint64_t>(next)});
            piece = cut(piece, todo_.back().piece);
            isCut = true;
        }
        if (!isCut || !near.has(piece)) left_.push_back(piece);
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

    /// Of a triangle's edge: what lies less than that beyond it stays.
    static constexpr double kHair = 1e-9;

    std::array<double, ConvexPiece::kMost> side_{};  ///< of the corners to the plane at an edge
    std::vector<Task> todo_;
    std::vector<ConvexPiece> left_;
};

}  // namespace adaptiso::detail
