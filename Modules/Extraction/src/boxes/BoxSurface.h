#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Extraction/detail/BoxCases.h"
#include "boxes/SimpleBoxes.h"
#include "lattice/ActiveBlocks.h"
#include "lattice/Bits.h"
#include "lattice/BlockSamples.h"
#include "lattice/BlockVertices.h"
#include "lattice/LatticeSampler.h"

/// Calls a macro with every block size and type of ids: for explicit instantiations.
#define ADAPTISO_FOR_EACH_BLOCK_SIZE_AND_ID(macro)                               \
    macro(2, std::uint32_t) macro(4, std::uint32_t) macro(8, std::uint32_t)      \
        macro(16, std::uint32_t) macro(2, std::uint64_t) macro(4, std::uint64_t) \
            macro(8, std::uint64_t) macro(16, std::uint64_t)

namespace adaptiso::detail {

/// A half-edge of the surface before merging: the vertex where it starts, and two marks. While a
/// block is worked on the vertex is a local code, afterwards its number.
template <class Id>
struct HalfEdge {
    static constexpr Id kMarkA = Id{1} << (8 * sizeof(Id) - 1);
    static constexpr Id kMarkB = Id{1} << (8 * sizeof(Id) - 2);

    Id word = 0;

    Id vertex() const { return word & ~(kMarkA | kMarkB); }
    void setVertex(Id v) { word = (word & (kMarkA | kMarkB)) | v; }

    // of an unshared box
    bool isErased() const { return word & kMarkA; }  ///< merged with the facet beyond
    void erase() { word |= kMarkA; }
    bool isVisited() const { return word & kMarkB; }
    void visit() { word |= kMarkB; }

    // of a shared box
    bool isLast() const { return word & kMarkA; }  ///< of its loop
    void markLast() { word |= kMarkA; }
    bool isInFace() const { return word & kMarkB; }  ///< starts within a face, not on a box edge
    void markInFace() { word |= kMarkB; }
};

/// A simple box that the surface passes through.
struct BoxRecord {
    static constexpr std::uint16_t kShared = 0xFFFF;

    std::uint32_t firstHalfEdge;  ///< in the chunk
    std::uint16_t boxCase;        ///< of BoxCases, or kShared: its half-edges are iso-line loops
    std::uint16_t place;          ///< low cell in the block (12 bits), level (3 bits)

    bool isShared() const { return boxCase == kShared; }
    int cell() const { return place & 0xFFF; }
    int level() const { return place >> 12; }
};

/// Record of an active block.
template <int N, class Id>
struct BlockRecord : BlockVertices<N, Id> {
    BoxTree<N> tree;
    Bits<N * N * N> boxes;  ///< low cells of the boxes that hold surface
};

/// Boxes and half-edges of kChunkBlocks active blocks.
template <class Id>
struct Chunk {
    std::vector<std::uint32_t> firstBox;  ///< per block, and the end
    std::vector<BoxRecord> boxes;
    std::vector<HalfEdge<Id>> halfEdges;
};

/// The isosurface as simple boxes with the facets and loops in them: every half-edge has its
/// vertex, and half-edges between facets that merge are erased.
template <int N, class Id>
struct BoxSurface {
    static constexpr int kChunkBlocks = 256;
    static constexpr int kCells = N * N * N;

    const LatticeSampler& sampler;
    ActiveBlocks active;
    std::vector<BlockRecord<N, Id>> blocks;
    std::vector<Chunk<Id>> chunks;
    Id vertexCount = 0;
    std::vector<BoxCount> boxCounts;
    std::int64_t boxesChangingTopology = 0;
    std::int64_t marchingCubesTriangles = 0;

    static Box boxOf(const BoxRecord& record) {
        const int c = record.cell();
        return {c % N, c / N % N, c / (N * N), N >> record.level()};
    }
    static int cellOf(const Box& box) { return box.x + N * (box.y + N * box.z); }

    /// Lattice position (>= 0) of a block's first sample.
    Index3 latticeOrigin(std::int64_t block) const {
        Index3 p = active.grid().firstSample(active.block(block));
        for (auto& c : p) c += active.grid().offset;
        return p;
    }

    const BoxRecord* findBox(std::int64_t block, int cell) const {
        const auto& boxes = blocks[block].boxes;
        if (!boxes.test(cell)) return nullptr;
        const Chunk<Id>& chunk = chunks[block / kChunkBlocks];
        return &chunk.boxes[chunk.firstBox[block % kChunkBlocks] + boxes.rank(cell)];
    }
};

/// A half-edge of an unshared box, by its box and its number in the box's case.
struct HalfEdgeRef {
    std::int64_t block = ActiveBlocks::kNone;
    const BoxRecord* box = nullptr;
    int half = 0;

    friend bool operator==(const HalfEdgeRef&, const HalfEdgeRef&) = default;
};

/// The half-edge of the unshared box of equal size behind the face that `ref` runs on; its box is
/// null where there is no such box.
template <int N, class Id>
HalfEdgeRef twinAcrossFace(const BoxSurface<N, Id>& surface, const HalfEdgeRef& ref);

/// Division of blocks: boxes as large as they are simple, or unit boxes.
enum class Division { Simple, Unit };

/// How far facets merge: as far as they agree, or not beyond the faces of their block.
enum class MergeReach { Surface, Block };

/// Builds it (thesis, chapters 4, 5.1, 5.2). The statistics of unit boxes tell of no other sizes.
template <int N, class Id>
BoxSurface<N, Id> makeBoxSurface(const LatticeSampler& sampler, ActiveBlocks active,
                                 Division division, MergeReach reach = MergeReach::Surface);

}  // namespace adaptiso::detail
