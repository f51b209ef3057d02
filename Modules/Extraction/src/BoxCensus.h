#pragma once

#include <array>
#include <cstdint>

#include "BlockSamples.h"
#include "BoxCases.h"

namespace adaptiso::detail {

/// The case of a simple cubic box, its ambiguous faces decided by their own samples.
template <int N>
std::uint16_t caseOf(const BoxCases& cases, const BlockSamples<N>& samples, const Box& box) {
    const unsigned corners = samples.corners(box);
    unsigned joined = 0;
    const unsigned ambiguous = cases.ambiguousFaces(corners);
    for (int face = 0; ambiguous >> face != 0; ++face) {
        if ((ambiguous >> face & 1u) == 0) continue;
        std::array<int, 3> corner{box.x, box.y, box.z};
        if (face & 1) corner[face / 2] += box.size;
        joined |= static_cast<unsigned>(samples.insideJoins(corner, face / 2, box.size)) << face;
    }
    return cases.caseIndex(corners, joined);
}

/// What the surface of the full grid is in a simple box of more than one cell.
struct BoxCensus {
    std::int64_t marchingCubesTriangles = 0;
    bool changesTopology = false;  ///< a disc for each loop on its faces is not the same surface
};

/// Counts the triangles of the full grid in the box, and whether `loops` discs are the same
/// surface: its Euler characteristic V - E + F, of vertices on crossed lattice edges, iso-lines
/// on unit faces and a disc for each loop of a cell, must be the number of loops.
template <int N>
BoxCensus takeCensus(const BoxCases& cases, const BlockSamples<N>& samples,
                     const std::array<int, 3>& low, const std::array<int, 3>& size, int loops) {
    std::int64_t cellLoops = 0, cellCorners = 0;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                const Box cell{low[0] + x, low[1] + y, low[2] + z, 1};
                const unsigned corners = samples.corners(cell);
                if (corners == 0 || corners == 255) continue;
                const BoxCase& boxCase = cases[caseOf(cases, samples, cell)];
                cellLoops += boxCase.loopCount;
                cellCorners += boxCase.crossedEdges;
            }
        }
    }
    std::int64_t vertices = 0, onFaces = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = axisAfter(axis, 1), v = axisAfter(axis, 2);
        for (int b = 0; b <= size[v]; ++b) {
            for (int a = 0; a <= size[u]; ++a) {
                std::array<int, 3> p = low, q;
                p[u] += a;
                p[v] += b;
                q = p;
                q[axis] += size[axis];
                if (samples.inside(p) == samples.inside(q)) continue;  // simple: one at most
                ++vertices;
                onFaces += a == 0 || b == 0 || a == size[u] || b == size[v];
            }
        }
    }
    // loops go over inner iso-lines twice, over those on the box's faces (one a vertex) once
    const std::int64_t edges = (cellCorners + onFaces) / 2;
    return {cellCorners - 2 * cellLoops, vertices - edges + cellLoops != loops};
}

}  // namespace adaptiso::detail
