#include "JsonReport.h"

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "adaptiso/HeadPipeline/TetrahedraJson.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso {
namespace {

Json inputJson(const LabelsRun& run) {
    const MapSummary& map = run.map;
    Json json{{"file", baseName(run.options.input)}};
    json.update(imageJson(map.format, map.geometry, map.pixelType, map.range, map.warnings));
    json["labels"] = map.labels;
    return json;
}

Json rangesJson(const LabelRanges& ranges) {
    Json json = Json::array();
    for (const LabelRange& range : ranges) json.push_back(toText(range));
    return json;
}

Json optionsJson(const LabelsOptions& options) {
    Json merges = Json::array();
    for (const LabelMerge& merge : options.merges) {
        merges.push_back({{"name", merge.name},
                          {"label", merge.number()},
                          {"labels", rangesJson(merge.labels)}});
    }
    Json conductivities = Json::object();
    for (const auto& [label, value] : options.conductivities) {
        conductivities[std::to_string(label)] = value;
    }
    return {{"labels", options.labels.empty() ? Json(nullptr) : rangesJson(options.labels)},
            {"merges", merges},
            {"maxErrorMm", orNull(options.maxErrorMm)},
            {"maxTriangles", orNull(options.maxTriangles)},
            {"reduction", orNull(options.reduction)},
            {"minAngleDeg", options.minAngleDeg},
            {"layers", options.writesLayers},
            {"conductivities", conductivities},
            {"strict", options.common.isStrict}};
}

Json wallsJson(const LabelsRun& run) {
    const LabelStatistics& statistics = run.statistics;
    return {{"points", run.points},
            {"triangles", run.triangles},
            {"mapTriangles", statistics.mapTriangles},
            {"fullTriangles", statistics.fullTriangles},
            {"wantedTriangles", orNull(statistics.wantedTriangles)},
            {"errorBoundMm", number(run.errorBoundMm())},
            {"cells", statistics.cells},
            {"dividedCells", statistics.dividedCells},
            {"heldVertices", statistics.heldVertices},
            {"mendedCrossings", statistics.mendedCrossings}};
}

Json regionJson(const Region& region) {
    const RegionMeasure& measure = region.measure;
    Json neighbours = Json::array();
    for (const RegionContact& contact : measure.neighbours) {
        neighbours.push_back({{"label", contact.label},
                              {"triangles", contact.triangles},
                              {"areaMm2", number(contact.areaMm2)}});
    }
    const Json abbreviation =
        region.abbreviation.empty() ? Json(nullptr) : Json(region.abbreviation);
    return {{"label", region.label},
            {"name", region.name},
            {"isNamed", region.hasOwnName},
            {"abbreviation", abbreviation},
            {"color", hexText(region.color)},
            {"voxels", region.voxels},
            {"volumeMm3", number(measure.volumeMm3)},
            {"areaMm2", number(measure.areaMm2)},
            {"vertices", measure.vertices},
            {"triangles", measure.triangles},
            {"eulerCharacteristic", measure.eulerCharacteristic},
            {"components", measure.components},
            {"neighbours", neighbours},
            {"file", region.file}};
}

Json tetrahedraJson(const LabelsRun& run) {
    if (!run.tetrahedra) return nullptr;
    const RegionTetrahedra& made = *run.tetrahedra;
    const double voxelMm3 = run.map.geometry.voxelVolumeMm3();
    Json regions = Json::array();
    for (std::size_t n = 0; n < made.regions.size(); ++n) {
        regions.push_back(
            {{"label", made.regions[n].label},
             {"tetrahedra", made.report.counts[n]},
             {"volumeMm3", number(made.report.volumesMm3[n])},
             {"withinWallsMm3", number(made.report.expectedMm3[n])},
             {"voxelsMm3", number(voxelMm3 * static_cast<double>(run.regions[n].voxels))}});
    }
    Json json{{"mesher", run.options.tetrahedra.mesher},
              {"points", std::ssize(made.mesh.points)},
              {"tetrahedra", std::ssize(made.mesh.tetrahedra)},
              {"regions", regions}};
    json.update(elementShapesJson(made.report));
    return json;
}

Json checksJson(const LabelsRun& run) {
    Json checks = Json::array();
    for (const LabelsCheck& check : run.checks) {
        checks.push_back(
            {{"name", check.name}, {"passed", check.isPassed}, {"finding", check.finding}});
    }
    return checks;
}

Json sharedJson(const LabelsRun& run) {
    Json regions = Json::array();
    for (const Region& region : run.regions) regions.push_back(regionJson(region));
    const bool hasNames = !run.names.format.empty();
    return {{"schema", "adaptiso-labels/1"},
            {"program", {{"name", "adaptiso-labels"}, {"version", programVersion()}}},
            {"input", inputJson(run)},
            {"names",
             {{"format", hasNames ? Json(run.names.format) : Json(nullptr)},
              {"files", run.names.files}}},
            {"options", optionsJson(run.options)},
            {"output",
             {{"format", run.format->name},
              {"coordinates", frameWord(run.frame)},
              {"roundingMm", number(run.roundingMm)},
              {"giftiRoundingMm", run.leavesGiftiOut ? Json() : number(run.giftiRoundingMm)}}},
            {"walls", wallsJson(run)},
            {"regions", regions},
            {"tetrahedra", tetrahedraJson(run)},
            {"passed", run.holdsPromises()},
            {"checks", checksJson(run)},
            {"warnings", run.warnings}};
}

std::string textOf(const Json& json) {
    return jsonText(json) + "\n";
}

}  // namespace

std::string folderReport(const LabelsRun& run) {
    return textOf(sharedJson(run));
}

std::string jsonReport(const LabelsRun& run) {
    Json json = reportHead("adaptiso-labels/1", "adaptiso-labels", run.verdict, run.warnings);
    json.update(sharedJson(run));
    json["passed"] = run.verdict.exitCode == kExitOk;
    Json& output = json["output"];
    output["folder"] = baseName(run.folder);
    output["written"] = run.writesFolder();
    output["files"] = Json::array();
    for (const auto& [name, bytes] : run.files) {
        output["files"].push_back({{"file", name}, {"bytes", bytes}});
    }
    json["options"]["threads"] = orNull(run.options.common.threads);
    json["failedByWarnings"] = run.failsStrict();
    json["reportFailure"] = reportFailureJson(run.verdict.reportFailure);
    json["seconds"] = secondsJson(run.timer);
    json["peakMemoryMb"] = peakMemoryMb();
    return textOf(json);
}

}  // namespace adaptiso
