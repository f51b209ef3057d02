#include "adaptive/bricks/SampleNumbers.h"

namespace adaptiso::detail {
namespace {

/// Calls f(block, first vertex, last vertex + 1) for the blocks of a brick that were meshed.
template <class F>
void forEachBlock(const FineSurface& fine, const F& f) {
    for (std::size_t i = 0; i < fine.blocks.size(); ++i) {
        const bool isLast = i + 1 == fine.blocks.size();
        f(fine.blocks[i], fine.blocks[i].firstVertex,
          isLast ? fine.ownVertices : fine.blocks[i + 1].firstVertex);
    }
}

}  // namespace

void SampleNumbers::ofWhole(std::int64_t brick, const FineSurface& fine,
                            std::vector<std::uint32_t>& numbers) {
    numbers.assign(fine.ownVertices, kNone);
    first_[brick].clear();
    std::uint32_t next = 0;
    forEachBlock(fine, [&](const FineSurface::Block&, std::size_t begin, std::size_t end) {
        first_[brick].push_back(next);
        for (std::size_t v = begin; v < end; ++v) {
            if (!fine.vertices[v].isOnWall) numbers[v] = next++;
        }
    });
}

void SampleNumbers::ofPart(std::int64_t brick, const FineSurface& fine,
                           std::vector<std::uint32_t>& numbers) const {
    numbers.assign(fine.ownVertices, kNone);
    forEachBlock(fine, [&](const FineSurface::Block& meshed, std::size_t begin, std::size_t end) {
        const std::uint32_t block = bricks_[brick].blocks[meshed.place];
        std::uint32_t next = first_[brick][meshed.place];
        for (std::size_t v = begin; v < end; ++v) {
            const FineVertex& vertex = fine.vertices[v];
            if (!vertex.isOnWall && comesWith(block, vertex)) numbers[v] = next++;
        }
    });
}

/// Blocks are meshed in ascending order: a vertex comes with the block that holds the lowest of the
/// cells around its lattice edge.
/// \param vertex  not on a wall of the brick
bool SampleNumbers::comesWith(std::uint32_t block, const FineVertex& vertex) const {
    const int axis = vertex.edge.axis();
    if (axis > 2) return true;  // the middle of a cell
    const BlockGrid& grid = bricks_.grid();
    const Index3 first = grid.firstSample(block);
    for (int a = 0; a < 3; ++a) {
        if (a != axis && vertex.edge.position(a) == first[a] + grid.offset) return false;
    }
    return true;
}

}  // namespace adaptiso::detail
