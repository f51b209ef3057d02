#include "Pipeline.h"

#include <algorithm>
#include <iostream>
#include <optional>
#include <utility>

#include "BemRun.h"
#include "Common/AtomicFolder.h"
#include "Common/ExitCodes.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Inputs.h"
#include "JsonReport.h"
#include "ModelFiles.h"
#include "ReportPage.h"
#include "SurfaceSteps.h"
#include "TextReport.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

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
std::vector<std::string_view> replaceable(const BemOptions& options) {
    return options.mayReplace ? modelFileNames() : std::vector<std::string_view>{};
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

/// A closed ball that can be worked with as it is. Turns it outward.
bool isUsable(TriangleMesh& mesh, BemRun& run) {
    const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    if (!topology.isSound() || topology.components.size() != 1 || topology.genus() != 0) {
        return false;
    }
    if (findSelfIntersections(mesh, {.maxPairs = 0}).pairCount > 0) return false;
    if (enclosedVolume(mesh) < 0) {
        flipOrientation(mesh);
        run.notes.push_back("a surface was inside out and has been turned");
    }
    return true;
}

/// What the images or the surfaces given lead to, dense or as it came.
std::vector<TriangleMesh> firstSurfaces(BemRun& run, ProgressLine& progress) {
    if (run.source != "surfaces") {
        return extractSurfaces(boundariesFromImages(run, progress), run, progress);
    }
    progress.show("read");
    std::vector<TriangleMesh> surfaces = run.timer.time("read", [&] { return readSurfaces(run); });
    bool areUsable = true;
    run.timer.time("check", [&] {
        for (TriangleMesh& surface : surfaces) areUsable = isUsable(surface, run) && areUsable;
    });
    if (areUsable) {
        run.surfaces.resize(surfaces.size());
        return surfaces;
    }
    run.notes.push_back(
        "not every surface is a closed one of genus 0 that does not cross itself: "
        "all are made anew from the solids that they bound");
    BoundaryOptions boundaries = run.options.boundaries;
    boundaries.progress = progress.callback();
    HeadBoundaries mended =
        run.timer.time("boundaries", [&] { return boundariesFromSurfaces(surfaces, boundaries); });
    run.notes.insert(run.notes.end(), mended.notes.begin(), mended.notes.end());
    return extractSurfaces(mended, run, progress);
}

void printWarnings(const BemRun& run) {
    if (run.options.common.isQuiet) return;
    for (const std::string& warning : run.warnings) {
        printError("adaptiso-bem", "warning: " + warning);
    }
}

void report(const BemRun& run, const std::string& json) {
    if (run.options.common.wantsJsonOnStdout()) {
        std::cout << json;
    } else if (!run.options.common.isQuiet) {
        printReport(std::cout, run);
    }
    if (!std::cout.flush()) throw FileError("standard output: can't be written");
}

/// Writes the folder (the report alone when there is no model) and all else, or nothing.
/// \param shown  what the report shows
std::string write(const std::vector<TriangleMesh>& surfaces, const std::vector<TriangleMesh>& shown,
                  BemRun& run) {
    const BemOptions& options = run.options;
    const PictureFolder pictures(options.report.pictures);
    std::vector<AtomicOutput> outputs;
    std::string json;
    std::optional<AtomicFolder> folder;
    run.timer.time("write", [&] {
        if (!options.isDryRun) {
            folder.emplace(options.output, replaceable(options));
            if (run.hasModel()) {
                writeModel(surfaces, run, *folder);
                outputs = writeSubject(surfaces, run);
            }
        }
    });
    if (options.report.isWanted()) {
        Report page = makeReport(run, shown);
        run.timer.time("report",
                       [&] { writeReport(page, "adaptiso-bem", options.report, outputs); });
    }
    json = jsonReport(run);
    if (folder) folder->writeText("report.json", json);
    if (hasJsonFile(options)) outputs.emplace_back(options.common.json).writeText(json);
    if (folder) {
        folder->commit(outputs);
    } else {
        AtomicOutput::commit(outputs);
    }
    return json;
}

}  // namespace

int runBem(const BemOptions& options) {
    const ThreadLimit threads(options.common);
    ProgressLine progress(options.common.isQuiet);
    BemRun run{options, {}, {}, {}, sourceOf(options), {}, {}, {}, {}, {}, {}, {}, {}, {}};
    checkOutputs(options);

    const std::vector<TriangleMesh> dense = firstSurfaces(run, progress);
    chooseTkRas(run);
    progress.clear();
    printWarnings(run);
    const std::vector<TriangleMesh> surfaces = remeshAndNest(dense, run, progress);
    if (run.hasModel()) checkModel(surfaces, run, progress);

    progress.show("write");
    const std::string json = write(surfaces, surfaces.empty() ? dense : surfaces, run);
    progress.clear();
    report(run, json);
    if (run.hasModel()) return kExitOk;
    printError("adaptiso-bem", "no model: " + failureText(run));
    return kExitCheckFailed;
}

}  // namespace adaptiso
