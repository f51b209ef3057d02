#include "Pipeline.h"

#include <algorithm>
#include <iostream>
#include <optional>
#include <span>
#include <utility>

#include "BemRun.h"
#include "CheckModel.h"
#include "Common/AtomicFolder.h"
#include "Common/ExitCodes.h"
#include "Common/Numbers.h"
#include "Common/Progress.h"
#include "Common/ResultOutput.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Inputs.h"
#include "JsonReport.h"
#include "ModelFiles.h"
#include "ReadySurfaces.h"
#include "ReportPage.h"
#include "SurfaceSteps.h"
#include "TextReport.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::string sourceOf(const BemOptions& options) {
    return !options.t1.empty()              ? "t1"
           : !options.labels.empty()        ? "labels"
           : !options.probabilities.empty() ? "probabilities"
           : !options.ct.empty()            ? "ct"
                                            : "surfaces";
}

std::vector<fs::path> inputsOf(const BemOptions& options) {
    std::vector<fs::path> inputs = options.probabilities;
    inputs.insert(inputs.end(), options.surfaces.begin(), options.surfaces.end());
    for (const fs::path& path :
         {options.t1, options.brainMask, options.labels, options.ct, options.volume}) {
        if (!path.empty()) inputs.push_back(path);
    }
    return inputs;
}

bool hasJsonFile(const BemOptions& options) {
    return options.common.wantsJson() && !options.common.wantsJsonOnStdout();
}

/// The folder's own names when it may be replaced.
OwnNames replaceable(const BemOptions& options) {
    return options.mayReplace ? OwnNames(modelFileNames()) : OwnNames();
}

void checkSubject(const BemOptions& options) {
    for (const fs::path& path : subjectPaths(options)) {
        const fs::path subject = path.parent_path().parent_path();
        std::error_code error;
        if (!fs::is_directory(subject, error)) {
            throw FileError(subject.string() + ": there is no such subject folder");
        }
        if (!fs::is_directory(path.parent_path(), error)) {
            throw FileError(path.parent_path().string() + ": there is no such folder; make it");
        }
        const fs::file_status status = fs::symlink_status(path, error);
        if (fs::is_symlink(status)) {
            throw FileError(path.string() +
                            ": is a link (to a surface that another program made?); remove it");
        }
        if (fs::exists(status) && !options.mayReplace) {
            throw FileError(path.string() + ": exists; --force replaces it");
        }
        checkOutput(path);
    }
}

/// Everything about the outputs that can be told before an input is read.
void checkOutputs(const BemOptions& options) {
    std::vector<fs::path> files = subjectPaths(options);
    const std::vector<fs::path> inputs = inputsOf(options);
    checkReportOutputs(options.report, inputs);
    if (hasJsonFile(options)) {
        checkOutput(options.common.json);
        files.push_back(options.common.json);
    }
    const auto canonical = [](const fs::path& path) {
        std::error_code error;
        return fs::weakly_canonical(fs::absolute(path), error);
    };
    for (const fs::path& input : inputs) {
        for (const fs::path& file : files) checkNotInput(file, input);
        // replacing the folder would take an input in it away
        if (!options.isDryRun && canonical(input).parent_path() == canonical(options.output)) {
            throw FileError(options.output.string() +
                            ": holds an input, which is never overwritten");
        }
    }
    if (options.isDryRun) return;
    AtomicFolder::check(options.output, replaceable(options));
    checkSubject(options);
}

/// What the images or the surfaces given lead to, dense or as it came.
std::vector<TriangleMesh> firstSurfaces(BemRun& run, ProgressLine& progress) {
    if (run.source != "surfaces") {
        return extractSurfaces(boundariesFromImages(run, progress), run, progress);
    }
    return readySurfaces(run, progress);
}

/// Those from number `first` on.
void tellWarnings(const BemRun& run, std::size_t first = 0) {
    printWarnings("adaptiso-bem", run.options.common, std::span(run.warnings).subspan(first));
}

/// Solvers take the square of the number of vertices in memory, the cube in time.
void warnOfMany(const std::vector<TriangleMesh>& surfaces, BemRun& run) {
    constexpr std::int64_t kMany = 10'000;
    std::int64_t vertices = 0;
    for (const TriangleMesh& surface : surfaces) vertices += std::ssize(surface.points);
    if (vertices <= kMany) return;
    run.warnings.push_back(formatCount(vertices) +
                           " vertices in all; MNE warns above 10,000 (--vertices)");
}

/// The model's folder, not yet under its name; one that holds nothing when what was written does
/// not keep the model's promises when read back.
void fillFolder(const std::vector<TriangleMesh>& surfaces, BemRun& run,
                std::optional<AtomicFolder>& folder) {
    const BemOptions& options = run.options;
    folder.emplace(options.output, replaceable(options));
    if (!run.hasModel() || run.failsStrict()) return;
    run.timer.time("write", [&] { writeModel(surfaces, run, *folder); });
    run.timer.time("check", [&] { checkFiles(folder->path(), surfaces, run); });
    if (run.hasModel()) return;
    run.files.clear();
    folder.reset();
    folder.emplace(options.output, replaceable(options));
}

/// Shows the run as asked for. Where there is no model and places are known where it failed, a
/// picture of them goes into the model's folder in its stead.
/// \param folder  none with --dry-run
/// \return the folder of pictures, to be kept until all is in place
std::unique_ptr<PictureFolder> show(BemRun& run, const std::vector<TriangleMesh>& shown,
                                    std::vector<AtomicOutput>& outputs,
                                    std::optional<AtomicFolder>& folder) {
    const bool showsFailure = folder && !run.hasModel();
    const ReportOptions& asked = run.options.report;
    if (!asked.isWanted() && !(showsFailure && !run.findings.empty())) return nullptr;
    ReportResult page = run.timer.time("report", [&] {
        return writeReport([&] { return makeReport(run, shown); }, "adaptiso-bem", asked, outputs);
    });
    for (const Picture& picture : page.pictures) {
        if (showsFailure && picture.name == "spots.png") {
            folder->writeText(picture.name, picture.png);
        }
    }
    run.reportFailure = page.failure;
    return std::move(page.folder);
}

/// Writes the folder (the report and a picture alone when there is no model) and all else, and
/// prints the results, or does nothing of it.
/// \param shown  what the report shows
void write(const std::vector<TriangleMesh>& surfaces, const std::vector<TriangleMesh>& shown,
           BemRun& run, ProgressLine& progress) {
    const BemOptions& options = run.options;
    std::vector<AtomicOutput> outputs;
    std::optional<AtomicFolder> folder;
    if (!options.isDryRun) {
        fillFolder(surfaces, run, folder);
        if (run.hasModel() && !run.failsStrict()) outputs = writeSubject(surfaces, run);
    }
    const std::unique_ptr<PictureFolder> pictures = show(run, shown, outputs, folder);
    const std::string json = jsonReport(run);
    if (folder) folder->writeText("report.json", json);
    if (hasJsonFile(options)) outputs.emplace_back(options.common.json).writeText(json);
    progress.clear();
    printResults(options.common, json, [&](std::ostream& out) { printReport(out, run); });
    if (folder) {
        folder->commit(outputs);
    } else {
        AtomicOutput::commit(outputs);
    }
}

}  // namespace

int runBem(const BemOptions& options) {
    const ThreadLimit threads(options.common);
    ProgressLine progress(options.common.isQuiet);
    BemRun run{options, {}, {}, {}, sourceOf(options), {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
    checkOutputs(options);

    const std::vector<TriangleMesh> dense = firstSurfaces(run, progress);
    chooseTkRas(run);
    progress.clear();
    tellWarnings(run);
    const std::size_t told = run.warnings.size();
    std::vector<TriangleMesh> surfaces;
    if (run.hasModel()) surfaces = remeshAndNest(dense, run, progress);
    if (run.hasModel()) checkModel(surfaces, run, progress);
    if (run.hasModel()) askWhatIsUsual(surfaces, run, progress);
    warnOfMany(surfaces, run);
    progress.clear();
    tellWarnings(run, told);

    progress.show("write");
    write(surfaces, surfaces.empty() ? dense : surfaces, run, progress);
    const std::string written =
        options.isDryRun ? "all is done" : options.output.string() + " is written";
    if (run.hasModel()) {
        const int code = strictVerdict("adaptiso-bem", options.common, run.warnings,
                                       "so no model was written", kExitOk);
        return tellReportFailure("adaptiso-bem", written, run.reportFailure, code);
    }
    printError("adaptiso-bem", "no model: " + failureText(run));
    return tellReportFailure("adaptiso-bem", written, run.reportFailure, kExitCheckFailed);
}

}  // namespace adaptiso
