#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "lattice/ActiveBlocks.h"
#include "lattice/Bits.h"

namespace adaptiso::detail {

/// A lattice edge within a block as one small number: low sample (0 .. N a side) and axis.
template <int N>
struct EdgeCode {
    static constexpr int kSide = N + 1;
    static constexpr int kCount = 4 * kSide * kSide * kSide;

    static int encode(const std::array<int, 3>& p, int axis) {
        return 4 * (p[0] + kSide * (p[1] + kSide * p[2])) + axis;
    }
    static std::array<int, 3> sample(int code) {
        const int place = code / 4;
        return {place % kSide, place / kSide % kSide, place / (kSide * kSide)};
    }
    static int axis(int code) { return code % 4; }
};

/// Cells of a block that lie in the volume, along each axis: all N, but at an open border.
template <int N>
std::array<int, 3> cellsInVolume(const BlockGrid& grid, const Index3& firstSample) {
    std::array<int, 3> cells{N, N, N};
    if (grid.border == Border::Open) {
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t left = grid.volumeSize[axis] - 1 - firstSample[axis];
            cells[axis] = static_cast<int>(std::min<std::int64_t>(N, left));
        }
    }
    return cells;
}

/// The crossed lattice edges in use that start in a block's N^3 cells: the vertices it owns.
template <int N, class Id>
struct BlockVertices {
    std::array<Bits<N * N * N>, 3> vertices{};  ///< by axis
    Id firstVertex = 0;

    /// Number of the vertex on the lattice edge from `cell` along `axis`.
    Id vertex(int axis, int cell) const {
        int before = 0;
        for (int a = 0; a < axis; ++a) before += vertices[a].count();
        return firstVertex + static_cast<Id>(before + vertices[axis].rank(cell));
    }
};

/// The active blocks that own the lattice edges in and on one block: those of a side at N belong to
/// the block beyond (bit a of an owner's number: beyond along axis a).
class VertexOwners {
public:
    VertexOwners() = default;
    VertexOwners(const ActiveBlocks& active, std::int64_t block) {
        owner_[0] = block;
        for (int high = 1; high < 8; ++high) {
            owner_[high] = active.neighbour(block, {high & 1, high >> 1 & 1, high >> 2});
        }
    }

    struct Place {
        std::int64_t block;  ///< active number
        int cell;
    };
    template <int N>
    Place find(std::array<int, 3> p) const {
        int high = 0;
        for (int a = 0; a < 3; ++a) {
            if (p[a] == N) {
                p[a] = 0;
                high |= 1 << a;
            }
        }
        return {owner_[high], p[0] + N * (p[1] + N * p[2])};
    }

private:
    std::array<std::int64_t, 8> owner_{};
};

}  // namespace adaptiso::detail
