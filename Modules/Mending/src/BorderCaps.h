#pragma once

#include "MendInput.h"

namespace adaptiso::detail {

/// Rings of border edges, in the direction of triangles that close them. Where a border meets
/// itself, it is cut into rings that do not.
/// \pre triangles that hang together face one way; edges are found
std::vector<std::vector<VertexId>> borderRings(const MendInput& input);

enum class CapKind : std::uint8_t {
    Flat,       ///< in the plane that fits best, of up to 4096 edges; one for borders of one plane
    FlatAlone,  ///< the same, one for each border
    /// Of the least area that crosses nothing, for borders of up to 256 edges. Several borders of
    /// about one plane, longer borders, and those that no such cap closes have their dents filled
    /// first, up to 512 edges may be left, and a quarter of the triangles may be missing.
    LeastArea
};

/// Closes holes by triangles between the corners of their borders: appends them to the mesh.
/// \pre triangles that hang together face one way; edges are found \post edges are not
/// \return  whether there are any
bool addCaps(MendInput& input, CapKind kind);

/// Takes away caps that cross anything, and all their crossings. Of a cap that goes in parts
/// (MendInput::capGoesInParts) the places that cross go alone, where they are less than half of it.
/// \post edges are not found
/// \return  whether there were any
bool dropCrossingCaps(MendInput& input);

}  // namespace adaptiso::detail
