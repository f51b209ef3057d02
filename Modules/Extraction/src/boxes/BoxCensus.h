#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "adaptiso/Extraction/detail/BoxCases.h"
#include "lattice/BlockSamples.h"

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

/// Surface of the full grid in a simple box of more than one cell.
struct BoxCensus {
    std::int64_t marchingCubesTriangles = 0;
    bool changesTopology = false;  ///< a disc for each loop on its faces is not the same surface
};

/// The crossed lattice edges of a simple box, each lign through it being crossed once at most.
struct CrossedEdges {
    int count = 0;
    int onFaces = 0;  ///< of them, those on the box's faces
};

template <int N>
CrossedEdges crossedEdges(const BlockSamples<N>& samples, const std::array<int, 3>& low,
                          const std::array<int, 3>& size) {
    const int highX = low[0] + size[0], highY = low[1] + size[1], highZ = low[2] + size[2];
    const std::uint32_t ends = 1u << low[0] | 1u << highX;
    const std::uint32_t within = (2u << highX) - (1u << low[0]);
    CrossedEdges crossed;
    // ligns along y or z: bit x of `changes`, all of them on the faces where `isOuter`
    const auto add = [&](std::uint32_t changes, bool isOuter) {
        changes &= within;
        crossed.count += std::popcount(changes);
        crossed.onFaces += std::popcount(isOuter ? changes : changes & ends);
    };
    for (int z = low[2]; z <= highZ; ++z) {
        const bool isOuterZ = z == low[2] || z == highZ;
        add(samples.row(low[1], z) ^ samples.row(highY, z), isOuterZ);
        for (int y = low[1]; y <= highY; ++y) {  // along x
            const std::uint32_t row = samples.row(y, z);
            const int change = static_cast<int>((row >> low[0] ^ row >> highX) & 1u);
            crossed.count += change;
            if (isOuterZ || y == low[1] || y == highY) crossed.onFaces += change;
        }
    }
    for (int y = low[1]; y <= highY; ++y) {
        add(samples.row(y, low[2]) ^ samples.row(y, highZ), y == low[1] || y == highY);
    }
    return crossed;
}

/// Counts the triangles of the full grid in the box, and whether `loops` discs are the same
/// surface: its Euler characteristic V - E + F, of vertices on crossed lattice edges, iso-lines
/// on unit faces and a disc for each loop of a cell, must be the number of loops.
template <int N>
BoxCensus takeCensus(const BoxCases& cases, const BlockSamples<N>& samples,
                     const std::array<int, 3>& low, const std::array<int, 3>& size, int loops) {
    std::int64_t cellLoops = 0, cellCorners = 0;
    const std::uint32_t within = ((1u << size[0]) - 1) << low[0];
    for (int z = low[2]; z < low[2] + size[2]; ++z) {
        for (int y = low[1]; y < low[1] + size[1]; ++y) {
            const std::uint32_t a = samples.row(y, z), b = samples.row(y + 1, z);
            const std::uint32_t c = samples.row(y, z + 1), d = samples.row(y + 1, z + 1);
            const std::uint32_t any = a | b | c | d, all = a & b & c & d;
            std::uint32_t mixed = (any | any >> 1) & ~(all & all >> 1) & within;
            for (; mixed != 0; mixed &= mixed - 1) {  // bit x: the surface passes the cell
                const Box cell{std::countr_zero(mixed), y, z, 1};
                const BoxCase& boxCase = cases[caseOf(cases, samples, cell)];
                cellLoops += boxCase.loopCount;
                cellCorners += boxCase.crossedEdges;
            }
        }
    }
    const CrossedEdges vertices = crossedEdges(samples, low, size);
    // loops go over inner iso-lines twice, over those on the box's faces (one a vertex) once
    const std::int64_t edges = (cellCorners + vertices.onFaces) / 2;
    return {cellCorners - 2 * cellLoops, vertices.count - edges + cellLoops != loops};
}

}  // namespace adaptiso::detail
