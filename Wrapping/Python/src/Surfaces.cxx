#include <pybind11/stl.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "Calls.h"
#include "MeshData.h"
#include "OptionRows.h"
#include "Words.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Files/StageTimer.h"
#include "adaptiso/ImageIO/SampleStatistics.h"
#include "adaptiso/Preprocessing/Preprocess.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"
#include "adaptiso/SurfacePipeline/SurfaceWarnings.h"

namespace adaptiso::python {
namespace {

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

/// Arguments of surface() and Index.surface(), apart from the image.
struct SurfaceRequest {
    std::optional<double> level;  ///< empty: Otsu's method chooses
    ExtractionOptions extraction;
    ComponentSelection selection;
    PreprocessOptions preprocessing;
    Border border = Border::Closed;
    int threads = 0;
};

void requireUsable(const SurfaceRequest& request) {
    const ExtractionOptions& extraction = request.extraction;
    if (extraction.method != Method::Adaptive && !(extraction.adaptive == AdaptiveOptions{})) {
        throw InvalidInput(namesOf(aimOptions(AimedSurface::OfScan)) +
                           ": are for the method 'adaptive'");
    }
    const ComponentSelection& pieces = request.selection;
    if (request.border == Border::Open && (pieces.fillCavities || pieces.minVolumeMm3 > 0)) {
        throw InvalidInput("min_volume and fill_cavities need closed surfaces, not border 'open'");
    }
    const PreprocessOptions& steps = request.preprocessing;
    if (steps.interpolation != Interpolation::Linear && !steps.resampleMm) {
        throw InvalidInput("interpolation: is for resample, which is not given");
    }
}

std::string rangeText(double level, const ValueRange& range) {
    if (range.minimum > range.maximum) return "the image holds no numbers";
    const auto texts = formatApart({range.minimum, range.maximum, level});
    return "the range of the image is " + texts[0] + " to " + texts[1];
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
                           rangeText(*request.level, range));
    }
    return *request.level;
}

/// The history's part that is known before the surface.
/// \param built  an index, or null
SurfaceHistory historyOf(const SurfaceRequest& request, const ArrayIndex* built,
                         const ImageOrigin& origin) {
    SurfaceHistory history;
    history.extraction = request.extraction;
    history.selection = request.selection;
    history.preprocessing = request.preprocessing;
    history.index = {.border = request.border, .search = BlockSearchKind::Linear};
    if (built != nullptr) {
        history.index = built->index.options();
        history.indexBytes = built->index.memoryBytes();
    }
    history.seconds.emplace_back("index", built != nullptr ? built->seconds : 0);
    history.origin = origin;
    history.threads = request.threads;
    return history;
}

/// The samples to make the surface of: `volume`'s where nothing is to be done.
Preprocessed prepared(const VolumeView& volume, SurfaceHistory& history, Watcher& watcher) {
    Preprocessed done{Volume(volume, nullptr), {}};
    if (history.preprocessing.changesNothing()) return done;
    watcher.tell("preprocess", 0);
    const auto start = std::chrono::steady_clock::now();
    try {
        done = preprocess(std::move(done.volume), history.preprocessing);
    } catch (const PreprocessError& error) {
        throw InvalidInput(optionOf(error.step(), history.preprocessing) + ": " + error.what());
    }
    const VolumeView& view = done.volume.view();
    history.preprocessed = {view.geometry(), view.pixelType(), valueRange(view)};
    addWarnings(history.preprocessingWarnings, done.warnings);
    history.seconds.emplace_back("preprocess", secondsSince(start));
    return done;
}

/// Calls `work`, which chooses pieces. \throws InvalidInput when nothing is left
template <class Work>
TriangleMesh choosingPieces(const SurfaceRequest& request, const Work& work) {
    try {
        return work();
    } catch (const NothingLeft& error) {
        throw InvalidInput("min_volume " + formatNumber(request.selection.minVolumeMm3) + ": " +
                           error.what());
    }
}

/// The surface before it is finished. Without an index every block is looked at, which for one
/// level is quicker than to build one, and keeps nothing.
TriangleMesh extracted(const VolumeView& volume, const ArrayIndex* built,
                       const SurfaceRequest& request, SurfaceHistory& history, Watcher& watcher) {
    const auto start = std::chrono::steady_clock::now();
    SurfaceRecord& record = history.record;
    record.isAutomatic = !request.level;
    record.isovalue = levelOf(request, volume, history.workingRange());
    ExtractionOptions options = history.extraction;
    options.isovalue = record.isovalue;
    options.progress = watcher.callback();
    const auto extractor = [&](const ExtractionOptions& each) {
        return built != nullptr ? extractSurface(volume, built->index, each)
                                : extractSurface(volume, each, history.index.border);
    };
    TriangleMesh mesh = choosingPieces(
        request, [&] { return extractPieces(extractor, options, history.selection, record); });
    history.seconds.emplace_back("extract", secondsSince(start));
    if (mesh.triangles.empty()) {
        throw InvalidInput("level " + formatNumber(record.isovalue) +
                           ": the surface is empty; no two neighbouring voxels lie on both sides");
    }
    return mesh;
}

TriangleMesh finished(TriangleMesh mesh, const SurfaceRequest& request, SurfaceHistory& history,
                      Watcher& watcher) {
    FinishOptions finish;
    finish.selection = history.selection;
    finish.method = history.extraction.method;
    finish.border = history.index.border;
    finish.countsCrossings = false;  // when the report is asked for
    finish.runStage = [&](std::string_view stage, const std::function<void()>& work) {
        watcher.tell(stage, 0);
        const auto begin = std::chrono::steady_clock::now();
        work();
        history.seconds.emplace_back(stage, secondsSince(begin));
    };
    return choosingPieces(
        request, [&] { return finishSurface(std::move(mesh), finish, history.record).mesh; });
}

/// \param smoothing  as noiseWarning() takes it
std::vector<Warning> warningsOf(const VolumeView& volume, const SurfaceHistory& history,
                                const std::string& smoothing) {
    std::vector<Warning> warnings;
    for (const auto& warning :
         {labelsWarning(findLabelValues(volume), history.record.isovalue, "adaptiso.labels()"),
          noiseWarning(history.record, history.extraction, volume.geometry(),
                       "max_error=", smoothing)}) {
        if (warning) warnings.push_back(*warning);
    }
    return warnings;
}

/// Makes a surface as adaptiso-mesh does, from the samples on.
/// \param built  an index, or null
std::shared_ptr<MeshData> makeSurface(ArrayVolume& volume, const ArrayIndex* built,
                                      const SurfaceRequest& request, const ImageOrigin& origin,
                                      py::object progress) {
    requireUsable(request);
    SurfaceHistory history = historyOf(request, built, origin);
    history.pixelType = volume.view.pixelType();
    history.range = volume.valueRange(request.threads);
    Watcher watcher(std::move(progress));
    TriangleMesh mesh;
    watcher.run(request.threads, [&] {
        const Preprocessed samples = prepared(volume.view, history, watcher);
        mesh = extracted(samples.volume, built, request, history, watcher);
        mesh = finished(std::move(mesh), request, history, watcher);
        const bool mayBeSmoothed = built == nullptr && !history.preprocessing.smoothSigmaMm;
        history.warnings = warningsOf(samples.volume, history, mayBeSmoothed ? "smooth=" : "");
        watcher.tell("check", 1);
    });
    history.peakMemoryMb = peakMemoryMb();
    return MeshData::fromLps(std::move(mesh), volume.geometry, std::move(history));
}

}  // namespace

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
        [](const ArrayVolume& volume, const py::dict& options, int threads) {
            IndexOptions index;
            take(indexOptions(), index, options);
            return buildIndex(volume, index, threads);
        },
        py::arg("volume"), py::arg("options"), py::arg("threads"));
    module.def(
        "make_surface",
        [](ArrayVolume& volume, const std::shared_ptr<ArrayIndex>& index,
           std::optional<double> level, const py::dict& options, int threads, py::object progress,
           const std::string& file, const std::string& format,
           const std::vector<Warning>& warnings) {
            SurfaceRequest request;
            request.level = level;
            request.threads = threads;
            IndexOptions border = index ? index->index.options() : IndexOptions{};
            take(indexOptions(), border, options);
            request.border = border.border;
            take(methodOptions(), request.extraction, options);
            takeAims(AimedSurface::OfScan, request.extraction.adaptive, options);
            take(pieceOptions(), request.selection, options);
            take(preprocessOptions(), request.preprocessing, options);
            return makeSurface(volume, index.get(), request, {file, format, warnings},
                               std::move(progress));
        },
        py::arg("volume"), py::arg("index"), py::arg("level"), py::arg("options"),
        py::arg("threads"), py::arg("progress"), py::arg("file"), py::arg("format"),
        py::arg("warnings"));
}

}  // namespace adaptiso::python
