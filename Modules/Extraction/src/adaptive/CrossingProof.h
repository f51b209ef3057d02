#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// A point of each triangle that crosses another one; empty when nothing crosses. Checks the mesh
/// as it is, whatever made it: pairs that no plane is found between (see Certificate.h) are looked
/// at exactly, by MeshQuality's trianglesCross(). The same mesh gives the same points in the same
/// order. Cost: O(T log T), in parallel.
std::vector<Vec3> crossingPlaces(const TriangleMesh& mesh);

}  // namespace adaptiso::detail
