#include <algorithm>
#include <ostream>
#include <string_view>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadPipeline/BemJson.h"

namespace adaptiso::bem {
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

void printSurface(std::ostream& out, HeadSurface which, const BemSurface& surface) {
    out << toString(which) << ": " << formatCount(surface.topology.vertices) << " vertices, "
        << formatCount(surface.topology.triangles) << " triangles, edges "
        << formatFixed(surface.shape.edgeMm.minimum, 1) << " to "
        << formatFixed(surface.shape.edgeMm.maximum, 1) << " mm, angles from "
        << formatFixed(surface.shape.angleDeg.minimum, 0) << " deg, volume "
        << formatRounded(surface.volumeMm3 / 1000) << " cm3\n";
}

Json resultJson(const BemRun& run, bool hasModel) {
    if (!hasModel) {
        const auto& findings = run.model.findings;
        return adaptiso::resultJson("no model: " + (findings.empty() ? "it could not be guaranteed"
                                                                     : findings.front().what));
    }
    std::vector<std::string> files;
    for (const auto& file : run.files) {
        files.push_back(baseName(run.options.output) + "/" + file.first);
    }
    return adaptiso::resultJson(
        "a model of " + std::to_string(run.model.surfaces.size()) + " surfaces", files);
}

}  // namespace

std::string jsonReport(const BemRun& run) {
    const bool hasModel = run.model.hasModel() && !run.failsStrict() && !run.options.isDryRun;
    Json report{{"model", hasModel},
                {"input", bemInputJson(run.model)},
                {"options", optionsJson(run.options)}};
    report.update(bemModelJson(run.model));
    report["output"] = outputJson(run);
    report["result"] = resultJson(run, hasModel);
    return run.json("adaptiso-bem/1", report);
}

void printReport(std::ostream& out, const BemRun& run) {
    for (std::size_t n = 0; n < run.model.surfaces.size() && !run.model.checks.empty(); ++n) {
        printSurface(out, headSurface(n, run.model.surfaces.size()), run.model.surfaces[n]);
    }
    for (std::size_t n = 0; n < run.model.gaps.size(); ++n) {
        out << bemSurfaceName(n, run.model.surfaces.size()) << " to "
            << bemSurfaceName(n + 1, run.model.surfaces.size()) << ": at least "
            << formatFixed(run.model.gaps[n].mm, 2) << " mm, at "
            << rasText(run.model.gaps[n].innerPointMm) << '\n';
    }
    for (const std::string& note : run.model.notes) out << "  " << note << '\n';
    const auto passed = std::count_if(run.model.checks.begin(), run.model.checks.end(),
                                      [](const BemCheck& check) { return check.isPassed; });
    if (!run.model.checks.empty()) {
        out << formatCount(passed) << " of " << formatCount(std::ssize(run.model.checks))
            << " checks passed";
        const std::int64_t noted = notedCount(run.model.plausibility);
        if (noted > 0) {
            out << "; " << formatCount(noted) << " of "
                << formatCount(std::ssize(run.model.plausibility))
                << " questions of plausibility noted (places in mm RAS):";
        }
        out << '\n';
        for (const ReportedNote& reported : run.model.plausibility) {
            if (!reported.note.isNoted) continue;
            out << "  noted: " << reported.subject << ": " << reported.note.name << ": "
                << reported.note.finding << placeText(reported) << '\n';
        }
    }
    if (run.options.isDryRun) {
        out << "nothing written (--dry-run)\n";
    } else {
        const bool holdsModel = run.model.hasModel() && !run.failsStrict();
        out << (holdsModel ? "head model" : "report only") << " written to "
            << run.options.output.string() << "/\n";
        for (const auto& path : run.subjectFiles) out << path.string() << '\n';
    }
    printTimes(out, run.timer, 1);
}

}  // namespace adaptiso::bem
