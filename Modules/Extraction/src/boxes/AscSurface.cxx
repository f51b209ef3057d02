#include "boxes/AscSurface.h"

#include <algorithm>
#include <span>

#include "adaptiso/Core/Parallel.h"
#include "boxes/AscBoxes.h"
#include "boxes/BoxCensus.h"
#include "lattice/BlockVertices.h"
#include "loops/IsoLineLoops.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kChunkBlocks = 256;

/// Record of an active block.
template <int N, class Id>
struct AscBlock : BlockVertices<N, Id> {
    std::uint32_t firstBox = 0;  ///< in the chunk; of the boxes that hold surface
    std::uint32_t boxCount = 0;
};

/// Boxes that hold surface and loops of kChunkBlocks active blocks, block after block.
struct AscChunk {
    std::vector<AscBox> boxes;
    std::vector<LoopKey> keys;               ///< of each loop
    std::vector<std::uint32_t> endCorner;    ///< of each loop, in `corners`
    std::vector<std::uint16_t> corners;      ///< as local edge codes
    std::vector<std::uint32_t> blockCorner;  ///< of each block, the end in `corners`
};

template <int N, class Id>
struct AscSurface {
    const LatticeSampler& sampler;
    const ActiveBlocks& active;
    std::vector<AscBlock<N, Id>> blocks;
    std::vector<AscChunk> chunks;

    Index3 firstSample(std::int64_t block) const {
        return active.grid().firstSample(active.block(block));
    }
    /// Lattice position (>= 0) of a block's first sample.
    Index3 latticeOrigin(std::int64_t block) const {
        Index3 p = firstSample(block);
        for (auto& c : p) c += active.grid().offset;
        return p;
    }
    std::span<const AscBox> boxesOf(std::int64_t block) const {
        const AscBlock<N, Id>& record = blocks[block];
        return {chunks[block / kChunkBlocks].boxes.data() + record.firstBox, record.boxCount};
    }
};

/// No surface passes a box whose corners agree: it is simple, so nothing is lost.
template <int N>
bool isEmpty(const BlockSamples<N>& samples, const AscBox& box) {
    const bool first = samples.inside(box.low[0], box.low[1], box.low[2]);
    for (int c = 1; c < kBoxCorners; ++c) {
        const std::array<int, 3> corner{box.low[0] + (c & 1) * box.size[0],
                                        box.low[1] + (c >> 1 & 1) * box.size[1],
                                        box.low[2] + (c >> 2) * box.size[2]};
        if (samples.inside(corner) != first) return false;
    }
    return true;
}

/// Which box a cell belongs to: of a block's N^3 cells, or of its N^2 cells at one face.
template <int N>
class BoxMap {
public:
    void readBlock(std::span<const AscBox> boxes) {
        boxes_ = boxes;
        numbers_.assign(std::size_t{N} * N * N, kEmpty);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const AscBox& box = boxes[i];
            for (int z = box.low[2]; z < box.low[2] + box.size[2]; ++z) {
                fill(box, 0, 1, i, std::size_t{N} * N * z);
            }
        }
    }
    /// \param side  0: the cells of lowest position along `axis`, 1: of highest
    void readFace(std::span<const AscBox> boxes, int axis, int side) {
        boxes_ = boxes;
        numbers_.assign(std::size_t{N} * N, kEmpty);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const AscBox& box = boxes[i];
            const bool touches =
                side == 0 ? box.low[axis] == 0 : box.low[axis] + box.size[axis] == N;
            if (touches) fill(box, axisAfter(axis, 1), axisAfter(axis, 2), i, 0);
        }
    }

    /// The box at (x, y, z) of the block, or at (u, v, 0) of the face; null where no surface passes
    /// it.
    const AscBox* find(int x, int y, int z) const {
        const std::uint16_t number = numbers_[x + N * (y + N * z)];
        return number == kEmpty ? nullptr : &boxes_[number];
    }

private:
    static constexpr std::uint16_t kEmpty = 0xFFFF;

    void fill(const AscBox& box, int u, int v, std::size_t number, std::size_t offset) {
        for (int b = box.low[v]; b < box.low[v] + box.size[v]; ++b) {
            const auto row = numbers_.begin() + static_cast<std::ptrdiff_t>(offset) + N * b;
            std::fill_n(row + box.low[u], box.size[u], static_cast<std::uint16_t>(number));
        }
    }

    std::span<const AscBox> boxes_;
    std::vector<std::uint16_t> numbers_;
};

template <int N, class Id>
void climbBlocks(AscSurface<N, Id>& surface) {
    const std::int64_t count = surface.active.count();
    parallelForPieces(count, kChunkBlocks, [&](std::int64_t begin, std::int64_t end) {
        AscChunk& chunk = surface.chunks[begin / kChunkBlocks];
        std::vector<AscBox> boxes;
        for (std::int64_t b = begin; b < end; ++b) {
            AscBlock<N, Id>& block = surface.blocks[b];
            const Index3 first = surface.firstSample(b);
            const BlockSamples<N> samples(surface.sampler, first);
            boxes.clear();
            SkeletonClimber<N>(samples, cellsInVolume<N>(surface.active.grid(), first))
                .findBoxes(boxes);
            block.firstBox = static_cast<std::uint32_t>(chunk.boxes.size());
            for (const AscBox& box : boxes) {
                if (!isEmpty(samples, box)) chunk.boxes.push_back(box);
            }
            block.boxCount = static_cast<std::uint32_t>(chunk.boxes.size()) - block.firstBox;
        }
    });
}

/// Sums over the boxes of a chunk.
template <int N>
struct AscTally {
    std::array<BoxCount, N + 1> counts{};  ///< by longest side
    std::int64_t boxesChangingTopology = 0;
    std::int64_t marchingCubesTriangles = 0;
};

/// Works out the loops of one block's boxes after the other, and marks the vertices they use.
template <int N, class Id>
class LoopWorker {
public:
    LoopWorker(AscSurface<N, Id>& surface, AscChunk& chunk) : surface_(surface), chunk_(chunk) {}

    AscTally<N> tally;

    /// Appends the loops of the block's boxes.
    void work(std::int64_t block) {
        block_ = block;
        const Index3 first = surface_.firstSample(block);
        for (int face = 0; face < kBoxFaces; ++face) {
            std::array<int, 3> steps{};
            steps[face / 2] = face & 1 ? 1 : -1;
            const std::int64_t neighbour = surface_.active.neighbour(block, steps);
            isActive_[face] = neighbour != ActiveBlocks::kNone;
            if (isActive_[face]) {
                beyond_[face].readFace(surface_.boxesOf(neighbour), face / 2, face & 1 ? 0 : 1);
            }
        }
        own_.readBlock(surface_.boxesOf(block));
        owners_ = VertexOwners(surface_.active, block);
        cells_ = cellsInVolume<N>(surface_.active.grid(), first);
        isOpen_ = surface_.active.grid().border == Border::Open;
        for (int axis = 0; axis < 3; ++axis) {
            isLast_[axis] =
                first[axis] + cells_[axis] + 1 == surface_.active.grid().volumeSize[axis];
        }
        const BlockSamples<N> samples(surface_.sampler, first);
        for (const AscBox& box : surface_.boxesOf(block)) addBox(samples, box);
        chunk_.blockCorner.push_back(static_cast<std::uint32_t>(chunk_.corners.size()));
    }

private:
    void addBox(const BlockSamples<N>& samples, const AscBox& box) {
        const std::array<int, 3> low{box.low[0], box.low[1], box.low[2]},
            size{box.size[0], box.size[1], box.size[2]};
        bool isShared = false;
        for (int face = 0; face < kBoxFaces; ++face) {
            isShared = addFace(samples, low, size, face) || isShared;
        }
        Index3 latticeLow = surface_.latticeOrigin(block_);
        for (int a = 0; a < 3; ++a) latticeLow[a] += low[a];
        const std::size_t firstCorner = chunk_.corners.size();
        const int loops = isoLines_.takeLoops([&](int code, bool isLast) {
            const VertexOwners::Place place = owners_.template find<N>(EdgeCode<N>::sample(code));
            surface_.blocks[place.block].vertices[EdgeCode<N>::axis(code)].setShared(place.cell);
            chunk_.corners.push_back(static_cast<std::uint16_t>(code));
            if (!isLast) return;
            chunk_.endCorner.push_back(static_cast<std::uint32_t>(chunk_.corners.size()));
            chunk_.keys.push_back(BoxKey::make(latticeLow, size));
        });
        const int longest = *std::max_element(size.begin(), size.end());
        ++(isShared ? tally.counts[longest].shared : tally.counts[longest].unshared);
        if (longest == 1) {  // its loops are those of marching cubes
            tally.marchingCubesTriangles +=
                static_cast<std::int64_t>(chunk_.corners.size() - firstCorner) - 2 * loops;
        } else {
            const BoxCensus census = takeCensus(cases_, samples, low, size, loops);
            tally.marchingCubesTriangles += census.marchingCubesTriangles;
            tally.boxesChangingTopology += census.changesTopology;
        }
    }

    /// Adds the iso-lines of a box's face, rectangle by rectangle: one for each box that the face
    /// touches. Returns whether that divides it. Where no surface passes the other box there is no
    /// iso-line either.
    bool addFace(const BlockSamples<N>& samples, const std::array<int, 3>& low,
                 const std::array<int, 3>& size, int face) {
        const int axis = face / 2, u = axisAfter(axis, 1), v = axisAfter(axis, 2);
        FaceRectangle whole{low, axis, size[u], size[v]};
        if (face & 1) whole.corner[axis] += size[axis];
        const unsigned corners = cornersOf(samples, whole);
        if (corners == 0 || corners == 15) return false;

        const int plane = whole.corner[axis];
        const bool inBlock = (face & 1) != 0 ? plane < N : plane > 0;
        const bool atOpenBorder =
            isOpen_ && ((!inBlock && !isActive_[face]) ||
                        ((face & 1) != 0 && isLast_[axis] && plane == cells_[axis]));
        if (atOpenBorder) {
            isoLines_.add(samples, whole, face);
            return false;
        }
        std::array<int, 3> cell = low;  // beyond the face
        cell[axis] = (face & 1) != 0 ? plane : plane - 1;
        bool isDivided = false;
        const int endU = low[u] + size[u], endV = low[v] + size[v];
        for (cell[v] = low[v]; cell[v] < endV; ++cell[v]) {
            for (cell[u] = low[u]; cell[u] < endU;) {
                const AscBox* const other = inBlock ? own_.find(cell[0], cell[1], cell[2])
                                                    : beyond_[face].find(cell[u], cell[v], 0);
                if (other == nullptr) {
                    ++cell[u];
                    continue;
                }
                const int highU = std::min(endU, other->low[u] + other->size[u]);
                if (cell[v] == std::max<int>(low[v], other->low[v])) {
                    const int highV = std::min(endV, other->low[v] + other->size[v]);
                    FaceRectangle part = whole;
                    part.corner[u] = cell[u];
                    part.corner[v] = cell[v];
                    part.sizeU = highU - cell[u];
                    part.sizeV = highV - cell[v];
                    isDivided = isDivided || part.sizeU < size[u] || part.sizeV < size[v];
                    isoLines_.add(samples, part, face);
                }
                cell[u] = highU;
            }
        }
        return isDivided;
    }

    AscSurface<N, Id>& surface_;
    AscChunk& chunk_;
    const BoxCases& cases_ = BoxCases::instance();
    std::int64_t block_ = 0;
    BoxMap<N> own_;
    std::array<BoxMap<N>, kBoxFaces> beyond_;  ///< the cells beyond each face of the block
    std::array<bool, kBoxFaces> isActive_{};   ///< the block beyond it
    VertexOwners owners_;
    std::array<int, 3> cells_{};    ///< of the block that lie in the volume
    std::array<bool, 3> isLast_{};  ///< the volume ends at the last of them
    bool isOpen_ = false;
    IsoLineLoops<N> isoLines_;
};

template <int N, class Id>
void chainLoops(AscSurface<N, Id>& surface, ExtractionStatistics& statistics) {
    std::vector<AscTally<N>> tallies(surface.chunks.size());
    const std::int64_t count = surface.active.count();
    parallelForPieces(count, kChunkBlocks, [&](std::int64_t begin, std::int64_t end) {
        AscChunk& chunk = surface.chunks[begin / kChunkBlocks];
        LoopWorker<N, Id> worker(surface, chunk);
        for (std::int64_t b = begin; b < end; ++b) {
            worker.work(b);
        }
        tallies[begin / kChunkBlocks] = worker.tally;
    });
    for (int side = N; side > 0; --side) {
        BoxCount boxes{side, 0, 0};
        for (const AscTally<N>& tally : tallies) {
            boxes.shared += tally.counts[side].shared;
            boxes.unshared += tally.counts[side].unshared;
        }
        statistics.boxes.push_back(boxes);
    }
    for (const AscTally<N>& tally : tallies) {
        statistics.boxesChangingTopology += tally.boxesChangingTopology;
        statistics.marchingCubesTriangles += tally.marchingCubesTriangles;
    }
}

/// Numbers the vertices by block, axis and cell, and says which lattice edge each lies on.
template <int N, class Id>
void numberVertices(AscSurface<N, Id>& surface, std::vector<EdgeKey>& vertices) {
    Id total = 0;
    for (AscBlock<N, Id>& block : surface.blocks) {
        block.firstVertex = total;
        for (const auto& bits : block.vertices) total += static_cast<Id>(bits.count());
    }
    vertices.resize(total);
    const std::int64_t count = surface.active.count();
    parallelForPieces(count, kChunkBlocks, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t b = begin; b < end; ++b) {
            const Index3 origin = surface.latticeOrigin(b);
            Id number = surface.blocks[b].firstVertex;
            for (int axis = 0; axis < 3; ++axis) {
                surface.blocks[b].vertices[axis].forEach([&](int cell) {
                    const Index3 p{origin[0] + cell % N, origin[1] + cell / N % N,
                                   origin[2] + cell / (N * N)};
                    vertices[number++] = EdgeKey::make(p, axis);
                });
            }
        }
    });
}

/// Puts the chunks' loops together, with vertex numbers for local codes.
template <int N, class Id>
void gatherLoops(const AscSurface<N, Id>& surface, SurfaceLoops<Id>& loops) {
    std::vector<std::size_t> firstLoop{0}, firstCorner{0};
    for (const AscChunk& chunk : surface.chunks) {
        firstLoop.push_back(firstLoop.back() + chunk.keys.size());
        firstCorner.push_back(firstCorner.back() + chunk.corners.size());
    }
    loops.keys.resize(firstLoop.back());
    loops.firstCorner.resize(firstLoop.back() + 1);
    loops.corners.resize(firstCorner.back());
    const std::int64_t count = surface.active.count();
    parallelForPieces(count, kChunkBlocks, [&](std::int64_t begin, std::int64_t end) {
        const std::size_t c = static_cast<std::size_t>(begin / kChunkBlocks);
        const AscChunk& chunk = surface.chunks[c];
        std::copy(chunk.keys.begin(), chunk.keys.end(),
                  loops.keys.begin() + static_cast<std::ptrdiff_t>(firstLoop[c]));
        for (std::size_t l = 0; l < chunk.keys.size(); ++l) {
            loops.firstCorner[firstLoop[c] + l + 1] =
                static_cast<Id>(firstCorner[c] + chunk.endCorner[l]);
        }
        std::size_t i = 0;
        for (std::int64_t b = begin; b < end; ++b) {
            const VertexOwners owners(surface.active, b);
            for (; i < chunk.blockCorner[b - begin]; ++i) {
                const int code = chunk.corners[i];
                const VertexOwners::Place place =
                    owners.template find<N>(EdgeCode<N>::sample(code));
                loops.corners[firstCorner[c] + i] =
                    surface.blocks[place.block].vertex(EdgeCode<N>::axis(code), place.cell);
            }
        }
    });
}

}  // namespace

template <int N, class Id>
SurfaceLoops<Id> makeAscLoops(const LatticeSampler& sampler, const ActiveBlocks& active,
                              ExtractionStatistics& statistics) {
    AscSurface<N, Id> surface{sampler, active, {}, {}};
    surface.blocks.resize(active.count());
    surface.chunks.resize((active.count() + kChunkBlocks - 1) / kChunkBlocks);
    climbBlocks(surface);
    chainLoops(surface, statistics);
    SurfaceLoops<Id> loops;
    loops.blockSize = N;
    numberVertices(surface, loops.vertices);
    gatherLoops(surface, loops);
    return loops;
}

#define ADAPTISO_INSTANTIATE(N, Id)                                                           \
    template SurfaceLoops<Id> makeAscLoops<N, Id>(const LatticeSampler&, const ActiveBlocks&, \
                                                  ExtractionStatistics&);
ADAPTISO_FOR_EACH_BLOCK_SIZE_AND_ID(ADAPTISO_INSTANTIATE)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
