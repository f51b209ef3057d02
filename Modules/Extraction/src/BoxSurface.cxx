#include "BoxSurface.h"

#include <algorithm>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

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

/// What the unit cells of a box add up to.
struct CellCensus {
    std::int64_t loops = 0;
    std::int64_t corners = 0;  ///< vertices of all loops
};

/// Works out one block: its boxes, each one's case or loops, the vertices they use.
template <int N, class Id>
class BlockWorker {
public:
    explicit BlockWorker(BoxSurface<N, Id>& surface) : surface_(surface) {
        next_.assign(EdgeCode<N>::kCount, -1);
    }

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
        for (int high = 0; high < 8; ++high) {
            owner_[high] =
                high == 0 ? block_
                          : surface_.active.neighbour(block_, {high & 1, high >> 1 & 1, high >> 2});
        }
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
            boxes.back().boxCase = caseOf(samples, box);
            const BoxCase& boxCase = cases_[boxes.back().boxCase];
            addFacets(samples, box, boxCase);
            loops = boxCase.loopCount;
        }
        takeCensus(samples, box, loops);
    }

    std::uint16_t caseOf(const BlockSamples<N>& samples, const Box& box) const {
        const unsigned corners = samples.corners(box);
        unsigned joined = 0;
        const unsigned ambiguous = cases_.ambiguousFaces(corners);
        for (int face = 0; ambiguous >> face != 0; ++face) {
            if ((ambiguous >> face & 1u) == 0) continue;
            std::array<int, 3> corner{box.x, box.y, box.z};
            if (face & 1) corner[face / 2] += box.size;
            joined |= static_cast<unsigned>(samples.insideJoins(corner, face / 2, box.size))
                      << face;
        }
        return cases_.caseIndex(corners, joined);
    }

    /// Facets of discretized marching cubes for an unshared box (thesis 5.2).
    void addFacets(const BlockSamples<N>& samples, const Box& box, const BoxCase& boxCase) {
        std::array<int, kBoxEdges> code;
        code.fill(-1);
        for (int h = 0; h < boxCase.halfEdgeCount; ++h) {
            const int edge = boxCase.halfEdge[h].edge;
            if (code[edge] < 0) {
                const int corner = lowCorner(edge);
                code[edge] =
                    use(samples,
                        {box.x + (corner & 1) * box.size, box.y + (corner >> 1 & 1) * box.size,
                         box.z + (corner >> 2) * box.size},
                        edgeAxis(edge), box.size);
            }
            halfEdges.push_back({static_cast<Id>(code[edge])});
        }
    }

    /// Marks the vertex on a stretch of a lign as used and returns its local code.
    int use(const BlockSamples<N>& samples, std::array<int, 3> p, int axis, int length) {
        p[axis] = samples.crossingOn(p, axis, length);
        int high = 0;
        std::array<int, 3> q = p;
        for (int a = 0; a < 3; ++a) {
            if (q[a] == N) {
                q[a] = 0;
                high |= 1 << a;
            }
        }
        surface_.blocks[owner_[high]].vertices[axis].setShared(q[0] + N * (q[1] + N * q[2]));
        return EdgeCode<N>::encode(p, axis);
    }

    /// Iso-line loops of a shared box (thesis 5.1): every face is cut into squares by the boxes
    /// behind it, every square gives its iso-lines, the iso-lines chain into loops.
    int addIsoLineLoops(const BlockSamples<N>& samples, const Box& box) {
        starts_.clear();
        for (int face = 0; face < kBoxFaces; ++face) processSquare(samples, box, face);
        int loops = 0;
        for (const int start : starts_) {
            if (next_[start] < 0) continue;
            ++loops;
            int code = start;
            do {
                HalfEdge<Id> half{static_cast<Id>(code)};
                if (isInFace(box, code)) half.markInFace();
                halfEdges.push_back(half);
                code = std::exchange(next_[code], -1);
            } while (code != start);
            halfEdges.back().markLast();
        }
        return loops;
    }

    /// The thesis's Pro_Squares: `square` is a box whose face is the square; starts as the box.
    void processSquare(const BlockSamples<N>& samples, const Box& square, int face) {
        if (!isDivided(behind(square, face))) {
            addIsoLines(samples, square, face);
            return;
        }
        const int half = square.size / 2;
        const int axis = face / 2, u = axisAfter(axis, 1), v = axisAfter(axis, 2);
        for (int quarter = 0; quarter < 4; ++quarter) {
            std::array<int, 3> p{square.x, square.y, square.z};
            if (face & 1) p[axis] += half;
            p[u] += (quarter & 1) * half;
            p[v] += (quarter >> 1) * half;
            processSquare(samples, {p[0], p[1], p[2], half}, face);
        }
    }

    void addIsoLines(const BlockSamples<N>& samples, const Box& square, int face) {
        const int axis = face / 2, u = axisAfter(axis, 1), v = axisAfter(axis, 2), s = square.size;
        std::array<int, 3> corner{square.x, square.y, square.z};
        if (face & 1) corner[axis] += s;
        const auto at = [&](int a, int b) {
            std::array<int, 3> p = corner;
            p[u] += a * s;
            p[v] += b * s;
            return p;
        };
        unsigned corners = 0;
        for (int c = 0; c < 4; ++c) {
            corners |= static_cast<unsigned>(samples.inside(at(c & 1, c >> 1))) << c;
        }
        const bool joined = isAmbiguous(corners) && samples.insideJoins(corner, axis, s);
        const SquareIsoLines lines = squareIsoLines(corners, joined);
        for (int i = 0; i < lines.count; ++i) {
            const auto vertexOn = [&](int side) {
                return use(samples, at(side == 1, side == 2), side % 2 == 0 ? u : v, s);
            };
            int from = vertexOn(lines.lines[i].from), to = vertexOn(lines.lines[i].to);
            if ((face & 1) == 0) std::swap(from, to);
            next_[from] = to;
            starts_.push_back(from);
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

    /// Counts the triangles of the full grid in the box, and whether `loops` discs are the same
    /// surface: its Euler characteristic V - E + F, of vertices on crossed lattice edges, iso-lines
    /// on unit faces and a disc for each loop of a cell, must be the number of loops.
    void takeCensus(const BlockSamples<N>& samples, const Box& box, int loops) {
        CellCensus census;
        for (int z = 0; z < box.size; ++z) {
            for (int y = 0; y < box.size; ++y) {
                for (int x = 0; x < box.size; ++x) {
                    const Box cell{box.x + x, box.y + y, box.z + z, 1};
                    const unsigned corners = samples.corners(cell);
                    if (corners == 0 || corners == 255) continue;
                    const BoxCase& boxCase = box.size == 1 && !boxes.back().isShared()
                                                 ? cases_[boxes.back().boxCase]
                                                 : cases_[caseOf(samples, cell)];
                    census.loops += boxCase.loopCount;
                    census.corners += boxCase.crossedEdges;
                }
            }
        }
        marchingCubesTriangles += census.corners - 2 * census.loops;
        if (box.size == 1) return;

        std::int64_t vertices = 0, onFaces = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const int u = axisAfter(axis, 1), v = axisAfter(axis, 2);
            for (int b = 0; b <= box.size; ++b) {
                for (int a = 0; a <= box.size; ++a) {
                    std::array<int, 3> p{box.x, box.y, box.z}, q;
                    p[u] += a;
                    p[v] += b;
                    q = p;
                    q[axis] += box.size;
                    if (samples.inside(p) == samples.inside(q)) continue;  // simple: one at most
                    ++vertices;
                    onFaces += a == 0 || b == 0 || a == box.size || b == box.size;
                }
            }
        }
        // loops go over inner iso-lines twice, over those on the box's faces (one a vertex) once
        const std::int64_t edges = (census.corners + onFaces) / 2;
        boxesChangingTopology += vertices - edges + census.loops != loops;
    }

    BoxSurface<N, Id>& surface_;
    const BoxCases& cases_ = BoxCases::instance();
    std::int64_t block_ = 0;
    std::array<std::int64_t, kBoxFaces> neighbour_{};
    std::array<std::int64_t, 8> owner_{};  ///< block that owns a vertex, by its sides at N
    std::vector<int> next_;                ///< iso-line from a vertex to the next, by local code
    std::vector<int> starts_;
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
        std::array<std::int64_t, 8> owner{};
        forEachBox(
            surface, begin, end, [&](std::int64_t b, const BoxRecord&, auto* half, auto* last) {
                if (b != ownersOf) {
                    for (int high = 0; high < 8; ++high) {
                        owner[high] = high == 0 ? b
                                                : surface.active.neighbour(
                                                      b, {high & 1, high >> 1 & 1, high >> 2});
                    }
                    ownersOf = b;
                }
                for (; half != last; ++half) {
                    const int code = static_cast<int>(half->vertex());
                    std::array<int, 3> p = EdgeCode<N>::sample(code);
                    int high = 0;
                    for (int a = 0; a < 3; ++a) {
                        if (p[a] == N) {
                            p[a] = 0;
                            high |= 1 << a;
                        }
                    }
                    half->setVertex(surface.blocks[owner[high]].vertex(
                        EdgeCode<N>::axis(code), p[0] + N * (p[1] + N * p[2])));
                }
            });
    });
}

/// Merging (thesis 5.2): facets of the same incidence and resolution that meet on a face are one.
template <int N, class Id>
void eraseMergedHalfEdges(BoxSurface<N, Id>& surface) {
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
                                 Division division) {
    const std::int64_t count = active.count();
    BoxSurface<N, Id> surface{sampler, std::move(active), {}, {}, 0, {}, 0, 0};
    surface.blocks.resize(count);
    surface.chunks.resize((count + surface.kChunkBlocks - 1) / surface.kChunkBlocks);
    divideBlocks(surface, division);
    fillBoxes(surface);
    if (division == Division::Unit) surface.boxCounts = {surface.boxCounts.back()};
    numberVertices(surface);
    resolveVertices(surface);
    eraseMergedHalfEdges(surface);
    return surface;
}

#define ADAPTISO_INSTANTIATE(N, Id)                                                       \
    template BoxSurface<N, Id> makeBoxSurface<N, Id>(const LatticeSampler&, ActiveBlocks, \
                                                     Division);                           \
    template HalfEdgeRef twinAcrossFace<N, Id>(const BoxSurface<N, Id>&, const HalfEdgeRef&);
ADAPTISO_INSTANTIATE(2, std::uint32_t)
ADAPTISO_INSTANTIATE(4, std::uint32_t)
ADAPTISO_INSTANTIATE(8, std::uint32_t)
ADAPTISO_INSTANTIATE(16, std::uint32_t)
ADAPTISO_INSTANTIATE(2, std::uint64_t)
ADAPTISO_INSTANTIATE(4, std::uint64_t)
ADAPTISO_INSTANTIATE(8, std::uint64_t)
ADAPTISO_INSTANTIATE(16, std::uint64_t)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
