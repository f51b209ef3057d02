#pragma once

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// No two triangles cross. Checks the mesh as it is, whatever made it: pairs that no plane is found
/// between (see Certificate.h) are looked at exactly, by MeshQuality's findSelfIntersections().
/// Cost: O(T log T), in parallel.
bool crossesNothing(const TriangleMesh& mesh);

}  // namespace adaptiso::detail
