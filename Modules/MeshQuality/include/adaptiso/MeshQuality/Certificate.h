#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Squared sine of 0.8 degrees: triangles that meet at a smaller angle count as folded.
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

/// The test of the three above that fits two triangles of a mesh, by the numbers of their corners.
template <class Id>
bool areClear(std::span<const Vec3> points, const std::array<Id, 3>& s, const std::array<Id, 3>& t,
              double gap, double squaredSine = kSquaredSineOfFold) {
    std::array<int, 3> inT{};  // where a corner of s stands in t, or -1
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        const auto at = std::find(t.begin(), t.end(), s[i]);
        inT[i] = at == t.end() ? -1 : static_cast<int>(at - t.begin());
        if (inT[i] >= 0) ++shared;
    }
    const auto cornersFrom = [&](const std::array<Id, 3>& u, int first) {
        return Corners{points[u[first]], points[u[(first + 1) % 3]], points[u[(first + 2) % 3]]};
    };
    if (shared == 0) return areApart(cornersFrom(s, 0), cornersFrom(t, 0), gap);
    if (shared == 1) {
        const int i = inT[0] >= 0 ? 0 : inT[1] >= 0 ? 1 : 2;
        return touchAtVertexOnly(cornersFrom(s, i), cornersFrom(t, inT[i]), gap);
    }
    if (shared == 3) return false;
    const int other = inT[0] < 0 ? 0 : inT[1] < 0 ? 1 : 2;  // the corner of s that t does not have
    if (inT[(other + 1) % 3] == inT[(other + 2) % 3]) return false;  // s names a vertex twice
    const Corners fromEdge = cornersFrom(s, (other + 1) % 3);
    const int otherInT = 3 - inT[(other + 1) % 3] - inT[(other + 2) % 3];
    return touchAtEdgeOnly(fromEdge, {fromEdge[1], fromEdge[0], points[t[otherInT]]}, squaredSine);
}

}  // namespace adaptiso
