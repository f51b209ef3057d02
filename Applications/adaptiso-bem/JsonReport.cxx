#include "JsonReport.h"

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "adaptiso/HeadPipeline/BemJson.h"

namespace adaptiso {
namespace {

Json optionsJson(const BemOptions& options) {
    Json json = bemOptionsJson(options.model);
    json["threads"] = orNull(options.common.threads);
    json["strict"] = options.common.isStrict;
    return json;
}

Json outputJson(const BemRun& run) {
    std::vector<std::string> subject;
    for (const auto& path : run.subjectFiles) subject.push_back(baseName(path));
    return bemOutputJson(run.model, run.options.files, run.files, subject);
}

}  // namespace

std::string jsonReport(const BemRun& run) {
    Json report = reportHead("adaptiso-bem/1", "adaptiso-bem", run.verdict, run.model.warnings);
    report.update(
        Json{{"model", run.model.hasModel() && !run.failsStrict() && !run.options.isDryRun},
             {"failedByWarnings", run.failsStrict()},
             {"input", bemInputJson(run.model)},
             {"options", optionsJson(run.options)}});
    report.update(bemModelJson(run.model));
    report["output"] = outputJson(run);
    report["reportFailure"] = reportFailureJson(run.verdict.reportFailure);
    report["seconds"] = secondsJson(run.timer);
    report["peakMemoryMb"] = peakMemoryMb();
    return jsonText(report) + "\n";
}

}  // namespace adaptiso
