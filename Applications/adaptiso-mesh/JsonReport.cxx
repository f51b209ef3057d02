#include "JsonReport.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/ImageJson.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"

namespace adaptiso {
namespace {

/// Components listed in full; a noisy image has thousands.
constexpr std::size_t kMaxComponents = 100;

std::string_view borderWord(Border border) {
    return border == Border::Closed ? "closed" : "open";
}

Json inputJson(const MeshRun& run) {
    const InputSummary& input = run.input;
    Json json{{"file", baseName(run.options.input)}, {"format", input.format}};
    json.update(geometryJson(input.geometry));
    json["pixelType"] = toString(input.pixelType);
    json["minimum"] = number(input.range.minimum);
    json["maximum"] = number(input.range.maximum);
    json["warnings"] = input.warnings;
    return json;
}

Json preprocessedJson(const MeshRun& run) {
    if (!run.preprocessed) return nullptr;
    Json json = preprocessingJson(run.options.preprocessing, run.input.geometry.size);
    json.update(geometryJson(run.preprocessed->geometry));
    json["pixelType"] = toString(run.preprocessed->pixelType);
    json["minimum"] = number(run.preprocessed->range.minimum);
    json["maximum"] = number(run.preprocessed->range.maximum);
    return json;
}

Json optionsJson(const MeshOptions& options) {
    return {{"method", toString(options.method)},
            {"adjustVertices", options.adjustVertices},
            {"mergeWithinBlocks", options.mergeWithinBlocks},
            {"maxErrorMm", orNull(options.adaptive.maxErrorMm)},
            {"maxTriangles", orNull(options.adaptive.maxTriangles)},
            {"reduction", orNull(options.adaptive.reduction)},
            {"minAngleDeg", options.adaptive.minAngleDeg},
            {"blockSize", options.index.blockSize},
            {"border", borderWord(options.index.border)},
            {"search", toString(options.index.search)},
            {"largest", options.selection.largestOnly},
            {"minVolumeMm3", options.selection.minVolumeMm3},
            {"fillCavities", options.selection.fillCavities},
            {"threads", orNull(options.common.threads)},
            {"strict", options.common.isStrict}};
}

Json indexJson(const IndexSummary& index) {
    const bool hasFile = !index.file.empty();
    return {{"search", toString(index.search)},
            {"memoryBytes", index.memoryBytes},
            {"source", index.isLoaded ? "file" : "built"},
            {"file", hasFile ? Json(baseName(index.file)) : Json(nullptr)},
            {"fileBytes", hasFile ? Json(index.fileBytes) : Json(nullptr)}};
}

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

Json soundnessJson(const SurfaceSummary& surface) {
    const TopologyReport& topology = surface.topology;
    return {{"closed", topology.isClosed()},
            {"boundaryEdges", topology.count(TopologyDefect::BoundaryEdge)},
            {"nonManifoldEdges", topology.count(TopologyDefect::NonManifoldEdge)},
            {"inconsistentEdges", topology.count(TopologyDefect::InconsistentEdge)},
            {"nonManifoldVertices", topology.count(TopologyDefect::NonManifoldVertex)},
            {"degenerateTriangles", topology.count(TopologyDefect::DegenerateTriangle)},
            {"duplicateTriangles", topology.count(TopologyDefect::DuplicateTriangle)},
            {"unusedVertices", topology.count(TopologyDefect::UnusedVertex)},
            {"crossingPairs", orNull(surface.crossingPairs)}};
}

Json surfaceJson(const MeshRun& run, const SurfaceSummary& surface) {
    const ExtractionStatistics& statistics = surface.statistics;
    const TopologyReport& topology = surface.topology;
    return {
        {"isovalue", surface.isovalue},
        {"isovalueChosenBy", surface.isAutomatic ? "otsu" : "user"},
        {"method", toString(run.options.method)},
        {"blocks",
         {{"size", run.options.index.blockSize},
          {"total", statistics.blocksTotal},
          {"active", statistics.blocksActive},
          {"nodesVisited", statistics.indexNodesVisited}}},
        {"boxes", boxesJson(statistics.boxes)},
        {"boxesChangingTopology", statistics.boxesChangingTopology},
        {"edgesSplit", statistics.edgesSplit},
        {"errorBoundMm", orNull(statistics.errorBoundMm)},
        {"verifiedSamples", surface.verification ? Json(surface.verification->samples) : Json()},
        {"verifiedMaxMm", surface.verification ? number(surface.verification->maxMm) : Json()},
        {"wantedTriangles", orNull(statistics.wantedTriangles)},
        {"countMet", orNull(surface.countMet())},
        {"triangles", topology.triangles},
        {"vertices", topology.vertices},
        {"marchingCubesTriangles", statistics.marchingCubesTriangles},
        {"areaMm2", number(surface.areaMm2)},
        {"volumeMm3", orNull(surface.volumeMm3)},
        {"genus", orNull(topology.genus())},
        {"componentCount", topology.components.size()},
        {"components", componentsJson(topology)},
        {"soundness", soundnessJson(surface)},
        {"output",
         {{"file", surface.file.filename().string()},
          {"format", surface.format->name},
          {"coordinates", frameWord(surface.frame)},
          {"bytes", surface.bytes},
          {"written", !run.failsStrict()}}}};
}

}  // namespace

std::string jsonReport(const MeshRun& run) {
    Json surfaces = Json::array();
    for (const SurfaceSummary& surface : run.surfaces) {
        surfaces.push_back(surfaceJson(run, surface));
    }
    const Json report{{"schema", "adaptiso-mesh/1"},
                      {"program", {{"name", "adaptiso-mesh"}, {"version", programVersion()}}},
                      {"input", inputJson(run)},
                      {"preprocessing", preprocessedJson(run)},
                      {"options", optionsJson(run.options)},
                      {"index", indexJson(run.index)},
                      {"surfaces", surfaces},
                      {"warnings", run.warnings},
                      {"failedByWarnings", run.failsStrict()},
                      {"reportFailure", reportFailureJson(run.reportFailure)},
                      {"seconds", secondsJson(run.timer)},
                      {"peakMemoryMb", peakMemoryMb()}};
    // a file's name need not be UTF-8: what is not becomes U+FFFD
    return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace adaptiso
