#pragma once

#include <array>

#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {

/// Positive where d lies on the side of a, b, c from which these are seen clockwise.
inline double volumeOf(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    const Vec3& a = mesh.points[t[0]];
    return dot(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a) / 6;
}

}  // namespace adaptiso
