#pragma once

#include <cstdint>
#include <vector>

#include "boxes/BoxSurface.h"
#include "lattice/LatticeSampler.h"

namespace adaptiso::detail {

/// Key of the facet that a loop bounds: a part of a plane (PlaneKey) or, in space, a disc in a box
/// (BoxKey). The top bit tells them apart.
struct LoopKey {
    std::uint64_t word = 0;
    static constexpr std::uint64_t kPlane = std::uint64_t{1} << 63;

    bool isPlane() const { return word & kPlane; }
};

/// The plane of a merged facet: boxes of one size, one of the 26 directions, one offset. Loops with
/// equal keys lie in the same plane and do not overlap.
struct PlaneKey {
    std::uint64_t word = 0;

    static LoopKey make(const std::array<int, 3>& normal, int level, std::int64_t offset) {
        const int code = (normal[0] + 1) + 3 * (normal[1] + 1) + 9 * (normal[2] + 1);
        return {LoopKey::kPlane | static_cast<std::uint64_t>(code) << 58 |
                static_cast<std::uint64_t>(level) << 55 |
                static_cast<std::uint64_t>(offset + (std::int64_t{1} << 53))};
    }
    std::array<int, 3> normal() const {
        const int code = static_cast<int>(word >> 58 & 31);
        return {code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
    }
    int level() const { return static_cast<int>(word >> 55 & 7); }
};

/// The box whose faces a loop runs on: its low corner, as far as it tells where the loop's vertices
/// lie against it, and its sides (at most 16 cells).
struct BoxKey {
    std::uint64_t word = 0;

    static LoopKey make(const Index3& low, const std::array<int, 3>& size) {
        std::uint64_t word = 0;
        for (int a = 0; a < 3; ++a) {
            word |= (static_cast<std::uint64_t>(low[a]) & 31) << 10 * a;
            word |= static_cast<std::uint64_t>(size[a]) << (10 * a + 5);
        }
        return {word};
    }
    /// How far the lattice position `at` (within the box) lies above its low corner.
    int above(int axis, std::int64_t at) const {
        return static_cast<int>((static_cast<std::uint64_t>(at) - (word >> 10 * axis)) & 31);
    }
    int size(int axis) const { return static_cast<int>(word >> (10 * axis + 5) & 31); }
};

/// A lattice edge as one word: lattice position (20 bits an axis) and axis.
struct EdgeKey {
    std::uint64_t word = 0;
    static constexpr std::int64_t kMaximumExtent = (1 << 20) - 64;  ///< samples along an axis

    static EdgeKey make(const Index3& p, int axis) {
        return {static_cast<std::uint64_t>(p[0]) | static_cast<std::uint64_t>(p[1]) << 20 |
                static_cast<std::uint64_t>(p[2]) << 40 | static_cast<std::uint64_t>(axis) << 60};
    }
    std::int64_t position(int axis) const {
        return static_cast<std::int64_t>(word >> 20 * axis & 0xFFFFF);
    }
    int axis() const { return static_cast<int>(word >> 60); }

    /// In sample indices, `offset` being the lattice position of sample 0.
    LatticeEdge latticeEdge(std::int64_t offset) const {
        return {{position(0) - offset, position(1) - offset, position(2) - offset}, axis()};
    }
};

/// All loops, in terms of the vertices that remain, numbered 0 .. vertices.size().
template <class Id>
struct SurfaceLoops {
    int blockSize = 0;              ///< N: size of the boxes of level 0
    std::vector<LoopKey> keys;      ///< of each loop
    std::vector<Id> firstCorner;    ///< of each loop in `corners`, and the end
    std::vector<Id> corners;        ///< vertices of all loops; the inside runs to their left
    std::vector<EdgeKey> vertices;  ///< the lattice edge that each vertex lies on

    std::size_t count() const { return keys.size(); }
};

/// Follows the boundaries of merged facets across boxes and blocks, and drops the vertices that no
/// loop needs (thesis 5.2, 5.4): inside a merged facet; and where exactly two loops pass, each
/// straight on (a merged facet) or within a face of its box (an iso-line loop), one of them at
/// least a merged facet. Both loops at a vertex drop it together, so no crack opens.
template <int N, class Id>
SurfaceLoops<Id> makeSurfaceLoops(BoxSurface<N, Id> surface);

}  // namespace adaptiso::detail
