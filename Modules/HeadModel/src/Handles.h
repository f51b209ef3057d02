#pragma once

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// A closed path along edges that no disc of the surface fills: it runs round or through a handle.
struct HandleLoop {
    double lengthMm = 0;
    Vec3 centreMm;  ///< mean of its vertices
};

/// A short loop of some handle: the shortest through a root [Erickson2005, with the tree and cotree
/// of Eppstein2003], rooted anew on the loop found until it gets no shorter. Not always the
/// shortest of the surface.
/// \pre  surface is one closed, oriented, manifold component of genus >= 1
/// Cost: O(T log T) for each of a handful of roots
HandleLoop findHandleLoop(const TriangleMesh& surface);

}  // namespace adaptiso
