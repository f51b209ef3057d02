#include <emscripten.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "Common/ImageOptions.h"
#include "Common/Naming.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Programs.h"
#include "adaptiso-labels/Regions.h"
#include "adaptiso-mesh/Info.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/LabelPipeline/Masks.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

EM_JS(int, processNumber, (), { return typeof process == "object" ? process.pid : 1; })
EM_JS(int, hasProgress, (), { return Module["onProgress"] ? 1 : 0; })
EM_JS(void, showProgress, (const char* text), { Module["onProgress"](UTF8ToString(text)); })

/// The page's WebAssembly. main() is that of the programs, chosen by the name they are called by,
/// so that the page refuses, prints and writes what they do, to the byte. The functions below it
/// look at an image and at meshes: what a page shows and the programs need not.
///
/// An instance runs one program, as a process does, or looks; the page makes another for the next.
namespace adaptiso::web {
using namespace mesher;  // Info.h
namespace {

/// The JSON that the function called last answers with.
std::string answer;

/// {line, volumes, hasSeries}: the line that the program prints, the volumes to choose from, and
/// whether there are series to choose from.
int refusing(const char* program, const ChoiceNeeded* choice) {
    const Verdict verdict = verdictOf(std::current_exception());
    const bool areVolumes = choice && choice->among() == ChoiceNeeded::Among::Volumes;
    answer = jsonText({{"line", std::string(program) + ": " + oneLine(verdict.error)},
                       {"volumes", areVolumes ? Json(choice->count()) : Json(nullptr)},
                       {"hasSeries", choice && !areVolumes}},
                      -1);
    return verdict.exitCode;
}

/// Runs `work`, which sets `answer`. \return an exit code; other than 0, `answer` is refusing()'s
int answering(const char* program, const std::function<void()>& work) {
    try {
        work();
        return kExitOk;
    } catch (const ChoiceNeeded& choice) {
        return refusing(program, &choice);
    } catch (...) {
        return refusing(program, nullptr);
    }
}

/// A mesh as the page draws it: scanner RAS mm.
struct ShownMesh {
    std::vector<float> points, values;  ///< three numbers a point; one value, where there are any
    std::vector<std::uint32_t> triangles;

    void set(const TriangleMesh& lps) {
        points.clear();
        triangles.clear();
        values.clear();
        points.reserve(3 * lps.points.size());
        for (const Vec3& p : lps.points) {
            for (const double x : {-p.x, -p.y, p.z}) points.push_back(static_cast<float>(x));
        }
        triangles.reserve(3 * lps.triangles.size());
        for (const Triangle& t : lps.triangles) {
            for (const VertexId v : t) triangles.push_back(static_cast<std::uint32_t>(v));
        }
    }
};

struct OpenImage {
    ReadVolume read;
    std::optional<Volume> coarse;  ///< every n-th sample of it, for previews
    std::optional<SpanSpaceIndex> index;
    std::vector<std::uint8_t> shades;  ///< of a label map: two bytes a sample, the lower first
};

std::optional<OpenImage> image;
ShownMesh shown;

/// Every `step`-th sample along each axis.
Volume thinned(const VolumeView& volume, std::int64_t step) {
    ImageGeometry geometry = volume.geometry();
    for (int axis = 0; axis < 3; ++axis) {
        geometry.size[axis] = (geometry.size[axis] - 1) / step + 1;
        geometry.indexToPhysical.column[axis] =
            static_cast<double>(step) * geometry.indexToPhysical.column[axis];
    }
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        std::vector<T> samples;
        samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
        for (std::int64_t k = 0; k < view.geometry.size[2]; k += step) {
            for (std::int64_t j = 0; j < view.geometry.size[1]; j += step) {
                for (std::int64_t i = 0; i < view.geometry.size[0]; i += step) {
                    samples.push_back(view.at(i, j, k));
                }
            }
        }
        return Volume::fromSamples(std::move(samples), geometry);
    });
}

/// `volume` itself, or thinned to at most `most` samples.
Volume withAtMost(const Volume& volume, std::int64_t most, std::int64_t& step) {
    const auto countAt = [&](std::int64_t n) {
        std::int64_t count = 1;
        for (const std::int64_t size : volume.view().geometry().size) count *= (size - 1) / n + 1;
        return count;
    };
    for (step = 1; countAt(step) > most;) ++step;
    return step == 1 ? volume : thinned(volume, step);
}

/// Samples as bytes, from black to white.
std::vector<std::uint8_t> shadesOf(const VolumeView& volume, double black, double white) {
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        std::vector<std::uint8_t> shades(static_cast<std::size_t>(view.geometry.voxelCount()));
        const double scale = white > black ? 255 / (white - black) : 0;
        std::transform(view.samples, view.samples + shades.size(), shades.begin(), [&](T sample) {
            const double shade = (static_cast<double>(sample) - black) * scale;
            return static_cast<std::uint8_t>(shade > 0 ? std::min(shade + 0.5, 255.0) : 0.0);
        });
        return shades;
    });
}

/// For each sample the place of its label among `labels`, from 1; 0 for none of them.
std::vector<std::uint8_t> labelPlaces(const VolumeView& volume,
                                      const std::vector<std::int32_t>& labels) {
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        std::vector<std::uint8_t> places;
        places.reserve(2 * static_cast<std::size_t>(view.geometry.voxelCount()));
        double last = 0;
        std::size_t place = 0;
        for (std::int64_t n = 0; n < view.geometry.voxelCount(); ++n) {
            if (const auto value = static_cast<double>(view.samples[n]); value != last) {
                last = value;
                const auto at = std::ranges::lower_bound(labels, value, {}, [](std::int32_t label) {
                    return static_cast<double>(label);
                });
                const bool isThere = at != labels.end() && *at == value;
                place = isThere ? static_cast<std::size_t>(at - labels.begin()) + 1 : 0;
            }
            places.push_back(static_cast<std::uint8_t>(place & 0xff));
            places.push_back(static_cast<std::uint8_t>(place >> 8));
        }
        return places;
    });
}

/// The labels of a map but for 0, ascending; empty where it is none, or has too many to colour.
std::vector<std::int32_t> labelsOf(const VolumeView& volume) {
    constexpr std::size_t kMost = 4095;  // colours in a row of a texture
    std::vector<std::int32_t> found;
    try {
        const labels::LabelCensus census = labels::countLabels(volume, {});
        if (census.voxels.size() > kMost) return {};
        for (const auto& [label, voxels] : census.voxels) found.push_back(label);
    } catch (const InvalidInput&) {
        return {};
    }
    return found;
}

Json histogramJson(const ValueSummary& values) {
    if (!values.histogram) return nullptr;
    return {{"lower", number(values.histogram->lower)},
            {"upper", number(values.histogram->upper)},
            {"counts", values.histogram->counts}};
}

/// The affine of a NIfTI's sform: three rows, RAS.
Json affineJson(const ImageGeometry& geometry) {
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row) {
        const double sign = row == 2 ? 1 : -1;
        for (int axis = 0; axis < 3; ++axis) {
            rows.push_back(sign * geometry.indexToPhysical.column[axis][row]);
        }
        rows.push_back(sign * geometry.originMm[row]);
    }
    return rows;
}

/// A label map as adaptiso-labels takes it: masks in a folder are joined to one.
ReadVolume readMap(const std::string& path, const ReadOptions& read) {
    const std::vector<MaskSource> masks = masksOfFolder(path, read);
    if (masks.empty()) return readImage(path, read);
    const auto readMask = [](const MaskSource& mask) { return readImage(mask.file, mask.read); };
    MaskMap map = joinMasks(masks, {}, readMask, baseName(path));
    return {std::move(map.volume), map.format + ", " + counted(std::ssize(masks), "mask"),
            std::move(map.warnings)};
}

void openImage(const std::string& path, const ReadOptions& options, bool isLabels) {
    constexpr std::int64_t kMostShown = 16'000'000, kMostPreviewed = 2'000'000;
    image.reset();
    image.emplace(
        OpenImage{isLabels ? readMap(path, options) : readImage(path, options), {}, {}, {}});
    const VolumeView& view = image->read.volume.view();
    const ValueSummary values = summarizeValues(view);
    const auto at = [&](std::size_t n) {
        return values.percentiles.empty() ? 0 : values.percentiles[n];
    };
    constexpr std::size_t kLow = 1, kHigh = std::size(kPercents) - 2;
    std::int64_t shownStep = 1, previewStep = 1;
    const Volume seen = withAtMost(image->read.volume, kMostShown, shownStep);
    const bool isFlat = !(at(kLow) < at(kHigh)) || isLabels;
    const std::vector<std::int32_t> labels =
        isLabels ? labelsOf(view) : std::vector<std::int32_t>();
    image->shades = labels.empty() ? shadesOf(seen.view(), isFlat ? at(0) : at(kLow),
                                              isFlat ? at(std::size(kPercents) - 1) : at(kHigh))
                                   : labelPlaces(seen.view(), labels);
    Json labelColorsJson = Json::array();
    const std::vector<std::optional<LabelColor>> none(labels.size());
    for (const LabelColor& color : labelColors(labels, none)) labelColorsJson.push_back(color);
    image->coarse = withAtMost(image->read.volume, kMostPreviewed, previewStep);
    image->index.emplace(SpanSpaceIndex::build(image->coarse->view(), {}));
    Json warnings = Json::array();
    for (const Warning& warning : image->read.warnings) warnings.push_back(warning.text);
    const ImageGeometry& geometry = view.geometry();
    answer = jsonText({{"format", image->read.format},
                       {"geometry", geometryJson(geometry)},
                       {"defaultErrorMm", orNull(requestedBoundMm({}, geometry))},
                       {"orientation", summarizeAxes(geometry).orientation},
                       {"type", toString(view.pixelType())},
                       {"bytes", static_cast<double>(geometry.voxelCount()) *
                                     static_cast<double>(bytesPerPixel(view.pixelType()))},
                       {"minimum", number(at(0))},
                       {"maximum", number(at(std::size(kPercents) - 1))},
                       {"isInteger", isInteger(view.pixelType())},
                       {"otsu", values.otsu.empty() ? Json(nullptr) : Json(values.otsu[0][0])},
                       {"histogram", histogramJson(values)},
                       {"warnings", warnings},
                       {"shownSize", seen.view().geometry().size},
                       {"shownAffine", affineJson(seen.view().geometry())},
                       {"previewStep", previewStep},
                       {"labels", labels},
                       {"labelColors", labelColorsJson}},
                      -1);
}

/// What people choose a series by. The description may identify a patient: it stays in the page.
void listAllSeries(const std::string& path) {
    Json list = Json::array();
    for (const DicomSeries& series : listSeries(path).series) {
        list.push_back({{"number", series.number},
                        {"modality", series.modality},
                        {"description", series.description},
                        {"size", {series.columns, series.rows, series.slices}},
                        {"volumes", series.volumes},
                        {"spacingMm", {series.spacingMm.x, series.spacingMm.y, series.spacingMm.z}},
                        {"orientation", series.orientation},
                        {"localizer", series.isLocalizer},
                        {"details", series.details},
                        {"fault", series.fault}});
    }
    answer = jsonText(list, -1);
}

void preview(double isovalue) {
    if (!image) throw InvalidInput("no image is open");
    const VolumeView& view = image->coarse->view();
    if (const auto fault = isovalueFault(isovalue, valueRange(view))) throw InvalidInput(*fault);
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = Method::MarchingCubes;
    options.computeNormals = false;
    shown.set(extractSurface(view, *image->index, options).mesh);
    answer = jsonText({{"triangles", shown.triangles.size() / 3}}, -1);
}

/// Pairs of neighbouring voxels between which a surface passes: at `isovalue`, or between any two
/// labels where it is NaN. Beyond the border is background. Memory grows with it.
double crossedEdges(const VolumeView& volume, double isovalue) {
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        const auto& size = view.geometry.size;
        const auto sideOf = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
            if (i < 0 || j < 0 || k < 0 || i == size[0] || j == size[1] || k == size[2]) return 0.0;
            const auto value = static_cast<double>(view.at(i, j, k));
            return std::isnan(isovalue) ? value : static_cast<double>(value >= isovalue);
        };
        double count = 0;
        for (std::int64_t k = 0; k <= size[2]; ++k) {
            for (std::int64_t j = 0; j <= size[1]; ++j) {
                for (std::int64_t i = 0; i <= size[0]; ++i) {
                    const double here = sideOf(i, j, k);
                    count += (here != sideOf(i - 1, j, k)) + (here != sideOf(i, j - 1, k)) +
                             (here != sideOf(i, j, k - 1));
                }
            }
        }
        return count;
    });
}

/// Reads a mesh. Frames that belong to an image are taken for those of the file's own, else of the
/// image that is open; where there is neither, points stay as they are.
void openMesh(const std::string& path) {
    MeshReadOptions options;
    options.keepsFaults = true;
    options.keepsPointArrays = true;
    const MeshFile file = readMesh(path, options);
    const CoordinateFrame frame = file.frame.value_or(CoordinateFrame::Ras);
    std::optional<ImageGeometry> volume = file.volume;
    if (needsVolume(frame) && !volume && image) {
        volume = frameVolume(frame, image->read.volume.view().geometry());
    }
    const bool isKnown = !needsVolume(frame) || volume;
    shown.set(fromFrame(file.mesh, isKnown ? frame : CoordinateFrame::Ras, volume));
    std::string valuesName;
    for (const PointArray& array : file.pointArrays) {
        const auto* const values = std::get_if<std::vector<double>>(&array.values);
        if (values == nullptr || array.components != 1) continue;
        shown.values.assign(values->begin(), values->end());
        valuesName = array.name;
        break;
    }
    answer = jsonText({{"triangles", shown.triangles.size() / 3},
                       {"points", shown.points.size() / 3},
                       {"format", file.format->name},
                       {"frame", file.frame ? Json(frameWord(*file.frame)) : Json(nullptr)},
                       {"values", valuesName.empty() ? Json(nullptr) : Json(valuesName)}},
                      -1);
}

}  // namespace
}  // namespace adaptiso::web

namespace web = adaptiso::web;

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* adaptisoAnswer() {
    return web::answer.c_str();
}

/// \param read  a JSON object of options of readOptions() by name
EMSCRIPTEN_KEEPALIVE int adaptisoOpenImage(const char* path, const char* read, int isLabels) {
    return web::answering(isLabels != 0 ? "adaptiso-labels" : "adaptiso-mesh", [&] {
        const adaptiso::Json given = adaptiso::Json::parse(read);
        adaptiso::ReadOptions options;
        for (const auto& row : adaptiso::readOptions()) {
            const auto value = given.find(std::string(row.facts.name));
            if (value != given.end()) {
                row.put(options, adaptiso::optionValue(*value, row.kind));
            }
        }
        web::openImage(path, options, isLabels != 0);
    });
}

EMSCRIPTEN_KEEPALIVE int adaptisoListSeries(const char* path) {
    return web::answering("adaptiso-mesh", [&] { web::listAllSeries(path); });
}

EMSCRIPTEN_KEEPALIVE int adaptisoPreview(double isovalue) {
    return web::answering("adaptiso-mesh", [&] { web::preview(isovalue); });
}

/// Formats and tissue presets of the library's tables. build.mjs writes them into the page's forms.
EMSCRIPTEN_KEEPALIVE int adaptisoChoices() {
    return web::answering("adaptiso", [] {
        adaptiso::Json formats = adaptiso::Json::array();
        for (const adaptiso::MeshFormat& format : adaptiso::meshFormats()) {
            formats.push_back({{"name", format.name}, {"extension", format.extensions.front()}});
        }
        web::answer = adaptiso::jsonText(
            {{"formats", formats}, {"presets", adaptiso::tissuePresetNames()}}, -1);
    });
}

/// \return 0 without an image
EMSCRIPTEN_KEEPALIVE double adaptisoCrossedEdges(double isovalue) {
    return web::image ? web::crossedEdges(web::image->read.volume.view(), isovalue) : 0;
}

EMSCRIPTEN_KEEPALIVE int adaptisoOpenMesh(const char* path, const char* program) {
    return web::answering(program, [&] { web::openMesh(path); });
}

EMSCRIPTEN_KEEPALIVE const std::uint8_t* adaptisoShades() {
    return web::image ? web::image->shades.data() : nullptr;
}
EMSCRIPTEN_KEEPALIVE int adaptisoShadeCount() {
    return web::image ? static_cast<int>(web::image->shades.size()) : 0;
}
EMSCRIPTEN_KEEPALIVE const float* adaptisoPoints() {
    return web::shown.points.data();
}
EMSCRIPTEN_KEEPALIVE const std::uint32_t* adaptisoTriangles() {
    return web::shown.triangles.data();
}
EMSCRIPTEN_KEEPALIVE const float* adaptisoValues() {
    return web::shown.values.data();
}

/// Temporaries are named by it: Emscripten's is 42 for all.
pid_t getpid() {
    return processNumber();
}

/// `adaptiso mesh` becomes adaptiso-mesh. \return only where that is not in here
int execv(const char* path, char* const* argv) {
    const auto program = kPrograms.find(std::filesystem::path(path).filename().string());
    if (program != kPrograms.end()) {
        int argc = 0;
        while (argv[argc] != nullptr) ++argc;
        std::exit(program->second(argc, const_cast<char**>(argv)));
    }
    errno = ENOSYS;
    return -1;
}

}  // extern "C"

int main(int argc, char** argv) {
    if (hasProgress() != 0) {
        adaptiso::observeProgress([](const std::string& text) { showProgress(text.c_str()); });
    }
    const auto program = kPrograms.find(argv[0]);
    if (program != kPrograms.end()) return program->second(argc, argv);
    std::cerr << argv[0] << ": is not among the programs in WebAssembly\n";
    return adaptiso::kExitUsage;
}
