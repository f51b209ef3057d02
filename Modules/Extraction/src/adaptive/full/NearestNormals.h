#pragma once

#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// For each point of `mesh` the normal of `input` at its nearest point, interpolated.
/// \param tree  of `input`. \pre it has normals
std::vector<Normal> normalsFrom(const TriangleMesh& input, const TriangleMesh& mesh,
                                const AabbTree& tree);

}  // namespace adaptiso::detail
