#pragma once

#include <array>
#include <cstdint>

namespace adaptiso::detail {

// Numbering of a box, used by everything that walks one.
//   corner c = x + 2 y + 4 z of the unit box
//   edge   e = 4 axis + a + 2 b: along `axis`, at a, b on the two following axes (cyclic)
//   face   f = 2 axis + side: at right angles to `axis`; side 1 is the high one
//   side of a face: 0 bottom (v = 0), 1 right (u = 1), 2 top (v = 1), 3 left (u = 0), where u and v
//   are the two axes that follow the face's own
inline constexpr int kBoxCorners = 8, kBoxEdges = 12, kBoxFaces = 6;
inline constexpr int kInsideBox = 6;     ///< in place of a face: a half-edge within the box
inline constexpr int kNoIncidence = 13;  ///< a facet in none of the 13 families of planes

constexpr int axisAfter(int axis, int steps) {
    return (axis + steps) % 3;
}
constexpr int edgeAxis(int edge) {
    return edge / 4;
}

/// Corner at the low end of an edge.
constexpr int lowCorner(int edge) {
    const int axis = edge / 4;
    return ((edge & 1) << axisAfter(axis, 1)) | (((edge >> 1) & 1) << axisAfter(axis, 2));
}
constexpr int highCorner(int edge) {
    return lowCorner(edge) | (1 << (edge / 4));
}

/// The four corners of a face in the order (u, v) = 00, 10, 01, 11.
constexpr std::array<int, 4> faceCorners(int face) {
    const int axis = face / 2, u = axisAfter(axis, 1), v = axisAfter(axis, 2);
    const int base = (face & 1) << axis;
    return {base, base | 1 << u, base | 1 << v, base | 1 << u | 1 << v};
}

/// The box's edge that is a side of a face.
constexpr int faceEdge(int face, int side) {
    const int axis = face / 2, high = face & 1;
    if (side % 2 == 0) {  // along u; the axes after u are v and the face's own
        return 4 * axisAfter(axis, 1) + (side == 2 ? 1 : 0) + 2 * high;
    }
    return 4 * axisAfter(axis, 2) + high + 2 * (side == 1 ? 1 : 0);  // along v
}

/// A directed iso-line on a square: from the crossing on side `from` to that on side `to`.
struct IsoLine {
    std::uint8_t from, to;
};
/// The iso-lines of a square by its four corners (bit 0: (u, v) = 00, 1: 10, 2: 01, 3: 11), the
/// inside on their right where u, v run right and up. An ambiguous square is cut by `joined`:
/// whether its two inside corners are connected.
struct SquareIsoLines {
    std::uint8_t count = 0;
    std::array<IsoLine, 2> lines{};
};
SquareIsoLines squareIsoLines(unsigned corners, bool joined);

/// Do the diagonals of the square differ: two inside corners opposite each other?
constexpr bool isAmbiguous(unsigned corners) {
    return corners == 0b1001 || corners == 0b0110;
}

/// A half-edge of a facet: it starts at the crossing on a box edge and runs on a face or inside.
struct CaseHalfEdge {
    std::uint8_t edge;  ///< box edge where it starts
    std::uint8_t face;  ///< the face it runs on, or kInsideBox
    std::uint8_t next;  ///< following half-edge of the facet
    std::uint8_t facet;
    std::array<std::int8_t, 3> direction;  ///< midpoint to midpoint, half box sides
};

/// A plane family of discretized marching cubes: normal with components -1, 0, 1, made unique by
/// the sign of its first non-zero component.
struct CaseFacet {
    std::uint8_t firstHalfEdge;
    std::uint8_t size;
    std::uint8_t incidence;             ///< 0 .. 12, or kNoIncidence
    std::array<std::int8_t, 3> normal;  ///< outward; zero where there is no incidence
};

/// The facets of a box by its corners and its ambiguous faces' decisions [Montani1994, table 1].
/// A loop that can't be cut without a chord on a face of the box (116 of 656 cases, all with two
/// ambiguous faces or more) is one facet without incidence.
struct BoxCase {
    std::uint8_t halfEdgeCount = 0;
    std::uint8_t facetCount = 0;
    std::uint8_t loopCount = 0;     ///< closed loops of iso-lines on the faces
    std::uint8_t crossedEdges = 0;  ///< all loops' vertices
    std::array<std::uint8_t, 4> loopLength{};
    std::array<std::uint8_t, kBoxEdges>
        loopEdge{};  ///< box edges of all loops, one after the other
    std::array<CaseHalfEdge, 32> halfEdge{};
    std::uint8_t triangleCount = 0;
    bool hasChordOnFace = false;  ///< of its triangles, see LoopCutter
    std::array<CaseFacet, 12> facet{};
    /// The loops in triangles, by box edges: what marching cubes makes of the box.
    std::array<std::array<std::uint8_t, 3>, 10> triangle{};
    /// Half-edge that runs on a face and starts at one of its sides, or 255.
    std::array<std::array<std::uint8_t, 4>, 6> onFace{};

    /// Triangles that fill all loops.
    int loopTriangles() const { return crossedEdges - 2 * loopCount; }
};

/// All cases. `caseIndex` finds one: by the eight corners (bit c: corner c is inside) and, for
/// ambiguous faces, `joined` (bit f: the inside joins across face f; other bits are ignored).
class BoxCases {
public:
    static const BoxCases& instance();

    std::uint16_t caseIndex(unsigned corners, unsigned joined) const {
        const Group& group = groups_[corners];
        unsigned decision = 0;
        for (int i = 0; i < group.ambiguousCount; ++i) {
            decision |= ((joined >> group.ambiguousFace[i]) & 1u) << i;
        }
        return static_cast<std::uint16_t>(group.first + decision);
    }
    /// Bit f: face f is ambiguous with these corners.
    unsigned ambiguousFaces(unsigned corners) const { return groups_[corners].ambiguousMask; }
    const BoxCase& operator[](std::uint16_t index) const { return cases_[index]; }
    int caseCount() const { return caseCount_; }

private:
    BoxCases();
    struct Group {
        std::uint16_t first = 0;
        std::uint8_t ambiguousCount = 0;
        std::uint8_t ambiguousMask = 0;
        std::array<std::uint8_t, 6> ambiguousFace{};
    };
    std::array<Group, 256> groups_{};
    std::array<BoxCase, 1024> cases_{};
    int caseCount_ = 0;
};

}  // namespace adaptiso::detail
