#include "boxes/BoxSurface.h"

#include <algorithm>

#include "adaptiso/Core/Parallel.h"
#include "boxes/BoxCensus.h"
#include "loops/IsoLineLoops.h"

namespace adaptiso::detail {
namespace {

/// Works out one block: its boxes, each one's case or loops, the vertices they use.
template <int N, class Id>
class BlockWorker {
public:
    explicit BlockWorker(BoxSurface<N, Id>& surface) : surface_(surface) {}

    std::vector<BoxRecord> boxes;
    std::vector<HalfEdge<Id>> halfEdges;
    std::array<BoxCount, BoxTree<N>::kLevels + 1> counts{};  ///< by level
    std::int64_t boxesChangingTopology = 0;
    std::int64_t marchingCubesTriangles = 0;

    /// Appends the block's boxes and half-edges (with local codes), marks vertices in use.
    void work(std::int64_t block) {
        block_ = block;
        const Index3 first = surface_.active.grid().firstSample(surface_.active.block(block));
        const BlockSamples<N> samples(surface_.sampler, first);
        findNeighbours();

        const std::array<int, 3> cells = cellsInVolume<N>(surface_.active.grid(), first);
        BlockRecord<N, Id>& record = surface_.blocks[block];
        std::array<std::uint8_t, std::size_t{N} * N * N> sizeAt;
        record.tree.forEachLeaf([&](const Box& box) {
            if (box.x >= cells[0] || box.y >= cells[1] || box.z >= cells[2]) return;
            const unsigned corners = samples.corners(box);
            if (corners == 0 || corners == 255) return;  // simple, so nothing is lost
            const int cell = surface_.cellOf(box);
            record.boxes.set(cell);
            sizeAt[cell] = static_cast<std::uint8_t>(box.size);
        });
        record.boxes.forEach([&](int cell) {
            addBox(samples, {cell % N, cell / N % N, cell / (N * N), sizeAt[cell]});
        });
    }

private:
    void findNeighbours() {
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                std::array<int, 3> steps{};
                steps[axis] = side ? 1 : -1;
                neighbour_[2 * axis + side] = surface_.active.neighbour(block_, steps);
            }
        }
        owners_ = VertexOwners(surface_.active, block_);
    }

    /// Is the box divided? It may lie one box beyond a face of the block.
    bool isDivided(Box box) const {
        std::int64_t block = block_;
        for (int axis = 0; axis < 3; ++axis) {
            int& low = axis == 0 ? box.x : axis == 1 ? box.y : box.z;
            if (low < 0) {
                low += N;
                block = neighbour_[2 * axis + 0];
            } else if (low >= N) {
                low -= N;
                block = neighbour_[2 * axis + 1];
            }
        }
        return block != ActiveBlocks::kNone && surface_.blocks[block].tree.isDivided(box);
    }

    /// The box of the same size behind a face.
    static Box behind(Box box, int face) {
        int& low = face / 2 == 0 ? box.x : face / 2 == 1 ? box.y : box.z;
        low += face & 1 ? box.size : -box.size;
        return box;
    }

    void addBox(const BlockSamples<N>& samples, const Box& box) {
        bool shared = false;
        if (box.size > 1) {
            for (int face = 0; face < kBoxFaces && !shared; ++face) {
                shared = isDivided(behind(box, face));
            }
        }
        const int level = BoxTree<N>::level(box.size);
        boxes.push_back({static_cast<std::uint32_t>(halfEdges.size()), BoxRecord::kShared,
                         static_cast<std::uint16_t>(surface_.cellOf(box) | level << 12)});
        int loops = 0;
        if (shared) {
            ++counts[level].shared;
            loops = addIsoLineLoops(samples, box);
        } else {
            ++counts[level].unshared;
            boxes.back().boxCase = caseOf(cases_, samples, box);
            const BoxCase& boxCase = cases_[boxes.back().boxCase];
            addFacets(samples, box, boxCase);
            loops = boxCase.loopCount;
        }
        if (box.size == 1) {  // nothing is finer: unshared
            marchingCubesTriangles += cases_[boxes.back().boxCase].loopTriangles();
        } else {
            const BoxCensus census = takeCensus(cases_, samples, {box.x, box.y, box.z},
                                                {box.size, box.size, box.size}, loops);
            marchingCubesTriangles += census.marchingCubesTriangles;
            boxesChangingTopology += census.changesTopology;
        }
    }

    /// Facets of discretized marching cubes for an unshared box (thesis 5.2).
    void addFacets(const BlockSamples<N>& samples, const Box& box, const BoxCase& boxCase) {
        std::array<int, kBoxEdges> code;
        code.fill(-1);
        for (int h = 0; h < boxCase.halfEdgeCount; ++h) {
            const int edge = boxCase.halfEdge[h].edge;
            if (code[edge] < 0) {
                const int corner = lowCorner(edge), axis = edgeAxis(edge);
                std::array<int, 3> p{box.x + (corner & 1) * box.size,
                                     box.y + (corner >> 1 & 1) * box.size,
                                     box.z + (corner >> 2) * box.size};
                p[axis] = samples.crossingOn(p, axis, box.size);
                code[edge] = EdgeCode<N>::encode(p, axis);
                use(code[edge]);
            }
            halfEdges.push_back({static_cast<Id>(code[edge])});
        }
    }

    /// Marks the vertex on the lattice edge `code` as used.
    void use(int code) {
        const VertexOwners::Place place = owners_.template find<N>(EdgeCode<N>::sample(code));
        surface_.blocks[place.block].vertices[EdgeCode<N>::axis(code)].setShared(place.cell);
    }

    /// Iso-line loops of a shared box (thesis 5.1): every face is cut into squares by the boxes
    /// behind it, every square gives its iso-lines, the iso-lines chain into loops.
    int addIsoLineLoops(const BlockSamples<N>& samples, const Box& box) {
        for (int face = 0; face < kBoxFaces; ++face) processSquare(samples, box, face);
        return isoLines_.takeLoops([&](int code, bool isLast) {
            use(code);
            HalfEdge<Id> half{static_cast<Id>(code)};
            if (isInFace(box, code)) half.markInFace();
            if (isLast) half.markLast();
            halfEdges.push_back(half);
        });
    }

    /// The thesis's Pro_Squares: `square` is a box whose face is the square; starts as the box.
    void processSquare(const BlockSamples<N>& samples, const Box& square, int face) {
        const int axis = face / 2;
        if (!isDivided(behind(square, face))) {
            std::array<int, 3> corner{square.x, square.y, square.z};
            if (face & 1) corner[axis] += square.size;
            isoLines_.add(samples, {corner, axis, square.size, square.size}, face);
            return;
        }
        const int half = square.size / 2;
        const int u = axisAfter(axis, 1), v = axisAfter(axis, 2);
        for (int quarter = 0; quarter < 4; ++quarter) {
            std::array<int, 3> p{square.x, square.y, square.z};
            if (face & 1) p[axis] += half;
            p[u] += (quarter & 1) * half;
            p[v] += (quarter >> 1) * half;
            processSquare(samples, {p[0], p[1], p[2], half}, face);
        }
    }

    static bool isInFace(const Box& box, int code) {
        const std::array<int, 3> p = EdgeCode<N>::sample(code);
        int onBoundary = 0;
        for (int a = 0; a < 3; ++a) {
            if (a == EdgeCode<N>::axis(code)) continue;
            onBoundary += p[a] == box.low(a) || p[a] == box.low(a) + box.size;
        }
        return onBoundary == 1;
    }

    BoxSurface<N, Id>& surface_;
    const BoxCases& cases_ = BoxCases::instance();
    std::int64_t block_ = 0;
    std::array<std::int64_t, kBoxFaces> neighbour_{};
    VertexOwners owners_;
    IsoLineLoops<N> isoLines_;
};

template <int N, class Id>
void divideBlocks(BoxSurface<N, Id>& surface, Division division) {
    if (division == Division::Unit) {
        for (auto& block : surface.blocks) block.tree = BoxTree<N>::ofUnitBoxes();
        return;
    }
    parallelForPieces(surface.active.count(), 64, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t b = begin; b < end; ++b) {
            const Index3 first = surface.active.grid().firstSample(surface.active.block(b));
            const BlockSamples<N> samples(surface.sampler, first);
            surface.blocks[b].tree =
                makeSimpleBoxes<N>(samples, cellsInVolume<N>(surface.active.grid(), first));
        }
    });
}

template <int N, class Id>
void fillBoxes(BoxSurface<N, Id>& surface) {
    constexpr int kChunk = BoxSurface<N, Id>::kChunkBlocks;
    struct Tally {
        std::array<BoxCount, BoxTree<N>::kLevels + 1> counts{};
        std::int64_t changed = 0, triangles = 0;
    };
    std::vector<Tally> tallies(surface.chunks.size());
    parallelForPieces(surface.active.count(), kChunk, [&](std::int64_t begin, std::int64_t end) {
        BlockWorker<N, Id> worker(surface);
        Chunk<Id>& chunk = surface.chunks[begin / kChunk];
        for (std::int64_t b = begin; b < end; ++b) {
            chunk.firstBox.push_back(static_cast<std::uint32_t>(worker.boxes.size()));
            worker.work(b);
        }
        chunk.firstBox.push_back(static_cast<std::uint32_t>(worker.boxes.size()));
        // copies hold no spare capacity
        chunk.boxes.assign(worker.boxes.begin(), worker.boxes.end());
        chunk.halfEdges.assign(worker.halfEdges.begin(), worker.halfEdges.end());
        tallies[begin / kChunk] = {worker.counts, worker.boxesChangingTopology,
                                   worker.marchingCubesTriangles};
    });
    for (int level = 0; level <= BoxTree<N>::kLevels; ++level) {
        BoxCount count{N >> level, 0, 0};
        for (const Tally& t : tallies) {
            count.shared += t.counts[level].shared;
            count.unshared += t.counts[level].unshared;
        }
        surface.boxCounts.push_back(count);
    }
    for (const Tally& t : tallies) {
        surface.boxesChangingTopology += t.changed;
        surface.marchingCubesTriangles += t.triangles;
    }
}

template <int N, class Id>
void numberVertices(BoxSurface<N, Id>& surface) {
    for (auto& block : surface.blocks) {
        block.firstVertex = surface.vertexCount;
        for (const auto& bits : block.vertices) {
            surface.vertexCount += static_cast<Id>(bits.count());
        }
    }
}

/// Calls f(block, box, its half-edges) for the boxes of a chunk's blocks [begin, end).
template <int N, class Id, class F>
void forEachBox(BoxSurface<N, Id>& surface, std::int64_t begin, std::int64_t end, const F& f) {
    Chunk<Id>& chunk = surface.chunks[begin / BoxSurface<N, Id>::kChunkBlocks];
    for (std::int64_t b = begin; b < end; ++b) {
        const std::int64_t local = b - begin;
        for (std::uint32_t i = chunk.firstBox[local]; i < chunk.firstBox[local + 1]; ++i) {
            const std::size_t last = i + 1 < chunk.boxes.size() ? chunk.boxes[i + 1].firstHalfEdge
                                                                : chunk.halfEdges.size();
            f(b, chunk.boxes[i], chunk.halfEdges.data() + chunk.boxes[i].firstHalfEdge,
              chunk.halfEdges.data() + last);
        }
    }
}

/// Replaces local codes by vertex numbers.
template <int N, class Id>
void resolveVertices(BoxSurface<N, Id>& surface) {
    constexpr int kChunk = BoxSurface<N, Id>::kChunkBlocks;
    parallelForPieces(surface.active.count(), kChunk, [&](std::int64_t begin, std::int64_t end) {
        std::int64_t ownersOf = ActiveBlocks::kNone;
        VertexOwners owners;
        forEachBox(
            surface, begin, end, [&](std::int64_t b, const BoxRecord&, auto* half, auto* last) {
                if (b != ownersOf) {
                    owners = VertexOwners(surface.active, b);
                    ownersOf = b;
                }
                for (; half != last; ++half) {
                    const int code = static_cast<int>(half->vertex());
                    const VertexOwners::Place place =
                        owners.template find<N>(EdgeCode<N>::sample(code));
                    half->setVertex(
                        surface.blocks[place.block].vertex(EdgeCode<N>::axis(code), place.cell));
                }
            });
    });
}

/// Merging (thesis 5.2): facets of the same incidence and resolution that meet on a face are one.
template <int N, class Id>
void eraseMergedHalfEdges(BoxSurface<N, Id>& surface, MergeReach reach) {
    constexpr int kChunk = BoxSurface<N, Id>::kChunkBlocks;
    const BoxCases& cases = BoxCases::instance();
    parallelForPieces(surface.active.count(), kChunk, [&](std::int64_t begin, std::int64_t end) {
        forEachBox(
            surface, begin, end, [&](std::int64_t b, const BoxRecord& box, auto* half, auto*) {
                if (box.isShared()) return;
                const BoxCase& boxCase = cases[box.boxCase];
                for (int h = 0; h < boxCase.halfEdgeCount; ++h) {
                    const CaseHalfEdge& record = boxCase.halfEdge[h];
                    const int incidence = boxCase.facet[record.facet].incidence;
                    if (record.face == kInsideBox || incidence == kNoIncidence) continue;
                    const HalfEdgeRef twin = twinAcrossFace(surface, {b, &box, h});
                    if (twin.box == nullptr) continue;
                    if (reach == MergeReach::Block && twin.block != b) continue;
                    const BoxCase& other = cases[twin.box->boxCase];
                    if (other.facet[other.halfEdge[twin.half].facet].incidence == incidence) {
                        half[h].erase();
                    }
                }
            });
    });
}

/// Side of a face that a box edge is, by [face][edge].
constexpr auto kSideOnFace = [] {
    std::array<std::array<std::uint8_t, kBoxEdges>, kBoxFaces> sides{};
    for (int face = 0; face < kBoxFaces; ++face) {
        for (int side = 0; side < 4; ++side) {
            sides[face][faceEdge(face, side)] = static_cast<std::uint8_t>(side);
        }
    }
    return sides;
}();

}  // namespace

template <int N, class Id>
HalfEdgeRef twinAcrossFace(const BoxSurface<N, Id>& surface, const HalfEdgeRef& ref) {
    const BoxCases& cases = BoxCases::instance();
    const BoxCase& boxCase = cases[ref.box->boxCase];
    const CaseHalfEdge& half = boxCase.halfEdge[ref.half];
    const int axis = half.face / 2;
    Box box = surface.boxOf(*ref.box);
    std::int64_t block = ref.block;
    int& low = axis == 0 ? box.x : axis == 1 ? box.y : box.z;
    low += half.face & 1 ? box.size : -box.size;
    if (low < 0 || low >= N) {
        std::array<int, 3> steps{};
        steps[axis] = low < 0 ? -1 : 1;
        low += low < 0 ? N : -N;
        block = surface.active.neighbour(block, steps);
        if (block == ActiveBlocks::kNone) return {};
    }
    const BoxRecord* other = surface.findBox(block, surface.cellOf(box));
    if (other == nullptr || other->isShared() || other->level() != ref.box->level()) return {};
    const int end = boxCase.halfEdge[half.next].edge;
    return {block, other, cases[other->boxCase].onFace[half.face ^ 1][kSideOnFace[half.face][end]]};
}

template <int N, class Id>
BoxSurface<N, Id> makeBoxSurface(const LatticeSampler& sampler, ActiveBlocks active,
                                 Division division, MergeReach reach) {
    const std::int64_t count = active.count();
    BoxSurface<N, Id> surface{sampler, std::move(active), {}, {}, 0, {}, 0, 0};
    surface.blocks.resize(count);
    surface.chunks.resize((count + surface.kChunkBlocks - 1) / surface.kChunkBlocks);
    divideBlocks(surface, division);
    fillBoxes(surface);
    if (division == Division::Unit) surface.boxCounts = {surface.boxCounts.back()};
    numberVertices(surface);
    resolveVertices(surface);
    eraseMergedHalfEdges(surface, reach);
    return surface;
}

#define ADAPTISO_INSTANTIATE(N, Id)                                                       \
    template BoxSurface<N, Id> makeBoxSurface<N, Id>(const LatticeSampler&, ActiveBlocks, \
                                                     Division, MergeReach);               \
    template HalfEdgeRef twinAcrossFace<N, Id>(const BoxSurface<N, Id>&, const HalfEdgeRef&);
ADAPTISO_FOR_EACH_BLOCK_SIZE_AND_ID(ADAPTISO_INSTANTIATE)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
