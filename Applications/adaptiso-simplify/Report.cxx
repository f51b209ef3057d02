#include <algorithm>
#include <ostream>
#include <string>

#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::simplifier {
namespace {

Json findingsJson(const std::vector<Finding>& findings) {
    Json list = Json::array();
    for (const Finding& finding : findings) {
        list.push_back({{"what", finding.key},
                        {"count", finding.count},
                        {"isComplete", finding.isComplete},
                        {"firstMm", finding.placeMm ? vector(*finding.placeMm) : Json(nullptr)},
                        {"dropped", finding.isDropped}});
    }
    return list;
}

Json inputJson(const SimplifyRun& run) {
    Json json = figuresJson(summaryFigures(), run.input);
    json["sound"] = isSound(run.findings);
    json["findings"] = findingsJson(run.findings);
    return json;
}

Json optionsJson(const SimplifyCommand& command) {
    Json json{{"inputCoordinates", inputCoordinatesJson(command.inputCoordinates)}};
    json.update(valuesJson(aimOptions(AimedSurface::Mesh), command.aim));
    json.update(valuesJson(simplifyOptions(), command.aim));
    json.update(valuesJson(scaleOptions(), command.scale));
    json["requireSound"] = command.requiresSound;
    json["threads"] = orNull(command.common.threads);
    json["strict"] = command.common.isStrict;
    return json;
}

Json outputJson(const SimplifyRun& run) {
    if (run.failsSoundness()) return nullptr;
    Json json = figuresJson(summaryFigures(), run.output);
    json["scale"] = number(run.output.scale);
    json["bytes"] = run.bytes;
    json["written"] = run.writesSurface();
    json["wantedTriangles"] = orNull(run.statistics.wantedTriangles);
    json["countMet"] = orNull(run.countMet());
    json["errorBoundMm"] = number(run.errorBoundMm());
    json["adaptive"] = workJson(run.statistics.work);
    json["roundingMm"] = number(run.roundingMm);
    json["verification"] = verificationJson(run.verification);
    json["values"] = run.keptArrays;
    return json;
}

Json dataJson(const SimplifyRun& run) {
    Json list = Json::array();
    for (const DataSummary& data : run.data) {
        list.push_back({{"file", baseName(data.file)},
                        {"output", baseName(data.output)},
                        {"format", toString(data.format)},
                        {"arrays", data.arrays},
                        {"labels", data.areLabels}});
    }
    return list;
}

void printInput(std::ostream& out, const SimplifyRun& run) {
    const SurfaceSummary& input = run.input;
    out << oneLine(input.file.string()) << ": " << formatCount(input.triangles) << " triangles, "
        << input.format->name << ", " << frameText(input.frame) << '\n';
    if (isSound(run.findings)) out << "  closed, 2-manifold, oriented, nothing crosses\n";
    for (const Finding& finding : run.findings) out << "  " << finding.text() << '\n';
}

void printOutput(std::ostream& out, const SimplifyRun& run) {
    const SurfaceSummary& output = run.output;
    const double percent =
        100.0 * static_cast<double>(output.triangles) / static_cast<double>(run.input.triangles);
    out << oneLine(output.file.string()) << (run.writesSurface() ? "" : " (not written)") << ": "
        << formatCount(output.triangles) << " triangles (" << formatFixed(percent, 1) << " %), "
        << output.format->name << ", " << frameText(output.frame) << '\n';
    out << "  no point farther than " << formatBound(run.errorBoundMm())
        << " mm from the input, nor it from this one (proved; farthest of "
        << formatCount(run.verification->samples)
        << " points measured: " << formatLength(run.verification->maxMm, 4) << " mm)\n";
    if (!run.countMet().value_or(true)) {
        out << "  " << formatCount(*run.statistics.wantedTriangles) << " triangles were asked for; "
            << (run.command.aim.maxErrorMm
                    ? "the bound of --max-error does not allow as few\n"
                    : "keeping all its pieces, holes and borders left little to gain\n");
    }
    for (const std::string& name : run.keptArrays) {
        out << "  with the values " << oneLine(name) << '\n';
    }
}

void addVerdict(const SimplifyRun& run, Report& report) {
    report.title = baseName(run.input.file) + " simplified";
    if (run.failsSoundness()) {
        report.verdict = ReportVerdict::Failed;
        report.headline = "Not simplified: the surface is not sound, and it is asked to be.";
        return;
    }
    report.headline = formatCount(run.output.triangles) + " triangles of " +
                      formatCount(run.input.triangles) + "; no point farther than " +
                      formatBound(run.errorBoundMm()) +
                      " mm from the input, nor the other way round.";
}

void addInputs(const SimplifyRun& run, Report& report) {
    const SurfaceSummary& input = run.input;
    report.inputs.push_back({"Surface", fileText(input.file, *input.format, input.frame)});
    for (const DataSummary& data : run.data) {
        report.inputs.push_back(
            {"Values", baseName(data.file) + " (" + std::string(toString(data.format)) + ")"});
    }
}

void addFindings(const SimplifyRun& run, Report& report) {
    const auto add = [&](const std::string& subject, const std::string& name, bool holds,
                         const std::string& finding) {
        const ReportOutcome bad =
            run.failsSoundness() ? ReportOutcome::Failed : ReportOutcome::Noted;
        report.checks.push_back({subject, name, holds ? ReportOutcome::Passed : bad, finding});
    };
    const std::string input = baseName(run.input.file);
    if (isSound(run.findings)) {
        add(input, "closed, 2-manifold, oriented, not crossing itself", true, "");
    }
    for (const Finding& finding : run.findings) {
        if (finding.isFault) add(input, "sound", false, finding.text());
    }
    if (run.failsSoundness()) return;
    const std::string output = baseName(run.output.file);
    add(output, "as sound as the input, as written", true, "");
    add(output, "within the proved distance", true,
        formatLength(run.verification->maxMm, 4) + " mm at most at " +
            formatCount(run.verification->samples) + " points, " + formatBound(run.errorBoundMm()) +
            " mm proved");
}

void addSpots(const SimplifyRun& run, const TriangleMesh& input, const ShownFrame& frame,
              Report& report) {
    const std::string in = " in " + baseName(run.input.file);
    for (const Finding& finding : run.findings) {
        if (!finding.placeMm || !finding.isFault) continue;
        if (finding.key == "crossingTriangles" && !run.statistics.crossingTriangles.empty()) {
            SpotClusters clusters(input);
            for (const std::int64_t t : run.statistics.crossingTriangles) {
                clusters.add(middleOf(input, t));
            }
            clusters.tell("crossing triangles" + in, run.failsSoundness(), report.spots);
            continue;
        }
        report.spots.push_back(
            {finding.what + in, frame.toLps(*finding.placeMm), run.failsSoundness()});
    }
}

Json resultJson(const SimplifyRun& run) {
    if (run.failsSoundness()) return adaptiso::resultJson("is not sound");
    std::vector<std::string> files;
    if (run.writesSurface()) {
        files.push_back(baseName(run.output.file));
        for (const DataSummary& data : run.data) files.push_back(baseName(data.output));
    }
    return adaptiso::resultJson(
        formatCount(run.output.triangles) + " triangles of " + formatCount(run.input.triangles),
        files);
}

}  // namespace

std::string jsonReport(const SimplifyRun& run) {
    return run.json("adaptiso-simplify/1", {{"input", inputJson(run)},
                                            {"options", optionsJson(run.command)},
                                            {"output", outputJson(run)},
                                            {"data", dataJson(run)},
                                            {"failedBySoundness", run.failsSoundness()},
                                            {"result", resultJson(run)}});
}

void printReport(std::ostream& out, const SimplifyRun& run) {
    printInput(out, run);
    if (!run.failsSoundness()) {
        printOutput(out, run);
        for (const DataSummary& data : run.data) {
            out << oneLine(data.output.string()) << (run.writesSurface() ? "" : " (not written)")
                << ": " << (data.areLabels ? "labels" : "values") << " of "
                << oneLine(baseName(data.file)) << ", " << toString(data.format) << '\n';
        }
    }
    printTimes(out, run.timer);
}

Report makeReport(const SimplifyRun& run, const MeshFile& input, const TriangleMesh& shown) {
    Report report;
    addVerdict(run, report);
    addInputs(run, report);
    addOptions(aimOptions(AimedSurface::Mesh), run.command.aim, report.options);
    addOptions(simplifyOptions(), run.command.aim, report.options);
    addFindings(run, report);
    const ShownFrame frame = shownFrame(input);
    TriangleMesh before = transformed(input.mesh, frame.toLps);
    addSpots(run, before, frame, report);
    run.show(std::move(before), shown, frame, report);
    return report;
}

}  // namespace adaptiso::simplifier
