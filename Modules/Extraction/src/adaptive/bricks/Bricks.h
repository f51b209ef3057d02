#pragma once

#include <cstdint>
#include <functional>
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

    static constexpr std::int64_t kNone = -1;

    const BlockGrid& grid() const { return grid_; }
    std::int64_t count() const { return static_cast<std::int64_t>(bricks_.size()); }
    const Brick& operator[](std::int64_t number) const { return bricks_[number]; }

    /// The brick at a place (lattice position / Brick::kSide), or kNone.
    std::int64_t at(const Index3& place) const;

private:
    BlockGrid grid_;
    Index3 places_{};
    std::vector<std::int64_t> numberAt_;
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
    std::size_t middles = 0;

    std::int64_t cellsSeen = 0, cellsCrossed = 0;  ///< of the active blocks
};

/// Makes fine surfaces brick by brick; keeps its working memory between them.
class BrickMesher {
public:
    explicit BrickMesher(const LatticeSampler& sampler, const BlockGrid& grid);

    /// The same brick always gives the same vertices and triangles in the same order.
    /// \param wantsGaps  asked of the surface with all but FineVertex::gap; these are looked for
    ///                   where it says so
    void mesh(const Brick& brick, const std::function<bool(const FineSurface&)>& wantsGaps,
              FineSurface& surface);

    /// The same with all gaps.
    void mesh(const Brick& brick, FineSurface& surface);

    /// The same, when nobody asks for FineVertex::isSingleSheet and FineVertex::gap.
    void meshWithoutSheets(const Brick& brick, FineSurface& surface);

private:
    void meshBlock(const Brick& brick, std::uint32_t block, FineSurface& surface);
    std::array<int, 3> cellsOf(std::uint32_t block) const;
    std::uint32_t vertexOn(const Brick& brick, const std::array<int, 3>& cell, int edge,
                           bool isSingle, FineSurface& surface);
    unsigned joinedFaces(const Index3& sample, unsigned ambiguous) const;
    void findGaps(const Brick& brick, FineSurface& surface) const;
    float gapOf(const Brick& brick, const FineSurface& surface, const FineVertex& vertex) const;
    void forget(const Brick& brick, const FineSurface& surface);

    const LatticeSampler& sampler_;
    const BlockGrid& grid_;
    bool findsSheets_ = true;
    ZeroedTable vertexOnEdge_;  ///< number + 1
    std::vector<std::uint32_t> rows_;
};

}  // namespace adaptiso::detail
