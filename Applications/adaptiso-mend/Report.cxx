#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/Mending/MendJson.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::mender {
namespace {

Json foundJson(const MendRun& run) {
    if (!run.isSearched) return nullptr;
    Json json{{"sound", run.statistics.wasSound}};
    json.update(mendFaultsJson(run.statistics));
    return json;
}

Json optionsJson(const MendCommand& command) {
    Json json{{"inputCoordinates", inputCoordinatesJson(command.inputCoordinates)}};
    json.update(valuesJson(mendOptions(), command.aim));
    json.update(valuesJson(pieceOptions(), command.aim.pieces));
    json["around"] = command.around.empty() ? Json() : Json(baseName(command.around));
    json["gapMm"] = orNull(command.gapMm);
    json.update(valuesJson(scaleOptions(), command.scale));
    json["dryRun"] = command.isDryRun;
    json["threads"] = orNull(command.common.threads);
    json["strict"] = command.common.isStrict;
    return json;
}

/// How it lies around another surface; null: none was given.
Json aroundJson(const MendRun& run) {
    if (run.command.around.empty()) return nullptr;
    return {{"file", baseName(run.command.around)},
            {"gapMm", number(run.gapMm)},
            {"movedVertices", run.move.movedVertices},
            {"meanMoveMm", number(run.move.meanMm)},
            {"largestMoveMm", number(run.move.maximumMm)}};
}

Json outputJson(const MendRun& run) {
    if (!run.isMended()) return nullptr;
    const MendStatistics& done = run.statistics;
    Json json = figuresJson(summaryFigures(), run.output);
    json["scale"] = number(run.output.scale);
    json["bytes"] = run.bytes;
    json["written"] = run.writesSurface();
    json["copied"] = run.isCopy;
    json["maxErrorMm"] = number(done.maxErrorMm * run.output.scale);
    json["resultToInputMm"] = number(run.resultToInputMm());
    json["inputToResultMm"] = number(run.inputToResultMm());
    json["roundingMm"] = number(run.roundingMm);
    json["latticeMm"] = number(done.latticeMm);
    json["keptTriangles"] = done.keptTriangles;
    json["cutTriangles"] = done.cutTriangles;
    json.update(mendPlacesJson(done));
    json["around"] = aroundJson(run);
    json["verification"] = verificationJson(run.verification);
    json["values"] = run.keptArrays;
    return json;
}

Json resultJson(const MendRun& run) {
    if (!run.isMended()) {
        return adaptiso::resultJson("can't be mended as asked: " + run.refusal);
    }
    std::vector<std::string> files;
    if (run.writesSurface()) files.push_back(baseName(run.output.file));
    return adaptiso::resultJson(run.isUnchanged()
                                    ? "is sound"
                                    : "mended: " + formatCount(run.output.triangles) +
                                          " triangles of " + formatCount(run.input.triangles),
                                files);
}

void printInput(std::ostream& out, const MendRun& run) {
    const SurfaceSummary& input = run.input;
    out << oneLine(input.file.string()) << ": " << formatCount(input.triangles) << " triangles, "
        << input.format->name << ", " << frameText(input.frame) << '\n';
    if (run.statistics.wasSound) {
        out << "  sound: " << (run.statistics.leftOpen.empty() ? "closed" : "open")
            << ", 2-manifold, oriented, nothing crosses\n";
    }
    for (const std::string& fault : mendFaultTexts(run.statistics)) out << "  " << fault << '\n';
}

void printAround(std::ostream& out, const MendRun& run) {
    if (run.command.around.empty()) return;
    out << "  " << formatMeasure(run.gapMm) << " mm around "
        << oneLine(baseName(run.command.around));
    if (run.move.movedVertices > 0) {
        out << ": " << counted(run.move.movedVertices, "vertex", "vertices") << " moved, by up to "
            << formatMeasure(run.move.maximumMm) << " mm";
    }
    out << '\n';
}

void printOutput(std::ostream& out, const MendRun& run) {
    const SurfaceSummary& output = run.output;
    out << (output.file.empty() || run.command.isDryRun ? "mended" : oneLine(output.file.string()))
        << (run.writesSurface() ? "" : " (not written)") << ": " << formatCount(output.triangles)
        << " triangles, " << output.format->name << ", " << frameText(output.frame) << '\n';
    if (run.isCopy) out << "  the input's bytes\n";
    printAround(out, run);
    if (run.isUnchanged()) return;
    out << "  " << formatCount(run.statistics.keptTriangles) << " triangles of the input kept"
        << (run.move.movedVertices > 0 ? ", then moved" : " as they are") << '\n';
    for (const std::string& places : mendPlaceTexts(run.statistics)) out << "  " << places << '\n';
    out << "  " << mendDistanceText(run.statistics, run.shiftMm()) << '\n';
    for (const std::string& name : run.keptArrays) {
        out << "  with the values " << oneLine(name) << '\n';
    }
}

void addVerdict(const MendRun& run, Report& report) {
    const std::string input = baseName(run.input.file);
    report.title = run.isMended() ? input + " mended" : "Mending of " + input;
    report.verdict = run.isMended() ? ReportVerdict::Passed : ReportVerdict::Failed;
    if (!run.isMended()) {
        report.headline = "Not mended: " + run.refusal + ".";
    } else if (run.isUnchanged()) {
        report.headline = "Sound as it was given.";
    } else {
        report.headline = formatCount(run.output.triangles) + " triangles of " +
                          formatCount(run.input.triangles) + "; " +
                          mendDistanceText(run.statistics, run.shiftMm()) + ".";
    }
}

void addChecks(const MendRun& run, Report& report) {
    const std::string input = baseName(run.input.file);
    for (const std::string& fault : mendFaultTexts(run.statistics)) {
        report.checks.push_back({input, "sound", ReportOutcome::Noted, fault});
    }
    if (!run.isMended()) return;
    const std::string output = run.output.file.empty() ? "result" : baseName(run.output.file);
    const bool isOpen = !run.statistics.leftOpen.empty();
    report.checks.push_back(
        {output,
         std::string(isOpen ? "" : "closed, ") + "2-manifold, oriented, not crossing itself",
         ReportOutcome::Passed, ""});
    const bool isMoved = run.move.movedVertices > 0;
    report.checks.push_back(
        {output, "within the proved distances", ReportOutcome::Passed,
         formatBound(std::max(run.resultToInputMm(), run.inputToResultMm())) + " mm, " +
             (isMoved
                  ? "with the move of up to " + formatMeasure(run.move.maximumMm)
                  : "the bound is " + formatBound(run.statistics.maxErrorMm * run.output.scale)) +
             " mm"});
    if (run.command.around.empty()) return;
    report.checks.push_back({output, "around " + baseName(run.command.around),
                             ReportOutcome::Passed, formatMeasure(run.gapMm) + " mm at least"});
}

}  // namespace

std::string jsonReport(const MendRun& run) {
    return run.json("adaptiso-mend/1", {{"input", figuresJson(summaryFigures(), run.input)},
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

Report makeReport(const MendRun& run, const MeshFile& input, const TriangleMesh& shown) {
    Report report;
    addVerdict(run, report);
    report.inputs.push_back(
        {"Surface", fileText(run.input.file, *run.input.format, run.input.frame)});
    addOptions(mendOptions(), run.command.aim, report.options);
    addOptions(pieceOptions(), run.command.aim.pieces, report.options);
    addChecks(run, report);
    report.notes = mendPlaceTexts(run.statistics);
    const ShownFrame frame = shownFrame(input);
    for (const auto& [what, place] : mendPlaces(run.statistics)) {
        report.spots.push_back({what + ", " + formatMeasure(place.spanMm) + " mm wide",
                                frame.toLps(place.middleMm), false});
    }
    run.show(transformed(input.mesh, frame.toLps), shown, frame, report);
    return report;
}

}  // namespace adaptiso::mender
