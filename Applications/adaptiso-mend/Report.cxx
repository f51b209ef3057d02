#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::mender {
namespace {

/// A count of faults, its key in the report and its words.
struct FaultRow {
    std::string_view key;
    std::int64_t MendStatistics::*count;
    const char *one, *many;
};

constexpr FaultRow kFaults[] = {
    {"borderEdges", &MendStatistics::borderEdges, "open border edge", "open border edges"},
    {"badEdges", &MendStatistics::badEdges, "edge that is no manifold's",
     "edges that are no manifold's"},
    {"badVertices", &MendStatistics::badVertices, "vertex whose triangles are not one fan",
     "vertices whose triangles are not one fan"},
    {"crossingTriangles", &MendStatistics::crossingTriangles, "triangle that crosses another",
     "triangles that cross others"},
    {"flippedTriangles", &MendStatistics::flippedTriangles, "triangle that faced the other way",
     "triangles that faced the other way"},
    {"degenerateTriangles", &MendStatistics::degenerateTriangles, "triangle without area, dropped",
     "triangles without area, dropped"},
    {"duplicateTriangles", &MendStatistics::duplicateTriangles,
     "triangle on the corners of another, dropped", "triangles on the corners of others, dropped"},
    {"mergedPoints", &MendStatistics::mergedPoints, "point of a border merged with another",
     "points of borders merged with others"},
};

/// Places, their key in the report and their words.
struct PlacesRow {
    std::string_view key;
    std::vector<MendedPlace> MendStatistics::*places;
    const char *one, *many;
};

const PlacesRow kPlaces[] = {
    {"filled", &MendStatistics::filled, "hole closed", "holes closed"},
    {"leftOpen", &MendStatistics::leftOpen, "hole left open", "holes left open"},
    {"inner", &MendStatistics::inner, "part inside the solid dropped",
     "parts inside the solid dropped"},
    {"thin", &MendStatistics::thin, "part too thin for the bound dropped",
     "parts too thin for the bound dropped"},
};

Json placesJson(const std::vector<MendedPlace>& places) {
    Json list = Json::array();
    for (const MendedPlace& place : places) {
        list.push_back({{"middleMm", vector(place.middleMm)},
                        {"spanMm", number(place.spanMm)},
                        {"areaMm2", number(place.areaMm2)}});
    }
    return list;
}

Json foundJson(const MendRun& run) {
    if (!run.isMended()) return nullptr;
    Json json{{"sound", run.statistics.wasSound}};
    for (const FaultRow& row : kFaults) json[std::string(row.key)] = run.statistics.*row.count;
    return json;
}

Json optionsJson(const MendCommand& command) {
    Json json{{"inputCoordinates", inputCoordinatesJson(command.inputCoordinates)}};
    json.update(valuesJson(mendOptions(), command.aim));
    json.update(valuesJson(scaleOptions(), command.scale));
    json["dryRun"] = command.isDryRun;
    json["threads"] = orNull(command.common.threads);
    json["strict"] = command.common.isStrict;
    return json;
}

Json outputJson(const MendRun& run) {
    if (!run.isMended()) return nullptr;
    const MendStatistics& done = run.statistics;
    Json json = surfaceJson(run.output);
    json["scale"] = number(run.output.scale);
    json["bytes"] = run.bytes;
    json["written"] = run.writesSurface();
    json["copied"] = run.isCopy;
    json["maxErrorMm"] = number(done.maxErrorMm);
    json["resultToInputMm"] = number(run.resultToInputMm());
    json["inputToResultMm"] = number(run.inputToResultMm());
    json["roundingMm"] = number(run.roundingMm);
    json["latticeMm"] = number(done.latticeMm);
    json["keptTriangles"] = done.keptTriangles;
    json["cutTriangles"] = done.cutTriangles;
    for (const PlacesRow& row : kPlaces) json[std::string(row.key)] = placesJson(done.*row.places);
    json["verification"] = nullptr;
    if (run.verification) {
        json["verification"] = {{"samples", run.verification->samples},
                                {"maxMm", number(run.verification->maxMm)}};
    }
    json["values"] = run.keptArrays;
    return json;
}

Json resultJson(const MendRun& run) {
    if (!run.isMended()) return adaptiso::resultJson("can't be mended as asked");
    std::vector<std::string> files;
    if (run.writesSurface()) files.push_back(baseName(run.output.file));
    return adaptiso::resultJson(run.statistics.wasSound
                                    ? "is sound"
                                    : "mended: " + formatCount(run.output.triangles) +
                                          " triangles of " + formatCount(run.input.triangles),
                                files);
}

void printPlaces(std::ostream& out, const PlacesRow& row, const std::vector<MendedPlace>& places) {
    if (places.empty()) return;
    double area = 0;
    for (const MendedPlace& place : places) area += place.areaMm2;
    const MendedPlace& widest = places.front();
    out << "  " << counted(std::ssize(places), row.one, row.many) << ", " << formatMeasure(area)
        << " mm2; the widest spans " << formatMeasure(widest.spanMm) << " mm, around "
        << formatShort(widest.middleMm.x) << ", " << formatShort(widest.middleMm.y) << ", "
        << formatShort(widest.middleMm.z) << '\n';
}

void printInput(std::ostream& out, const MendRun& run) {
    const SurfaceSummary& input = run.input;
    out << oneLine(input.file.string()) << ": " << formatCount(input.triangles) << " triangles, "
        << input.format->name << ", " << frameText(input.frame) << '\n';
    if (!run.isMended()) return;
    if (run.statistics.wasSound) {
        out << "  sound: closed, 2-manifold, oriented, nothing crosses\n";
    }
    for (const FaultRow& row : kFaults) {
        const std::int64_t count = run.statistics.*row.count;
        if (count > 0) out << "  " << counted(count, row.one, row.many) << '\n';
    }
}

/// How far the two surfaces lie apart, but for what is listed.
void printDistances(std::ostream& out, const MendRun& run) {
    const MendStatistics& done = run.statistics;
    out << "  no point farther than " << formatBound(run.resultToInputMm()) << " mm from the input"
        << (done.filled.empty() ? "" : ", but for the closed holes")
        << "; no point of the input farther than " << formatBound(run.inputToResultMm())
        << " mm from it"
        << (done.inner.empty() && done.thin.empty() ? "" : ", but for what was dropped")
        << " (proved)\n";
}

void printOutput(std::ostream& out, const MendRun& run) {
    const SurfaceSummary& output = run.output;
    out << (output.file.empty() || run.command.isDryRun ? "mended" : oneLine(output.file.string()))
        << (run.writesSurface() ? "" : " (not written)") << ": " << formatCount(output.triangles)
        << " triangles, " << output.format->name << ", " << frameText(output.frame) << '\n';
    if (run.isCopy) out << "  the input's bytes\n";
    if (run.statistics.wasSound) return;
    out << "  " << formatCount(run.statistics.keptTriangles)
        << " triangles of the input kept as they are\n";
    for (const PlacesRow& row : kPlaces) printPlaces(out, row, run.statistics.*row.places);
    printDistances(out, run);
    for (const std::string& name : run.keptArrays) {
        out << "  with the values " << oneLine(name) << '\n';
    }
}

}  // namespace

std::string jsonReport(const MendRun& run) {
    return run.json("adaptiso-mend/1", {{"input", surfaceJson(run.input)},
                                        {"found", foundJson(run)},
                                        {"options", optionsJson(run.command)},
                                        {"output", outputJson(run)},
                                        {"result", resultJson(run)}});
}

void printReport(std::ostream& out, const MendRun& run) {
    printInput(out, run);
    if (run.isMended()) printOutput(out, run);
    printTimes(out, run.timer);
}

}  // namespace adaptiso::mender
