#include "JsonReport.h"

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::simplifier {
namespace {

Json surfaceJson(const SurfaceSummary& surface) {
    const TopologyReport& topology = surface.topology;
    return {{"file", baseName(surface.file)},
            {"format", surface.format->name},
            {"coordinates", frameJson(surface.frame)},
            {"triangles", surface.triangles},
            {"vertices", surface.vertices},
            {"components", std::ssize(topology.components)},
            {"genus", orNull(topology.genus())},
            {"closed", topology.isClosed()},
            {"areaMm2", number(surface.areaMm2)}};
}

Json findingsJson(const std::vector<Finding>& findings) {
    Json list = Json::array();
    for (const Finding& finding : findings) {
        list.push_back({{"what", finding.key},
                        {"count", finding.count},
                        {"firstMm", finding.placeMm ? vector(*finding.placeMm) : Json(nullptr)},
                        {"dropped", finding.isDropped}});
    }
    return list;
}

Json inputJson(const SimplifyRun& run) {
    Json json = surfaceJson(run.input);
    json["sound"] = isSound(run.findings);
    json["findings"] = findingsJson(run.findings);
    return json;
}

Json optionsJson(const SimplifyCommand& command) {
    return {{"inputCoordinates", inputCoordinatesJson(command.inputCoordinates)},
            {"maxErrorMm", orNull(command.aim.maxErrorMm)},
            {"triangles", orNull(command.aim.maxTriangles)},
            {"reduction", orNull(command.aim.reduction)},
            {"minAngleDeg", number(command.aim.minAngleDeg)},
            {"keepBorders", command.aim.keepBorders},
            {"requireSound", command.requiresSound},
            {"threads", orNull(command.common.threads)},
            {"strict", command.common.isStrict}};
}

Json outputJson(const SimplifyRun& run) {
    if (run.failsSoundness()) return nullptr;
    Json json = surfaceJson(run.output);
    json["bytes"] = run.bytes;
    json["written"] = run.writesSurface();
    json["wantedTriangles"] = orNull(run.statistics.wantedTriangles);
    json["countMet"] = orNull(run.countMet());
    json["errorBoundMm"] = number(run.errorBoundMm());
    json["adaptive"] = workJson(run.statistics.work);
    json["roundingMm"] = number(run.roundingMm);
    json["verification"] = {{"samples", run.verification->samples},
                            {"maxMm", number(run.verification->maxMm)}};
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

}  // namespace

std::string jsonReport(const SimplifyRun& run) {
    Json report = reportHead("adaptiso-simplify/1", "adaptiso-simplify", run.verdict, run.warnings);
    report.update(Json{{"input", inputJson(run)},
                       {"options", optionsJson(run.command)},
                       {"output", outputJson(run)},
                       {"data", dataJson(run)},
                       {"failedBySoundness", run.failsSoundness()},
                       {"failedByWarnings", run.failsStrict()},
                       {"reportFailure", reportFailureJson(run.verdict.reportFailure)},
                       {"seconds", secondsJson(run.timer)},
                       {"peakMemoryMb", peakMemoryMb()}});
    return jsonText(report) + "\n";
}

}  // namespace adaptiso::simplifier
