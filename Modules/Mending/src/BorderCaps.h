#pragma once

#include "MendInput.h"

namespace adaptiso::detail {

/// Rings of border edges, in the direction of triangles that close them. Where a border meets
/// itself, it is cut into rings that do not.
/// \pre triangles that hang together face one way; edges are found
std::vector<std::vector<VertexId>> borderRings(const MendInput& input);

/// Closes holes by triangles between the corners of their borders: appends them to the mesh.
/// \param isByArea  by those of the least area that cross nothing, borders of up to 256 edges; else
///                  by those in the plane that fits best, borders of up to 4096 edges
/// \pre triangles that hang together face one way; edges are found \post edges are not
/// \return  whether there are any
bool addCaps(MendInput& input, bool isByArea);

/// Takes away caps that cross anything, and all their crossings.
/// \post edges are not found
/// \return  whether there were any
bool dropCrossingCaps(MendInput& input);

}  // namespace adaptiso::detail
