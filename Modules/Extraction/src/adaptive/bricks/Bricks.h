#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "adaptiso/SpanSpace/BlockGrid.h"
#include "adaptiso/SurfaceProof/ZeroedTable.h"
#include "lattice/LatticeSampler.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso::detail {

/// A cube of blocks, worked on as one: what is made of it fits a processor's cache.
struct Brick {
    static constexpr int kSide = 32;  ///< cells

    Index3 low{};                       ///< lattice position of its first sample
    std::vector<std::uint32_t> blocks;  ///< active ones, ascending
};

/// The bricks that hold active blocks.
class Bricks {
public:
    Bricks(const BlockGrid& grid, const std::vector<std::uint32_t>& blocks);

    const BlockGrid& grid() const { return grid_; }
    std::int64_t count() const { return static_cast<std::int64_t>(bricks_.size()); }
    const Brick& operator[](std::int64_t number) const { return bricks_[number]; }

private:
    BlockGrid grid_;
    std::vector<Brick> bricks_;
};

/// A vertex of the full-resolution surface.
struct FineVertex {
    Vec3 index;    ///< where it lies, continuous sample indices
    EdgeKey edge;  ///< lattice edge that it lies on; none (axis 3) for the middle of a cell
    bool isOnWall = false;  ///< may belong to a neighbouring brick too
    /// Around the vertex, a cell and more on every side, the surface is one sheet seen from some
    /// direction: no other part of it comes near.
    bool isSingleSheet = true;
    /// From here to where the surface crosses the line of the lattice edge again, on the other side
    /// of the nearer sample, in steps of the lattice; kNoGap where it does not.
    float gap = kNoGap;

    static constexpr float kNoGap = 2;
};

/// The marching cubes surface within a brick, as the method mc makes it.
struct FineSurface {
    std::vector<FineVertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< outward in index space

    /// Loops filled from their middle, which takes two triangles more than the table's.
    std::int64_t middles = 0;

    std::int64_t cellsSeen = 0, cellsCrossed = 0;  ///< of the active blocks
};

/// Makes fine surfaces brick by brick; keeps its working memory between them.
class BrickMesher {
public:
    /// \param findsSheets  false: FineVertex::isSingleSheet means nothing
    BrickMesher(const LatticeSampler& sampler, const BlockGrid& grid, bool findsSheets = true);

    /// All but FineVertex::gap. The same brick always gives the same vertices and triangles in the
    /// same order.
    void mesh(const Brick& brick, FineSurface& surface);

    /// Adds the gaps. \pre mesh() made the surface, last and of this brick
    void findGaps(const Brick& brick, FineSurface& surface) const;

private:
    void meshBlock(const Brick& brick, std::uint32_t block, FineSurface& surface);
    std::array<int, 3> cellsOf(std::uint32_t block) const;
    std::uint32_t vertexOn(const Brick& brick, const std::array<int, 3>& cell, int edge,
                           bool isSingle, FineSurface& surface);
    unsigned joinedFaces(const Index3& sample, unsigned ambiguous) const;
    float gapOf(const Brick& brick, const FineSurface& surface, const FineVertex& vertex) const;

    const LatticeSampler& sampler_;
    const BlockGrid& grid_;
    bool findsSheets_;
    ZeroedTable vertexOnEdge_;        ///< number + 1, of the last brick
    std::vector<std::size_t> slots_;  ///< of it that are not 0
    std::vector<std::uint32_t> rows_;
};

}  // namespace adaptiso::detail
