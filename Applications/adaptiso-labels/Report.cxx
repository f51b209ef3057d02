#include <ostream>
#include <string>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadPipeline/TetrahedraJson.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::labels {
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

/// "1 region", "3 regions"
std::string counted(std::int64_t count, const std::string& what) {
    return formatCount(count) + " " + what + (count == 1 ? "" : "s");
}

void printWalls(std::ostream& out, const LabelsRun& run) {
    const LabelStatistics& statistics = run.statistics;
    out << "  " << counted(run.triangles, "triangle") << ", " << formatCount(run.points)
        << " vertices in walls that are stored once; "
        << (run.isPart() ? "the whole map has " + formatCount(statistics.mapTriangles) +
                               ", at full resolution "
                         : "the full resolution has ")
        << formatCount(statistics.fullTriangles) << '\n';
    if (run.errorBoundMm() > 0) {
        out << "  no wall farther than " << formatBound(run.errorBoundMm())
            << " mm from that of the full resolution, nor that from it (proved)\n";
    }
    if (statistics.wantedTriangles && statistics.mapTriangles > *statistics.wantedTriangles) {
        out << "  " << formatCount(*statistics.wantedTriangles) << " triangles were asked for"
            << (run.isPart() ? " in the whole map" : "")
            << "; keeping all regions, pieces and junctions left little to gain\n";
    }
}

}  // namespace

std::string folderReport(const LabelsRun& run) {
    return jsonText(sharedJson(run)) + "\n";
}

std::string jsonReport(const LabelsRun& run) {
    Json json = sharedJson(run);
    json["passed"] = run.verdict.exitCode == kExitOk;
    Json& output = json["output"];
    output["folder"] = baseName(run.folder);
    output["written"] = run.writesFolder();
    output["files"] = Json::array();
    for (const auto& [name, bytes] : run.files) {
        output["files"].push_back({{"file", name}, {"bytes", bytes}});
    }
    json["options"]["threads"] = orNull(run.options.common.threads);
    return run.json("adaptiso-labels/1", json);
}

void printReport(std::ostream& out, const LabelsRun& run) {
    out << oneLine(run.folder.string()) << (run.writesFolder() ? "" : " (not written)") << ": "
        << counted(std::ssize(run.regions), "region") << " of "
        << oneLine(run.options.input.filename().string()) << ", " << run.format->name << ", "
        << toString(run.frame) << '\n';
    printWalls(out, run);
    if (run.tetrahedra) {
        out << "  "
            << describeTetrahedra(run.tetrahedra->mesh, run.tetrahedra->report,
                                  run.options.tetrahedra.mesher)
            << '\n';
    }
    for (const LabelsCheck& check : run.checks) {
        out << "  " << (check.isPassed ? "holds:  " : "FAILED: ") << check.name
            << (check.isPassed ? "" : ": " + check.finding) << '\n';
    }
    if (!run.names.files.empty()) {
        out << "  names and colours of " << oneLine(run.names.files.front());
        for (std::size_t n = 1; n < run.names.files.size(); ++n) {
            out << " and " << oneLine(run.names.files[n]);
        }
        out << " (" << run.names.format << ")\n";
    }
    printTimes(out, run.timer);
}

}  // namespace adaptiso::labels
