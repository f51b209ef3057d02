#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"

namespace adaptiso {

/// A point that lies far from a surface.
struct FarPoint {
    Vec3 point, nearest;
    double distance = 0;  ///< no less than that, but for Tolerance::rounding
};

/// The surface that distances are measured to.
struct DistanceTarget {
    const TriangleMesh& mesh;
    AabbTree tree;

    explicit DistanceTarget(const TriangleMesh& of) : mesh(of), tree(of) {}

    /// Squared distance to one of the triangle's points: never less than that to the triangle, but
    /// for Tolerance::rounding.
    double squaredTo(const Vec3& p, std::int64_t triangle) const;

    /// \param triangle  one near p: saves time
    /// \param effort    shrinks by the triangles looked at
    FarPoint farPoint(const Vec3& p, std::int64_t triangle, std::int64_t& effort) const;
};

/// When a piece lies near enough.
struct Tolerance {
    HausdorffOptions options;
    double sizeMm = 0;      ///< of the surfaces
    double roundingMm = 0;  ///< more than it takes a distance off

    /// \param coordinateMm  the largest
    static double roundingAt(double coordinateMm);
    double at(double distanceMm) const;
    /// \param distanceMm  of the farthest point so far
    double enoughMm(double distanceMm) const;
};

/// Bounds the distances of triangles from a surface.
class PieceSearch {
public:
    /// A corner of a piece, and one or two triangles near it.
    struct Corner {
        Vec3 point;
        std::int64_t triangle = -1;
        double squared = 0;  ///< distance to the triangle
        std::int64_t other = -1;
        double squaredToOther = 0;

        bool isNear(std::int64_t t) const { return t == triangle || t == other; }
        double squaredTo(std::int64_t t) const { return t == triangle ? squared : squaredToOther; }
    };

    PieceSearch(const DistanceTarget& to, const Tolerance& tolerance, const FarPoint& farthest)
        : to_(to), tolerance_(tolerance), farthest_(farthest) {
        setEnough();
    }

    /// The farthest point so far.
    const FarPoint& farthest() const { return farthest_; }
    /// Pieces as near are done with.
    double squaredEnough() const { return enough_; }

    /// Bounds the squared distance of all points of a triangle.
    /// \param effort  triangles that may be looked at; shrinks by those that were. With 0 it is
    ///                bounded by those near its corners, uncut
    /// \return more than squaredEnough() only where that does not suffice
    double bound(const std::array<Corner, 3>& triangle, std::int64_t& effort);

private:
    struct Piece {
        std::array<Corner, 3> corners;
        int cuts = 0;  ///< that made it
    };

    void setEnough();
    double squaredTo(const Vec3& p, std::int64_t triangle);
    double boundOf(const Piece& piece, double most);
    void offer(const Piece& piece);
    bool isNearMiddle(Piece piece);
    void gatherNearby(const Piece& piece);
    Corner cornerAt(const Vec3& p, std::int64_t hint);
    void cut(const Piece& piece);
    bool isParted(const Corner& a, const Corner& b, std::array<Corner, 2>& at);

    const DistanceTarget& to_;
    const Tolerance& tolerance_;
    FarPoint farthest_;
    double enough_ = 0;  ///< squared
    double closed_ = 0;  ///< squared bound of the pieces that are done with
    std::int64_t effort_ = 0;
    std::vector<Piece> open_;  ///< to be cut
    struct Nearby {
        BoundingBox box;
        std::int64_t triangle;
    };
    std::vector<Nearby> nearby_;  ///< triangles within enough_ of the whole triangle
    bool areAllNearby_ = false;
};

}  // namespace adaptiso
