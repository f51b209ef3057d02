#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/Winding.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso {

namespace {

std::int64_t countRepeatedIndices(const TriangleMesh& mesh) {
    return std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [](const Triangle& t) {
        return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    });
}

/// Adds what lies on another inside each solid.
DuplicateReport findDuplicatesOf(const TriangleMesh& mesh, std::span<const Solid> solids) {
    const DuplicateOptions options;
    DuplicateReport all;
    const auto add = [&](auto& list, const auto& found, std::size_t first) {
        for (const auto number : found) {
            if (std::ssize(list) == options.maxExamples) return;
            list.push_back(number + static_cast<std::int64_t>(first));
        }
    };
    for (std::size_t n = 0; n < solids.size(); ++n) {
        const DuplicateReport found = findDuplicates(solidAt(mesh, solids, n), options);
        all.vertexCount += found.vertexCount;
        all.triangleCount += found.triangleCount;
        add(all.vertices, found.vertices, solids[n].firstPoint);
        add(all.triangles, found.triangles, solids[n].firstTriangle);
    }
    return all;
}

/// The pieces that are the wrong way round, and those that lie in another solid's material, as
/// numbers into topology.components. The wall of a cavity may be a solid of its own in the file: a
/// piece that is right among all is right.
std::optional<std::vector<std::int64_t>> findWrongPieces(const TriangleMesh& mesh,
                                                         const TopologyReport& topology,
                                                         std::span<const Solid> solids) {
    const auto amongAll = findInsideOutPieces(mesh, topology);
    if (solids.empty()) return amongAll;
    std::vector<std::int64_t> wrongAlone;
    for (std::size_t n = 0; n < solids.size(); ++n) {
        const TriangleMesh solid = solidAt(mesh, solids, n);
        const TopologyReport alone = checkTopology(solid, {.maxExamplesPerDefect = 0});
        const auto found = findInsideOutPieces(solid, alone);
        if (!found) return std::nullopt;
        for (const std::int64_t piece : *found) {
            const auto first = alone.components[static_cast<std::size_t>(piece)].firstVertex +
                               static_cast<VertexId>(solids[n].firstPoint);
            const auto at = std::ranges::lower_bound(topology.components, first, {},
                                                     &SurfaceComponent::firstVertex);
            wrongAlone.push_back(at - topology.components.begin());
        }
    }
    const std::vector<std::int64_t> within = findPiecesWithin(mesh, topology, solids);
    std::vector<std::int64_t> wrong;
    std::set_union(wrongAlone.begin(), wrongAlone.end(), within.begin(), within.end(),
                   std::back_inserter(wrong));
    // shared walls may be more crossings than are decided: then each counts by itself
    if (amongAll) {
        std::erase_if(wrong, [&](std::int64_t piece) {
            return !std::binary_search(amongAll->begin(), amongAll->end(), piece);
        });
    }
    return wrong;
}

}  // namespace

bool SurfaceFacts::isSoup() const {
    return topology.triangles > 1 && duplicates.vertexCount > 0 &&
           topology.count(TopologyDefect::BoundaryEdge) == 3 * topology.triangles;
}

void replaceBadIndices(TriangleMesh& mesh) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const auto count = static_cast<VertexId>(mesh.points.size());
    mesh.points.push_back({kNan, kNan, kNan});
    mesh.normals.clear();
    for (Triangle& t : mesh.triangles) {
        if (std::any_of(t.begin(), t.end(), [&](VertexId v) { return v < 0 || v >= count; })) {
            t = {count, count, count};
        }
    }
}

SurfaceFacts measureSurface(const TriangleMesh& given, const SizeLimits& sizeLimits,
                            std::int64_t maxPairs, std::span<const Solid> solids) {
    SurfaceFacts facts;
    facts.solids = std::max<std::size_t>(1, solids.size());
    facts.topology = checkTopology(given);
    facts.repeatedIndexTriangles = countRepeatedIndices(given);
    TriangleMesh repaired;
    const bool isBad = facts.topology.count(TopologyDefect::IndexOutOfRange) > 0;
    if (isBad) replaceBadIndices(repaired = given);
    const TriangleMesh& mesh = isBad ? repaired : given;

    double volume = 0;
    for (const SurfaceComponent& component : facts.topology.components) {
        facts.areaMm2 += component.areaMm2;
        volume += component.signedVolumeMm3;
    }
    if (facts.topology.isWatertight()) {
        facts.volumeMm3 = volume;
        if (facts.topology.count(TopologyDefect::NonFiniteVertex) == 0) {
            facts.insideOut = findWrongPieces(mesh, facts.topology, solids);
        }
    }
    facts.duplicates = solids.empty() ? findDuplicates(mesh) : findDuplicatesOf(mesh, solids);
    if (facts.topology.count(TopologyDefect::BoundaryEdge) > 0 && !facts.isSoup()) {
        facts.holes = findHoles(mesh);
    }
    if (solids.empty()) {
        facts.intersections = findSelfIntersections(mesh, {.maxPairs = maxPairs});
    } else {
        SharedWalls walls = findSharedWalls(mesh, solids, {.maxPairs = maxPairs});
        facts.sharedWallTriangles = walls.triangleCount;
        facts.intersections = std::move(walls.intersections);
    }
    if (!facts.intersections.pairs.empty()) {
        const auto& [a, b, c] = mesh.triangles[facts.intersections.pairs.front()[0]];
        facts.firstCrossingMm = 1.0 / 3 * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
    }
    facts.shape = measureShape(mesh);
    facts.size = judgeSize(mesh, sizeLimits);
    facts.solidAngle = solidAngleFromMean(mesh);
    return facts;
}

void measureWallsOf(const TriangleMesh& mesh, double limitMm, SurfaceFacts& facts,
                    std::span<const Solid> solids) {
    if (!facts.insideOut || !facts.insideOut->empty()) return;
    if (solids.empty()) {
        facts.walls = measureWalls(mesh, limitMm);
        return;
    }
    WallReport all;
    for (std::size_t n = 0; n < solids.size(); ++n) {
        WallReport walls = measureWalls(solidAt(mesh, solids, n), limitMm);
        const double thinMm2 = all.thinAreaMm2 + walls.thinAreaMm2,
                     areaMm2 = all.areaMm2 + walls.areaMm2;
        if (walls.hasWall() && (!all.hasWall() || walls.leastMm < all.leastMm)) {
            all = walls;
            all.triangle += static_cast<std::int64_t>(solids[n].firstTriangle);
        }
        all.thinAreaMm2 = thinMm2;
        all.areaMm2 = areaMm2;
    }
    facts.walls = all;
}

std::string wallText(const WallReport& walls) {
    constexpr double kEdgeMm = 0.01;  // what sharp edges run out to
    return walls.leastMm < kEdgeMm ? "below 0.01 mm" : formatFixed(walls.leastMm, 2) + " mm";
}

}  // namespace adaptiso
