#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// Number of a vertex; 64 bits, so that no volume is too large (and as VTK keeps them).
using VertexId = std::int64_t;
using Triangle = std::array<VertexId, 3>;
/// Corners of a triangle, in its order.
using Corners = std::array<Vec3, 3>;

/// A triangle surface: V points, T triangles, and V normals or none.
///
/// Inside the library points are in LPS millimetres. Triangles are counter-clockwise seen from
/// outside, the low-intensity side of an isosurface; normals are unit vectors pointing there.
struct TriangleMesh {
    std::vector<Vec3> points;
    std::vector<Normal> normals;  ///< one per point, or empty
    std::vector<Triangle> triangles;

    friend bool operator==(const TriangleMesh&, const TriangleMesh&) = default;
};

/// Area (mm2) of all triangles.
double surfaceArea(const TriangleMesh& mesh);

/// Signed volume (mm3) that a closed surface encloses: positive where normals point outward.
double enclosedVolume(const TriangleMesh& mesh);

/// Box of a triangle.
inline BoundingBox boxOf(const Corners& corners) {
    BoundingBox box{corners[0], corners[0]};
    box.add(corners[1]);
    box.add(corners[2]);
    return box;
}

inline Corners cornersOf(const TriangleMesh& mesh, std::int64_t triangle) {
    const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
    return {mesh.points[static_cast<std::size_t>(a)], mesh.points[static_cast<std::size_t>(b)],
            mesh.points[static_cast<std::size_t>(c)]};
}

/// Box of all points, used or not.
/// \pre the mesh has a point \throws InvalidInput otherwise
BoundingBox boundingBox(const TriangleMesh& mesh);

/// Turns every triangle round (for a mirrored frame) and every normal with it.
void flipOrientation(TriangleMesh& mesh);

}  // namespace adaptiso
