// peerMeasure VOLUME MESH REFERENCE...: what is wrong with a mesh, and how far it lies from each
// reference, in voxels (a step along any axis is 1). One JSON object.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "PeerFiles.h"
#include "adaptiso/Core/Errors.h"
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

int run(int argc, char** argv) {
    CLI::App app("Measures a mesh against references");
    std::string volumePath, meshPath;
    std::vector<std::string> references;
    std::int64_t samples = 200000;
    bool distancesOnly = false;
    app.add_option("volume", volumePath)->required();
    app.add_option("mesh", meshPath)->required();
    app.add_option("references", references);
    app.add_option("--samples", samples, "On each surface (default 200000)");
    app.add_flag("--distances-only", distancesOnly, "Leave the defects out");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    const ImageGeometry geometry = readVolumeFile(volumePath).view().geometry();
    const TriangleMesh mesh = readMeshFile(meshPath);
    const TriangleMesh meshInVoxels = inVoxels(mesh, geometry);
    nlohmann::ordered_json report{{"triangles", mesh.triangles.size()}};
    if (!distancesOnly) {
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
    for (const std::string& path : references) {
        distances.push_back(
            distanceTo(inVoxels(readMeshFile(path), geometry), meshInVoxels, samples));
    }
    report["distances"] = distances;
    std::cout << report.dump() << '\n';
    return 0;
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    try {
        return adaptiso::benchmarks::run(argc, argv);
    } catch (const adaptiso::Error& error) {
        std::cerr << "peerMeasure: " << error.what() << '\n';
        return 3;
    } catch (const std::exception& error) {
        std::cerr << "peerMeasure: " << error.what() << '\n';
        return 4;
    }
}
