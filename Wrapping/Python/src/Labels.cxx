#include "adaptiso/Labels/Labels.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/LabelPipeline/LabelsJson.h"
#include "adaptiso/LabelPipeline/Masks.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Scene.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::python {

namespace py = pybind11;

/// The walls of a label map whose arrays Python looks at, in scanner RAS mm: LPS with the signs of
/// x and y turned in place.
class LabelData {
public:
    /// \param result  LPS mm \param labels  of regions that are whole; empty: all are
    static std::shared_ptr<LabelData> fromLps(LabelResult result, const ImageGeometry& image,
                                              const std::vector<Label>& labels);

    /// \param points  n x 3, RAS mm \param faces  m x 3 \param labels  m x 2; all are copied
    /// \throws InvalidInput  shapes, faces out of range
    static std::shared_ptr<LabelData> fromArrays(
        const py::array_t<double, py::array::c_style>& points,
        const py::array_t<std::int64_t, py::array::c_style>& faces,
        const py::array_t<Label, py::array::c_style>& labels, const ImageGeometry& image,
        std::string report);

    const LabelComplex& complex() const { return complex_; }
    const ImageGeometry& image() const { return image_; }

    /// The surface of one region: closed, outward, its points those of the walls, to the bit.
    std::shared_ptr<MeshData> region(Label label) const;

    /// All walls as one mesh.
    std::shared_ptr<MeshData> walls() const;

    /// Bound, statistics, and the measures of the regions; JSON.
    const std::string& report() const { return report_; }

    /// walls.vtp of adaptiso-labels. \return as MeshData::write()
    std::string write(const std::string& path, std::optional<CoordinateFrame> frame) const;

    /// All regions in one file of scenes, as adaptiso-labels writes them.
    /// \param regions  label, name and colour of each, by label
    /// \throws InvalidInput  digits of the format that do not do, a frame that it can't hold;
    /// FileError
    void writeRegions(const std::string& path, std::optional<CoordinateFrame> frame,
                      const std::vector<std::tuple<Label, std::string, LabelColor>>& regions) const;

private:
    LabelComplex complex_;
    ImageGeometry image_;
    std::string report_;
};

namespace {

Json reportJson(const LabelResult& result, const std::vector<Label>& labels) {
    Json regions = Json::array();
    for (const RegionMeasure& measure : measureRegions(result.complex, labels)) {
        regions.push_back(measureJson({{"label", measure.label}}, measure));
    }
    return {
        {"walls", wallsJson(std::ssize(result.complex.points), std::ssize(result.complex.triangles),
                            result.statistics.errorBoundMm, result.statistics)},
        {"regions", regions}};
}

}  // namespace

std::shared_ptr<LabelData> LabelData::fromLps(LabelResult result, const ImageGeometry& image,
                                              const std::vector<Label>& labels) {
    auto data = std::make_shared<LabelData>();
    data->report_ = dumped(reportJson(result, labels));
    data->complex_ = std::move(result.complex);
    turnXY(data->complex_.points);
    data->image_ = image;
    return data;
}

std::shared_ptr<LabelData> LabelData::fromArrays(
    const py::array_t<double, py::array::c_style>& points,
    const py::array_t<std::int64_t, py::array::c_style>& faces,
    const py::array_t<Label, py::array::c_style>& labels, const ImageGeometry& image,
    std::string report) {
    const auto mesh = MeshData::fromArrays(points, faces, std::nullopt, CoordinateFrame::Ras,
                                           std::nullopt, false);
    if (labels.ndim() != 2 || labels.shape(1) != 2 || labels.shape(0) != faces.shape(0)) {
        throw InvalidInput("labels: must be two for each face");
    }
    auto data = std::make_shared<LabelData>();
    data->complex_.points = mesh->mesh().points;
    data->complex_.triangles = mesh->mesh().triangles;
    const auto table = labels.unchecked<2>();
    for (py::ssize_t t = 0; t < labels.shape(0); ++t) {
        data->complex_.labels.push_back({table(t, 0), table(t, 1)});
    }
    data->image_ = image;
    data->report_ = std::move(report);
    return data;
}

std::shared_ptr<MeshData> LabelData::region(Label label) const {
    TriangleMesh mesh = regionSurface(complex_, label);
    if (mesh.triangles.empty()) {
        throw InvalidInput("label " + std::to_string(label) + ": has no surface here");
    }
    auto data =
        std::make_shared<MeshData>(MeshData::asStored(std::move(mesh), CoordinateFrame::Ras));
    data->setImage(image_);
    return data;
}

std::shared_ptr<MeshData> LabelData::walls() const {
    auto data = std::make_shared<MeshData>(
        MeshData::asStored({complex_.points, {}, complex_.triangles}, CoordinateFrame::Ras));
    data->setImage(image_);
    return data;
}

std::string LabelData::write(const std::string& path, std::optional<CoordinateFrame> frame) const {
    std::vector<CellArray> arrays{{"label0", {}}, {"label1", {}}};
    for (std::size_t side = 0; side < arrays.size(); ++side) {
        std::vector<Label> values;
        values.reserve(complex_.labels.size());
        for (const auto& labels : complex_.labels) values.push_back(labels[side]);
        arrays[side].values = std::move(values);
    }
    return walls()->write(path, frame, std::move(arrays));
}

void LabelData::writeRegions(
    const std::string& path, std::optional<CoordinateFrame> frame,
    const std::vector<std::tuple<Label, std::string, LabelColor>>& regions) const {
    const MeshFormat& format = findMeshFormat(path);
    MeshWriteOptions options;
    options.frame = frame.value_or(format.defaultFrame);
    options.volume = frameVolume(options.frame, image_);
    TriangleMesh walls{complex_.points, {}, complex_.triangles};
    turnXY(walls.points);
    const RoundingHarm harm =
        settleRounding(walls, format.precision, lpsToFrame(options.frame, options.volume));
    if (harm) throw InvalidInput(path + ": " + textOf(harm, format));
    const LabelComplex settled{std::move(walls.points), std::move(walls.triangles),
                               complex_.labels};
    std::vector<Label> labels;
    for (const auto& region : regions) labels.push_back(std::get<Label>(region));
    const RegionSurfaces surfaces(settled, labels);
    std::vector<ScenePart> parts;
    for (std::size_t n = 0; n < regions.size(); ++n) {
        TriangleMesh surface = surfaces.surface(n);
        if (format.holdsNormals) surface.normals = areaWeightedNormals(surface);
        parts.push_back({std::get<std::string>(regions[n]), std::get<LabelColor>(regions[n]),
                         std::move(surface)});
    }
    AtomicOutput output(path);
    output.write(
        [&](const std::filesystem::path& file) { writeScene(std::move(parts), file, options); });
    AtomicOutput::commit({&output, 1});
}

namespace {

/// \param subject  of messages: the file, or "image"
/// \param advice   what may have made samples others than whole numbers
std::shared_ptr<LabelData> makeLabels(const ArrayVolume& volume, LabelOptions options, int threads,
                                      py::object progress, const std::string& subject,
                                      const std::string& advice) {
    Watcher watcher(std::move(progress));
    options.progress = watcher.callback();
    std::shared_ptr<LabelData> data;
    watcher.run(threads, [&] {
        try {
            LabelResult result = extractLabels(volume.view, options);
            watcher.tell("measure", 0);
            data = LabelData::fromLps(std::move(result), volume.geometry, options.labels);
        } catch (const NotALabelMap& error) {
            throw InvalidInput(subject + ": " + error.what() + "; " + advice);
        } catch (const InvalidInput& error) {
            throw InvalidInput(subject + ": " + error.what());
        }
        watcher.tell("measure", 1);
    });
    return data;
}

/// (value, name, abbreviation, colour or None) of every entry
py::list entriesOf(const LabelTable& table) {
    py::list entries;
    for (const LabelEntry& entry : table.entries) {
        entries.append(py::make_tuple(entry.value, entry.name, entry.abbreviation, entry.color));
    }
    return entries;
}

/// How masks are found: in a folder, as files, or as the segments of one file.
std::vector<MaskSource> findMasks(const std::vector<std::string>& paths, const std::string& kind) {
    if (kind == "folder") return masksOfFolder(paths.front(), {});
    if (kind == "segments") return masksOfSegments(paths.front(), {});
    return masksOfFiles({paths.begin(), paths.end()}, {});
}

/// \param priority  "name", "largest", "smallest" or "list" \param listed  names, with "list"
MaskPriority priorityOf(const std::string& priority, const std::vector<std::string>& listed,
                        const std::vector<MaskSource>& masks) {
    using enum MaskPriority::Rule;
    MaskPriority result;
    for (const auto rule : {LastByName, Largest, Smallest, Listed}) {
        if (MaskPriority{rule}.word() == priority) result.rule = rule;
    }
    for (const std::string& name : listed) {
        const auto mask = std::ranges::find(masks, name, &MaskSource::name);
        const auto place = static_cast<std::size_t>(mask - masks.begin());
        if (mask == masks.end()) throw InvalidInput("priority '" + name + "': is no mask");
        if (std::ranges::count(result.listed, place) > 0) {
            throw InvalidInput("priority '" + name + "': stands there twice");
        }
        result.listed.push_back(place);
    }
    return result;
}

/// Masks joined to a map: samples, affine, format, warnings, (label, name, colour or None) of each
/// mask, JSON of masksJson(); None where a folder holds no masks.
py::object joinedMasks(const std::vector<std::string>& paths, const std::string& kind,
                       const std::string& priority, const std::vector<std::string>& listed,
                       const std::string& table) {
    std::vector<MaskSource> masks;
    std::vector<Warning> warnings;
    std::optional<MaskMap> map;
    runUnlocked(0, [&] {
        masks = findMasks(paths, kind);
        if (masks.empty()) return;
        if (!table.empty()) {
            const LabelTable rows = readLabelTable(table);
            warnings = rows.warnings;
            const auto more = numberByTable(masks, rows, std::filesystem::path(table).filename());
            warnings.insert(warnings.end(), more.begin(), more.end());
        }
        const auto read = [](const MaskSource& mask) { return readVolume(mask.file, mask.read); };
        map = joinMasks(masks, priorityOf(priority, listed, masks), read, "");
    });
    if (masks.empty()) return py::none();
    warnings.insert(warnings.end(), map->warnings.begin(), map->warnings.end());
    py::list entries;
    for (const MaskSource& mask : masks) {
        entries.append(py::make_tuple(mask.label, mask.name, mask.color));
    }
    return py::make_tuple(toArray(map->volume), affineOf(map->volume.view().geometry()),
                          map->format, warnings, entries, dumped(masksJson(map->joined)));
}

void declareLabelData(py::module_& module) {
    const auto side = [](int n) {
        return [n](const py::object& self) {
            const auto& labels = self.cast<const LabelData&>().complex().labels;
            py::array_t<Label> array({static_cast<py::ssize_t>(labels.size())},
                                     {static_cast<py::ssize_t>(sizeof(labels[0]))},
                                     labels.empty() ? nullptr : &labels[0][n], self);
            array.attr("setflags")(py::arg("write") = false);
            return array;
        };
    };
    py::class_<LabelData, std::shared_ptr<LabelData>>(module, "LabelData")
        .def_static(
            "from_arrays",
            [](const py::array_t<double, py::array::c_style>& points,
               const py::array_t<std::int64_t, py::array::c_style>& faces,
               const py::array_t<Label, py::array::c_style>& labels, const Index3& shape,
               const py::array_t<double>& affine, const std::string& report) {
                return LabelData::fromArrays(points, faces, labels,
                                             geometryFromAffine(shape, affine), report);
            },
            py::arg("vertices"), py::arg("faces"), py::arg("labels"), py::arg("shape"),
            py::arg("affine"), py::arg("report"))
        .def_property_readonly("vertices",
                               [](const py::object& self) {
                                   const auto& complex = self.cast<const LabelData&>().complex();
                                   return viewRows<double>(complex.points, self);
                               })
        .def_property_readonly("faces",
                               [](const py::object& self) {
                                   const auto& complex = self.cast<const LabelData&>().complex();
                                   return viewRows<std::int64_t>(complex.triangles, self);
                               })
        .def_property_readonly("label0", side(0))
        .def_property_readonly("label1", side(1))
        .def_property_readonly("shape", [](const LabelData& self) { return self.image().size; })
        .def_property_readonly("affine",
                               [](const LabelData& self) { return affineOf(self.image()); })
        .def_property_readonly("report", &LabelData::report)
        .def(
            "region",
            [](const LabelData& self, Label label) {
                const Unlocked unlocked;
                return self.region(label);
            },
            py::arg("label"))
        .def("walls", &LabelData::walls)
        .def(
            "write",
            [](const LabelData& self, const std::string& path,
               const std::optional<std::string>& frame) {
                const auto wanted = frameOf(frame);
                const Unlocked unlocked;
                return self.write(path, wanted);
            },
            py::arg("path"), py::arg("frame"))
        .def(
            "write_regions",
            [](const LabelData& self, const std::string& path,
               const std::optional<std::string>& frame,
               const std::vector<std::tuple<Label, std::string, LabelColor>>& regions) {
                const auto wanted = frameOf(frame);
                const Unlocked unlocked;
                self.writeRegions(path, wanted, regions);
            },
            py::arg("path"), py::arg("frame"), py::arg("regions"));
}

}  // namespace

void declareLabels(py::module_& module) {
    declareLabelData(module);
    module.def(
        "make_labels",
        [](const ArrayVolume& volume, const py::dict& options, const std::vector<Label>& labels,
           int threads, py::object progress, const std::string& subject,
           const std::string& advice) {
            LabelOptions extraction;
            takeAims(AimedSurface::Walls, extraction, options);
            extraction.labels = labels;
            return makeLabels(volume, std::move(extraction), threads, std::move(progress), subject,
                              advice);
        },
        py::arg("volume"), py::arg("options"), py::arg("labels"), py::arg("threads"),
        py::arg("progress"), py::arg("subject"), py::arg("advice"));
    module.def("join_masks", joinedMasks, py::arg("paths"), py::arg("kind"), py::arg("priority"),
               py::arg("listed"), py::arg("table"));
    module.def(
        "read_label_table",
        [](const std::string& path) {
            const LabelTable table = readLabelTable(path);
            return py::make_tuple(entriesOf(table), table.warnings);
        },
        py::arg("path"));
    module.def(
        "find_label_table",
        [](const std::string& image, std::int64_t volume) {
            const FoundLabelTables found = findLabelTables(image, volume);
            return py::make_tuple(entriesOf(found.table), found.table.warnings);
        },
        py::arg("image"), py::arg("volume") = 0);
    module.def(
        "label_colors",
        [](const std::vector<std::int32_t>& labels,
           const std::vector<std::optional<LabelColor>>& given) {
            return labelColors(labels, given);
        },
        py::arg("labels"), py::arg("given"));
}

}  // namespace adaptiso::python
