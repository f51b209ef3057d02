#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// A point and the nearest one on another surface's triangles.
struct FarPoint {
    Vec3 point, onOther;
    std::size_t nearest = 0;  ///< of those triangles
    bool hasNearest = false;
};

/// Bounds the distance of a triangle's points to a surface, given the surface's triangles nearby.
///
/// A piece lies within d of the surface if its corners lie within d of one and the same triangle
/// of it: the distance to a convex set is a convex function. A piece whose corners have different
/// nearest triangles is cut where an edge is as far from the one as from the other.
class PieceBound {
public:
    /// \param enoughMm  pieces proved to lie within it need no tighter bound
    explicit PieceBound(double enoughMm = 0) : enough_(enoughMm * enoughMm) {}

    /// Triangles of the surface that include() may use.
    std::vector<Corners>& nearby() { return nearby_; }

    /// Bounds the distance of the piece's points, too.
    void include(const Corners& piece);

    /// The same where the points can be shown to lie within a limit.
    /// \param farthestMm  where they can't: at least how far they may lie
    /// \return where they can't: such a point; the bound stays as it was
    std::optional<FarPoint> includeWithin(double limitMm, const Corners& piece, double& farthestMm);

    /// Proves that the piece lies within the bound so far, without much ado.
    /// \return false when it may not
    bool isWithin(const Corners& piece) const;

    /// The piece lies within the bound so far of this triangle.
    bool isWithin(const Corners& piece, const Corners& triangle) const;

    /// No point of the pieces so far is farther from the surface, mm; at least enoughMm.
    double boundMm() const { return std::sqrt(enough_); }
    double squaredBound() const { return enough_; }

private:
    struct Corner {
        Vec3 point;
        std::size_t nearest;
        double squared;  ///< distance to it
    };
    using Piece = std::array<Corner, 3>;
    struct Parts {
        std::array<Piece, 4> piece;
        int count;
    };

    Corner cornerAt(const Vec3& point) const;
    void noteFarthest(const Corner& corner);
    Corner newCornerAt(const Vec3& point);
    Corner between(const Corner& a, const Corner& b) const;
    Parts partsOf(const Piece& piece) const;
    bool isWithin(const Piece& piece, int depth) const;
    void include(const Piece& piece, int depth);
    void includeUncut(const Corners& piece);

    std::vector<Corners> nearby_;
    double enough_;      ///< the bound so far, squared
    FarPoint farthest_;  ///< where the bound had to grow last
};

double squaredDistanceToTriangle(const Vec3& p, const Corners& triangle);

}  // namespace adaptiso::detail
