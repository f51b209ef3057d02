// peerMeasure VOLUME MESH REFERENCE...: what is wrong with a mesh, and how far it lies from each
// reference, in voxels (a step along any axis is 1). One JSON object.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../RunBenchmark.h"
#include "PeerFiles.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::benchmarks {
namespace {

TriangleMesh inVoxels(TriangleMesh mesh, const ImageGeometry& geometry) {
    for (Vec3& point : mesh.points) point = geometry.toIndex(point);
    return mesh;
}

/// Both ends lie within half a voxel of the first or last sample of one axis: where a surface may
/// be open. (vtkQuadricDecimation moves vertices off the border.)
bool isAtBorder(const Vec3& p, const Vec3& q, const Index3& size) {
    constexpr double kNear = 0.5;
    for (int a = 0; a < 3; ++a) {
        for (const double face : {0.0, static_cast<double>(size[a] - 1)}) {
            if (std::abs(p[a] - face) <= kNear && std::abs(q[a] - face) <= kNear) return true;
        }
    }
    return false;
}

/// Edges of one triangle that do not lie at the border of the volume.
std::int64_t countOpenInside(const TriangleMesh& inVoxels, const Index3& size) {
    std::vector<std::array<VertexId, 2>> edges;
    edges.reserve(3 * inVoxels.triangles.size());
    for (const Triangle& t : inVoxels.triangles) {
        for (int c = 0; c < 3; ++c)
            edges.push_back({std::min(t[c], t[(c + 1) % 3]), std::max(t[c], t[(c + 1) % 3])});
    }
    std::sort(edges.begin(), edges.end());
    std::int64_t open = 0;
    for (auto at = edges.begin(); at != edges.end();) {
        const auto next = std::find_if(at, edges.end(), [&](const auto& e) { return e != *at; });
        if (next - at == 1) {
            const auto& [p, q] = *at;
            open += isAtBorder(inVoxels.points[p], inVoxels.points[q], size) ? 0 : 1;
        }
        at = next;
    }
    return open;
}

nlohmann::ordered_json toJson(const DistanceStatistics& distance) {
    return {{"mean", distance.meanMm},
            {"rms", distance.rmsMm},
            {"p99", distance.p99Mm},
            {"max", distance.maxMm}};
}

nlohmann::ordered_json distanceTo(const TriangleMesh& reference, const TriangleMesh& mesh,
                                  std::int64_t samples) {
    const DistanceReport distance = surfaceDistance(mesh, reference, {.samples = samples});
    return {{"both", toJson(distance.combined)},
            {"fromMesh", toJson(distance.aToB)},
            {"fromReference", toJson(distance.bToA)}};
}

struct Arguments {
    std::string volume, mesh;
    std::vector<std::string> references;
    std::int64_t samples = 200000;
    bool distancesOnly = false;
};

void declareOptions(CLI::App& app, Arguments& arguments) {
    app.add_option("volume", arguments.volume)->required();
    app.add_option("mesh", arguments.mesh)->required();
    app.add_option("references", arguments.references);
    app.add_option("--samples", arguments.samples, "On each surface (default 200000)");
    app.add_flag("--distances-only", arguments.distancesOnly, "Leave the defects out");
}

void run(const Arguments& arguments) {
    const ImageGeometry geometry = readVolumeFile(arguments.volume).view().geometry();
    const TriangleMesh mesh = readMeshFile(arguments.mesh);
    const TriangleMesh meshInVoxels = inVoxels(mesh, geometry);
    nlohmann::ordered_json report{{"triangles", mesh.triangles.size()}};
    if (!arguments.distancesOnly) {
        const TopologyReport topology = checkTopology(mesh);
        report["components"] = topology.components.size();
        report["openEdges"] = topology.count(TopologyDefect::BoundaryEdge);
        report["openEdgesInside"] = countOpenInside(meshInVoxels, geometry.size);
        report["nonManifoldEdges"] = topology.count(TopologyDefect::NonManifoldEdge);
        report["nonManifoldVertices"] = topology.count(TopologyDefect::NonManifoldVertex);
        report["inconsistentEdges"] = topology.count(TopologyDefect::InconsistentEdge);
        report["degenerateTriangles"] = topology.count(TopologyDefect::DegenerateTriangle);
        report["duplicateTriangles"] = topology.count(TopologyDefect::DuplicateTriangle);
        report["crossingPairs"] = findSelfIntersections(mesh).pairCount;
    }
    nlohmann::ordered_json distances = nlohmann::ordered_json::array();
    for (const std::string& path : arguments.references) {
        distances.push_back(
            distanceTo(inVoxels(readMeshFile(path), geometry), meshInVoxels, arguments.samples));
    }
    report["distances"] = distances;
    std::cout << report.dump() << '\n';
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    CLI::App app("Measures a mesh against references", "peerMeasure");
    Arguments arguments;
    declareOptions(app, arguments);
    return runBenchmark(app, argc, argv, [&] { run(arguments); });
}
