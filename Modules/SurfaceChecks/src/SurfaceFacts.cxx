#include <algorithm>
#include <limits>

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
                            std::int64_t maxPairs) {
    SurfaceFacts facts;
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
            facts.insideOut = findInsideOutPieces(mesh, facts.topology);
        }
    }
    facts.duplicates = findDuplicates(mesh);
    if (facts.topology.count(TopologyDefect::BoundaryEdge) > 0 && !facts.isSoup()) {
        facts.holes = findHoles(mesh);
    }
    facts.intersections = findSelfIntersections(mesh, {.maxPairs = maxPairs});
    if (!facts.intersections.pairs.empty()) {
        const auto& [a, b, c] = mesh.triangles[facts.intersections.pairs.front()[0]];
        facts.firstCrossingMm = 1.0 / 3 * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
    }
    facts.shape = measureShape(mesh);
    facts.size = judgeSize(mesh, sizeLimits);
    facts.solidAngle = solidAngleFromMean(mesh);
    return facts;
}

void measureWallsOf(const TriangleMesh& mesh, double limitMm, SurfaceFacts& facts) {
    if (!facts.insideOut || !facts.insideOut->empty()) return;
    facts.walls = measureWalls(mesh, limitMm);
}

std::string wallText(const WallReport& walls) {
    constexpr double kEdgeMm = 0.01;  // what sharp edges run out to
    return walls.leastMm < kEdgeMm ? "below 0.01 mm" : formatFixed(walls.leastMm, 2) + " mm";
}

}  // namespace adaptiso
