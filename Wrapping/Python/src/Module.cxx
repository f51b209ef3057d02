// The C++ half of the Python package: arrays in and out, no algorithm. Arguments are checked and
// named by the Python half (adaptiso/*.py), which documents what users see.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "HeadModel.h"
#include "Judgements.h"
#include "MeshData.h"
#include "Resources.h"
#include "Simplify.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Numbers.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/ImageIO/Otsu.h"
#include "adaptiso/ImageIO/SampleStatistics.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/Pipeline/Checks.h"
#include "adaptiso/Pipeline/DistanceJson.h"
#include "adaptiso/Pipeline/FinishSurface.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#ifdef ADAPTISO_PYTHON_READERS
#include "adaptiso/ImageIO/ReadVolume.h"
#endif

namespace adaptiso::python {
namespace {

template <class Value>
Value choose(const char* argument, const std::string& word,
             const std::vector<std::pair<const char*, Value>>& choices) {
    std::string words;
    for (const auto& [name, value] : choices) {
        if (word == name) return value;
        words += (words.empty() ? "" : ", ") + std::string(name);
    }
    throw InvalidInput(std::string(argument) + " '" + word + "': must be one of " + words);
}

Method methodOf(const std::string& word) {
    return choose<Method>("method", word,
                          {{"adaptive", Method::Adaptive},
                           {"boxes", Method::Boxes},
                           {"dmc", Method::DiscretizedMarchingCubes},
                           {"asc", Method::SkeletonClimbing},
                           {"mc", Method::MarchingCubes}});
}

Border borderOf(const std::string& word) {
    return choose<Border>("border", word, {{"closed", Border::Closed}, {"open", Border::Open}});
}

CoordinateFrame frameOf(const std::string& word) {
    return choose<CoordinateFrame>("frame", word,
                                   {{"ras", CoordinateFrame::Ras},
                                    {"lps", CoordinateFrame::Lps},
                                    {"tkras", CoordinateFrame::TkRas},
                                    {"voxel", CoordinateFrame::Voxel}});
}

Profile profileOf(const std::string& word) {
    return choose<Profile>(
        "profile", word,
        {{"bem", Profile::Bem}, {"print", Profile::Print}, {"view", Profile::View}});
}

/// An index over an array's blocks.
struct ArrayIndex {
    SpanSpaceIndex index;
    double seconds = 0;
};

std::shared_ptr<ArrayIndex> buildIndex(const ArrayVolume& volume, const IndexOptions& options,
                                       int threads) {
    const auto start = std::chrono::steady_clock::now();
    std::shared_ptr<ArrayIndex> built;
    runUnlocked(threads, [&] {
        built =
            std::make_shared<ArrayIndex>(ArrayIndex{SpanSpaceIndex::build(volume.view, options)});
    });
    built->seconds = secondsSince(start);
    return built;
}

/// What surface() and Index.surface() take, apart from the image.
struct SurfaceRequest {
    std::optional<double> level;  ///< none: Otsu's method chooses
    std::string method;
    std::optional<double> maxErrorMm;
    std::optional<std::int64_t> maxTriangles;
    std::optional<double> reduction;
    double minAngleDeg = 0;
    bool largest = false;
    double minVolumeMm3 = 0;
    bool fillCavities = false;
    int threads = 0;

    ExtractionOptions extraction() const {
        ExtractionOptions options;
        options.method = methodOf(method);
        options.adaptive.maxErrorMm = maxErrorMm;
        options.adaptive.maxTriangles = maxTriangles;
        options.adaptive.reduction = reduction;
        options.adaptive.minAngleDeg = minAngleDeg;
        if (options.method != Method::Adaptive && !(options.adaptive == AdaptiveOptions{})) {
            throw InvalidInput(
                "max_error, triangles, reduction and min_angle are for the method 'adaptive'");
        }
        return options;
    }
    ComponentSelection selection(Border border) const {
        ComponentSelection selection;
        selection.largestOnly = largest;
        selection.minVolumeMm3 = minVolumeMm3;
        selection.fillCavities = fillCavities;
        if (border == Border::Open && (fillCavities || minVolumeMm3 > 0)) {
            throw InvalidInput(
                "min_volume and fill_cavities need closed surfaces, not border 'open'");
        }
        return selection;
    }
};

std::string rangeText(const ValueRange& range) {
    if (range.minimum > range.maximum) return "the image holds no numbers";
    return "the range of the image is " + formatShort(range.minimum) + " to " +
           formatShort(range.maximum);
}

double levelOf(const SurfaceRequest& request, const VolumeView& volume, const ValueRange& range) {
    if (!request.level) {
        try {
            return otsuThreshold(volume);
        } catch (const InvalidInput& error) {
            throw InvalidInput("level 'auto': " + std::string(error.what()));
        }
    }
    if (const auto fault = isovalueFault(*request.level, range)) {
        throw InvalidInput("level " + formatNumber(*request.level) + ": " + *fault + "; " +
                           rangeText(range));
    }
    return *request.level;
}

/// Makes a surface as adaptiso-mesh does, from the samples on.
/// \param built  an index, or null: a look at every block, which for one level is quicker than a
///               tree and a third of its size, and is gone when the surface is there
std::shared_ptr<MeshData> makeSurface(ArrayVolume& volume, std::shared_ptr<const ArrayIndex> built,
                                      const std::string& border, const SurfaceRequest& request,
                                      const ImageOrigin& origin, py::object progress) {
    SurfaceHistory history;
    history.extraction = request.extraction();
    history.selection = request.selection(borderOf(border));
    if (!built) {
        built = buildIndex(volume, {.border = borderOf(border), .search = BlockSearchKind::Linear},
                           request.threads);
    }
    history.index = built->index.options();
    history.indexBytes = built->index.memoryBytes();
    history.origin = origin;
    history.pixelType = volume.view.pixelType();
    history.range = volume.valueRange(request.threads);
    history.threads = request.threads;
    history.seconds.emplace_back("index", built->seconds);

    Watcher watcher(std::move(progress));
    TriangleMesh mesh;
    watcher.run(request.threads, [&] {
        auto start = std::chrono::steady_clock::now();
        SurfaceRecord& record = history.record;
        record.isAutomatic = !request.level;
        record.isovalue = levelOf(request, volume.view, history.range);
        ExtractionOptions options = history.extraction;
        options.isovalue = record.isovalue;
        options.progress = watcher.callback();
        Extraction extraction = extractSurface(volume.view, built->index, options);
        built.reset();
        history.seconds.emplace_back("extract", secondsSince(start));
        record.statistics = extraction.statistics;
        record.extractedTriangles = std::ssize(extraction.mesh.triangles);
        if (extraction.mesh.triangles.empty()) {
            throw InvalidInput("level " + formatNumber(record.isovalue) +
                               ": the surface is empty; no two neighbouring voxels lie on both "
                               "sides");
        }
        FinishOptions finish;
        finish.selection = history.selection;
        finish.method = options.method;
        finish.border = history.index.border;
        finish.countsCrossings = false;  // when the report is asked for
        finish.runStage = [&](std::string_view stage, const std::function<void()>& work) {
            watcher.tell(stage, 0);
            const auto begin = std::chrono::steady_clock::now();
            work();
            history.seconds.emplace_back(stage, secondsSince(begin));
        };
        try {
            mesh = finishSurface(std::move(extraction.mesh), finish, record).mesh;
        } catch (const NothingLeft& error) {
            throw InvalidInput("min_volume " + formatNumber(request.minVolumeMm3) + ": " +
                               error.what());
        }
        watcher.tell("check", 1);
    });
    history.peakMemoryMb = peakMemoryMb();
    return MeshData::fromLps(std::move(mesh), volume.geometry, std::move(history));
}

std::string checkMesh(const MeshData& data, const std::string& profile,
                      std::optional<double> minAngleDeg, std::int64_t maxPairs, int threads) {
    CheckRules rules;
    rules.profile = profileOf(profile);
    rules.minAngleDeg = minAngleDeg;
    rules.maxPairs = maxPairs;
    std::string json;
    runUnlocked(threads, [&] { json = dumped(surfaceVerdict(data.mesh(), rules)); });
    return json;
}

std::string checkNested(const std::vector<std::shared_ptr<MeshData>>& meshes,
                        const std::vector<std::string>& names, const std::string& profile,
                        std::optional<double> minGapMm, std::optional<double> minAngleDeg,
                        std::int64_t maxPairs, int threads) {
    CheckRules rules;
    rules.isNested = true;
    rules.profile = profileOf(profile);
    rules.minGapMm = minGapMm;
    rules.minAngleDeg = minAngleDeg;
    rules.maxPairs = maxPairs;
    std::vector<const TriangleMesh*> asked;
    for (const auto& mesh : meshes) asked.push_back(&mesh->mesh());
    std::string text;
    runUnlocked(threads, [&] { text = dumped(nestedJson(asked, names, {}, rules)); });
    return text;
}

/// What adaptiso-compare tells of one of the two.
Json measuresOf(const TriangleMesh& mesh, const char* name) {
    const double areaMm2 = surfaceArea(mesh);
    if (!(areaMm2 > 0)) {
        throw InvalidInput(std::string(name) +
                           ": its triangles have no area, so there is nothing to measure");
    }
    const TopologyReport topology = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    const bool isSolid = topology.isClosed() && topology.isOriented();
    const BoundingBox box = boundingBox(mesh);
    return {{"triangles", mesh.triangles.size()},
            {"vertices", mesh.points.size()},
            {"areaMm2", number(areaMm2)},
            {"volumeMm3", isSolid ? number(enclosedVolume(mesh)) : Json(nullptr)},
            {"boundingBoxDiagonalMm", number(norm(box.maximum - box.minimum))}};
}

std::string compareMeshes(const MeshData& a, const MeshData& b, std::int64_t samples,
                          bool isSymmetric, int threads, py::object progress) {
    Watcher watcher(std::move(progress));
    std::string text;
    watcher.run(threads, [&] {
        // in LPS, as the program does: where two triangles are equally near the same one counts
        const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, {});
        const auto told = [&](const DistanceStatistics& distances) {
            return distances.samples == 0 ? Json(nullptr) : distanceJson(distances, toRas);
        };
        const TriangleMesh meshA = a.lps(), meshB = b.lps();
        const Json measuresA = measuresOf(meshA, "a"), measuresB = measuresOf(meshB, "b");
        const DistanceReport report =
            surfaceDistance(meshA, meshB, {samples, isSymmetric, watcher.callback()});
        text = dumped({{"a", measuresA},
                       {"b", measuresB},
                       {"options", {{"samples", samples}, {"symmetric", isSymmetric}}},
                       {"distances",
                        {{"aToB", told(report.aToB)},
                         {"bToA", told(report.bToA)},
                         {"combined", told(report.combined)}}}});
    });
    return text;
}

#ifdef ADAPTISO_PYTHON_READERS
py::tuple readImage(const std::string& path, std::optional<std::string> series,
                    std::optional<std::int64_t> volumeIndex, bool resampleSlices) {
    ReadOptions options;
    options.series = std::move(series);
    options.volumeIndex = volumeIndex;
    options.resampleSlices = resampleSlices;
    std::optional<ReadVolume> read;
    runUnlocked(0, [&] { read = readVolume(path, options); });
    return py::make_tuple(toArray(read->volume), affineOf(read->volume.view().geometry()),
                          read->format, read->warnings);
}
#endif

/// Rows of three numbers that `owner` keeps; nobody may write to them.
template <class Value, class Row>
py::array viewRows(const std::vector<Row>& rows, const py::object& owner) {
    static_assert(sizeof(Row) == 3 * sizeof(Value));
    py::array array(
        py::dtype::of<Value>(), {static_cast<py::ssize_t>(rows.size()), py::ssize_t{3}},
        {static_cast<py::ssize_t>(sizeof(Row)), static_cast<py::ssize_t>(sizeof(Value))},
        rows.data(), owner);
    array.attr("setflags")(py::arg("write") = false);
    return array;
}

std::optional<ImageGeometry> imageOf(const std::optional<std::vector<std::int64_t>>& shape,
                                     const std::optional<py::array_t<double>>& affine) {
    if (!shape || !affine) return std::nullopt;
    if (shape->size() != 3) throw InvalidInput("shape: must be three counts of voxels");
    return geometryFromAffine({(*shape)[0], (*shape)[1], (*shape)[2]}, *affine);
}

std::optional<CoordinateFrame> optionalFrame(const std::optional<std::string>& word) {
    if (!word) return std::nullopt;
    return frameOf(*word);
}

void declareMeshData(py::module_& module) {
    py::class_<MeshData, std::shared_ptr<MeshData>>(module, "MeshData")
        .def_static(
            "from_arrays",
            [](const py::array_t<double, py::array::c_style>& points,
               const py::array_t<std::int64_t, py::array::c_style>& faces,
               const std::optional<py::array_t<float, py::array::c_style>>& normals,
               const std::string& frame, const std::optional<std::vector<std::int64_t>>& shape,
               const std::optional<py::array_t<double>>& affine, bool keepsFaults) {
                return MeshData::fromArrays(points, faces, normals, frameOf(frame),
                                            imageOf(shape, affine), keepsFaults);
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
                               [](const MeshData& self) { return frameWord(self.frame()); })
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
                const auto wanted = optionalFrame(frame);
                const py::gil_scoped_release unlocked;
                self.write(path, wanted);
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
        .def_property_readonly("area",
                               [](const MeshData& self) { return surfaceArea(self.mesh()); })
        .def_property_readonly("volume",
                               [](const MeshData& self) { return enclosedVolume(self.mesh()); })
        .def_property_readonly("bytes", [](const MeshData& self) {
            const TriangleMesh& mesh = self.mesh();
            return mesh.points.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Normal) +
                   mesh.triangles.size() * sizeof(Triangle);
        });
}

void declareSurfaces(py::module_& module) {
    py::class_<ArrayVolume, std::shared_ptr<ArrayVolume>>(module, "ArrayVolume")
        .def(py::init([](const py::array& samples, const py::array_t<double>& affine,
                         const std::vector<std::int64_t>& userShape,
                         const py::array_t<double>& userAffine) {
                 if (userShape.size() != 3) throw InvalidInput("image: must have three axes");
                 return std::make_shared<ArrayVolume>(ArrayVolume::make(
                     samples, affine, {userShape[0], userShape[1], userShape[2]}, userAffine));
             }),
             py::arg("samples"), py::arg("affine"), py::arg("user_shape"), py::arg("user_affine"))
        .def("value_range",
             [](ArrayVolume& self) {
                 const ValueRange& range = self.valueRange(0);
                 return py::make_tuple(range.minimum, range.maximum);
             })
        .def_property_readonly("address",
                               [](const ArrayVolume& self) {
                                   return reinterpret_cast<std::uintptr_t>(self.view.samples());
                               })
        .def("count_not_finite", [](const ArrayVolume& self) {
            std::int64_t finite = 0;
            runUnlocked(0, [&] { finite = countFinite(self.view); });
            return self.view.geometry().voxelCount() - finite;
        });
    py::class_<ArrayIndex, std::shared_ptr<ArrayIndex>>(module, "ArrayIndex")
        .def_property_readonly(
            "blocks", [](const ArrayIndex& self) { return self.index.grid().blockCount(); })
        .def_property_readonly("memory_bytes",
                               [](const ArrayIndex& self) { return self.index.memoryBytes(); });
    module.def(
        "build_index",
        [](const ArrayVolume& volume, const std::string& border, int threads) {
            return buildIndex(volume, {.border = borderOf(border)}, threads);
        },
        py::arg("volume"), py::arg("border"), py::arg("threads"));
    module.def(
        "make_surface",
        [](ArrayVolume& volume, const std::shared_ptr<ArrayIndex>& index, const std::string& border,
           std::optional<double> level, const std::string& method, std::optional<double> maxError,
           std::optional<std::int64_t> triangles, std::optional<double> reduction, double minAngle,
           bool largest, double minVolume, bool fillCavities, int threads, py::object progress,
           const std::string& file, const std::string& format,
           const std::vector<std::string>& warnings) {
            return makeSurface(volume, index, border,
                               {level, method, maxError, triangles, reduction, minAngle, largest,
                                minVolume, fillCavities, threads},
                               {file, format, warnings}, std::move(progress));
        },
        py::arg("volume"), py::arg("index"), py::arg("border"), py::arg("level"), py::arg("method"),
        py::arg("max_error"), py::arg("triangles"), py::arg("reduction"), py::arg("min_angle"),
        py::arg("largest"), py::arg("min_volume"), py::arg("fill_cavities"), py::arg("threads"),
        py::arg("progress"), py::arg("file"), py::arg("format"), py::arg("warnings"));
}

void declareFilesAndChecks(py::module_& module) {
#ifdef ADAPTISO_PYTHON_READERS
    module.def("read_image", &readImage, py::arg("path"), py::arg("series"),
               py::arg("volume_index"), py::arg("resample_slices"));
#endif
    module.def(
        "read_mesh",
        [](const std::string& path, const std::optional<std::vector<std::int64_t>>& shape,
           const std::optional<py::array_t<double>>& affine, bool keepsFaults) {
            const std::optional<ImageGeometry> image = imageOf(shape, affine);
            const py::gil_scoped_release unlocked;
            return readMeshData(path, image, keepsFaults);
        },
        py::arg("path"), py::arg("shape"), py::arg("affine"), py::arg("keeps_faults"));
    module.def("check", &checkMesh, py::arg("mesh"), py::arg("profile"), py::arg("min_angle"),
               py::arg("max_pairs"), py::arg("threads"));
    module.def("check_nested", &checkNested, py::arg("meshes"), py::arg("names"),
               py::arg("profile"), py::arg("min_gap"), py::arg("min_angle"), py::arg("max_pairs"),
               py::arg("threads"));
    module.def("compare", &compareMeshes, py::arg("a"), py::arg("b"), py::arg("samples"),
               py::arg("symmetric"), py::arg("threads"), py::arg("progress"));
}

/// What bem() takes, apart from what the model is made from.
struct BemRequest {
    bool isMeg = false;
    std::vector<std::int64_t> vertices;
    std::optional<std::pair<double, double>> edgeLengthMm;
    std::array<double, 2> minGapsMm{};
    double csfMm = 0, skullMm = 0, maxSkullMm = 0, skullHu = 0, skinHu = 0, closingMm = 0;
    double smoothingMm = 0, cutNecksMm = 0, stepMm = 0;
    std::array<double, 3> conductivities{};

    BemModelOptions options() const {
        BemModelOptions options;
        BoundaryOptions& head = options.boundaries;
        head.innerSkullOnly = isMeg;
        head.minSkullMm = minGapsMm[0];
        head.minScalpMm = minGapsMm[1];
        head.csfMm = csfMm;
        head.skullMm = skullMm;
        head.maxSkullMm = maxSkullMm;
        head.skullHu = skullHu;
        head.skinHu = skinHu;
        head.closingMm = closingMm;
        head.smoothingMm = smoothingMm;
        head.cutNecksMm = cutNecksMm;
        head.stepMm = stepMm;
        options.vertices = vertices;
        if (edgeLengthMm) options.edgeLengthMm = {edgeLengthMm->first, edgeLengthMm->second};
        options.conductivities = {conductivities[0], conductivities[1], conductivities[2]};
        try {
            checkConductivities(options.conductivities);
        } catch (const InvalidInput& error) {
            throw InvalidInput(std::string("conductivity: ") + error.what());
        }
        return options;
    }
};

TissueLabels tissuesOf(const std::string& preset, const std::vector<std::int64_t>& brain,
                       const std::vector<std::int64_t>& skull,
                       const std::vector<std::int64_t>& scalp) {
    if (!preset.empty()) return tissuePreset(preset);
    return {brain, skull, scalp};
}

BemFileOptions bemFilesOf(const std::string& unit, const std::string& frame, bool writesGifti,
                          bool writesVtp) {
    BemFileOptions options;
    options.unit = choose<OpenMeegUnit>(
        "units", unit, {{"mm", OpenMeegUnit::Millimetres}, {"m", OpenMeegUnit::Metres}});
    options.frame = frameOf(frame);
    options.writesGifti = writesGifti;
    options.writesVtp = writesVtp;
    return options;
}

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
        .def("check", &HeadModelData::check, py::arg("threads"))
        .def("report", [](const HeadModelData& self) { return self.report({}); })
        .def(
            "write",
            [](const HeadModelData& self, const std::string& folder, const std::string& unit,
               const std::string& frame, bool writesGifti, bool writesVtp) {
                const BemFileOptions options = bemFilesOf(unit, frame, writesGifti, writesVtp);
                runUnlocked(0, [&] { self.write(folder, options); });
            },
            py::arg("folder"), py::arg("units"), py::arg("frame"), py::arg("gifti"), py::arg("vtp"))
        .def("page", &HeadModelData::page, py::arg("deface"));
    module.def(
        "make_bem",
        [](const std::string& source, const std::vector<std::shared_ptr<ArrayVolume>>& images,
           const std::shared_ptr<ArrayVolume>& brainMask, const std::string& preset,
           const std::vector<std::vector<std::int64_t>>& tissues,
           const std::vector<std::shared_ptr<MeshData>>& surfaces,
           const std::vector<std::array<std::string, 3>>& inputs,
           const std::vector<std::string>& warnings, bool isMeg,
           const std::vector<std::int64_t>& vertices,
           const std::optional<std::pair<double, double>>& edgeLength,
           const std::array<double, 2>& minGap, double csf, double skull, double maxSkull,
           double skullHu, double skinHu, double closing, double smoothing, double cutNecks,
           double voxel, const std::array<double, 3>& conductivity, int threads,
           py::object progress) {
            const BemRequest request{isMeg,     vertices, edgeLength, minGap,      csf,
                                     skull,     maxSkull, skullHu,    skinHu,      closing,
                                     smoothing, cutNecks, voxel,      conductivity};
            HeadSources sources;
            sources.source = source;
            sources.images = images;
            sources.brainMask = brainMask;
            sources.tissues = tissuesOf(preset, tissues.at(0), tissues.at(1), tissues.at(2));
            sources.surfaces = surfaces;
            for (const auto& [file, role, format] : inputs) {
                sources.inputs.push_back({file, role, format});
            }
            sources.warnings = warnings;
            return HeadModelData::make(sources, request.options(), threads, std::move(progress));
        },
        py::arg("source"), py::arg("images"), py::arg("brain_mask"), py::arg("preset"),
        py::arg("tissues"), py::arg("surfaces"), py::arg("inputs"), py::arg("warnings"),
        py::arg("meg"), py::arg("vertices"), py::arg("edge_length"), py::arg("min_gap"),
        py::arg("csf"), py::arg("skull"), py::arg("max_skull"), py::arg("skull_hu"),
        py::arg("skin_hu"), py::arg("closing"), py::arg("smoothing"), py::arg("cut_necks"),
        py::arg("voxel"), py::arg("conductivity"), py::arg("threads"), py::arg("progress"));
}

}  // namespace
}  // namespace adaptiso::python

PYBIND11_MODULE(_adaptiso, module) {
    using namespace adaptiso::python;
    module.attr("__version__") = ADAPTISO_VERSION;
    const auto error = py::register_exception<adaptiso::Error>(module, "Error", PyExc_ValueError);
    error.doc() = "What can't be used: a file, an array, an argument. The message is one line.";
    py::register_exception<adaptiso::InternalError>(module, "InternalError", PyExc_RuntimeError);
    declareMeshData(module);
    declareSurfaces(module);
    declareFilesAndChecks(module);
    declareSimplify(module);
    declareHeadModels(module);
    module.def("before_fork", &beforeFork);
    module.def("after_fork_in_parent", &afterForkInParent);
    module.def("after_fork_in_child", &afterForkInChild);
}
