#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Regions.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadPipeline/TetrahedraJson.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/LabelPipeline/LabelsJson.h"
#include "adaptiso/LabelPipeline/Masks.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::labels {
namespace {

Json inputJson(const LabelsRun& run) {
    const MapSummary& map = run.map;
    Json json{{"file", baseName(run.options.input)}};
    json.update(imageJson(map.format, map.geometry, map.pixelType, map.range, map.warnings));
    json["labels"] = map.labels;
    json["masks"] = masksJson(run.joined);
    return json;
}

/// As text where a double, which readers of JSON take numbers for, does not hold it.
Json idJson(const LabelId& id) {
    constexpr std::int64_t kExact = std::int64_t{1} << 53;
    if (id < LabelId(-kExact) || LabelId(kExact) < id) return idText(id);
    return static_cast<std::int64_t>(id.bits);
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
                          {"label", idJson(merge.number())},
                          {"labels", rangesJson(merge.labels)}});
    }
    Json conductivities = Json::object();
    for (const auto& [label, value] : options.conductivities) {
        conductivities[std::to_string(label)] = value;
    }
    Json json{{"labels", options.labels.empty() ? Json(nullptr) : rangesJson(options.labels)},
              {"merges", merges}};
    json.update(valuesJson(aimOptions(AimedSurface::Walls), options.aims));
    json.update(valuesJson(scaleOptions(), options.scale));
    json["layers"] = options.writesLayers;
    json["conductivities"] = conductivities;
    json["strict"] = options.common.isStrict;
    return json;
}

Json regionJson(const Region& region, const LabelsRun& run) {
    Json json = measureJson(
        {{"label", idJson(run.ids.of(region.label))},
         {"name", region.name},
         {"isNamed", region.hasOwnName},
         {"abbreviation", region.abbreviation.empty() ? Json(nullptr) : Json(region.abbreviation)},
         {"color", hexText(region.color)},
         {"voxels", region.voxels}},
        region.measure);
    for (Json& neighbour : json["neighbours"]) {
        neighbour["label"] = idJson(run.ids.of(neighbour["label"].get<Label>()));
    }
    json["file"] = region.file;
    return json;
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
    for (const Region& region : run.regions) regions.push_back(regionJson(region, run));
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
              {"coordinates", run.scale == 1 ? Json(frameWord(run.frame)) : Json()},
              {"scale", number(run.scale)},
              {"roundingMm", number(run.roundingMm)},
              {"giftiRoundingMm", run.leavesGiftiOut ? Json() : number(run.giftiRoundingMm)}}},
            {"walls", wallsJson(run.points, run.triangles, run.errorBoundMm(), run.statistics)},
            {"regions", regions},
            {"tetrahedra", tetrahedraJson(run)},
            {"passed", run.holdsPromises()},
            {"checks", checksJson(run)},
            {"warnings", run.warnings}};
}

std::string frameText(const LabelsRun& run) {
    return run.scale == 1 ? std::string(toString(run.frame))
                          : "scaled by " + formatNumber(run.scale);
}

void printMasks(std::ostream& out, const LabelsRun& run) {
    const JoinedMasks& joined = run.joined;
    if (joined.masks.empty()) return;
    const auto empty = std::ranges::count(joined.masks, 0, &MaskFate::voxels);
    out << "  joined of " << counted(std::ssize(joined.masks), "mask") << ", " << formatCount(empty)
        << " of them empty; " << counted(joined.sharedVoxels, "voxel lies", "voxels lie")
        << " in more than one\n";
}

void printWalls(std::ostream& out, const LabelsRun& run) {
    const LabelStatistics& statistics = run.statistics;
    out << "  " << counted(run.triangles, "triangle") << ", " << formatCount(run.points)
        << " vertices in walls that are stored once; the full resolution has "
        << formatCount(statistics.fullTriangles) << '\n';
    if (run.errorBoundMm() > 0) {
        out << "  no wall farther than " << formatBound(run.errorBoundMm())
            << " mm from that of the full resolution, nor that from it (proved)\n";
    }
    if (statistics.wantedTriangles && run.triangles > *statistics.wantedTriangles) {
        out << "  " << formatCount(*statistics.wantedTriangles)
            << " triangles were asked for; keeping all regions, pieces and junctions left little "
               "to gain\n";
    }
}

/// More regions than that make a page slow to open; the largest are shown.
constexpr std::size_t kMostShown = 2000;

/// A region's colour, lightened if too dark for the page's black background.
ReportColor onBlack(const LabelColor& color) {
    constexpr std::uint8_t kDark = 70;
    if (std::ranges::max(color) >= kDark) return color;
    ReportColor lighter{};
    for (std::size_t n = 0; n < 3; ++n) {
        lighter[n] = static_cast<std::uint8_t>(color[n] + kDark);
    }
    return lighter;
}

void addVerdict(const LabelsRun& run, Report& report) {
    const std::size_t count = run.regions.size();
    report.title = formatCount(static_cast<std::int64_t>(count)) +
                   (count == 1 ? " region of " : " regions of ") + baseName(run.options.input);
    if (run.holdsPromises()) {
        report.headline =
            "Written: each region closed, outward and manifold; neighbours share one wall; no "
            "triangle crosses another; every voxel centre lies in the region of its label.";
        return;
    }
    report.verdict = ReportVerdict::Failed;
    report.headline = "Not written: the walls do not keep what is promised of them.";
}

void addInputs(const LabelsRun& run, Report& report) {
    const MapSummary& map = run.map;
    report.inputs = imageFacts(baseName(run.options.input), map.format, map.geometry);
    report.inputs.push_back(
        {"Labels", formatCount(map.labels) + " (" + std::string(toString(map.pixelType)) + ")"});
    const std::string names = joined(run.names.files);
    report.inputs.push_back(
        {"Names", names.empty() ? "none found" : names + " (" + run.names.format + ")"});
}

void addOptions(const LabelsRun& run, Report& report) {
    const LabelsOptions& options = run.options;
    const auto add = [&](const std::string& name, const std::string& value) {
        report.options.push_back({name, value});
    };
    if (!options.labels.empty()) {
        add("Regions asked for", joined(options.labels, toText));
    }
    for (const LabelMerge& merge : options.merges) {
        add("Merged", merge.name + " = " + joined(merge.labels, toText));
    }
    const LabelStatistics& statistics = run.statistics;
    add("Triangles", formatCount(run.triangles) + " in walls stored once; full resolution " +
                         formatCount(statistics.fullTriangles));
    add("Distance to the full resolution",
        run.errorBoundMm() > 0
            ? "at most " + formatBound(run.errorBoundMm()) + " mm, both ways (proved)"
            : "none, these are its walls");
    addOptions(scaleOptions(), options.scale, report.options);
    add("Format, frame", std::string(run.format->name) + ", " + frameText(run));
}

void addFindings(const LabelsRun& run, Report& report) {
    for (const LabelsCheck& check : run.checks) {
        report.checks.push_back({"all walls", check.name,
                                 check.isPassed ? ReportOutcome::Passed : ReportOutcome::Failed,
                                 check.finding});
        for (std::size_t n = 0; n < check.pointsMm.size(); ++n) {
            report.spots.push_back(
                {"not so: " + check.name, check.pointsMm[n], true, static_cast<int>(n)});
        }
    }
}

/// Whom a region meets most, by area.
std::string neighboursText(const LabelsRun& run, const Region& region) {
    constexpr std::size_t kMost = 4;
    std::vector<RegionContact> contacts = region.measure.neighbours;
    std::ranges::stable_sort(contacts, std::ranges::greater{}, &RegionContact::areaMm2);
    std::string text;
    for (std::size_t n = 0; n < std::min(contacts.size(), kMost); ++n) {
        text += (n == 0 ? "" : ", ") + run.nameOf(contacts[n].label) + " " +
                formatMeasure(contacts[n].areaMm2);
    }
    const std::size_t more = contacts.size() - std::min(contacts.size(), kMost);
    return more == 0 ? text : text + ", " + std::to_string(more) + " more";
}

ReportTable regionTable(const LabelsRun& run, const std::vector<std::size_t>& shown) {
    ReportTable table{"Regions",
                      {"Region", "Label", "Voxels", "Volume, mm³", "Area, mm²", "Triangles",
                       "Pieces", "Euler", "Neighbours, and the area shared, mm²"},
                      {}};
    for (const std::size_t n : shown) {
        const Region& region = run.regions[n];
        const RegionMeasure& measure = region.measure;
        table.rows.push_back({region.name, run.ids.text(region.label), formatCount(region.voxels),
                              formatMeasure(measure.volumeMm3), formatMeasure(measure.areaMm2),
                              formatCount(measure.triangles), formatCount(measure.components),
                              std::to_string(measure.eulerCharacteristic),
                              neighboursText(run, region)});
    }
    return table;
}

/// The regions that are shown, by label.
std::vector<std::size_t> chooseShown(const LabelsRun& run, Report& report) {
    std::vector<std::size_t> shown(run.regions.size());
    for (std::size_t n = 0; n < shown.size(); ++n) shown[n] = n;
    if (shown.size() <= kMostShown) return shown;
    std::ranges::stable_sort(shown, std::ranges::greater{},
                             [&](std::size_t n) { return run.regions[n].voxels; });
    shown.resize(kMostShown);
    std::ranges::sort(shown);
    report.notes.push_back("The page shows the " + formatCount(kMostShown) + " largest of " +
                           formatCount(std::ssize(run.regions)) +
                           " regions; all are in the output.");
    return shown;
}

Json resultJson(const LabelsRun& run) {
    std::vector<std::string> files;
    if (run.writesFolder()) {
        for (const auto& file : run.files) {
            files.push_back((run.isScene ? "" : baseName(run.folder) + "/") + file.first);
        }
    }
    const auto failed = std::ranges::find(run.checks, false, &LabelsCheck::isPassed);
    const std::string says = failed != run.checks.end()
                                 ? "failed: " + failed->name
                                 : formatCount(std::ssize(run.regions)) + " regions, " +
                                       formatCount(run.triangles) + " triangles";
    return adaptiso::resultJson(says, files);
}

}  // namespace

Report makeReport(const LabelsRun& run, const RegionSurfaces& surfaces,
                  const std::string& volumeName, const VolumeView& volume) {
    Report report;
    report.areRegions = true;
    addVerdict(run, report);
    addInputs(run, report);
    addOptions(run, report);
    addFindings(run, report);
    const std::vector<std::size_t> shown = chooseShown(run, report);
    for (const std::size_t n : shown) {
        ReportSurface surface{run.nameOf(run.regions[n].label), surfaces.surface(n)};
        surface.color = onBlack(run.regions[n].color);
        report.surfaces.push_back(std::move(surface));
    }
    report.tables.push_back(regionTable(run, shown));
    report.volume = ReportVolume{volumeName, volume};
    return report;
}

std::string folderReport(const LabelsRun& run) {
    return jsonText(sharedJson(run)) + "\n";
}

std::string jsonReport(const LabelsRun& run) {
    Json json = sharedJson(run);
    json["passed"] = run.verdict.exitCode == kExitOk;
    Json& output = json["output"];
    output["folder"] = run.isScene ? Json() : Json(baseName(run.folder));
    output["written"] = run.writesFolder();
    output["files"] = Json::array();
    for (const auto& [name, bytes] : run.files) {
        output["files"].push_back({{"file", name}, {"bytes", bytes}});
    }
    json["options"]["threads"] = orNull(run.options.common.threads);
    json["result"] = resultJson(run);
    return run.json("adaptiso-labels/1", json);
}

void printReport(std::ostream& out, const LabelsRun& run) {
    out << oneLine(run.folder.string()) << (run.writesFolder() ? "" : " (not written)") << ": "
        << counted(std::ssize(run.regions), "region") << " of "
        << oneLine(run.options.input.filename().string()) << ", " << run.format->name << ", "
        << frameText(run) << '\n';
    printMasks(out, run);
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
