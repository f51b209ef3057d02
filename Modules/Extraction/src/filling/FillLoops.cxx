#include "filling/FillLoops.h"

#include <algorithm>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/detail/PlanarTriangulation.h"
#include "filling/LoopTriangulation.h"
#include "repair/MeshRepair.h"

namespace adaptiso::detail {
namespace {

/// Loops that are filled together: one, or all those of a plane in which there are holes. They
/// stand together in the filler's order, up to those of the next region.
template <class Id>
struct Region {
    Id firstLoop;
    Id firstTriangle;
};

template <class Id>
class LoopFiller {
public:
    LoopFiller(const SurfaceLoops<Id>& loops, const TriangleMesh& mesh, bool isMirrored)
        : loops_(loops), mesh_(mesh), isMirrored_(isMirrored) {
        makeRegions();
    }

    std::uint64_t triangleCount() const { return regions_.back().firstTriangle; }
    std::size_t regionCount() const { return regions_.size() - 1; }

    /// Work space of one thread.
    struct Scratch {
        PlanarTriangulator planar;
        std::vector<PlanarCorner> planarCorners;
        std::vector<SpatialCorner> spatialCorners;
        std::vector<Id> vertices;         ///< of the region's corners, loop after loop
        std::vector<std::uint32_t> next;  ///< corner after each corner on its loop
        std::vector<LocalTriangle> triangles;
    };

    /// Fills region r into scratch.triangles (by scratch.vertices).
    void fill(std::size_t r, Scratch& scratch) const {
        scratch.vertices.clear();
        scratch.next.clear();
        scratch.triangles.clear();
        for (Id l = regions_[r].firstLoop; l < regions_[r + 1].firstLoop; ++l) {
            appendLoop(order_[l], scratch);
        }
        const LoopKey key = loops_.keys[order_[regions_[r].firstLoop]];
        if (scratch.vertices.size() == 3) {
            scratch.triangles.push_back({0, 1, 2});
        } else if (key.isPlane()) {
            fillPlane(PlaneKey{key.word}, scratch);
        } else {
            fillSpace(BoxKey{key.word}, scratch);
        }
    }

    std::uint64_t firstTriangle(std::size_t r) const { return regions_[r].firstTriangle; }
    std::uint64_t lastTriangle(std::size_t r) const { return regions_[r + 1].firstTriangle; }

    /// The region that triangle t belongs to.
    std::size_t regionOf(std::uint64_t t) const {
        const auto after = std::upper_bound(regions_.begin(), regions_.end(), t,
                                            [](std::uint64_t triangle, const Region<Id>& region) {
                                                return triangle < region.firstTriangle;
                                            });
        return static_cast<std::size_t>(after - regions_.begin()) - 1;
    }

private:
    Id size(Id l) const { return loops_.firstCorner[l + 1] - loops_.firstCorner[l]; }

    /// Place of a vertex on a plane, by the midpoint of its box edge in half lattice steps, seen
    /// along the first axis that the normal is not at right angles to.
    PlanarCorner place(Id vertex, const PlaneKey& plane, int boxSize) const {
        const EdgeKey edge = loops_.vertices[vertex];
        std::array<std::int64_t, 3> p;
        for (int a = 0; a < 3; ++a) {
            const std::int64_t at = edge.position(a);
            p[a] = a == edge.axis() ? 2 * (at / boxSize * boxSize) + boxSize : 2 * at;
        }
        const std::array<int, 3> normal = plane.normal();
        const int drop = normal[0] != 0 ? 0 : normal[1] != 0 ? 1 : 2;
        const std::int64_t u = p[axisAfter(drop, 1)], v = p[axisAfter(drop, 2)];
        return normal[drop] > 0 ? PlanarCorner{u, v, 0, 0} : PlanarCorner{v, u, 0, 0};
    }

    int boxSizeOf(const PlaneKey& plane) const { return loops_.blockSize >> plane.level(); }

    /// Twice the area that a loop encloses on its plane: negative for a hole.
    std::int64_t signedArea(Id l) const {
        const PlaneKey plane{loops_.keys[l].word};
        const int boxSize = boxSizeOf(plane);
        const Id* corner = &loops_.corners[loops_.firstCorner[l]];
        const PlanarCorner origin = place(corner[0], plane, boxSize);
        PlanarCorner before = origin;
        std::int64_t area = 0;
        for (Id i = 1; i < size(l); ++i) {
            const PlanarCorner p = place(corner[i], plane, boxSize);
            area +=
                (before.u - origin.u) * (p.v - origin.v) - (before.v - origin.v) * (p.u - origin.u);
            before = p;
        }
        return area;
    }

    void makeRegions() {
        const std::int64_t count = static_cast<std::int64_t>(loops_.count());
        constexpr std::int64_t kPiece = 4096;
        std::vector<std::vector<Id>> holesOf((count + kPiece - 1) / kPiece);
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (Id l = static_cast<Id>(begin); l < static_cast<Id>(end); ++l) {
                if (loops_.keys[l].isPlane() && signedArea(l) < 0) {
                    holesOf[begin / kPiece].push_back(l);
                }
            }
        });
        std::vector<std::uint64_t> planesWithHoles;
        std::vector<Id> holes;
        for (const auto& some : holesOf) {
            holes.insert(holes.end(), some.begin(), some.end());
            for (const Id l : some) planesWithHoles.push_back(loops_.keys[l].word);
        }
        std::sort(planesWithHoles.begin(), planesWithHoles.end());

        std::vector<Id> grouped;
        order_.reserve(count);
        regions_.reserve(count + 1);
        Id triangles = 0;
        for (Id l = 0; l < static_cast<Id>(count); ++l) {
            if (loops_.keys[l].isPlane() &&
                std::binary_search(planesWithHoles.begin(), planesWithHoles.end(),
                                   loops_.keys[l].word)) {
                grouped.push_back(l);
                continue;
            }
            regions_.push_back({static_cast<Id>(order_.size()), triangles});
            order_.push_back(l);
            triangles += size(l) - 2;
        }
        std::stable_sort(grouped.begin(), grouped.end(),
                         [&](Id a, Id b) { return loops_.keys[a].word < loops_.keys[b].word; });
        for (std::size_t i = 0; i < grouped.size();) {
            regions_.push_back({static_cast<Id>(order_.size()), triangles});
            const std::uint64_t key = loops_.keys[grouped[i]].word;
            for (; i < grouped.size() && loops_.keys[grouped[i]].word == key; ++i) {
                order_.push_back(grouped[i]);
                triangles += size(grouped[i]);
                const bool isHole = std::binary_search(holes.begin(), holes.end(), grouped[i]);
                triangles = isHole ? triangles + 2 : triangles - 2;
            }
        }
        regions_.push_back({static_cast<Id>(order_.size()), triangles});
    }

    void appendLoop(Id l, Scratch& scratch) const {
        const std::uint32_t base = static_cast<std::uint32_t>(scratch.vertices.size());
        const Id* corner = &loops_.corners[loops_.firstCorner[l]];
        for (Id i = 0; i < size(l); ++i) {
            scratch.vertices.push_back(corner[i]);
            scratch.next.push_back(base + static_cast<std::uint32_t>((i + 1) % size(l)));
        }
    }

    void fillPlane(const PlaneKey& plane, Scratch& scratch) const {
        const int boxSize = boxSizeOf(plane);
        scratch.planarCorners.resize(scratch.vertices.size());
        for (std::uint32_t i = 0; i < scratch.vertices.size(); ++i) {
            const PlanarCorner p = place(scratch.vertices[i], plane, boxSize);
            scratch.planarCorners[i].u = p.u;
            scratch.planarCorners[i].v = p.v;
            scratch.planarCorners[i].next = scratch.next[i];
            scratch.planarCorners[scratch.next[i]].previous = i;
        }
        scratch.planar.triangulate(scratch.planarCorners, scratch.triangles);
    }

    void fillSpace(const BoxKey& box, Scratch& scratch) const {
        scratch.spatialCorners.clear();
        for (const Id vertex : scratch.vertices) {
            const EdgeKey edge = loops_.vertices[vertex];
            const Vec3 outward = toVec3(mesh_.normals[vertex]);
            // in a mirrored image loops still run as in index space
            SpatialCorner corner{mesh_.points[vertex], isMirrored_ ? -outward : outward, 0};
            for (int a = 0; a < 3; ++a) {
                if (a == edge.axis()) continue;
                const int at = box.above(a, edge.position(a));
                if (at == 0) corner.faces |= static_cast<std::uint8_t>(1 << 2 * a);
                if (at == box.size(a)) corner.faces |= static_cast<std::uint8_t>(2 << 2 * a);
            }
            scratch.spatialCorners.push_back(corner);
        }
        triangulateLoop(scratch.spatialCorners, scratch.triangles);
    }

    const SurfaceLoops<Id>& loops_;
    const TriangleMesh& mesh_;
    bool isMirrored_;
    std::vector<Id> order_;            ///< loops, region after region
    std::vector<Region<Id>> regions_;  ///< and the end
};

template <class Id>
void placeVertices(const SurfaceLoops<Id>& loops, const LatticeSampler& sampler,
                   std::int64_t latticeOffset, VertexPlacement placement, TriangleMesh& mesh) {
    const std::int64_t count = static_cast<std::int64_t>(loops.vertices.size());
    mesh.points.reserve(withSpare(count));
    mesh.normals.reserve(withSpare(count));
    mesh.points.resize(count);
    mesh.normals.resize(count);
    parallelForPieces(count, 4096, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            const LatticeEdge edge = loops.vertices[v].latticeEdge(latticeOffset);
            const Crossing crossing = placement == VertexPlacement::Midpoint
                                          ? sampler.midpoint(edge)
                                          : sampler.crossing(edge);
            mesh.points[v] = crossing.pointMm;
            mesh.normals[v] = toNormal(crossing.normal);
        }
    });
}

template <class Id>
void fillAll(const LoopFiller<Id>& filler, TriangleMesh& mesh) {
    mesh.triangles.reserve(withSpare(filler.triangleCount()));
    mesh.triangles.resize(filler.triangleCount());
    const std::int64_t count = static_cast<std::int64_t>(filler.regionCount());
    parallelForPieces(count, 512, [&](std::int64_t begin, std::int64_t end) {
        typename LoopFiller<Id>::Scratch scratch;
        for (std::int64_t r = begin; r < end; ++r) {
            filler.fill(r, scratch);
            std::uint64_t t = filler.firstTriangle(r);
            if (t + scratch.triangles.size() != filler.lastTriangle(r)) {
                throw InternalError("fillLoops: a merged facet's loops do not bound a region");
            }
            for (const LocalTriangle& local : scratch.triangles) {
                mesh.triangles[t++] = {static_cast<VertexId>(scratch.vertices[local[0]]),
                                       static_cast<VertexId>(scratch.vertices[local[1]]),
                                       static_cast<VertexId>(scratch.vertices[local[2]])};
            }
        }
    });
}

/// The two triangles of every chord between two vertices that more than one edge joins, but for one
/// chord where no loop's edge joins them.
template <class Id>
std::vector<ChordToSplit> chordsToSplit(const LoopFiller<Id>& filler, const TriangleMesh& mesh) {
    std::vector<ChordToSplit> chords;
    typename LoopFiller<Id>::Scratch scratch;
    for (const CrowdedEdge& edge : findCrowdedEdges(mesh)) {
        bool hasLoopEdge = false;
        std::vector<ChordToSplit> found;
        std::vector<std::size_t> regions;
        for (const std::uint64_t t : edge.triangles) regions.push_back(filler.regionOf(t));
        std::sort(regions.begin(), regions.end());
        regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
        for (const std::size_t r : regions) {
            filler.fill(r, scratch);
            // half-edges between the two vertices, by their corners
            struct Side {
                std::uint32_t from, to;
                std::uint64_t triangle;
            };
            std::vector<Side> sides;
            for (std::size_t t = 0; t < scratch.triangles.size(); ++t) {
                for (int c = 0; c < 3; ++c) {
                    const std::uint32_t from = scratch.triangles[t][c],
                                        to = scratch.triangles[t][(c + 1) % 3];
                    const VertexId a = static_cast<VertexId>(scratch.vertices[from]),
                                   b = static_cast<VertexId>(scratch.vertices[to]);
                    if (std::min(a, b) != edge.a || std::max(a, b) != edge.b) continue;
                    if (scratch.next[from] == to) {
                        hasLoopEdge = true;
                    } else {
                        sides.push_back({from, to, filler.firstTriangle(r) + t});
                    }
                }
            }
            for (std::size_t i = 0; i < sides.size(); ++i) {
                for (std::size_t j = i + 1; j < sides.size(); ++j) {
                    if (sides[i].from == sides[j].to && sides[i].to == sides[j].from) {
                        found.push_back({edge.a, edge.b, sides[i].triangle, sides[j].triangle});
                    }
                }
            }
        }
        if (!hasLoopEdge && !found.empty()) found.erase(found.begin());
        chords.insert(chords.end(), found.begin(), found.end());
    }
    return chords;
}

}  // namespace

template <class Id>
TriangleMesh fillLoops(SurfaceLoops<Id> loops, const LatticeSampler& sampler,
                       const ImageGeometry& geometry, std::int64_t latticeOffset,
                       VertexPlacement placement, std::int64_t& edgesSplit) {
    TriangleMesh mesh;
    placeVertices(loops, sampler, latticeOffset, placement, mesh);
    {
        const LoopFiller<Id> filler(loops, mesh, geometry.isMirrored());
        fillAll(filler, mesh);
        const std::vector<ChordToSplit> chords = chordsToSplit(filler, mesh);
        edgesSplit = static_cast<std::int64_t>(chords.size());
        splitChords(mesh, chords);
    }
    if (placement == VertexPlacement::Crossing) {
        spreadFlatTriangles(mesh, loops.vertices, geometry, latticeOffset);
    }
    if (geometry.isMirrored()) {
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    }
    completeNormals(mesh);
    return mesh;
}

template TriangleMesh fillLoops<std::uint32_t>(SurfaceLoops<std::uint32_t>, const LatticeSampler&,
                                               const ImageGeometry&, std::int64_t, VertexPlacement,
                                               std::int64_t&);
template TriangleMesh fillLoops<std::uint64_t>(SurfaceLoops<std::uint64_t>, const LatticeSampler&,
                                               const ImageGeometry&, std::int64_t, VertexPlacement,
                                               std::int64_t&);

}  // namespace adaptiso::detail
