#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadModel/Landmarks.h"
#include "adaptiso/HeadModel/Tetrahedra.h"
#include "adaptiso/HeadPipeline/BemElectrodes.h"
#include "adaptiso/HeadPipeline/BemFiles.h"
#include "adaptiso/HeadPipeline/BemJson.h"
#include "adaptiso/HeadPipeline/BemModel.h"
#include "adaptiso/HeadPipeline/BemReport.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/HeadPipeline/BemSources.h"
#include "adaptiso/HeadPipeline/BemSurfaces.h"
#include "adaptiso/HeadPipeline/BemTetrahedra.h"
#include "adaptiso/Json/SecondsJson.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/PointFiles.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso::python {

namespace py = pybind11;

/// Input of a head model: images, or ready surfaces.
struct HeadSources {
    using Volumes = std::vector<std::shared_ptr<ArrayVolume>>;
    using Meshes = std::vector<std::shared_ptr<MeshData>>;

    BemSource source = BemSource::T1;
    Volumes images;  ///< with surfaces: the one they belong to
    std::map<std::string, std::shared_ptr<ArrayVolume>> masks;  ///< by argument: "brain_mask"
    Meshes pial, white, cortex;                                 ///< with t1; for sources
    TissueLabels tissues;
    Meshes surfaces;                ///< inside out, in one frame
    std::vector<BemInput> inputs;   ///< one for each of them
    std::vector<Warning> warnings;  ///< of reading
    GivenElectrodes electrodes{};
};

/// A head model, or the reason for its absence.
class HeadModelData {
public:
    /// Makes a head model as adaptiso-bem does, from the samples on.
    /// \throws InvalidInput  what is no head's
    static std::shared_ptr<HeadModelData> make(const HeadSources& sources,
                                               const BemModelOptions& options, int threads,
                                               py::object progress);

    const BemModel& model() const { return model_; }

    /// The surfaces, inside out, in scanner RAS mm; where there is no model, what it was tried
    /// from.
    std::vector<std::shared_ptr<MeshData>> surfaces() const;

    /// Result of `adaptiso-check --nested --profile bem`, with the gaps asked for; JSON.
    std::string check(int threads) const;

    /// The report adaptiso-bem/1.
    std::string report(const BemFileOptions& options) const;

    /// Writes the model's folder, whole or not at all: its files, read back and checked again, and
    /// report.json.
    /// \throws InvalidInput  they don't keep what is promised
    /// \throws FileError     the folder can't be written, or may not be replaced
    void write(const std::filesystem::path& target, const BemFileOptions& options,
               bool mayReplace) const;

    /// The run of a mesher that fills the layers. \pre there is a model
    MesherRun mesherRun(const MesherOptions& options) const {
        return adaptiso::mesherRun(headMesherInput(model_.meshes), options);
    }

    /// Takes what the run made.
    void takeTetrahedra(const MesherOptions& options, const std::vector<std::string>& results,
                        const std::optional<std::string>& reason, double seconds);

    /// The page of adaptiso-bem's --report.
    std::string page(bool leavesOutFaces) const;

private:
    using Files = std::vector<std::pair<std::string, std::uintmax_t>>;

    std::string reportOf(const BemModel& model, const BemFileOptions& options,
                         const Files& files) const;

    BemModel model_;
    std::shared_ptr<ArrayVolume> shown_;  ///< the main image
    bool isLoose_ = false;                ///< in tkRAS of a volume that is not known
    int threads_ = 0;
    Json seconds_;
    double peakMemoryMb_ = 0;
};

namespace {

namespace fs = std::filesystem;

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

/// The name of an argument for an option's: "brain_mask" for "brain-mask".
std::string argumentName(const std::string& option) {
    if (option == "tissue" || option == "preset") return "tissues";
    if (option == "nasion") return "landmarks";
    std::string name = option;
    std::ranges::replace(name, '-', '_');
    return name;
}

std::string optionName(const std::string& argument) {
    if (argument == "tissues") return "tissue";
    if (argument == "landmarks") return "nasion";
    std::string name = argument;
    std::ranges::replace(name, '_', '-');
    return name;
}

/// Surfaces of the cortex in LPS mm; those in tkRAS without a volume of their own are of `image`'s.
std::vector<TriangleMesh> cortexOf(const HeadSources::Meshes& surfaces,
                                   const std::optional<ImageGeometry>& image) {
    std::vector<TriangleMesh> meshes;
    for (const auto& surface : surfaces) {
        std::optional<ImageGeometry> volume = surface->image() ? surface->image() : image;
        if (volume) volume = frameVolume(CoordinateFrame::TkRas, *volume);
        meshes.push_back(inLps(*surface, volume));
    }
    return meshes;
}

HeadBoundaries boundariesOf(const HeadSources& sources, const BemModel& model,
                            const BemHooks& hooks) {
    BemImages images;
    for (const auto& image : sources.images) images.main.push_back(image->view);
    images.tissues = sources.tissues;
    const auto take = [&](const char* argument, std::optional<VolumeView>& view) {
        const auto mask = sources.masks.find(argument);
        if (mask != sources.masks.end()) view = mask->second->view;
    };
    take("brain_mask", images.brain.mask);
    take("aseg", images.brain.aseg);
    take("lesion", images.brain.lesion);
    take("head_mask", images.headMask);
    if (!images.main.empty()) {
        images.brain.pial = cortexOf(sources.pial, images.main.front().geometry());
        images.brain.white = cortexOf(sources.white, images.main.front().geometry());
    }
    return findBoundaries(model, images, hooks, argumentName);
}

/// The surfaces in LPS mm; of loose tkRAS in the LPS of a stand-in, as the program has it.
std::vector<TriangleMesh> readyMeshes(const HeadSources& sources, BemModel& model) {
    std::vector<TriangleMesh> meshes;
    for (const auto& surface : sources.surfaces) {
        std::optional<ImageGeometry> volume = model.image ? model.image : surface->image();
        if (volume) volume = frameVolume(CoordinateFrame::TkRas, *volume);
        if (surface->frame() == CoordinateFrame::TkRas && !volume) {
            volume = standInVolume();
        }
        if (!model.tkRasVolume) model.tkRasVolume = volume;
        meshes.push_back(inLps(*surface, volume));
    }
    return meshes;
}

/// The sources' surfaces, dense or as given.
std::vector<TriangleMesh> firstSurfaces(const HeadSources& sources, BemModel& model,
                                        const BemHooks& hooks) {
    if (sources.source != BemSource::Surfaces) {
        return extractSurfaces(boundariesOf(sources, model, hooks), model, hooks);
    }
    try {
        return mendSurfaces(readyMeshes(sources, model), model, hooks);
    } catch (const InvalidInput& error) {
        throw InvalidInput(std::string("surfaces: ") + error.what());
    }
}

void namingElectrodes(const BemModel& model, const std::function<void()>& work) {
    try {
        work();
    } catch (const InvalidInput& error) {
        throw InvalidInput((model.givenElectrodes.file ? "electrodes: " : "montage: ") +
                           std::string(error.what()));
    }
}

void putElectrodes(BemModel& model, const BemHooks& hooks) {
    if (!model.hasModel() || !model.wantsElectrodes()) return;
    namingElectrodes(model, [&] { placeElectrodes(model, hooks); });
}

void putSources(BemModel& model, const BemHooks& hooks) {
    if (!model.hasModel()) return;
    try {
        placeSources(model, hooks);
    } catch (const InvalidInput& error) {
        throw InvalidInput((model.options.sources.gridMm ? "source_grid: " : "sources: ") +
                           std::string(error.what()));
    }
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
    model.givenElectrodes = sources.electrodes;
    data->threads_ = threads;
    data->isLoose_ = areLoose(sources);
    if (!sources.images.empty()) {
        data->shown_ = sources.images.front();
        model.image = data->shown_->view.geometry();
        model.tkRasVolume = frameVolume(CoordinateFrame::TkRas, *model.image);
    }
    Watcher watcher(std::move(progress));
    StageTimer timer;
    watcher.run(threads, [&] {
        const BemHooks hooks{[&](std::string_view stage, const std::function<void()>& work) {
                                 watcher.tell(stage, 0);
                                 timer.time(stage, work);
                             },
                             watcher.callback()};
        namingElectrodes(model, [&] { checkElectrodes(model); });
        std::vector<TriangleMesh> dense = firstSurfaces(sources, model, hooks);
        const auto& image = model.image ? model.image : model.tkRasVolume;
        model.pial = cortexOf(sources.pial, image);
        model.cortex = cortexOf(sources.cortex, image);
        finishBemModel(std::move(dense), model, hooks);
        putElectrodes(model, hooks);
        putSources(model, hooks);
        watcher.tell("check", 1);
    });
    data->seconds_ = secondsJson(timer);
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
    std::vector<const TriangleMesh*> surfaces;
    std::vector<std::string> names;
    for (const TriangleMesh& mesh : model_.meshes) {
        meshes.push_back(toFrame(mesh, CoordinateFrame::Ras));
    }
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        surfaces.push_back(&meshes[n]);
        names.push_back(bemSurfaceName(n, model_.meshes.size()));
    }
    CheckRules rules;
    rules.isNested = true;
    rules.profile = Profile::Bem;
    std::string text;
    runUnlocked(threads, [&] {
        text = dumped(nestedJson(surfaces, names, model_.options.minGapsMm(), rules));
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
                {"input", bemInputJson(model)},
                {"options", told}};
    report.update(bemModelJson(model));
    report["output"] = bemOutputJson(model, options, files);
    report["failedByWarnings"] = false;
    report["reportFailure"] = nullptr;
    report["seconds"] = seconds_;
    report["peakMemoryMb"] = peakMemoryMb_;
    return jsonText(report) + "\n";
}

std::string HeadModelData::report(const BemFileOptions& options) const {
    return reportOf(model_, options, {});
}

void HeadModelData::write(const fs::path& target, const BemFileOptions& options,
                          bool mayReplace) const {
    OwnNames ownNames;
    if (mayReplace) {
        ownNames = [names = bemFileNames()](std::string_view name) {
            return std::find(names.begin(), names.end(), name) != names.end();
        };
    }
    AtomicFolder folder(target, ownNames);
    folder.fill([&] {
        writeBemFiles(model_, options, std::string(kProgramName) + " " + ADAPTISO_VERSION,
                      [&](const std::string& name) { return folder.place(name); });
    });
    BemModel written = model_;
    checkBemFiles(folder.path(), options, written);
    if (!written.hasModel()) throw InvalidInput("no model: " + written.failureText());
    folder.writeText("report.json", reportOf(written, options, folder.files()));
    folder.commit();
}

void HeadModelData::takeTetrahedra(const MesherOptions& options,
                                   const std::vector<std::string>& results,
                                   const std::optional<std::string>& reason, double seconds) {
    adaptiso::takeTetrahedra(mesherResult(options.mesher, results, reason), options, model_);
    seconds_["tetrahedra"] = seconds;
    seconds_["total"] = seconds_["total"].get<double>() + seconds;
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

namespace {

template <class T>
T take(const py::dict& options, const char* key) {
    return options[key].cast<T>();
}

/// \throws InvalidInput  as many numbers do not do
void takeNumbers(const py::dict& options, const char* name, const char* rule,
                 const std::function<bool(const std::vector<double>&)>& set) {
    const auto values = take<std::optional<std::vector<double>>>(options, name);
    if (values && !set(*values)) throw InvalidInput(std::string(name) + ": must be " + rule);
}

using Place = std::array<double, 3>;  ///< scanner RAS mm

Vec3 toLps(const Place& place) {
    return {-place[0], -place[1], place[2]};
}

/// Electrodes of a file, or by name.
PointFile pointsOf(const py::object& electrodes) {
    if (py::isinstance<py::str>(electrodes)) {
        const auto path = electrodes.cast<std::string>();
        const Unlocked unlocked;
        return readPoints(path);
    }
    PointFile file;
    file.format = "points";
    file.saysUnit = true;
    file.frame = CoordinateFrame::Ras;
    using Named = std::pair<std::string, std::optional<Place>>;
    for (const auto& [name, at] : electrodes.cast<std::vector<Named>>()) {
        if (!at) {
            file.placeless.push_back(name);
        } else {
            file.points.push_back({name, PointKind::Electrode, {(*at)[0], (*at)[1], (*at)[2]}});
        }
    }
    return file;
}

GivenElectrodes electrodesOf(const py::dict& options) {
    GivenElectrodes given;
    const py::object electrodes = options["electrodes"];
    if (!electrodes.is_none()) {
        given.file = pointsOf(electrodes);
        given.fileName = take<std::string>(options, "electrodes_name");
    }
    if (const auto places = take<std::optional<std::array<Place, 3>>>(options, "landmarks")) {
        Landmarks landmarks;
        landmarks.nasionMm = toLps((*places)[0]);
        landmarks.leftEarMm = toLps((*places)[1]);
        landmarks.rightEarMm = toLps((*places)[2]);
        if (const auto inion = take<std::optional<Place>>(options, "inion")) {
            landmarks.inionMm = toLps(*inion);
        }
        given.landmarks = landmarks;
    }
    return given;
}

ElectrodeOptions electrodeOptionsOf(const py::dict& options) {
    ElectrodeOptions wanted;
    wanted.frame = frameOf(take<std::optional<std::string>>(options, "electrodes_in"));
    wanted.montage = take<std::optional<std::string>>(options, "montage").value_or("");
    wanted.wantsLandmarks = take<bool>(options, "guesses_landmarks");
    return wanted;
}

BemModelOptions modelOptionsOf(const py::dict& options) {
    BemModelOptions model;
    model.boundaries.innerSkullOnly = take<bool>(options, "meg");
    if (!setLayers(model, take<std::int64_t>(options, "layers"))) {
        throw InvalidInput("layers: must be 1, 3, 4 or 5");
    }
    python::take(boundaryOptions(), model.boundaries, options);
    takeNumbers(options, "min_gap", kMinGapRule,
                [&](const auto& gaps) { return setMinGaps(model, gaps); });
    takeNumbers(options, "edge_length", kEdgeLengthRule,
                [&](const auto& lengths) { return setEdgeLengths(model, lengths); });
    takeNumbers(options, "conductivity", kConductivityRule,
                [&](const auto& sigmas) { return setConductivities(model, sigmas); });
    model.vertices = take<std::vector<std::int64_t>>(options, "vertices");
    python::take(sourceOptions(), model.sources, options);
    model.wantsHeadShape = take<bool>(options, "head_shape");
    model.inputCoordinates = take<std::vector<std::string>>(options, "input_coordinates");
    model.electrodes = electrodeOptionsOf(options);
    return model;
}

TissueLabels tissuesOf(const py::dict& source) {
    const auto preset = take<std::string>(source, "preset");
    if (!preset.empty()) return tissuePreset(preset);
    auto lists = take<std::map<std::string, std::vector<std::int64_t>>>(source, "tissues");
    return {lists["brain"], lists["skull"], lists["scalp"], false,
            lists["csf"],   lists["white"], lists["spongy"]};
}

std::vector<std::pair<const char*, BemSource>> namedSources() {
    std::vector<std::pair<const char*, BemSource>> named;
    for (const BemSource source : {BemSource::T1, BemSource::Labels, BemSource::Probabilities,
                                   BemSource::Ct, BemSource::Surfaces}) {
        named.emplace_back(toString(source), source);
    }
    return named;
}

HeadSources sourcesOf(const py::dict& from) {
    HeadSources sources;
    sources.source = choose<BemSource>("kind", take<std::string>(from, "kind"), namedSources());
    sources.images = take<HeadSources::Volumes>(from, "images");
    sources.masks = take<std::map<std::string, std::shared_ptr<ArrayVolume>>>(from, "masks");
    sources.pial = take<HeadSources::Meshes>(from, "pial");
    sources.white = take<HeadSources::Meshes>(from, "white");
    sources.cortex = take<HeadSources::Meshes>(from, "sources");
    sources.tissues = tissuesOf(from);
    sources.surfaces = take<HeadSources::Meshes>(from, "surfaces");
    for (const auto& [file, role, format] :
         take<std::vector<std::array<std::string, 3>>>(from, "inputs")) {
        sources.inputs.push_back({file, role, format});
    }
    sources.warnings = take<std::vector<Warning>>(from, "warnings");
    return sources;
}

/// \param given     arguments that are not None
/// \param surfaces  ready ones
/// \param sources   surfaces of the cortex
/// \throws InvalidInput  options that break a rule
void checkBem(const std::vector<std::string>& given, const py::dict& tissues,
              const py::dict& options, std::size_t surfaces, std::size_t sources) {
    BemRequest request{
        {}, tissuesOf(tissues), surfaces, sources, take<std::string>(tissues, "preset")};
    for (const std::string& argument : given) request.given.insert(optionName(argument));
    const std::string fault = bemFault(modelOptionsOf(options), request, argumentName);
    if (!fault.empty()) throw InvalidInput(fault);
}

BemFileOptions bemFilesOf(const py::dict& from) {
    BemFileOptions options;
    options.unit =
        choose<OpenMeegUnit>("units", take<std::string>(from, "units"),
                             {{"mm", OpenMeegUnit::Millimetres}, {"m", OpenMeegUnit::Metres}});
    options.frame = frameOf(take<std::string>(from, "frame"));
    options.writesGifti = take<bool>(from, "gifti");
    options.writesVtp = take<bool>(from, "vtp");
    options.writesFif = take<bool>(from, "fif");
    options.writesFieldTrip = take<bool>(from, "fieldtrip");
    options.writesBrainstorm = take<bool>(from, "brainstorm");
    options.writesSimNibs = take<bool>(from, "simnibs");
    options.writesBemFmm = take<bool>(from, "bem_fmm");
    options.writesBesa = take<bool>(from, "besa");
    return options;
}

/// (name, (x, y, z)) of electrodes, or of landmarks, on the skin, scanner RAS mm.
py::list placesOf(const HeadModelData& data, bool areElectrodes) {
    py::list places;
    if (!data.model().electrodes) return places;
    for (const NamedPoint& p : data.model().electrodes->all()) {
        if ((p.kind == PointKind::Electrode) != areElectrodes) continue;
        places.append(py::make_tuple(p.name, py::make_tuple(-p.point.x, -p.point.y, p.point.z)));
    }
    return places;
}

}  // namespace

void declareHeadModels(py::module_& module) {
    module.def("tissue_presets", &tissuePresetNames);
    module.def("montage_names", &montageNames);
    py::class_<HeadModelData, std::shared_ptr<HeadModelData>>(module, "HeadModelData")
        .def_property_readonly("surfaces", &HeadModelData::surfaces)
        .def_property_readonly("has_model",
                               [](const HeadModelData& self) { return self.model().hasModel(); })
        .def_property_readonly("failure",
                               [](const HeadModelData& self) {
                                   return self.model().hasModel() ? std::string()
                                                                  : self.model().failureText();
                               })
        .def_property_readonly("warnings",
                               [](const HeadModelData& self) { return self.model().warnings; })
        .def_property_readonly(
            "has_volume",
            [](const HeadModelData& self) { return self.model().tkRasVolume.has_value(); })
        .def_property_readonly(
            "has_head_shape",
            [](const HeadModelData& self) { return self.model().headShape.has_value(); })
        .def_property_readonly("electrodes",
                               [](const HeadModelData& self) { return placesOf(self, true); })
        .def_property_readonly("landmarks",
                               [](const HeadModelData& self) { return placesOf(self, false); })
        .def("check", &HeadModelData::check, py::arg("threads"))
        .def("report", [](const HeadModelData& self) { return self.report({}); })
        .def(
            "write",
            [](const HeadModelData& self, const std::string& folder, const py::dict& options,
               bool mayReplace) {
                const BemFileOptions files = bemFilesOf(options);
                runUnlocked(0, [&] { self.write(folder, files, mayReplace); });
            },
            py::arg("folder"), py::arg("options"), py::arg("replace"))
        .def(
            "mesher_run",
            [](const HeadModelData& self, const std::string& mesher, double elementMm) {
                const MesherRun run = self.mesherRun({mesher, elementMm});
                return py::make_tuple(run.program, run.arguments, run.inputs, run.results);
            },
            py::arg("mesher"), py::arg("element_size"))
        .def(
            "take_tetrahedra",
            [](HeadModelData& self, const std::string& mesher, double elementMm,
               const std::vector<py::bytes>& results, const std::optional<std::string>& reason,
               double seconds) {
                const std::vector<std::string> bytes(results.begin(), results.end());
                runUnlocked(0, [&] {
                    self.takeTetrahedra({mesher, elementMm}, bytes, reason, seconds);
                });
            },
            py::arg("mesher"), py::arg("element_size"), py::arg("results"), py::arg("reason"),
            py::arg("seconds"))
        .def("page", &HeadModelData::page, py::arg("deface"));
    module.def(
        "make_bem",
        [](const py::dict& source, const py::dict& options, int threads, py::object progress) {
            BemModelOptions model = modelOptionsOf(options);
            HeadSources sources = sourcesOf(source);
            sources.electrodes = electrodesOf(options);
            return HeadModelData::make(sources, model, threads, std::move(progress));
        },
        py::arg("source"), py::arg("options"), py::arg("threads"), py::arg("progress"));
    module.def("check_bem", &checkBem, py::arg("given"), py::arg("tissues"), py::arg("options"),
               py::arg("surfaces"), py::arg("sources"));
}

}  // namespace adaptiso::python
