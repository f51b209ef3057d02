#pragma once

#include "MendAssembly.h"
#include "adaptiso/Core/AabbTree.h"

namespace adaptiso::detail {

/// Thins new surface, and what is left of triangles that were cut, by simplification. Triangles
/// that are kept, what fills holes and borders stay. Nothing changes where nothing can be proved.
/// \param tree     of the prepared input
/// \param boundMm  no point moves farther; assembly.thinnedMm gets what was proved
void thin(const AabbTree& tree, double boundMm, MendAssembly& assembly);

}  // namespace adaptiso::detail
