#include "JsonReport.h"

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "Common/Warnings.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"

namespace adaptiso {
namespace {

Json deviationJson(const std::optional<DistanceStatistics>& deviation) {
    if (!deviation) return nullptr;
    return {{"samples", deviation->samples},
            {"meanMm", number(deviation->meanMm)},
            {"rmsMm", number(deviation->rmsMm)},
            {"p95Mm", number(deviation->p95Mm)},
            {"p99Mm", number(deviation->p99Mm)},
            {"maxMm", number(deviation->maxMm)},
            {"maxPointMm", vector(deviation->maxPointMm)}};
}

/// Why a file can't be read, without the folders of its name.
std::string errorText(const SurfaceRun& surface) {
    const std::string path = surface.file.string();
    const bool namesIt = surface.error.starts_with(path);
    return namesIt ? baseName(surface.file) + surface.error.substr(path.size()) : surface.error;
}

Json surfaceJson(const SurfaceRun& surface) {
    if (!surface.error.empty()) {
        return {{"file", baseName(surface.file)}, {"error", errorText(surface)}, {"passed", false}};
    }
    Json json{{"file", baseName(surface.file)}, {"error", nullptr}};
    json.update(verdictJson(surface.checks));
    json["format"] = surface.format->name;
    json["coordinates"] = frameJson(surface.frame);
    json["pointsIn"] = frameJson(surface.points);
    json.update(factsJson(surface.facts));
    json["isosurface"] = deviationJson(surface.deviation);
    return json;
}

Json nestingJson(const CheckRun& run) {
    if (!run.options.isNested) return nullptr;
    Json pairs = Json::array();
    for (const NestingRun& pair : run.nesting) {
        Json json{{"inner", baseName(run.surfaces[pair.inner].file)},
                  {"outer", baseName(run.surfaces[pair.outer].file)}};
        json.update(nestingJson(pair.report, pair.checks, run.toNestingFrame));
        pairs.push_back(json);
    }
    return {{"pointsIn", frameJson(run.nestingFrame)}, {"pairs", pairs}};
}

Json volumeJson(const CheckRun& run) {
    if (!run.volume) return nullptr;
    return {
        {"file", baseName(run.options.volume)},
        {"format", run.volume->format},
        {"sizeVoxels", run.volume->geometry.size},
        {"spacingMm", vector(run.volume->geometry.spacingMm())},
        {"preprocessing", preprocessingJson(run.options.preprocessing, run.volume->geometry.size)}};
}

Json optionsJson(const CheckOptions& options) {
    return {{"inputCoordinates", inputCoordinatesJson(options.inputCoordinates)},
            {"nested", options.isNested},
            {"profile", toString(options.profileInUse())},
            {"iso", orNull(options.isovalue)},
            {"minGapMm", options.minGapMm.value_or(CheckOptions::kDefaultMinGapMm)},
            {"minAngleDeg", options.minAngleDeg.value_or(CheckOptions::kDefaultMinAngleDeg)},
            {"maxOffMm", orNull(options.maxOffMm)},
            {"maxPairs", options.maxPairs},
            {"threads", orNull(options.common.threads)},
            {"strict", options.common.isStrict}};
}

}  // namespace

std::string jsonReport(const CheckRun& run) {
    Json surfaces = Json::array();
    for (const SurfaceRun& surface : run.surfaces) surfaces.push_back(surfaceJson(surface));
    Json report = reportHead("adaptiso-check/1", "adaptiso-check", run.verdict, run.warnings);
    report.update(Json{{"options", optionsJson(run.options)},
                       {"volume", volumeJson(run)},
                       {"surfaces", surfaces},
                       {"nesting", nestingJson(run)},
                       {"plausibility", notesJson(run.notes)},
                       {"failedByWarnings", failsStrict(run.options.common, run.warnings)},
                       {"reportFailure", reportFailureJson(run.verdict.reportFailure)},
                       {"seconds", secondsJson(run.timer)},
                       {"peakMemoryMb", peakMemoryMb()}});
    return jsonText(report) + "\n";
}

}  // namespace adaptiso
