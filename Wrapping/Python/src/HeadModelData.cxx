#include "HeadModelData.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>

#include "Calls.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/HeadPipeline/BemElectrodes.h"
#include "adaptiso/HeadPipeline/BemJson.h"
#include "adaptiso/HeadPipeline/BemReport.h"
#include "adaptiso/HeadPipeline/BemSurfaces.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso::python {
namespace {

namespace fs = std::filesystem;

void addSeconds(std::vector<std::pair<std::string, double>>& stages, std::string_view stage,
                double seconds) {
    const auto known = std::find_if(stages.begin(), stages.end(),
                                    [&](const auto& entry) { return entry.first == stage; });
    if (known == stages.end()) {
        stages.emplace_back(stage, seconds);
    } else {
        known->second += seconds;
    }
}

/// tkRAS of an unknown volume.
bool isLooseTkRas(const MeshData& surface) {
    return surface.frame() == CoordinateFrame::TkRas && !surface.image();
}

bool areLoose(const HeadSources& sources) {
    return sources.images.empty() &&
           std::any_of(sources.surfaces.begin(), sources.surfaces.end(),
                       [](const auto& surface) { return isLooseTkRas(*surface); });
}

/// A surface in LPS mm, without normals.
/// \param volume  whose tkRAS it is in, where it is
TriangleMesh inLps(const MeshData& surface, const std::optional<ImageGeometry>& volume) {
    TriangleMesh mesh = fromFrame(surface.mesh(), surface.frame(), volume);
    freeMemory(mesh.normals);
    return mesh;
}

HeadBoundaries boundariesOfT1(const HeadSources& sources, const BoundaryOptions& options) {
    const VolumeView& t1 = sources.images.front()->view;
    BrainSources brain;
    if (sources.brainMask) brain.mask = sources.brainMask->view;
    if (sources.aseg) brain.aseg = sources.aseg->view;
    for (const auto& surface : sources.pial) {
        const ImageGeometry& image = surface->image() ? *surface->image() : t1.geometry();
        brain.pial.push_back(inLps(*surface, frameVolume(CoordinateFrame::TkRas, image)));
    }
    return boundariesFromT1(t1, brain, options);
}

HeadBoundaries boundariesOf(const HeadSources& sources, const BoundaryOptions& options) {
    if (sources.source == "t1") return boundariesOfT1(sources, options);
    std::vector<VolumeView> views;
    for (const auto& image : sources.images) views.push_back(image->view);
    if (sources.source == "labels") {
        std::optional<VolumeView> head;
        if (sources.headMask) head = sources.headMask->view;
        return boundariesFromLabels(views.front(), sources.tissues, options, head);
    }
    if (sources.source == "probabilities") return boundariesFromProbabilities(views, options);
    return boundariesFromCt(views.front(), options);
}

/// Faults of an image, with the name of the argument.
HeadBoundaries namedBoundaries(const HeadSources& sources, const BoundaryOptions& options) {
    try {
        return boundariesOf(sources, options);
    } catch (const InvalidInput& error) {
        const std::string what = error.what();
        const std::string name = what.starts_with("the brain mask")
                                     ? (sources.brainMask ? "brain_mask" : "aseg")
                                 : what.starts_with("the head mask")  ? "head_mask"
                                 : what.starts_with("a pial surface") ? "pial"
                                                                      : sources.source;
        throw InvalidInput(name + ": " + what);
    }
}

/// The surfaces in LPS mm; of loose tkRAS in the LPS of a stand-in, as the program has it.
std::vector<TriangleMesh> readyMeshes(const HeadSources& sources, BemModel& model) {
    std::vector<TriangleMesh> meshes;
    for (const auto& surface : sources.surfaces) {
        std::optional<ImageGeometry> volume = model.image ? model.image : surface->image();
        if (volume) volume = frameVolume(CoordinateFrame::TkRas, *volume);
        if (surface->frame() == CoordinateFrame::TkRas && !volume) {
            volume = conformedGeometry({{256, 256, 256}, {-128, -128, -128}, {}});
        }
        if (!model.tkRasVolume) model.tkRasVolume = volume;
        meshes.push_back(inLps(*surface, volume));
    }
    return meshes;
}

/// The sources' surfaces, dense or as given.
std::vector<TriangleMesh> firstSurfaces(const HeadSources& sources, BemModel& model,
                                        const BemHooks& hooks) {
    if (sources.source != "surfaces") {
        BoundaryOptions boundaries = model.options.boundaries;
        boundaries.progress = hooks.progress;
        HeadBoundaries found;
        hooks.stage("boundaries", [&] { found = namedBoundaries(sources, boundaries); });
        return extractSurfaces(found, model, hooks);
    }
    try {
        return mendSurfaces(readyMeshes(sources, model), model, hooks);
    } catch (const InvalidInput& error) {
        throw InvalidInput(std::string("surfaces: ") + error.what());
    }
}

void putElectrodes(BemModel& model, const BemHooks& hooks) {
    const ElectrodeOptions& wanted = model.options.electrodes;
    if (!model.hasModel() || !wanted.areWanted()) return;
    try {
        placeElectrodes(model, hooks);
    } catch (const InvalidInput& error) {
        throw InvalidInput((wanted.file ? "electrodes: " : "montage: ") +
                           std::string(error.what()));
    }
}

void writeText(const fs::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file) throw FileError(path.string() + ": can't be written: " + std::strerror(errno));
}

}  // namespace

std::shared_ptr<HeadModelData> HeadModelData::make(const HeadSources& sources,
                                                   const BemModelOptions& options, int threads,
                                                   py::object progress) {
    auto data = std::make_shared<HeadModelData>();
    BemModel& model = data->model_;
    model.options = options;
    model.source = sources.source;
    model.inputs = sources.inputs;
    model.warnings = sources.warnings;
    data->threads_ = threads;
    data->isLoose_ = areLoose(sources);
    if (!sources.images.empty()) {
        data->shown_ = sources.images.front();
        model.image = data->shown_->view.geometry();
        model.tkRasVolume = frameVolume(CoordinateFrame::TkRas, *model.image);
    }
    Watcher watcher(std::move(progress));
    const auto begin = std::chrono::steady_clock::now();
    watcher.run(threads, [&] {
        const BemHooks hooks{[&](std::string_view stage, const std::function<void()>& work) {
                                 watcher.tell(stage, 0);
                                 const auto start = std::chrono::steady_clock::now();
                                 work();
                                 addSeconds(data->seconds_, stage, secondsSince(start));
                             },
                             watcher.callback()};
        finishBemModel(firstSurfaces(sources, model, hooks), model, hooks);
        putElectrodes(model, hooks);
        watcher.tell("check", 1);
    });
    data->totalSeconds_ = secondsSince(begin);
    data->peakMemoryMb_ = peakMemoryMb();
    return data;
}

std::vector<std::shared_ptr<MeshData>> HeadModelData::surfaces() const {
    std::vector<std::shared_ptr<MeshData>> list;
    const std::optional<ImageGeometry> volume = model_.image ? model_.image : model_.tkRasVolume;
    for (const TriangleMesh& mesh : model_.meshes) {
        if (isLoose_) {
            list.push_back(std::make_shared<MeshData>(MeshData::asStored(
                toFrame(mesh, CoordinateFrame::TkRas, volume), CoordinateFrame::TkRas)));
        } else {
            list.push_back(MeshData::fromLps(mesh, volume, std::nullopt));
        }
    }
    return list;
}

std::string HeadModelData::check(int threads) const {
    std::vector<TriangleMesh> meshes;
    std::vector<const TriangleMesh*> asked;
    std::vector<std::string> names;
    for (const TriangleMesh& mesh : model_.meshes) {
        meshes.push_back(toFrame(mesh, CoordinateFrame::Ras));
    }
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        asked.push_back(&meshes[n]);
        names.push_back(bemSurfaceName(n, model_.meshes.size()));
    }
    CheckRules rules;
    rules.isNested = true;
    rules.profile = Profile::Bem;
    std::string text;
    runUnlocked(threads, [&] {
        text = dumped(nestedJson(asked, names, model_.options.minGapsMm(), rules));
    });
    return text;
}

std::string HeadModelData::reportOf(const BemModel& model, const BemFileOptions& options,
                                    const Files& files) const {
    Json told = bemOptionsJson(model.options);
    told["threads"] = threads_ > 0 ? Json(threads_) : Json(nullptr);
    told["strict"] = false;
    Json report{{"schema", "adaptiso-bem/1"},
                {"program", {{"name", kProgramName}, {"version", ADAPTISO_VERSION}}},
                {"passed", model.hasModel()},
                {"exitCode", model.hasModel() ? 0 : 1},
                {"error", model.hasModel() ? Json(nullptr)
                                           : Json{{"text", "no model: " + model.failureText()}}},
                {"warnings", model.warnings},
                {"model", model.hasModel()},
                {"failedByWarnings", false},
                {"input", bemInputJson(model)},
                {"options", told}};
    report.update(bemModelJson(model));
    report["output"] = bemOutputJson(model, options, files);
    report["reportFailure"] = nullptr;
    Json seconds = Json::object();
    for (const auto& [stage, time] : seconds_) seconds[stage] = time;
    seconds["total"] = totalSeconds_;
    report["seconds"] = seconds;
    report["peakMemoryMb"] = peakMemoryMb_;
    return jsonText(report) + "\n";
}

std::string HeadModelData::report(const BemFileOptions& options) const {
    return reportOf(model_, options, {});
}

void HeadModelData::write(const fs::path& folder, const BemFileOptions& options) const {
    std::vector<std::string> names;
    writeBemFiles(model_, options, std::string(kProgramName) + " " + ADAPTISO_VERSION,
                  [&](const std::string& name) {
                      names.push_back(name);
                      return folder / name;
                  });
    BemModel written = model_;
    checkBemFiles(folder, options, written);
    if (!written.hasModel()) throw InvalidInput("no model: " + written.failureText());
    Files files;
    for (const std::string& name : names) files.emplace_back(name, fs::file_size(folder / name));
    writeText(folder / "report.json", reportOf(written, options, files));
}

std::string HeadModelData::page(bool leavesOutFaces) const {
    Report report = bemReport(model_, {});
    report.program = kProgramName;
    report.version = ADAPTISO_VERSION;
    report.date = reportDate();
    report.leavesOutFaces = leavesOutFaces;
    if (shown_) report.volume = ReportVolume{model_.inputs.front().role, shown_->view};
    std::string html;
    runUnlocked(threads_, [&] { html = htmlPage(report, drawPictures(report)); });
    return html;
}

}  // namespace adaptiso::python
