#pragma once

#include <array>
#include <cstdint>

namespace adaptiso::detail {

// A cell is the cube between eight voxel centres. Its corner c lies at (c & 1, c >> 1 & 1, c >> 2):
// corner 0 is the voxel that the cell is named by. Kuhn's triangulation cuts it into six
// tetrahedra round the diagonal from corner 0 to corner 7.

inline constexpr int kTetrahedra = 6;
inline constexpr int kEdgeKinds =
    7;  ///< an edge of kind m runs from a voxel to its cell's corner m

/// The other corners of the diagonal's tetrahedra, in a ring: tetrahedron t has 0, kRing[t],
/// kRing[t + 1] and 7.
inline constexpr std::array<int, kTetrahedra> kRing{1, 3, 2, 6, 4, 5};

constexpr int after(int t) {
    return (t + 1) % kTetrahedra;
}
constexpr int before(int t) {
    return (t + kTetrahedra - 1) % kTetrahedra;
}

/// Corners of a tetrahedron as bits.
constexpr unsigned cornersOf(int t) {
    return 1U | 1U << kRing[t] | 1U << kRing[after(t)] | 1U << 7;
}

/// A side of a cell is cut into two triangles by the diagonal from its first corner to its last.
/// The tetrahedra at the sides, [axis][0: the side of corner 0, 1: of corner 7][triangle].
using SideTetrahedra = std::array<std::array<std::array<int, 2>, 2>, 3>;
extern const SideTetrahedra kSideTetrahedra;
/// Corners of these triangles; those of the two sides of an axis match.
std::array<int, 3> sideTriangle(int axis, int side, int triangle);

/// A tetrahedron of a cell in the neighbourhood.
struct TetrahedronAt {
    std::array<int, 3> cell;  ///< 0 or -1 along each axis
    int tetrahedron;
};

/// The tetrahedra round an edge of each kind, counter-clockwise seen from its end.
struct EdgeRing {
    int count = 0;
    std::array<TetrahedronAt, 6> around;
};
const EdgeRing& edgeRing(int kind);

/// Connection of the walls in a cell: its tetrahedra in groups, one vertex each.
///
/// The pieces of wall inside a group's tetrahedra are what a cone from one point over the walls on
/// their border is, and so are those on what two groups share: one vertex a group keeps the
/// topology of one vertex a tetrahedron, whatever is around the cell.
struct CellPattern {
    static constexpr std::uint8_t kNone = 255;

    int groups = 0;
    std::array<std::uint8_t, kTetrahedra> groupOf{};  ///< kNone: all corners have one label
    std::array<std::uint8_t, kTetrahedra> first{};    ///< of each group: its first tetrahedron
    std::array<std::uint8_t, kTetrahedra> size{};     ///< kTetrahedra, or at most 3: convex

    /// One vertex, which may lie anywhere in the cell.
    bool isWhole() const { return groups == 1 && size[0] == kTetrahedra; }
};

/// The corners of a cell with equal labels, as a number below kPatterns.
inline constexpr int kPatterns = 40320;
template <class T>
int patternCode(const std::array<T, 8>& labels) {
    int code = 0, kinds = 1;
    std::array<T, 8> seen{labels[0]};
    for (int c = 1; c < 8; ++c) {
        int kind = 0;
        while (kind < kinds && seen[kind] != labels[c]) ++kind;
        if (kind == kinds) seen[kinds++] = labels[c];
        code = code * (c + 1) + kind;
    }
    return code;
}

const CellPattern& cellPattern(int code);

/// Labels p, q, r, s round a side, with the diagonal p-r: its walls are not a cone, as a label is
/// there in two pieces. One edge for both triangles would pinch it.
template <class T>
bool isPinched(T p, T q, T r, T s) {
    return p == r ? q != p && s != p : q == s && q != p && q != r;
}

}  // namespace adaptiso::detail
