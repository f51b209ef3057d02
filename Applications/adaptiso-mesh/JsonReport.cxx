#include "JsonReport.h"

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/PreprocessingOptions.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso {
namespace {

Json inputJson(const MeshRun& run) {
    const InputSummary& input = run.input;
    Json json{{"file", baseName(run.options.input)}};
    json.update(
        imageJson(input.format, input.geometry, input.pixelType, input.range, input.warnings));
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
    Json json = surfaceOptionsJson(options.extraction(), options.index, options.selection);
    json["threads"] = orNull(options.common.threads);
    json["strict"] = options.common.isStrict;
    return json;
}

Json indexJson(const IndexSummary& index) {
    return {{"search", toString(index.search)}, {"memoryBytes", index.memoryBytes}};
}

Json surfaceJson(const MeshRun& run, const SurfaceSummary& surface) {
    Json json = surfaceJson(surface, run.options.method, run.options.index.blockSize);
    json["output"] = {{"file", surface.file.filename().string()},
                      {"format", surface.format->name},
                      {"coordinates", frameWord(surface.frame)},
                      {"bytes", surface.bytes},
                      {"written", !run.failsStrict()}};
    return json;
}

}  // namespace

std::string jsonReport(const MeshRun& run) {
    Json surfaces = Json::array();
    for (const SurfaceSummary& surface : run.surfaces) {
        surfaces.push_back(surfaceJson(run, surface));
    }
    Json report = reportHead("adaptiso-mesh/1", "adaptiso-mesh", run.verdict, run.warnings);
    report.update(Json{{"input", inputJson(run)},
                       {"preprocessing", preprocessedJson(run)},
                       {"options", optionsJson(run.options)},
                       {"index", indexJson(run.index)},
                       {"surfaces", surfaces},
                       {"failedByWarnings", run.failsStrict()},
                       {"reportFailure", reportFailureJson(run.verdict.reportFailure)},
                       {"seconds", secondsJson(run.timer)},
                       {"peakMemoryMb", peakMemoryMb()}});
    return jsonText(report) + "\n";
}

}  // namespace adaptiso
