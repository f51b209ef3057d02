#pragma once

#include <vector>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::detail {

/// For each point of `mesh` the normal of `input` at its nearest point, interpolated.
/// \pre `input` has normals
std::vector<Normal> normalsFrom(const TriangleMesh& input, const TriangleMesh& mesh);

}  // namespace adaptiso::detail
