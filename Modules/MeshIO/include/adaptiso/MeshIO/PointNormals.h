#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// For every point the sum of the area vectors of the triangles around it, of unit length: for
/// formats that hold normals always. A point that no triangle uses has (0, 0, 0).
/// \pre triangles name points that are there
std::vector<Normal> areaWeightedNormals(const TriangleMesh& mesh);

}  // namespace adaptiso
