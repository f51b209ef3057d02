#include "adaptiso/SurfacePipeline/SurfaceJson.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "adaptiso/Json/OptionsJson.h"

namespace adaptiso {
namespace {

/// Components listed in full; a noisy image has thousands.
constexpr std::size_t kMaxComponents = 100;

Json boxesJson(const std::vector<BoxCount>& boxes) {
    Json list = Json::array();
    for (const BoxCount& count : boxes) {
        list.push_back(
            {{"size", count.size}, {"shared", count.shared}, {"unshared", count.unshared}});
    }
    return list;
}

/// The largest components: by what they enclose, those of an open surface by their area.
Json componentsJson(const TopologyReport& topology) {
    const bool isClosed = topology.isClosed();
    const auto size = [&](const SurfaceComponent& component) {
        return isClosed ? std::abs(component.signedVolumeMm3) : component.areaMm2;
    };
    std::vector<SurfaceComponent> components = topology.components;
    std::stable_sort(components.begin(), components.end(),
                     [&](const auto& a, const auto& b) { return size(a) > size(b); });
    components.resize(std::min(components.size(), kMaxComponents));
    Json list = Json::array();
    for (const SurfaceComponent& component : components) {
        list.push_back({{"vertices", component.vertices},
                        {"triangles", component.triangles},
                        {"genus", orNull(component.genus())},
                        {"areaMm2", number(component.areaMm2)},
                        {"volumeMm3", component.isClosed() ? number(component.signedVolumeMm3)
                                                           : Json(nullptr)}});
    }
    return list;
}

Json soundnessJson(const SurfaceRecord& surface) {
    const TopologyReport& topology = surface.topology;
    return {{"closed", topology.isClosed()},
            {"boundaryEdges", topology.count(TopologyDefect::BoundaryEdge)},
            {"nonManifoldEdges", topology.count(TopologyDefect::NonManifoldEdge)},
            {"inconsistentEdges", topology.count(TopologyDefect::InconsistentEdge)},
            {"nonManifoldVertices", topology.count(TopologyDefect::NonManifoldVertex)},
            {"degenerateTriangles", topology.count(TopologyDefect::DegenerateTriangle)},
            {"duplicateTriangles", topology.count(TopologyDefect::DuplicateTriangle)},
            {"unusedVertices", topology.count(TopologyDefect::UnusedVertex)},
            {"crossingPairs", orNull(surface.crossingPairs)},
            {"insideOutPieces", orNull(surface.insideOutPieces)}};
}

}  // namespace

Json imageJson(const std::string& format, const ImageGeometry& geometry, PixelType pixelType,
               const ValueRange& range, const std::vector<Warning>& warnings) {
    Json json{{"format", format}};
    json.update(geometryJson(geometry));
    json["pixelType"] = toString(pixelType);
    json["minimum"] = number(range.minimum);
    json["maximum"] = number(range.maximum);
    json["warnings"] = warnings;
    return json;
}

Json surfaceOptionsJson(const ExtractionOptions& extraction, const IndexOptions& index,
                        const ComponentSelection& selection) {
    Json json = valuesJson(methodOptions(), extraction);
    json.update(valuesJson(discretizedOptions(), extraction.discretized));
    json.update(valuesJson(aimOptions(AimedSurface::OfScan), extraction.adaptive));
    json.update(valuesJson(indexOptions(), index));
    json.update(valuesJson(pieceOptions(), selection));
    return json;
}

Json workJson(const std::optional<AdaptiveWork>& work) {
    const auto part = [&](auto member) { return work ? Json((*work).*member) : Json(); };
    return {{"runs", part(&AdaptiveWork::runs)},
            {"placesMended", part(&AdaptiveWork::placesMended)},
            {"verticesUndone", part(&AdaptiveWork::verticesUndone)},
            {"trianglesKept", part(&AdaptiveWork::trianglesKept)}};
}

Json surfaceJson(const SurfaceRecord& surface, Method method, int blockSize) {
    const ExtractionStatistics& statistics = surface.statistics;
    const TopologyReport& topology = surface.topology;
    return {
        {"isovalue", surface.isovalue},
        {"isovalueChosenBy", surface.isAutomatic ? "otsu" : "user"},
        {"method", toString(method)},
        {"blocks",
         {{"size", blockSize},
          {"total", statistics.blocksTotal},
          {"active", statistics.blocksActive},
          {"nodesVisited", statistics.indexNodesVisited}}},
        {"boxes", boxesJson(statistics.boxes)},
        {"boxesChangingTopology", statistics.boxesChangingTopology},
        {"edgesSplit", statistics.edgesSplit},
        {"errorBoundMm", orNull(surface.errorBoundMm())},
        {"roundingMm", orNull(surface.roundingMm)},
        {"verifiedSamples", surface.verification ? Json(surface.verification->samples) : Json()},
        {"verifiedMaxMm", surface.verification ? number(surface.verification->maxMm) : Json()},
        {"wantedTriangles", orNull(statistics.wantedTriangles)},
        {"countMet", orNull(surface.countMet())},
        {"adaptive", workJson(statistics.adaptiveWork)},
        {"triangles", topology.triangles},
        {"vertices", topology.vertices},
        {"marchingCubesTriangles", statistics.marchingCubesTriangles},
        {"areaMm2", number(surface.areaMm2)},
        {"volumeMm3", orNull(surface.volumeMm3)},
        {"genus", orNull(topology.genus())},
        {"componentCount", topology.components.size()},
        {"components", componentsJson(topology)},
        {"soundness", soundnessJson(surface)}};
}

}  // namespace adaptiso
