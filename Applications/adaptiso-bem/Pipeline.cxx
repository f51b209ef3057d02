#include "Pipeline.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <utility>

#include "Common/AtomicOutput.h"
#include "Common/Json.h"
#include "Common/Mesher.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/Tetrahedra.h"
#include "adaptiso/HeadPipeline/BemElectrodes.h"
#include "adaptiso/HeadPipeline/BemReport.h"
#include "adaptiso/HeadPipeline/BemSources.h"
#include "adaptiso/HeadPipeline/BemSurfaces.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso::bem {
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
    inputs.insert(inputs.end(), options.sources.begin(), options.sources.end());
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

/// Checks the outputs before an input is read.
void checkOutputs(const BemOptions& options) {
    OutputPlan plan(inputsOf(options));
    if (!options.isDryRun) {
        plan.checkFolder(options.output);
        AtomicFolder::check(options.output, replaceable(options));
        checkSubject(options);
        for (const fs::path& path : subjectPaths(options)) plan.add("--subject", path);
    }
    plan.check(options.common, options.report);
}

/// The first surfaces: extracted from the images (dense), or read and mended.
std::vector<TriangleMesh> firstSurfaces(BemRun& run, const BemHooks& hooks) {
    if (run.model.source != "surfaces") {
        return extractSurfaces(boundariesFromImages(run), run.model, hooks);
    }
    std::vector<TriangleMesh> surfaces = run.stage("read", [&] { return readSurfaces(run); });
    return naming("--surfaces",
                  [&] { return mendSurfaces(std::move(surfaces), run.model, hooks); });
}

/// Reads electrodes and landmarks, before there is a head.
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
    if (options.inion) landmarks.inionMm = toLps(*options.inion);
    wanted.landmarks = landmarks;
}

void putElectrodes(BemRun& run, const BemHooks& hooks) {
    if (!run.model.hasModel() || !run.model.options.electrodes.areWanted()) return;
    const fs::path& file = run.options.electrodes;
    naming(file.empty() ? std::string("--montage") : "--electrodes " + file.string(),
           [&] { placeElectrodes(run.model, hooks); });
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
        if (!name.ends_with(".surf")) continue;
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

void addCheck(BemModel& model, const TetrahedraCheck& check) {
    model.checks.push_back({"tetrahedra: " + check.name, check.isPassed, check.detail, {}});
    if (check.isPassed) return;
    const Vec3 place = model.meshes.front().points.front();
    model.checks.back().pointMm = place;
    model.findings.push_back({"tetrahedra: " + check.name + ": " + check.detail, place});
}

/// Notes layers whose elements are longer than asked for: gmsh keeps the surfaces' triangles.
void noteLongElements(BemModel& model, const TetrahedralMesh& mesh,
                      std::span<const TetrahedraRegion> regions, double askedMm) {
    constexpr double kLonger = 1.5, kNotedShare = 0.1;  // irregular ones are a half longer
    for (const TetrahedraRegion& region : regions) {
        std::int64_t count = 0, longer = 0;
        double longestMm = 0;
        for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
            if (mesh.labels[n] != region.label) continue;
            double mm = 0;
            for (const VertexId a : mesh.tetrahedra[n]) {
                for (const VertexId b : mesh.tetrahedra[n]) {
                    mm = std::max(mm, norm(mesh.points[a] - mesh.points[b]));
                }
            }
            ++count;
            longer += mm > kLonger * askedMm ? 1 : 0;
            longestMm = std::max(longestMm, mm);
        }
        const double share = static_cast<double>(longer) / static_cast<double>(count);
        if (!(share > kNotedShare)) continue;
        model.notes.push_back(
            region.name + ": " + formatRounded(100 * share) +
            " % of its elements are longer than " + formatShort(kLonger) +
            " times --element-size " + formatShort(askedMm) + ", up to " +
            formatLength(longestMm, 1) +
            " mm, as the triangles of its surfaces are; more --vertices shorten them");
    }
}

/// Gives elements in holes of the segmentation's skull (a craniotomy) to the scalp, with a note:
/// the surfaces are closed there, as boundary elements need. \pre model.segmented
void openHoles(BemModel& model, TetrahedralMesh& mesh) {
    const std::size_t count = model.meshes.size();
    const std::int32_t skull = tissueNumber(HeadSurface::OuterSkull, count);
    std::vector<std::size_t> elements;
    std::vector<Vec3> middlesMm;
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        if (mesh.labels[n] != skull) continue;
        Vec3 sum;
        for (const VertexId v : mesh.tetrahedra[n]) sum += mesh.points[v];
        elements.push_back(n);
        middlesMm.push_back(0.25 * sum);
    }
    const std::vector<bool> areOpen =
        areInHoles(middlesMm, model.meshes[count - 3], *model.skull, *model.segmented);
    std::int64_t opened = 0;
    double mm3 = 0;
    for (std::size_t n = 0; n < elements.size(); ++n) {
        if (!areOpen[n]) continue;
        mesh.labels[elements[n]] = tissueNumber(HeadSurface::OuterSkin, count);
        mm3 += volumeOf(mesh, mesh.tetrahedra[elements[n]]);
        ++opened;
    }
    model.segmented.reset();
    model.notes.push_back("tetrahedra: " + formatCount(opened) + " of the skull's (" +
                          formatMeasure(mm3 / 1000) +
                          " cm3), in holes of the segmentation's skull, are scalp");
}

/// Fills the model's layers with tetrahedra by the mesher, run as a program (stage "tetrahedra"),
/// and checks them; a failed check becomes a finding. \pre run.model.hasModel()
/// \throws FileError  the mesher is missing, fails, or writes an unreadable file
void makeTetrahedra(BemRun& run, const BemHooks& hooks) {
    BemModel& model = run.model;
    hooks.stage("tetrahedra", [&] {
        const std::vector<TetrahedraRegion> regions = headRegions(model.meshes);
        BemTetrahedra made;
        made.mesher = run.options.tetrahedra.mesher;
        made.mesh = runMesher(headMesherInput(model.meshes), run.options.tetrahedra);
        takeRegions(made.mesh, regions);
        made.report = checkTetrahedra(made.mesh, regions);
        model.notes.push_back(describeTetrahedra(made.mesh, made.report, made.mesher));
        noteLongElements(model, made.mesh, regions, run.options.tetrahedra.elementMm);
        for (const TetrahedraCheck& check : judgeTetrahedra(made.report, regions)) {
            addCheck(model, check);
        }
        if (model.segmented) {
            openHoles(model, made.mesh);
            made.report = checkTetrahedra(made.mesh, regions);
        }
        model.tetrahedra = std::move(made);
    });
}

}  // namespace

int runBem(const BemOptions& options) {
    BemRun run(options);
    run.model.options = options.model;
    run.model.options.wantsHeadShape = options.files.writesFif;
    run.model.source = sourceOf(options);
    checkOutputs(options);
    requireMesher(options.tetrahedra);
    readElectrodes(run);

    const BemHooks hooks{
        [&](std::string_view stage, const std::function<void()>& work) { run.stage(stage, work); },
        run.progress.callback()};
    std::vector<TriangleMesh> dense = firstSurfaces(run, hooks);
    readSources(run);
    chooseTkRas(run);
    run.takeWarnings();
    finishBemModel(std::move(dense), run.model, hooks);
    putElectrodes(run, hooks);
    if (run.model.hasModel()) {
        naming(options.sources.empty() ? "--source-grid" : "--sources",
               [&] { placeSources(run.model, hooks); });
    }
    if (run.model.hasModel() && options.tetrahedra.isAsked()) makeTetrahedra(run, hooks);
    run.takeWarnings();
    write(run);
    return run.end(options.isDryRun ? "all is done" : options.output.string() + " is written");
}

}  // namespace adaptiso::bem
