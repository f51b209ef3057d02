#include "loops/SurfaceLoops.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "adaptiso/Core/Memory.h"

namespace adaptiso::detail {
namespace {

/// Use of a vertex by the loops.
struct VertexUse {
    std::uint8_t loops = 0;    ///< passages of loops, capped
    bool needed : 1 = false;   ///< a loop turns here
    bool onPlane : 1 = false;  ///< a merged facet's loop passes
};

template <int N, class Id>
class LoopBuilder {
public:
    explicit LoopBuilder(BoxSurface<N, Id>& surface)
        : surface_(surface), uses_(static_cast<std::size_t>(surface.vertexCount)) {}

    void traceAll() {
        result_.blockSize = N;
        result_.corners.reserve(cornerCount());
        for (std::int64_t b = 0; b < surface_.active.count(); ++b) {
            const Chunk<Id>& chunk = surface_.chunks[b / surface_.kChunkBlocks];
            const std::int64_t local = b % surface_.kChunkBlocks;
            for (std::uint32_t i = chunk.firstBox[local]; i < chunk.firstBox[local + 1]; ++i) {
                const BoxRecord& box = chunk.boxes[i];
                if (box.isShared()) {
                    takeIsoLineLoops(b, box,
                                     i + 1 < chunk.boxes.size() ? chunk.boxes[i + 1].firstHalfEdge
                                                                : chunk.halfEdges.size());
                } else {
                    takeFacets(b, box);
                }
            }
        }
        result_.firstCorner.push_back(static_cast<Id>(result_.corners.size()));
    }

    /// Two edges of the surface that join the same two vertices would be one edge of four
    /// triangles. Only a run of dropped vertices can make such a pair: keeps one of the run.
    void keepEdgesApart() {
        while (keepOnePass()) {
        }
    }

    SurfaceLoops<Id> finish() {
        std::vector<Id> number = numberKept();
        compress(number);
        return std::move(result_);
    }

private:
    using Half = HalfEdge<Id>;
    static constexpr Id kDropped = std::numeric_limits<Id>::max();

    std::size_t cornerCount() const {
        std::size_t count = 0;
        for (const Chunk<Id>& chunk : surface_.chunks) {
            count += chunk.halfEdges.size();
            for (const BoxRecord& box : chunk.boxes) {
                if (box.isShared()) continue;
                const Half* first = &chunk.halfEdges[box.firstHalfEdge];
                for (int h = 0; h < cases_[box.boxCase].halfEdgeCount; ++h) {
                    count -= first[h].isErased();
                }
            }
        }
        return count;
    }

    Half& half(std::int64_t block, const BoxRecord& box, int h) {
        return surface_.chunks[block / surface_.kChunkBlocks].halfEdges[box.firstHalfEdge + h];
    }
    const BoxCase& caseOf(const HalfEdgeRef& ref) const { return cases_[ref.box->boxCase]; }
    bool isDropped(Id v) const {
        const VertexUse& use = uses_[v];
        return !use.needed && use.onPlane && use.loops <= 2;
    }

    void pass(Id vertex, bool straightOn, bool onPlane) {
        VertexUse& use = uses_[vertex];
        if (use.loops < 255) ++use.loops;
        use.needed = use.needed || !straightOn;
        use.onPlane = use.onPlane || onPlane;
    }

    Index3 latticeLow(std::int64_t block, const Box& box) const {
        Index3 p = surface_.latticeOrigin(block);
        for (int a = 0; a < 3; ++a) p[a] += box.low(a);
        return p;
    }

    void beginLoop(LoopKey key) {
        result_.keys.push_back(key);
        result_.firstCorner.push_back(static_cast<Id>(result_.corners.size()));
    }

    void takeIsoLineLoops(std::int64_t block, const BoxRecord& record, std::size_t end) {
        const Chunk<Id>& chunk = surface_.chunks[block / surface_.kChunkBlocks];
        bool starting = true;
        for (std::size_t h = record.firstHalfEdge; h < end; ++h) {
            const Half& half = chunk.halfEdges[h];
            if (starting) beginLoop(boxKey(block, record));
            result_.corners.push_back(half.vertex());
            pass(half.vertex(), half.isInFace(), false);
            starting = half.isLast();
        }
    }

    LoopKey boxKey(std::int64_t block, const BoxRecord& record) const {
        const Box box = surface_.boxOf(record);
        return BoxKey::make(latticeLow(block, box), {box.size, box.size, box.size});
    }

    void takeFacets(std::int64_t block, const BoxRecord& box) {
        const BoxCase& boxCase = cases_[box.boxCase];
        for (int h = 0; h < boxCase.halfEdgeCount; ++h) {
            const Half& start = half(block, box, h);
            if (start.isErased() || start.isVisited()) continue;
            const CaseFacet& facet = boxCase.facet[boxCase.halfEdge[h].facet];
            if (facet.incidence == kNoIncidence) {
                takeOddFacet(block, box, facet);
            } else {
                traceMergedFacet({block, &box, h});
            }
        }
    }

    /// A facet in none of the 13 families stays as it is.
    void takeOddFacet(std::int64_t block, const BoxRecord& box, const CaseFacet& facet) {
        beginLoop(boxKey(block, box));
        for (int i = 0; i < facet.size; ++i) {
            Half& corner = half(block, box, facet.firstHalfEdge + i);
            corner.visit();
            result_.corners.push_back(corner.vertex());
            // at its box's edges it turns, at a vertex on a chord as well
            pass(corner.vertex(), false, false);
        }
    }

    /// Follows the boundary of a merged facet once round (Freeman's chain), from `start`.
    void traceMergedFacet(const HalfEdgeRef& start) {
        beginLoop(planeKey(start));
        std::array<std::int8_t, 3> before{};
        const std::array<std::int8_t, 3> firstDirection = direction(start);
        HalfEdgeRef at = start;
        do {
            Half& current = half(at.block, *at.box, at.half);
            current.visit();
            const Id vertex = current.vertex();
            result_.corners.push_back(vertex);
            const std::array<std::int8_t, 3> along = direction(at);
            if (at != start) pass(vertex, isStraight(before, along), true);
            before = along;
            at = following(at);
        } while (at != start);
        pass(half(start.block, *start.box, start.half).vertex(), isStraight(before, firstDirection),
             true);
    }

    /// The next half-edge on the boundary: the facet's own, or, where that is erased, the one that
    /// follows it in the facet beyond.
    HalfEdgeRef following(HalfEdgeRef at) {
        at.half = caseOf(at).halfEdge[at.half].next;
        while (half(at.block, *at.box, at.half).isErased()) {
            at = twinAcrossFace(surface_, at);
            at.half = caseOf(at).halfEdge[at.half].next;
        }
        return at;
    }

    std::array<std::int8_t, 3> direction(const HalfEdgeRef& ref) const {
        return caseOf(ref).halfEdge[ref.half].direction;
    }

    static bool isStraight(const std::array<std::int8_t, 3>& a,
                           const std::array<std::int8_t, 3>& b) {
        return a[0] * b[1] == a[1] * b[0] && a[1] * b[2] == a[2] * b[1] &&
               a[2] * b[0] == a[0] * b[2] && a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0;
    }

    LoopKey planeKey(const HalfEdgeRef& ref) const {
        const BoxCase& boxCase = caseOf(ref);
        const CaseHalfEdge& half = boxCase.halfEdge[ref.half];
        const auto& n = boxCase.facet[half.facet].normal;
        const Box box = surface_.boxOf(*ref.box);
        const Index3 low = latticeLow(ref.block, box);
        const int corner = lowCorner(half.edge);
        std::int64_t offset = 0;
        for (int a = 0; a < 3; ++a) {
            const std::int64_t mid = a == edgeAxis(half.edge) ? 1 : 2 * (corner >> a & 1);
            offset += n[a] * (2 * low[a] + box.size * mid);
        }
        return PlaneKey::make({n[0], n[1], n[2]}, ref.box->level(), offset);
    }

    // An edge of the loops after dropping, with the smallest vertex dropped on it (kDropped: none).
    struct Run {
        Id a, b, dropped;
    };

    template <class F>
    void forEachRun(const F& f) const {
        for (std::size_t l = 0; l < result_.count(); ++l) {
            const std::size_t first = result_.firstCorner[l], last = result_.firstCorner[l + 1];
            std::size_t start = first;
            while (start < last && isDropped(result_.corners[start])) ++start;
            if (start == last) continue;
            Id from = result_.corners[start], dropped = kDropped;
            for (std::size_t i = 1; i <= last - first; ++i) {
                const std::size_t at = start + i < last ? start + i : start + i - (last - first);
                const Id v = result_.corners[at];
                if (isDropped(v)) {
                    dropped = std::min(dropped, v);
                } else {
                    f(Run{std::min(from, v), std::max(from, v), dropped});
                    from = v;
                    dropped = kDropped;
                }
            }
        }
    }

    bool keepOnePass() {
        // few edges have dropped vertices: only where such a run ends are others compared with it
        std::vector<Run> runs;
        std::vector<bool> endsRun(uses_.size());
        forEachRun([&](const Run& run) {
            if (run.dropped == kDropped) return;
            runs.push_back(run);
            endsRun[run.a] = endsRun[run.b] = true;
        });
        const auto byEnds = [](const Run& p, const Run& q) {
            return std::tie(p.a, p.b, p.dropped) < std::tie(q.a, q.b, q.dropped);
        };
        std::sort(runs.begin(), runs.end(), byEnds);
        std::vector<Id> keep;
        for (std::size_t i = 1; i < runs.size(); ++i) {
            const Run &p = runs[i - 1], &q = runs[i];
            if (p.a == q.a && p.b == q.b && p.dropped != q.dropped) keep.push_back(q.dropped);
        }
        forEachRun([&](const Run& run) {
            if (run.dropped != kDropped || !endsRun[run.a] || !endsRun[run.b]) return;
            const auto at =
                std::lower_bound(runs.begin(), runs.end(), Run{run.a, run.b, 0}, byEnds);
            if (at != runs.end() && at->a == run.a && at->b == run.b) keep.push_back(at->dropped);
        });
        for (const Id v : keep) uses_[v].needed = true;
        return !keep.empty();
    }

    /// New numbers of the vertices that stay; the lattice edge of each.
    std::vector<Id> numberKept() {
        std::vector<Id> number(uses_.size(), kDropped);
        for (const Id v : result_.corners) {
            if (!isDropped(v)) number[v] = 0;
        }
        Id old = 0, kept = 0;
        for (const Id n : number) kept += n == 0;
        result_.vertices.reserve(static_cast<std::size_t>(kept));
        kept = 0;
        for (std::size_t b = 0; b < surface_.blocks.size(); ++b) {
            const Index3 origin = surface_.latticeOrigin(static_cast<std::int64_t>(b));
            for (int axis = 0; axis < 3; ++axis) {
                surface_.blocks[b].vertices[axis].forEach([&](int cell) {
                    Id& n = number[old++];
                    if (n == kDropped) return;
                    n = kept++;
                    const Index3 p{origin[0] + cell % N, origin[1] + cell / N % N,
                                   origin[2] + cell / (N * N)};
                    result_.vertices.push_back(EdgeKey::make(p, axis));
                });
            }
        }
        return number;
    }

    void compress(const std::vector<Id>& number) {
        std::size_t out = 0;
        for (std::size_t l = 0; l < result_.count(); ++l) {
            const std::size_t first = result_.firstCorner[l], last = result_.firstCorner[l + 1];
            result_.firstCorner[l] = static_cast<Id>(out);
            for (std::size_t i = first; i < last; ++i) {
                const Id n = number[result_.corners[i]];
                if (n != kDropped) result_.corners[out++] = n;
            }
        }
        result_.firstCorner.back() = static_cast<Id>(out);
        result_.corners.resize(out);
        result_.corners.shrink_to_fit();
    }

    BoxSurface<N, Id>& surface_;
    const BoxCases& cases_ = BoxCases::instance();
    std::vector<VertexUse> uses_;
    SurfaceLoops<Id> result_;
};

}  // namespace

template <int N, class Id>
SurfaceLoops<Id> makeSurfaceLoops(BoxSurface<N, Id> surface) {
    LoopBuilder<N, Id> builder(surface);
    builder.traceAll();
    freeMemory(surface.chunks);
    builder.keepEdgesApart();
    return builder.finish();
}

#define ADAPTISO_INSTANTIATE(N, Id) \
    template SurfaceLoops<Id> makeSurfaceLoops<N, Id>(BoxSurface<N, Id>);
ADAPTISO_FOR_EACH_BLOCK_SIZE_AND_ID(ADAPTISO_INSTANTIATE)
#undef ADAPTISO_INSTANTIATE

}  // namespace adaptiso::detail
