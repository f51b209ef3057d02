#pragma once

#include "mend/MendInput.h"

namespace adaptiso::detail {

/// Closes holes by triangles between the corners of their borders, in the plane that fits best:
/// appends them to the mesh. Borders that meet themselves, are longer than some thousand edges, or
/// cross themselves seen across that plane, stay.
/// \pre triangles that hang together face one way; edges are found \post edges are not
void addCaps(MendInput& input);

/// Takes away caps that cross anything, and all their crossings.
/// \post edges are not found
/// \return  whether there were any
bool dropCrossingCaps(MendInput& input);

}  // namespace adaptiso::detail
