#pragma once

#include <cstdint>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// How thick a solid's walls are.
struct WallReport {
    double leastMm = 0;          ///< of the thinnest wall; 0 without one
    std::int64_t triangle = -1;  ///< where it is; -1: no two sides of the solid form a wall
    int corner = -1;             ///< of the triangle, near it; -1: in its middle
    Vec3 pointMm;                ///< there, on the surface
    double thinAreaMm2 = 0;      ///< area below which the wall is thinner than the limit
    double areaMm2 = 0;          ///< of the whole surface

    bool hasWall() const { return triangle >= 0; }
    double thinShare() const { return areaMm2 > 0 ? thinAreaMm2 / areaMm2 : 0; }
};

/// WallReport::pointMm on `mesh`, the same surface, perhaps moved. \pre report.hasWall()
Vec3 wallPoint(const WallReport& report, const TriangleMesh& mesh);

/// Measures the thickness of the solid below points of every triangle: along the inward normal to
/// the opposite side. Sides that lean on each other by more than 45 degrees form an edge, not a
/// wall.
///
/// Each triangle is measured below its middle, and below points near its corners where it is larger
/// than the limit. A thin place below the middle of a larger triangle is found from its other side.
/// \param mesh     mm
/// \param limitMm  thinner walls count into thinAreaMm2; > 0
/// \pre mesh is closed, manifold, oriented outward and finite
/// Cost: O(T log T) on surfaces; 32 bytes a triangle. The same bits, whatever the number of
/// threads.
WallReport measureWalls(const TriangleMesh& mesh, double limitMm);

}  // namespace adaptiso
