#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "HeadModelData.h"
#include "MeshData.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ConductivityModel.h"
#include "adaptiso/HeadModel/Landmarks.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso::python {
namespace {

template <class T>
T take(const py::dict& options, const char* key) {
    return options[key].cast<T>();
}

BoundaryOptions boundariesOf(const py::dict& options) {
    BoundaryOptions head;
    const auto layers = take<int>(options, "layers");
    head.innerSkullOnly = layers == 1;
    head.withBrain = layers == 4;
    const auto gaps = take<std::array<double, 3>>(options, "min_gap");
    head.minSkullMm = gaps[0];
    head.minScalpMm = gaps[1];
    head.minCsfMm = gaps[2];
    head.csfMm = take<double>(options, "csf");
    head.skullMm = take<double>(options, "skull");
    head.maxSkullMm = take<double>(options, "max_skull");
    head.skullHu = take<double>(options, "skull_hu");
    head.skinHu = take<double>(options, "skin_hu");
    head.closingMm = take<double>(options, "closing");
    head.sulciMm = take<double>(options, "sulci");
    head.smoothingMm = take<double>(options, "smoothing");
    head.cutNecksMm = take<double>(options, "cut_necks");
    head.stepMm = take<double>(options, "voxel");
    return head;
}

ConductivityModel conductivitiesOf(const py::dict& options) {
    const auto of = take<std::array<double, 4>>(options, "conductivity");
    ConductivityModel model;
    model.brain = of[0];
    model.csf = of[1];
    model.skull = of[2];
    model.scalp = of[3];
    try {
        checkConductivities(model);
    } catch (const InvalidInput& error) {
        throw InvalidInput(std::string("conductivity: ") + error.what());
    }
    return model;
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
    for (const auto& [name, at] : electrodes.cast<std::vector<std::pair<std::string, Place>>>()) {
        file.points.push_back({name, PointKind::Electrode, {at[0], at[1], at[2]}});
    }
    return file;
}

ElectrodeOptions electrodesOf(const py::dict& options) {
    ElectrodeOptions wanted;
    const py::object electrodes = options["electrodes"];
    if (!electrodes.is_none()) {
        wanted.file = pointsOf(electrodes);
        wanted.fileName = take<std::string>(options, "electrodes_name");
    }
    wanted.frame = frameOf(take<std::optional<std::string>>(options, "electrodes_in"));
    if (const auto system = take<std::optional<std::string>>(options, "montage")) {
        wanted.positions = choose<PositionSystem>("montage", *system,
                                                  {{"10-20", PositionSystem::TenTwenty},
                                                   {"10-10", PositionSystem::TenTen},
                                                   {"10-05", PositionSystem::TenFive}});
    }
    wanted.wantsLandmarks = take<bool>(options, "guesses_landmarks");
    if (const auto given = take<std::optional<std::array<Place, 3>>>(options, "landmarks")) {
        Landmarks landmarks;
        landmarks.nasionMm = toLps((*given)[0]);
        landmarks.leftEarMm = toLps((*given)[1]);
        landmarks.rightEarMm = toLps((*given)[2]);
        wanted.landmarks = landmarks;
    }
    return wanted;
}

BemModelOptions modelOptionsOf(const py::dict& options) {
    BemModelOptions model;
    model.boundaries = boundariesOf(options);
    model.vertices = take<std::vector<std::int64_t>>(options, "vertices");
    using Range = std::optional<std::pair<double, double>>;
    if (const auto range = take<Range>(options, "edge_length")) {
        model.edgeLengthMm = {range->first, range->second};
    }
    model.conductivities = conductivitiesOf(options);
    model.electrodes = electrodesOf(options);
    model.wantsHeadShape = take<bool>(options, "head_shape");
    model.inputCoordinates = take<std::vector<std::string>>(options, "input_coordinates");
    return model;
}

TissueLabels tissuesOf(const py::dict& source) {
    const auto preset = take<std::string>(source, "preset");
    if (!preset.empty()) return tissuePreset(preset);
    const py::dict lists = source["tissues"];
    const auto list = [&](const char* name) {
        return take<std::vector<std::int64_t>>(lists, name);
    };
    return {list("brain"), list("skull"), list("scalp"), false, list("csf")};
}

HeadSources sourcesOf(const py::dict& from) {
    using Volumes = std::vector<std::shared_ptr<ArrayVolume>>;
    using Meshes = std::vector<std::shared_ptr<MeshData>>;
    HeadSources sources;
    sources.source = take<std::string>(from, "kind");
    sources.images = take<Volumes>(from, "images");
    sources.brainMask = take<std::shared_ptr<ArrayVolume>>(from, "brain_mask");
    sources.aseg = take<std::shared_ptr<ArrayVolume>>(from, "aseg");
    sources.headMask = take<std::shared_ptr<ArrayVolume>>(from, "head_mask");
    sources.pial = take<Meshes>(from, "pial");
    sources.tissues = tissuesOf(from);
    sources.surfaces = take<Meshes>(from, "surfaces");
    for (const auto& [file, role, format] :
         take<std::vector<std::array<std::string, 3>>>(from, "inputs")) {
        sources.inputs.push_back({file, role, format});
    }
    sources.warnings = take<std::vector<Warning>>(from, "warnings");
    return sources;
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
            [](const HeadModelData& self, const std::string& folder, const py::dict& options) {
                const BemFileOptions files = bemFilesOf(options);
                runUnlocked(0, [&] { self.write(folder, files); });
            },
            py::arg("folder"), py::arg("options"))
        .def("page", &HeadModelData::page, py::arg("deface"));
    module.def(
        "make_bem",
        [](const py::dict& source, const py::dict& options, int threads, py::object progress) {
            return HeadModelData::make(sourcesOf(source), modelOptionsOf(options), threads,
                                       std::move(progress));
        },
        py::arg("source"), py::arg("options"), py::arg("threads"), py::arg("progress"));
    module.def("bem_file_names", &bemFileNames);
}

}  // namespace adaptiso::python
