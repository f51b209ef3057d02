#include "Pipeline.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <utility>

#include "BemRun.h"
#include "Common/AtomicOutput.h"
#include "Common/ExitCodes.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/Progress.h"
#include "Common/ResultOutput.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Inputs.h"
#include "JsonReport.h"
#include "Tetrahedra.h"
#include "TextReport.h"
#include "adaptiso/HeadPipeline/BemElectrodes.h"
#include "adaptiso/HeadPipeline/BemReport.h"
#include "adaptiso/HeadPipeline/BemSurfaces.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshIO/PointFiles.h"

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
    inputs.insert(inputs.end(), options.pial.begin(), options.pial.end());
    for (const fs::path& path :
         {options.t1, options.brainMask, options.aseg, options.labels, options.headMask, options.ct,
          options.volume, options.electrodes}) {
        if (!path.empty()) inputs.push_back(path);
    }
    return inputs;
}

bool hasJsonFile(const BemOptions& options) {
    return options.common.wantsJson() && !options.common.wantsJsonOnStdout();
}

/// The folder's own names when it may be replaced.
OwnNames replaceable(const BemOptions& options) {
    if (!options.mayReplace) return {};
    return [names = bemFileNames()](std::string_view name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
}

/// What a subject gets: the folder's files, and their names in SUBJECTS_DIR/SUBJECT/bem.
struct SubjectFile {
    std::string name;
    fs::path path;
};

std::vector<SubjectFile> subjectFiles(const BemOptions& options) {
    std::vector<SubjectFile> files;
    if (options.subject.empty()) return files;
    const fs::path folder = options.subjectsDir / options.subject / "bem";
    for (std::size_t n = 0; n < options.model.surfaceCount(); ++n) {
        const std::string name = bemFileName(options.model.surface(n), ".surf");
        files.push_back({name, folder / name});
    }
    if (!options.files.writesFif) return files;
    // the names that mne.coregistration looks for
    for (const char* name : {kFiffModel, kFiffDenseHead, kFiffSparseHead}) {
        if (name != kFiffModel && !options.model.hasSkin()) continue;
        files.push_back({name, folder / (options.subject + "-" + name)});
    }
    return files;
}

std::vector<fs::path> subjectPaths(const BemOptions& options) {
    std::vector<fs::path> paths;
    for (const SubjectFile& file : subjectFiles(options)) paths.push_back(file.path);
    return paths;
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
std::vector<TriangleMesh> firstSurfaces(BemRun& run, const BemHooks& hooks,
                                        ProgressLine& progress) {
    if (run.model.source != "surfaces") {
        return extractSurfaces(boundariesFromImages(run, progress), run.model, hooks);
    }
    progress.show("read");
    std::vector<TriangleMesh> surfaces = run.timer.time("read", [&] { return readSurfaces(run); });
    return naming("--surfaces",
                  [&] { return mendSurfaces(std::move(surfaces), run.model, hooks); });
}

/// What is known of electrodes and landmarks before there is a head.
void readElectrodes(BemRun& run) {
    const BemOptions& options = run.options;
    ElectrodeOptions& wanted = run.model.options.electrodes;
    wanted.wantsLandmarks = options.files.writesBesa;
    if (!options.electrodes.empty()) {
        wanted.file = readPoints(options.electrodes);
        wanted.fileName = baseName(options.electrodes);
        run.model.inputs.push_back({wanted.fileName, "electrodes", wanted.file->format});
    }
    if (!options.nasion) return;
    const AffineTransform toLps = inverse(lpsToFrame(CoordinateFrame::Ras, {}));
    Landmarks landmarks;
    landmarks.nasionMm = toLps(*options.nasion);
    landmarks.leftEarMm = toLps(*options.leftEar);
    landmarks.rightEarMm = toLps(*options.rightEar);
    wanted.landmarks = landmarks;
}

void putElectrodes(BemRun& run, const BemHooks& hooks) {
    if (!run.model.hasModel() || !run.model.options.electrodes.areWanted()) return;
    const fs::path& file = run.options.electrodes;
    naming(file.empty() ? std::string("--montage") : "--electrodes " + file.string(),
           [&] { placeElectrodes(run.model, hooks); });
}

/// Those from number `first` on.
void tellWarnings(const BemRun& run, std::size_t first = 0) {
    printWarnings("adaptiso-bem", run.options.common, std::span(run.model.warnings).subspan(first));
}

/// Files of the model's folder once more, for the subject's own.
std::vector<AtomicOutput> writeSubject(BemRun& run, const AtomicFolder& folder) {
    std::vector<AtomicOutput> outputs;
    for (const SubjectFile& file : subjectFiles(run.options)) {
        run.subjectFiles.push_back(file.path);
        outputs.emplace_back(file.path).write([&](const fs::path& path) {
            // the bytes alone: a file that is replaced keeps its mode
            std::ifstream from(folder.path() / file.name, std::ios::binary);
            std::ofstream to(path, std::ios::binary | std::ios::trunc);
            to << from.rdbuf();
            to.close();
            if (!from || !to) throw FileError(path.string() + ": can't be written");
        });
    }
    return outputs;
}

/// The model's folder, not yet under its name; one that holds nothing when what was written does
/// not keep the model's promises when read back.
void fillFolder(BemRun& run, std::optional<AtomicFolder>& folder) {
    const BemOptions& options = run.options;
    folder.emplace(options.output, replaceable(options));
    if (!run.model.hasModel() || run.failsStrict()) return;
    run.timer.time("write", [&] {
        folder->fill([&] {
            writeBemFiles(run.model, options.files, "adaptiso-bem " + programVersion(),
                          [&](const std::string& name) { return folder->place(name); });
        });
        run.files = folder->files();
    });
    run.timer.time("check", [&] { checkBemFiles(folder->path(), options.files, run.model); });
    if (run.model.hasModel()) return;
    run.files.clear();
    folder.reset();
    folder.emplace(options.output, replaceable(options));
}

Report makeReport(const BemRun& run) {
    Report report = bemReport(run.model, run.files);
    tellStrict(report, run.options.common, run.model.warnings, "so no model was written");
    if (run.options.isDryRun) report.notes.push_back("Nothing else was written (--dry-run).");
    if (run.shownImage) {
        report.volume = ReportVolume{run.model.inputs.front().role, run.shownImage->volume.view()};
    }
    return report;
}

/// Shows the run as asked for. Where there is no model and places are known where it failed, a
/// picture of them goes into the model's folder in its stead.
/// \param folder  none with --dry-run
/// \return the folder of pictures, to be kept until all is in place
std::unique_ptr<PictureFolder> show(BemRun& run, std::vector<AtomicOutput>& outputs,
                                    std::optional<AtomicFolder>& folder) {
    const bool showsFailure = folder && !run.model.hasModel();
    const ReportOptions& asked = run.options.report;
    if (!asked.isWanted() && !(showsFailure && !run.model.findings.empty())) return nullptr;
    ReportResult page = run.timer.time("report", [&] {
        return writeReport([&] { return makeReport(run); }, "adaptiso-bem", asked, outputs);
    });
    for (const Picture& picture : page.pictures) {
        if (showsFailure && picture.name == "spots.png") {
            folder->writeText(picture.name, picture.png);
        }
    }
    run.verdict.failReport(page.failure);
    return std::move(page.folder);
}

/// Writes the folder (the report and a picture alone when there is no model) and all else, and
/// prints the results, or does nothing of it.
void write(BemRun& run, ProgressLine& progress) {
    const BemOptions& options = run.options;
    std::vector<AtomicOutput> outputs;
    std::optional<AtomicFolder> folder;
    if (!options.isDryRun) {
        fillFolder(run, folder);
        if (run.model.hasModel() && !run.failsStrict()) outputs = writeSubject(run, *folder);
    }
    if (run.model.hasModel()) {
        run.verdict.failStrict(options.common, run.model.warnings, "so no model was written");
    } else {
        run.verdict = {kExitCheckFailed, "no model: " + run.model.failureText()};
    }
    const std::unique_ptr<PictureFolder> pictures = show(run, outputs, folder);
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
    BemRun run{options, {}};
    run.model.options = options.model;
    run.model.options.wantsHeadShape = options.files.writesFif;
    run.model.source = sourceOf(options);
    checkOutputs(options);
    requireMesher(options.tetrahedra);
    readElectrodes(run);

    const BemHooks hooks{[&](std::string_view stage, const std::function<void()>& work) {
                             progress.show(stage);
                             run.timer.time(stage, work);
                         },
                         progress.callback()};
    std::vector<TriangleMesh> dense = firstSurfaces(run, hooks, progress);
    chooseTkRas(run);
    progress.clear();
    tellWarnings(run);
    const std::size_t told = run.model.warnings.size();
    finishBemModel(std::move(dense), run.model, hooks);
    putElectrodes(run, hooks);
    if (run.model.hasModel() && options.tetrahedra.isAsked()) makeTetrahedra(run, hooks);
    progress.clear();
    tellWarnings(run, told);

    progress.show("write");
    write(run, progress);
    const std::string written =
        options.isDryRun ? "all is done" : options.output.string() + " is written";
    return printVerdict("adaptiso-bem", run.verdict, written);
}

}  // namespace adaptiso
