#include "adaptiso/MeshQuality/Nesting.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>

#include "NumberedTriangles.h"
#include "TriangleGroups.h"
#include "Triangles.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kVertexGrain = 4096;
constexpr std::int64_t kMostRayTests = 1 << 27;  // of all vertices; of many vertices more

/// The mesh with each triangle once, where all of it is there twice and so has no inside by the
/// even-odd rule; none where it is not.
std::optional<TriangleMesh> singleOf(const TriangleMesh& mesh) {
    const DuplicateReport duplicates =
        findDuplicates(mesh, {.maxExamples = std::ssize(mesh.triangles)});
    if (mesh.triangles.empty() || 2 * duplicates.triangleCount != std::ssize(mesh.triangles)) {
        return std::nullopt;
    }
    TriangleMesh result;
    result.points = mesh.points;
    auto next = duplicates.triangles.begin();
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        if (next != duplicates.triangles.end() && *next == n) {
            ++next;
        } else {
            result.triangles.push_back(mesh.triangles[n]);
        }
    }
    return result;
}

/// One of the two surfaces, ready to be asked.
struct Surface {
    explicit Surface(const TriangleMesh& m)
        : mesh(m),
          tree(m),
          single(singleOf(m)),
          singleTree(single ? std::make_optional<AabbTree>(*single) : std::nullopt),
          inside(single ? *single : m, single ? *singleTree : tree),
          meetsOther(m.triangles.size()),
          hasArea(m.triangles.size()) {
        for (std::int64_t n = 0; n < std::ssize(m.triangles); ++n) {
            const Corners corners = cornersOf(m, n);
            hasArea[n] = areFinite(corners) && axisWithArea(corners) >= 0;
        }
    }

    const TriangleMesh& mesh;
    AabbTree tree;
    std::optional<TriangleMesh> single;  ///< of a doubled surface
    std::optional<AabbTree> singleTree;
    InsideTest inside;
    std::vector<std::uint8_t> meetsOther;  ///< by triangle
    std::vector<bool> hasArea;  ///< by triangle, with finite corners: the others meet nothing

    /// From any thread.
    void mark(std::int64_t triangle) {
        std::atomic_ref(meetsOther[triangle]).store(1, std::memory_order_relaxed);
    }
};

/// Pairs of triangles that meet.
struct Meetings {
    std::int64_t count = 0;
    std::vector<TrianglePair> pairs;  ///< the first of them, ascending
    bool isComplete = true;

    void add(const TrianglePair& pair, std::int64_t most) {
        ++count;
        pairs.push_back(pair);
        if (std::ssize(pairs) > 2 * most) keepFirst(most);
    }
    void keepFirst(std::int64_t most) {
        std::sort(pairs.begin(), pairs.end());
        if (std::ssize(pairs) > most) pairs.resize(static_cast<std::size_t>(most));
    }
};

/// By boxes. \return  empty where too many of these overlap
std::optional<Meetings> findByBoxes(Surface& inner, Surface& outer, std::int64_t most) {
    constexpr std::int64_t kMostTests = 256 * kVertexGrain;  // of a piece
    const std::int64_t count = std::ssize(inner.mesh.triangles);
    std::vector<Meetings> ofPiece((count + kVertexGrain - 1) / kVertexGrain);
    std::atomic<bool> areTooMany = false;
    parallelForPieces(count, kVertexGrain, [&](std::int64_t begin, std::int64_t end) {
        Meetings& found = ofPiece[begin / kVertexGrain];
        std::int64_t tests = 0;
        for (std::int64_t n = begin; n < end && !areTooMany; ++n) {
            if (!inner.hasArea[n]) continue;
            const Corners corners = cornersOf(inner.mesh, n);
            outer.tree.forEachOverlap(inner.tree.triangleBox(n), [&](std::int64_t other) {
                if (!outer.hasArea[other] || ++tests > kMostTests) return;
                if (!trianglesMeet(corners, cornersOf(outer.mesh, other))) return;
                found.add({n, other}, most);
                inner.mark(n);
                outer.mark(other);
            });
            if (tests > kMostTests) areTooMany = true;
        }
    });
    if (areTooMany) return std::nullopt;
    Meetings all;
    for (Meetings& piece : ofPiece) {
        all.count += piece.count;
        all.pairs.insert(all.pairs.end(), piece.pairs.begin(), piece.pairs.end());
    }
    all.keepFirst(most);
    return all;
}

/// By groups that planes tell apart, as many as their budget allows.
Meetings findByGroups(Surface& inner, Surface& outer, std::int64_t most) {
    const NumberedTriangles ours(inner.mesh), theirs(outer.mesh);
    const TriangleView a = ours.view(), b = theirs.view();
    TriangleGroups::Pairs found =
        TriangleGroups(a).findPairs(TriangleGroups(b), 0, [&](std::uint32_t s, std::uint32_t t) {
            return trianglesMeet(a.cornersOf(s), b.cornersOf(t));
        });
    Meetings meetings;
    for (const auto& [s, t] : found.pairs) {
        meetings.add({ours.numbers[s], theirs.numbers[t]}, most);
        inner.mark(ours.numbers[s]);
        outer.mark(theirs.numbers[t]);
    }
    for (const std::uint32_t s : found.undecided) inner.mark(ours.numbers[s]);
    for (const std::uint32_t t : found.otherUndecided) outer.mark(theirs.numbers[t]);
    meetings.keepFirst(most);
    meetings.isComplete = found.undecided.empty() && found.otherUndecided.empty();
    return meetings;
}

/// \param most  pairs to keep, at least one
Meetings findMeetings(Surface& inner, Surface& outer, std::int64_t most) {
    std::optional<Meetings> found = findByBoxes(inner, outer, most);
    return found ? *std::move(found) : findByGroups(inner, outer, most);
}

/// For every vertex, one that stands for it: the smallest of those that hang together with it by
/// triangles that don't meet the other surface, and so lie on the same side of it. -1: not used by
/// a triangle with finite corners.
std::vector<VertexId> findSpokesmen(const Surface& surface, const Surface& other) {
    const TriangleMesh& mesh = surface.mesh;
    DisjointSets sets(std::ssize(mesh.points));
    std::vector<bool> isUsed(mesh.points.size());
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        const Corners corners = cornersOf(mesh, n);
        if (!areFinite(corners)) continue;
        const Triangle& t = mesh.triangles[n];
        for (const VertexId v : t) isUsed[v] = true;
        // a triangle without area meets nothing, wherever it lies
        const bool joins = other.inside.isClosed() && surface.meetsOther[n] == 0;
        if (!joins || !surface.hasArea[n]) continue;
        sets.join(t[0], t[1]);
        sets.join(t[1], t[2]);
    }
    std::vector<VertexId> spokesmen = std::move(sets).names();
    for (std::size_t v = 0; v < spokesmen.size(); ++v) {
        if (!isUsed[v]) spokesmen[v] = -1;
    }
    return spokesmen;
}

/// Tests of rays and triangles that the sides of all spokesmen take, by some of them.
double expectedRayTests(const Surface& surface, const Surface& other,
                        const std::vector<VertexId>& spokesmen) {
    constexpr std::int64_t kSome = 64;
    std::vector<VertexId> asked;
    for (VertexId v = 0; v < std::ssize(spokesmen); ++v) {
        if (spokesmen[v] == v) asked.push_back(v);
    }
    const std::int64_t count = std::ssize(asked), some = std::min(count, kSome);
    std::int64_t tests = 0;
    for (std::int64_t n = 0; n < some; ++n) {
        other.inside.sideOf(surface.mesh.points[asked[n * count / some]], &tests);
    }
    return some == 0 ? 0 : static_cast<double>(tests * count) / static_cast<double>(some);
}

/// The side of every vertex; empty: not used, or not known as rays pass too many triangles.
std::vector<std::optional<Side>> findSides(const Surface& surface, const Surface& other,
                                           const std::vector<VertexId>& spokesmen) {
    const std::int64_t count = std::ssize(spokesmen);
    const std::int64_t pieces = count / kVertexGrain + 1,
                       ofPiece = std::max<std::int64_t>(1 << 21, 2 * kMostRayTests / pieces);
    const bool isInVain = 2 * expectedRayTests(surface, other, spokesmen) >
                          static_cast<double>(ofPiece) * static_cast<double>(pieces);
    constexpr std::int64_t kPiecesInVain = 8;  // a sample, as not all can be known
    const std::int64_t most = isInVain ? 1 << 18 : ofPiece,
                       step = isInVain ? (pieces + kPiecesInVain - 1) / kPiecesInVain : 1;
    std::vector<std::optional<Side>> sides(spokesmen.size());
    parallelForPieces(count, kVertexGrain, [&](std::int64_t begin, std::int64_t end) {
        if (begin / kVertexGrain % step != 0) return;
        std::int64_t tests = 0;
        for (VertexId v = begin; v < end && tests <= most; ++v) {
            if (spokesmen[v] == v) sides[v] = other.inside.sideOf(surface.mesh.points[v], &tests);
        }
    });
    for (VertexId v = 0; v < count; ++v) {
        if (spokesmen[v] >= 0) sides[v] = sides[spokesmen[v]];
    }
    return sides;
}

struct SideCounts {
    std::int64_t used = 0, inside = 0, notInside = 0;
    VertexId firstNotInside = -1;

    bool areKnown() const { return inside + notInside == used; }
};

SideCounts countSides(const std::vector<VertexId>& spokesmen,
                      const std::vector<std::optional<Side>>& sides) {
    SideCounts counts;
    for (std::size_t v = 0; v < sides.size(); ++v) {
        if (spokesmen[v] >= 0) ++counts.used;
        if (!sides[v]) continue;
        if (*sides[v] == Side::Inside) {
            ++counts.inside;
        } else if (++counts.notInside == 1) {
            counts.firstNotInside = static_cast<VertexId>(v);
        }
    }
    return counts;
}

/// Finds the distance of the farthest vertex that is not inside from the other surface.
void measureFarthestOut(const Surface& surface, const Surface& other,
                        const std::vector<std::optional<Side>>& sides, NestingReport& report) {
    std::vector<double> squared(sides.size());
    std::vector<StandIn> leftOut;
    findNearestPlaces(
        other.mesh, other.tree, std::ssize(sides),
        [&](VertexId v) -> std::optional<Vec3> {
            if (!sides[v] || *sides[v] == Side::Inside) return std::nullopt;
            return surface.mesh.points[v];
        },
        [&](VertexId v, const ClosestPoint& nearest) { squared[v] = nearest.squaredDistanceMm2; },
        true, &leftOut);
    if (!squared.empty()) {
        report.farthestOutMm = std::sqrt(*std::max_element(squared.begin(), squared.end()));
    }
    report.isFarthestKnown = leftOut.empty();
}

/// Both have the same triangles at the same places, whatever their numbers.
bool areIdentical(const TriangleMesh& a, const TriangleMesh& b) {
    const auto singles = [](const TriangleMesh& mesh) {
        return std::ssize(mesh.triangles) - findDuplicates(mesh, {.maxExamples = 0}).triangleCount;
    };
    if (singles(a) != singles(b)) return false;
    TriangleMesh both = a;
    both.normals.clear();
    both.points.insert(both.points.end(), b.points.begin(), b.points.end());
    const std::int64_t offset = std::ssize(a.points);
    for (const auto& [i, j, k] : b.triangles) {
        both.triangles.push_back({static_cast<VertexId>(i + offset),
                                  static_cast<VertexId>(j + offset),
                                  static_cast<VertexId>(k + offset)});
    }
    return singles(both) == singles(a);
}

NestingRelation relationOf(const NestingReport& report) {
    if (report.innerVertices == 0 || report.outerVertices == 0) return NestingRelation::Unknown;
    if (report.crossingPairs > 0) return NestingRelation::Crossing;
    if (!report.isComplete || !report.areSidesKnown) return NestingRelation::Unknown;
    const bool noneIn = report.innerVerticesNotInside == report.innerVertices;
    if (report.innerVerticesNotInside == 0 && report.outerVerticesInside == 0) {
        return NestingRelation::Nested;
    }
    if (noneIn && report.outerVerticesInside == report.outerVertices) {
        return NestingRelation::Swapped;
    }
    if (noneIn && report.outerVerticesInside == 0) return NestingRelation::Apart;
    return NestingRelation::Mixed;
}

}  // namespace

std::string_view toString(NestingRelation relation) {
    constexpr const char* kWords[] = {"nested", "crossing", "identical", "swapped",
                                      "apart",  "mixed",    "unknown"};
    return kWords[static_cast<std::size_t>(relation)];
}

NestingReport checkNesting(const TriangleMesh& innerMesh, const TriangleMesh& outerMesh,
                           const NestingOptions& options) {
    if (options.maxPairs < 0) {
        throw InvalidInput("checkNesting: maxPairs is " + std::to_string(options.maxPairs) +
                           ", must be at least 0");
    }
    requireIndices(innerMesh, "checkNesting: inner");
    requireIndices(outerMesh, "checkNesting: outer");
    Surface inner(innerMesh), outer(outerMesh);
    NestingReport report;
    Meetings meetings = findMeetings(inner, outer, std::max<std::int64_t>(1, options.maxPairs));
    report.pairs = std::move(meetings.pairs);
    report.crossingPairs = meetings.count;
    report.isComplete = meetings.isComplete;

    const std::vector<VertexId> innerSpokesmen = findSpokesmen(inner, outer);
    const std::vector<std::optional<Side>> innerSides = findSides(inner, outer, innerSpokesmen);
    const SideCounts ofInner = countSides(innerSpokesmen, innerSides);
    report.innerVertices = ofInner.used;
    report.innerVerticesNotInside = ofInner.notInside;
    report.firstNotInside = ofInner.firstNotInside;
    measureFarthestOut(inner, outer, innerSides, report);

    const std::vector<VertexId> outerSpokesmen = findSpokesmen(outer, inner);
    const SideCounts ofOuter = countSides(outerSpokesmen, findSides(outer, inner, outerSpokesmen));
    report.outerVertices = ofOuter.used;
    report.outerVerticesInside = ofOuter.inside;

    report.areSidesKnown = ofInner.areKnown() && ofOuter.areKnown();
    report.relation = relationOf(report);
    if (report.relation == NestingRelation::Crossing && areIdentical(innerMesh, outerMesh)) {
        report.relation = NestingRelation::Identical;
    }
    if (report.crossingPairs > 0) {
        const auto& [a, b] = report.pairs.front();
        report.gap = {triangleDistance(cornersOf(innerMesh, a), cornersOf(outerMesh, b)), a, b};
    } else if (report.isComplete) {
        report.gap = surfaceGap(innerMesh, inner.tree, outerMesh, outer.tree);
    }
    if (std::ssize(report.pairs) > options.maxPairs) report.pairs.resize(options.maxPairs);
    return report;
}

}  // namespace adaptiso
