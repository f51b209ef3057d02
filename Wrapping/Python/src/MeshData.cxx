#include "MeshData.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/Report/Page.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso::python {

void turnXY(std::vector<Vec3>& points) {
    for (Vec3& p : points) {
        p.x = 0 - p.x;  // no -0, as files have it
        p.y = 0 - p.y;
    }
}

namespace {

constexpr const char* kStateIt =
    "; state it by input_coordinates=\"ras\", \"lps\", \"tkras\" or \"voxel\" where it is read";

/// Both axes turn, so triangles stay as they are.
void turnXY(TriangleMesh& mesh) {
    python::turnXY(mesh.points);
    for (Normal& n : mesh.normals) {
        n.x = -n.x;
        n.y = -n.y;
    }
}

Json originJson(const SurfaceHistory& history, const ImageGeometry& image) {
    ImageOrigin origin = history.origin;
    addWarnings(origin.warnings, history.preprocessingWarnings);
    Json json{{"file", origin.file.empty() ? Json(nullptr) : Json(origin.file)}};
    json.update(imageJson(origin.format, image, history.pixelType, history.range, origin.warnings));
    return json;
}

Json optionsJson(const SurfaceHistory& history) {
    Json json = surfaceOptionsJson(history.extraction, history.index, history.selection);
    json["threads"] = history.threads > 0 ? Json(history.threads) : Json(nullptr);
    json["strict"] = false;
    return json;
}

Json timesJson(const SurfaceHistory& history) {
    Json json = Json::object();
    double total = 0;
    for (const auto& [stage, seconds] : history.seconds) {
        json[stage] = seconds;
        total += seconds;
    }
    json["total"] = total;
    return json;
}

std::string reportOf(const SurfaceHistory& history, const ImageGeometry& image) {
    Json surface = figuresJson(
        surfaceFigures(), {history.record, history.extraction.method, history.index.blockSize});
    surface["output"] = nullptr;
    std::vector<Warning> warnings;
    const std::string file = history.origin.file.empty() ? "the image" : history.origin.file;
    addWarnings(warnings, history.origin.warnings, file);
    addWarnings(warnings, history.preprocessingWarnings, file);
    addWarnings(warnings, history.warnings, file);
    const Json report{
        {"schema", "adaptiso-mesh/1"},
        {"program", {{"name", kProgramName}, {"version", ADAPTISO_VERSION}}},
        {"passed", true},
        {"exitCode", 0},
        {"error", nullptr},
        {"warnings", warnings},
        {"input", originJson(history, image)},
        {"preprocessing",
         preprocessedJson(history.preprocessing, image.size, history.preprocessed)},
        {"options", optionsJson(history)},
        {"index",
         {{"search", toString(history.index.search)}, {"memoryBytes", history.indexBytes}}},
        {"surfaces", Json::array({surface})},
        {"failedByWarnings", false},
        {"reportFailure", nullptr},
        {"seconds", timesJson(history)},
        {"peakMemoryMb", history.peakMemoryMb}};
    return jsonText(report, -1);
}

void requireRows(const py::array& array, const char* name) {
    if (array.ndim() != 2 || array.shape(1) != 3) {
        throw InvalidInput(std::string(name) + ": must have the shape (n, 3)");
    }
}

template <class Row, class Value>
std::vector<Row> rowsOf(const py::array_t<Value, py::array::c_style>& array) {
    std::vector<Row> rows(static_cast<std::size_t>(array.shape(0)));
    const auto table = array.template unchecked<2>();
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const auto row = static_cast<py::ssize_t>(n);
        rows[n] = Row{table(row, 0), table(row, 1), table(row, 2)};
    }
    return rows;
}

void requireFaultless(const TriangleMesh& mesh) {
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        if (!std::isfinite(squaredNorm(mesh.points[n]))) {
            throw InvalidInput("vertices: row " + std::to_string(n) +
                               " is not finite, or too large");
        }
    }
    const auto count = static_cast<VertexId>(mesh.points.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        for (const VertexId v : mesh.triangles[n]) {
            if (v >= 0 && v < count) continue;
            throw InvalidInput("faces: row " + std::to_string(n) + " names vertex " +
                               std::to_string(v) + ", there are " + std::to_string(count));
        }
    }
}

}  // namespace

std::shared_ptr<MeshData> MeshData::fromLps(TriangleMesh mesh, std::optional<ImageGeometry> image,
                                            std::optional<SurfaceHistory> history) {
    auto data = std::make_shared<MeshData>();
    data->mesh_ = std::move(mesh);
    turnXY(data->mesh_);
    data->image_ = std::move(image);
    data->history_ = std::move(history);
    if (data->history_) {
        data->errorBoundMm_ = data->history_->record.statistics.errorBoundMm;
        const auto& used = data->history_->preprocessed;
        data->requestedBoundMm_ =
            requestedBoundMm(data->history_->extraction, used ? used->geometry : *data->image_);
    }
    return data;
}

std::shared_ptr<MeshData> MeshData::fromArrays(
    const py::array_t<double, py::array::c_style>& points,
    const py::array_t<std::int64_t, py::array::c_style>& faces,
    const std::optional<py::array_t<float, py::array::c_style>>& normals, CoordinateFrame frame,
    std::optional<ImageGeometry> image, bool keepsFaults) {
    requireRows(points, "vertices");
    requireRows(faces, "faces");
    auto data = std::make_shared<MeshData>();
    data->mesh_.points = rowsOf<Vec3>(points);
    data->mesh_.triangles = rowsOf<Triangle>(faces);
    if (normals) {
        requireRows(*normals, "normals");
        if (normals->shape(0) != points.shape(0)) {
            throw InvalidInput("normals: must be as many as vertices");
        }
        data->mesh_.normals = rowsOf<Normal>(*normals);
    }
    if (!keepsFaults) requireFaultless(data->mesh_);
    data->frame_ = frame;
    data->image_ = std::move(image);
    return data;
}

std::shared_ptr<MeshData> MeshData::moved(const AffineTransform& transform) const {
    auto data = alike(transformed(mesh_, transform));
    data->image_.reset();
    data->isMade_ = isMade();
    requireFaultless(data->mesh_);
    return data;
}

TriangleMesh MeshData::lps() const {
    TriangleMesh mesh{mesh_.points, {}, mesh_.triangles};
    turnXY(mesh);
    return mesh;
}

std::string MeshData::report() {
    if (!report_.empty() || !history_) return report_;
    SurfaceHistory history = *history_;
    if (!history.record.crossingPairs) {
        const Unlocked unlocked;
        const SelfIntersections found = findSelfIntersections(mesh_, {.maxPairs = 0});
        if (found.isComplete) history.record.crossingPairs = found.pairCount;
    }
    report_ = reportOf(history, *image_);
    return report_;
}

std::string MeshData::write(const std::string& path, std::optional<CoordinateFrame> frame,
                            std::vector<CellArray> cellArrays) const {
    findMeshFormat(path);  // or the message would name the temporary's extension
    AtomicOutput output(path);
    std::string warning;
    output.write([&](const std::filesystem::path& file) {
        warning = writeTo(file, frame, std::move(cellArrays));
    });
    AtomicOutput::commit({&output, 1});
    return warning;
}

std::string MeshData::writeTo(const std::filesystem::path& path,
                              std::optional<CoordinateFrame> frame,
                              std::vector<CellArray> cellArrays) const {
    const MeshFormat& format = findMeshFormat(path);
    MeshWriteOptions options;
    options.cellArrays = std::move(cellArrays);
    options.frame = frame.value_or(frame_ == CoordinateFrame::TkRas ? frame_ : format.defaultFrame);
    if (options.frame == CoordinateFrame::Voxel && !format.holdsVoxelFrame) {
        throw InvalidInput("frame voxel: " + std::string(format.name) + " holds points in mm only");
    }
    if (!isFrameKnown_) {
        if (frame || format.defaultFrame == CoordinateFrame::TkRas) {
            throw InvalidInput(path.string() +
                               ": the mesh is of a file that does not say its coordinate frame" +
                               kStateIt);
        }
        options.saysFrame = false;
    }
    if (frame_ == CoordinateFrame::TkRas && !image_) {
        if (options.frame != CoordinateFrame::TkRas) {
            throw InvalidInput(
                "the mesh is in tkRAS of a volume that is not known; load it with volume=");
        }
        options.volume = standInVolume();  // any volume's tkRAS will do to write it as it is
        writeMesh(fromFrame(mesh_, CoordinateFrame::TkRas, options.volume), path, options);
        return {};
    }
    if (needsVolume(options.frame)) {
        if (!image_) {
            throw InvalidInput("frame " + std::string(frameWord(options.frame)) +
                               ": the mesh does not know its image; give the frame ras or lps");
        }
        options.volume = frameVolume(options.frame, *image_);
    }
    if (frame_ == CoordinateFrame::TkRas) {
        writeMesh(fromFrame(mesh_, frame_, frameVolume(frame_, *image_)), path, options);
        return {};
    }
    TriangleMesh lps = mesh_;
    turnXY(lps);
    // as the programs do; walls of labels are rounded alike on both sides instead
    std::optional<Warning> warning;
    if (isMade()) {
        RoundingHarm harm =
            settleRounding(lps, format.precision, lpsToFrame(options.frame, options.volume));
        if (!history_) harm.mergedPoints = 0;  // adaptiso-simplify looks at triangles alone
        if (harm) throw InvalidInput(path.string() + ": " + textOf(harm, format));
        if (requestedBoundMm_) {
            const auto fault = roundingFault(harm.roundingMm, *requestedBoundMm_, format);
            if (fault) throw InvalidInput(path.string() + ": " + *fault);
            warning = roundingWarning({}, errorBoundMm_.value_or(0) + harm.roundingMm,
                                      *requestedBoundMm_, harm.roundingMm, format);
        }
    }
    writeMesh(lps, path, options);
    return warning ? warning->text : "";
}

std::string MeshData::notebook(const std::string& title) const {
    Report report;
    report.title = title;
    report.surfaces.push_back({"surface", lps()});
    const std::vector<Picture> pictures = drawPictures(report);
    const auto sixSides =
        std::find_if(pictures.begin(), pictures.end(),
                     [](const Picture& picture) { return picture.name == "surface-1.png"; });
    return notebookHtml(report, sixSides == pictures.end() ? Picture{} : *sixSides);
}

void MeshData::draw(const std::string& path) const {
    Report report;
    report.surfaces.push_back({"surface", lps()});
    AtomicOutput output(path);
    output.writeText(drawViews(report, {.width = 1200, .height = 900}).front().png);
    AtomicOutput::commit({&output, 1});
}

std::vector<Warning> warningsOfBound(std::optional<double> maxErrorMm, const TriangleMesh& mesh) {
    if (!maxErrorMm || mesh.points.empty()) return {};
    const auto warning =
        boundOverSize("max_error", *maxErrorMm, norm(boundingBox(mesh).size()), {});
    return warning ? std::vector{*warning} : std::vector<Warning>();
}

std::pair<std::shared_ptr<MeshData>, std::vector<Warning>> readMeshData(
    const std::string& path, const std::optional<ImageGeometry>& image, bool keepsFaults,
    std::optional<CoordinateFrame> stated) {
    MeshFile file = readMesh(path, {.keepsFaults = keepsFaults, .inputCoordinates = stated});
    std::vector<Warning> warnings = file.warnings;
    const bool isFrameKnown = file.frame.has_value();
    if (!isFrameKnown) {
        if (image) {
            throw InvalidInput(path + ": does not say its coordinate frame, so where it lies in " +
                               "the image is not known" + kStateIt);
        }
        if (!keepsFaults) {
            warnings.push_back(
                {"guessed-frame", "does not say its coordinate frame; points are as stored"});
        }
        file.frame = CoordinateFrame::Ras;
    }
    if (!file.volume && image && needsVolume(*file.frame)) {
        file.volume = frameVolume(*file.frame, *image);
    }
    if (*file.frame == CoordinateFrame::Voxel && !file.volume) {
        throw InvalidInput(path + ": is in voxel indices, which says nothing of mm; give volume=");
    }
    const bool isLoose = *file.frame == CoordinateFrame::TkRas && !file.volume;
    const bool isKept = isLoose || (keepsFaults && *file.frame != CoordinateFrame::Voxel);
    auto data = isKept ? std::make_shared<MeshData>()
                       : MeshData::fromLps(fromFrame(file.mesh, *file.frame, file.volume),
                                           std::nullopt, std::nullopt);
    if (isKept) *data = MeshData::asStored(std::move(file.mesh), *file.frame);
    if (image) {
        data->setImage(*image);
    } else if (file.volume && !isKept) {
        data->setImage(*file.volume);
    }
    data->setFrameKnown(isFrameKnown);
    data->setSolids(std::move(file.solids));
    return {data, warnings};
}

namespace {

/// Python's word for the frame of a mesh whose file does not name one.
constexpr std::string_view kUnknownFrame = "unknown";

std::optional<ImageGeometry> imageOf(const std::optional<std::vector<std::int64_t>>& shape,
                                     const std::optional<py::array_t<double>>& affine) {
    if (!shape || !affine) return std::nullopt;
    if (shape->size() != 3) throw InvalidInput("shape: must be three counts of voxels");
    return geometryFromAffine({(*shape)[0], (*shape)[1], (*shape)[2]}, *affine);
}

}  // namespace

void declareMeshes(py::module_& module) {
    py::class_<MeshData, std::shared_ptr<MeshData>>(module, "MeshData")
        .def_property_readonly("surface_warnings", &MeshData::surfaceWarnings)
        .def_static(
            "from_arrays",
            [](const py::array_t<double, py::array::c_style>& points,
               const py::array_t<std::int64_t, py::array::c_style>& faces,
               const std::optional<py::array_t<float, py::array::c_style>>& normals,
               const std::string& frame, const std::optional<std::vector<std::int64_t>>& shape,
               const std::optional<py::array_t<double>>& affine, bool keepsFaults) {
                const bool isKnown = frame != kUnknownFrame;
                auto data = MeshData::fromArrays(points, faces, normals,
                                                 isKnown ? frameOf(frame) : CoordinateFrame::Ras,
                                                 imageOf(shape, affine), keepsFaults);
                data->setFrameKnown(isKnown);
                return data;
            },
            py::arg("vertices"), py::arg("faces"), py::arg("normals") = py::none(),
            py::arg("frame") = "ras", py::arg("shape") = py::none(), py::arg("affine") = py::none(),
            py::arg("keeps_faults") = false)
        .def_property_readonly("vertices",
                               [](const py::object& self) {
                                   const auto& mesh = self.cast<const MeshData&>().mesh();
                                   return viewRows<double>(mesh.points, self);
                               })
        .def_property_readonly("faces",
                               [](const py::object& self) {
                                   const auto& mesh = self.cast<const MeshData&>().mesh();
                                   return viewRows<std::int64_t>(mesh.triangles, self);
                               })
        .def_property_readonly("normals",
                               [](const py::object& self) {
                                   const auto& mesh = self.cast<const MeshData&>().mesh();
                                   return viewRows<float>(mesh.normals, self);
                               })
        .def_property("error_bound", &MeshData::errorBoundMm, &MeshData::setErrorBoundMm)
        .def_property("report", &MeshData::report, &MeshData::setReport)
        .def_property_readonly("frame",
                               [](const MeshData& self) {
                                   return self.isFrameKnown() ? frameWord(self.frame())
                                                              : kUnknownFrame;
                               })
        .def_property_readonly("shape",
                               [](const MeshData& self) -> py::object {
                                   if (!self.image()) return py::none();
                                   const Index3& size = self.image()->size;
                                   return py::make_tuple(size[0], size[1], size[2]);
                               })
        .def_property_readonly("affine",
                               [](const MeshData& self) -> py::object {
                                   if (!self.image()) return py::none();
                                   return affineOf(*self.image());
                               })
        .def(
            "write",
            [](const MeshData& self, const std::string& path,
               const std::optional<std::string>& frame) {
                const auto wanted = frameOf(frame);
                const Unlocked unlocked;
                return self.write(path, wanted);
            },
            py::arg("path"), py::arg("frame") = py::none())
        .def(
            "in_frame",
            [](const MeshData& self, const std::string& frame) {
                // tkRAS of the image, as files of FreeSurfer hold it
                const CoordinateFrame wanted = frameOf(frame);
                if (!self.image()) throw InvalidInput("the mesh does not know its image");
                TriangleMesh lps = fromFrame(self.mesh(), CoordinateFrame::Ras);
                return std::make_shared<MeshData>(MeshData::asStored(
                    toFrame(lps, wanted, frameVolume(wanted, *self.image())), wanted));
            },
            py::arg("frame"))
        .def_property_readonly(
            "frame_volume",
            [](const MeshData& self) -> py::object {
                if (!self.image()) return py::none();
                const ImageGeometry volume = frameVolume(CoordinateFrame::TkRas, *self.image());
                return py::make_tuple(
                    py::make_tuple(volume.size[0], volume.size[1], volume.size[2]),
                    affineOf(volume));
            })
        .def(
            "notebook",
            [](const MeshData& self, const std::string& title) {
                std::string html;
                runUnlocked(0, [&] { html = self.notebook(title); });
                return html;
            },
            py::arg("title"))
        .def(
            "moved",
            [](const MeshData& self, const py::array_t<double>& matrix) {
                return self.moved(transformOf(matrix, "matrix"));
            },
            py::arg("matrix"))
        .def(
            "draw",
            [](const MeshData& self, const std::string& path) {
                runUnlocked(0, [&] { self.draw(path); });
            },
            py::arg("path"))
        .def_property_readonly(
            "is_watertight",
            [](const MeshData& self) {
                bool isWatertight = false;
                runUnlocked(0, [&] { isWatertight = checkTopology(self.mesh()).isWatertight(); });
                return isWatertight;
            })
        .def_property_readonly("area",
                               [](const MeshData& self) { return surfaceArea(self.mesh()); })
        .def_property_readonly("volume",
                               [](const MeshData& self) { return enclosedVolume(self.mesh()); })
        .def_property_readonly("bytes", [](const MeshData& self) {
            const TriangleMesh& mesh = self.mesh();
            return mesh.points.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Normal) +
                   mesh.triangles.size() * sizeof(Triangle);
        });
    module.def(
        "read_mesh",
        [](const std::string& path, const std::optional<std::vector<std::int64_t>>& shape,
           const std::optional<py::array_t<double>>& affine, bool keepsFaults,
           const std::optional<std::string>& stated) {
            const std::optional<ImageGeometry> image = imageOf(shape, affine);
            const auto frame = frameOf(stated);
            const Unlocked unlocked;
            return readMeshData(path, image, keepsFaults, frame);
        },
        py::arg("path"), py::arg("shape"), py::arg("affine"), py::arg("keeps_faults"),
        py::arg("input_coordinates"));
}

}  // namespace adaptiso::python
