#pragma once

#include <cstdint>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptive/proof/TriangleTree.h"

namespace adaptiso::detail {

/// The triangles that cross another one, ascending; empty when nothing crosses. Checks the mesh as
/// it is, whatever made it: pairs that no plane is found between (see Certificate.h) are looked at
/// exactly, by MeshQuality's trianglesCross(). Cost: O(T log T), in parallel.
/// \pre fewer than 2^32 points
std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh);

std::vector<std::int64_t> crossingTriangles(const TriangleView& mesh);

}  // namespace adaptiso::detail
