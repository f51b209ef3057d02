#pragma once

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Of 0.8 degrees: triangles at an edge with a smaller angle between them count as folded.
inline constexpr double kSquaredSineOfFold = 1.95e-4;

// Conservative proofs that two triangles of a mesh do not cross: `true` is certain, `false` means
// only that none of the planes tried lies between them. Both triangles keep `gap` mm of room
// beyond what is proved, so that rounding can't undo it.

/// Triangles that share no vertex: a plane lies between them (separating axis theorem: the two
/// normals, the nine products of edges and the six of normals and edges).
bool areApart(const Corners& a, const Corners& b, double gap);

/// Triangles that share the vertex a[0] = b[0] and no other: a plane through it lies between them.
bool touchAtVertexOnly(const Corners& a, const Corners& b, double gap);

/// Triangles that share the edge a[0] a[1] = b[1] b[0]: they are not folded onto each other, that
/// is, more than an angle lies between them.
/// \param squaredSine  of the angle
bool touchAtEdgeOnly(const Corners& a, const Corners& b, double squaredSine = kSquaredSineOfFold);

}  // namespace adaptiso
