#pragma once

#include <cstdint>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// How many pairs of triangles can't be proved not to cross (see Certificate.h); 0: none crosses.
/// Checks the mesh as it is, whatever made it.
/// Cost: O(T log T), in parallel.
std::int64_t countUnprovedPairs(const TriangleMesh& mesh);

}  // namespace adaptiso::detail
