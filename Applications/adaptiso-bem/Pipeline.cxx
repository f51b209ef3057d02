#include "Pipeline.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <optional>
#include <utility>

#include "Common/Json.h"
#include "Common/Mesher.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/HeadModel/Tetrahedra.h"
#include "adaptiso/HeadPipeline/BemElectrodes.h"
#include "adaptiso/HeadPipeline/BemReport.h"
#include "adaptiso/HeadPipeline/BemSources.h"
#include "adaptiso/HeadPipeline/BemSurfaces.h"
#include "adaptiso/HeadPipeline/BemTetrahedra.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso::bem {
namespace {

namespace fs = std::filesystem;

BemSource sourceOf(const BemOptions& options) {
    return !options.t1.empty()              ? BemSource::T1
           : !options.labels.empty()        ? BemSource::Labels
           : !options.probabilities.empty() ? BemSource::Probabilities
           : !options.ct.empty()            ? BemSource::Ct
                                            : BemSource::Surfaces;
}

std::vector<fs::path> inputsOf(const BemOptions& options) {
    std::vector<fs::path> inputs = options.probabilities;
    inputs.insert(inputs.end(), options.surfaces.begin(), options.surfaces.end());
    for (const auto* list : {&options.pial, &options.white, &options.sources}) {
        inputs.insert(inputs.end(), list->begin(), list->end());
    }
    for (const fs::path& path :
         {options.t1, options.brainMask, options.aseg, options.lesion, options.labels,
          options.headMask, options.ct, options.volume, options.electrodes}) {
        if (!path.empty()) inputs.push_back(path);
    }
    return inputs;
}

/// The folder's own names when it may be replaced.
OwnNames replaceable(const BemOptions& options) {
    if (!options.mayReplace) return {};
    return [names = bemFileNames()](std::string_view name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
}

/// A file of the model's folder that is copied to SUBJECTS_DIR/SUBJECT/bem.
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

/// SUBJECT/bem, which recon-all does not make. One that stays empty goes again.
class SubjectFolder {
public:
    explicit SubjectFolder(const BemOptions& options) {
        if (options.subject.empty() || options.isDryRun) return;
        const fs::path subject = options.subjectsDir / options.subject, bem = subject / "bem";
        std::error_code error;
        if (!fs::is_directory(subject, error) || fs::exists(fs::symlink_status(bem, error))) return;
        if (fs::create_directory(bem, error)) made_ = bem;
    }
    SubjectFolder(const SubjectFolder&) = delete;
    SubjectFolder& operator=(const SubjectFolder&) = delete;
    ~SubjectFolder() {
        std::error_code error;
        if (!made_.empty()) fs::remove(made_, error);
    }

private:
    fs::path made_;
};

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
        requireNoLink(path.parent_path(), subject);
        const fs::file_status status = fs::symlink_status(path, error);
        if (fs::is_symlink(status)) {
            throw FileError(path.string() +
                            ": is a link (to a surface that another program made?); remove it");
        }
        if (fs::exists(status) && !options.mayReplace) {
            throw FileError(path.string() + ": exists; --force replaces it");
        }
    }
}

/// Files in the subject's folder that MNE-Python reads as the model, and that this run leaves
/// there.
void warnOfOtherModel(BemRun& run) {
    const BemOptions& options = run.options;
    if (options.subject.empty() || options.isDryRun) return;
    const std::vector<fs::path> written = subjectPaths(options);
    std::vector<std::string> others;
    for (const std::string& name :
         {bemFileName(HeadSurface::InnerSkull, ".surf"),
          bemFileName(HeadSurface::OuterSkull, ".surf"),
          bemFileName(HeadSurface::OuterSkin, ".surf"), options.subject + "-" + kFiffModel}) {
        const fs::path path = options.subjectsDir / options.subject / "bem" / name;
        std::error_code error;
        const bool isWritten = std::ranges::find(written, path) != written.end();
        if (!isWritten && fs::exists(path, error)) others.push_back(name);
    }
    if (others.empty()) return;
    run.model.warnings.push_back(
        {"other-model",
         "keeps " + joined(others) + " of another model, which MNE-Python would mix with this one",
         options.subject + "/bem"});
}

/// Checks the outputs before an input is read.
void checkOutputs(const BemOptions& options) {
    OutputPlan plan(inputsOf(options));
    if (!options.isDryRun) {
        checkSubject(options);
        plan.checkFolder(options.output);
        AtomicFolder::check(options.output, replaceable(options));
        for (const fs::path& path : subjectPaths(options)) plan.add("--subject", path);
    }
    plan.check(options.common, options.report);
}

/// The first surfaces: extracted from the images (dense), or read and mended.
std::vector<TriangleMesh> firstSurfaces(BemRun& run, const BemHooks& hooks) {
    if (run.model.source != BemSource::Surfaces) {
        return extractSurfaces(boundariesFromImages(run, hooks), run.model, hooks);
    }
    std::vector<TriangleMesh> surfaces = run.stage("read", [&] { return readSurfaces(run); });
    readSources(run);
    return naming("--surfaces",
                  [&] { return mendSurfaces(std::move(surfaces), run.model, hooks); });
}

/// The option of the electrodes, for errors.
std::string electrodesOf(const BemOptions& options) {
    return options.electrodes.empty() ? "--montage" : "--electrodes " + options.electrodes.string();
}

/// Reads and checks electrodes and landmarks, before there is a head.
void readElectrodes(BemRun& run) {
    const BemOptions& options = run.options;
    GivenElectrodes& given = run.model.givenElectrodes;
    if (!options.electrodes.empty()) {
        given.file = readPoints(options.electrodes);
        given.fileName = baseName(options.electrodes);
        run.model.inputs.push_back({given.fileName, "electrodes", given.file->format});
        naming(electrodesOf(options), [&] { checkElectrodes(run.model); });
    }
    if (!options.nasion) return;
    const AffineTransform toLps = inverse(lpsToFrame(CoordinateFrame::Ras, {}));
    Landmarks landmarks;
    landmarks.nasionMm = toLps(*options.nasion);
    landmarks.leftEarMm = toLps(*options.leftEar);
    landmarks.rightEarMm = toLps(*options.rightEar);
    if (options.inion) landmarks.inionMm = toLps(*options.inion);
    given.landmarks = landmarks;
}

void putElectrodes(BemRun& run, const BemHooks& hooks) {
    if (!run.model.hasModel() || !run.model.wantsElectrodes()) return;
    naming(electrodesOf(run.options), [&] { placeElectrodes(run.model, hooks); });
}

/// Files of the model's folder once more, for the subject's own.
void writeSubject(BemRun& run, const AtomicFolder& folder) {
    for (const SubjectFile& file : subjectFiles(run.options)) {
        run.subjectFiles.push_back(file.path);
        run.addOutput(file.path, file.path.parent_path()).write([&](const fs::path& path) {
            // the bytes alone: a file that is replaced keeps its mode
            std::ifstream from(folder.path() / file.name, std::ios::binary);
            std::ofstream to(path, std::ios::binary | std::ios::trunc);
            to << from.rdbuf();
            to.close();
            if (!from || !to) throw FileError(path.string() + ": can't be written");
        });
    }
}

/// The model's folder, not yet under its name; one that holds nothing when what was written does
/// not keep the model's promises when read back.
void fillFolder(BemRun& run, std::optional<AtomicFolder>& folder) {
    const BemOptions& options = run.options;
    folder.emplace(options.output, replaceable(options));
    if (!run.model.hasModel() || run.failsStrict()) return;
    run.stage("write", [&] {
        folder->fill([&] {
            writeBemFiles(run.model, options.files, "adaptiso-bem " + programVersion(),
                          [&](const std::string& name) { return folder->place(name); });
        });
        run.files = folder->files();
    });
    run.stage("check", [&] { checkBemFiles(folder->path(), options.files, run.model); });
    if (run.model.hasModel()) return;
    run.files.clear();
    folder.reset();
    folder.emplace(options.output, replaceable(options));
}

Report makeReport(const BemRun& run) {
    Report report = bemReport(run.model, run.files);
    if (run.options.isDryRun) report.notes.push_back("Nothing else was written (--dry-run).");
    if (run.shownImage) {
        report.volume = ReportVolume{run.model.inputs.front().role, run.shownImage->volume.view()};
    }
    return report;
}

/// Writes the page and the pictures if asked for. If there is no model, the picture of the places
/// where it failed goes into the model's folder.
/// \param folder  empty with --dry-run
void writePage(BemRun& run, std::optional<AtomicFolder>& folder) {
    const bool showsFailure = folder && !run.model.hasModel();
    if (!run.options.report.isWanted() && !(showsFailure && !run.model.findings.empty())) return;
    for (const Picture& picture : run.writePage([&] { return makeReport(run); })) {
        if (showsFailure && picture.name == "spots.png") {
            folder->writeText(picture.name, picture.png);
        }
    }
}

/// "adaptiso-check --nested model/inner_skull.surf ..."; of one surface "--profile bem". Empty
/// without .surf files.
std::string checkCommand(const AtomicFolder& folder) {
    std::string surfaces;
    std::size_t count = 0;
    for (const auto& [name, bytes] : folder.files()) {
        if (!name.ends_with(".surf") || name == kSpongyBoneSurf) continue;
        surfaces += " " + shellQuoted((folder.target() / name).string());
        ++count;
    }
    if (count == 0) return "";
    return "adaptiso-check " + std::string(count == 1 ? "--profile bem" : "--nested") + surfaces +
           " --report check.html";
}

/// Writes the folder (only the report and a picture if there is no model) and all other outputs,
/// and prints the results, or does none of these.
void write(BemRun& run) {
    const BemOptions& options = run.options;
    std::optional<AtomicFolder> folder;
    if (!options.isDryRun) {
        fillFolder(run, folder);
        if (run.model.hasModel() && !run.failsStrict()) writeSubject(run, *folder);
    }
    if (!run.model.hasModel()) {
        run.verdict = {kExitCheckFailed, "no model: " + run.model.failureText()};
    }
    run.takeWarnings();
    writePage(run, folder);
    run.settleVerdict();
    const std::string json = jsonReport(run);
    if (folder && run.model.hasModel()) run.next = checkCommand(*folder);
    if (folder) folder->writeText("report.json", json);
    run.deliver([&] { return json; }, [&](std::ostream& out) { printReport(out, run); },
                folder ? &*folder : nullptr);
}

}  // namespace

int runBem(const BemOptions& options) {
    BemRun run(options);
    run.model.options = options.model;
    run.model.source = sourceOf(options);
    const SubjectFolder subjectFolder(options);
    checkOutputs(options);
    warnOfOtherModel(run);
    requireMesher(options.tetrahedra);
    readElectrodes(run);

    const BemHooks hooks{
        [&](std::string_view stage, const std::function<void()>& work) { run.stage(stage, work); },
        run.progress.callback()};
    std::vector<TriangleMesh> dense = firstSurfaces(run, hooks);
    chooseTkRas(run);
    run.takeWarnings();
    finishBemModel(std::move(dense), run.model, hooks);
    putElectrodes(run, hooks);
    if (run.model.hasModel()) {
        naming(options.sources.empty() ? "--source-grid" : "--sources",
               [&] { placeSources(run.model, hooks); });
    }
    if (run.model.hasModel() && options.tetrahedra.isRequested()) {
        run.stage("tetrahedra", [&] {
            takeTetrahedra(runMesher(headMesherInput(run.model.meshes), options.tetrahedra),
                           options.tetrahedra, run.model);
        });
    }
    run.takeWarnings();
    if (run.model.hasModel() && !options.model.leadField.empty() && !run.failsStrict()) {
        run.stage("solve", [&] { solveLeadField(run); });
    }
    write(run);
    return run.end(options.isDryRun ? "all is done" : options.output.string() + " is written");
}

}  // namespace adaptiso::bem
