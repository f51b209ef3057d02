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
    /// Of the least area that crosses nothing, of up to 256 edges. Where none is found, and for
    /// longer borders or several of about one plane, of up to 512 edges when their dents are
    /// filled: triangles that cross something are left out, a quarter at most.
    LeastArea
};

/// Closes holes by triangles between the corners of their borders: appends them to the mesh.
/// \pre triangles that hang together face one way; edges are found \post edges are not
/// \return  whether there are any
bool addCaps(MendInput& input, CapKind kind);

/// Takes away caps that cross anything, and all their crossings. A plane cap crosses by rounding,
/// and one of several borders here and there: either goes around these places alone, where that is
/// less than half of it.
/// \post edges are not found
/// \return  whether there were any
bool dropCrossingCaps(MendInput& input);

}  // namespace adaptiso::detail
