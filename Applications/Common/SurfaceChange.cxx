#include "Common/SurfaceChange.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include "Common/CommonFrame.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso {
namespace {

FrameChange changeOf(const MeshFile& input, std::optional<CoordinateFrame> wanted,
                     const MeshFormat& output) {
    FrameChange change;
    change.isSaid = input.frame || wanted;
    const CoordinateFrame from = input.frame.value_or(CoordinateFrame::Ras);
    change.frame = wanted.value_or(from);
    if (!input.frame && (wanted || output.defaultFrame == CoordinateFrame::TkRas)) {
        const char* const what = wanted ? "--coordinates" : "FreeSurfer's format";
        throw InvalidInput("does not say its coordinate frame, which " + std::string(what) +
                           " needs" + kStateIt);
    }
    if (change.frame == from) return change;
    for (const CoordinateFrame frame : {from, change.frame}) {
        if (!needsVolume(frame) || input.volume) continue;
        throw InvalidInput("is in " + std::string(toString(from)) +
                           ", and does not say the volume by which it would be in " +
                           std::string(toString(change.frame)));
    }
    change.move = lpsToFrame(change.frame, input.volume) * inverse(lpsToFrame(from, input.volume));
    return change;
}

/// The input's arrays that the output's format holds; warnings name the others.
/// \param from, to  names of the files
std::vector<const PointArray*> heldArrays(const MeshFile& input, const MeshFormat& format,
                                          const std::string& from, const std::string& to,
                                          std::vector<Warning>& warnings) {
    std::vector<const PointArray*> held;
    std::string others;
    for (const PointArray& array : input.pointArrays) {
        const bool isFirstColor =
            std::holds_alternative<std::vector<Color>>(array.values) && held.empty();
        if (format.holdsPointArrays || (format.holdsColors && isFirstColor)) {
            held.push_back(&array);
        } else {
            addPart(others, array.name);
        }
    }
    if (!others.empty()) {
        warnings.push_back({"array-left-out",
                            std::string(format.name) + " holds no values at points" +
                                (format.holdsColors ? " but colours" : "") +
                                "; left out: " + others,
                            to});
    }
    if (!input.arraysLeftOut.empty()) {
        warnings.push_back({"array-left-out",
                            "values of triangles, text and arrays of more than nine "
                            "components are not carried over; left out: " +
                                joined(input.arraysLeftOut),
                            from});
    }
    return held;
}

/// Values at the points of the input as the result has them. Numbers and colours are mixed; whole
/// numbers, which may be labels, are those of the nearest corner.
PointArray transferred(const PointArray& array, const PointTransfer& transfer) {
    const auto columns = static_cast<std::size_t>(array.components);
    PointArray taken{array.name, {}, array.components};
    if (const auto* const colors = std::get_if<std::vector<Color>>(&array.values)) {
        const std::vector<std::uint8_t> shades = transfer.mixed(colors->front().data(), 3);
        std::vector<Color> mixed(transfer.size());
        for (std::size_t p = 0; p < mixed.size(); ++p) {
            std::copy_n(shades.data() + 3 * p, 3, mixed[p].data());
        }
        taken.values = std::move(mixed);
    } else if (const auto* const numbers = std::get_if<std::vector<double>>(&array.values)) {
        taken.values = transfer.mixed(numbers->data(), columns);
    } else {
        taken.values =
            transfer.nearest(std::get<std::vector<std::int64_t>>(array.values).data(), columns);
    }
    return taken;
}

bool isFreeSurfer(const std::filesystem::path& path) {
    try {
        return findMeshFormat(path).defaultFrame == CoordinateFrame::TkRas;
    } catch (const InvalidInput&) {
        return false;
    }
}

}  // namespace

void checkSurfaceFiles(const CLI::App& app, SurfaceChangeCommand& command,
                       const std::string& purpose,
                       std::vector<std::pair<const char*, std::filesystem::path>> named,
                       bool writes) {
    BatchOptions& batch = command.batch;
    if (command.inputs.empty() && batch.list.empty()) {
        throw UsageError("MESH is missing: the surface to " + purpose);
    }
    refuseOutputAsInput(command.inputs, command.output, batch);
    for (const auto& [option, file] :
         {std::pair("--output", command.output), std::pair("--report", command.report.page),
          std::pair("--pictures", command.report.pictures)}) {
        named.emplace_back(option, file);
    }
    checkPlaceholders(named, batch, command.common);
    command.isBatch = batch.isRequested() || command.inputs.size() > 1 ||
                      std::any_of(named.begin(), named.end(),
                                  [](const auto& of) { return holdsName(of.second); });
    if (!command.inputs.empty()) command.input = command.inputs.front();
    if (!command.isBatch) return;
    keepRunOptions(app, batch);
    takeFolder(command.output, batch);
    if (writes && command.output.empty() && batch.outputFolder.empty()) {
        throw UsageError("--output is missing: a folder, or a name with {name}");
    }
}

std::string surfaceName(const std::filesystem::path& input) {
    const std::string name = input.filename().string();
    if (const std::size_t two = twoPartExtension(name)) return name.substr(0, name.size() - two);
    return isFreeSurfer(input) ? name : input.stem().string();
}

std::filesystem::path surfaceFile(const std::filesystem::path& output,
                                  const std::filesystem::path& input, const std::string& suffix) {
    if (output.empty()) return insertBeforeExtension(input.filename(), suffix);
    return isFolder(output) ? output / input.filename() : output;
}

ShownFrame shownFrame(const MeshFile& input) {
    const CoordinateFrame frame = input.frame.value_or(CoordinateFrame::Ras);
    if (!needsVolume(frame) || input.volume) {
        return {inverse(lpsToFrame(frame, input.volume)),
                input.frame ? "scanner RAS mm" : kUnsaidFrame};
    }
    return {inverse(lpsToFrame(CoordinateFrame::Ras, std::nullopt)),
            frame == CoordinateFrame::TkRas ? "FreeSurfer's tkRAS mm" : "voxel indices"};
}

void summarize(const TriangleMesh& mesh, SurfaceSummary& summary) {
    summary.triangles = std::ssize(mesh.triangles);
    summary.vertices = std::ssize(mesh.points);
    summary.areaMm2 = surfaceArea(mesh);
}

const Figures<SurfaceSummary>& summaryFigures() {
    using Of = const SurfaceSummary&;
    static const Figures<SurfaceSummary> kRows{
        {"file", "name; empty: none is written", [](Of of) { return Json(baseName(of.file)); },
         "File", Shown::Plain},
        {"format", "`\"PLY\"`, ...", [](Of of) { return Json(of.format->name); }},
        {"coordinates",
         "the file's frame: `\"ras\"`, `\"lps\"`, `\"tkras\"`, `\"voxel\"`; `null`: it does not "
         "say",
         [](Of of) { return frameJson(of.frame); }},
        {"triangles", "number of triangles", [](Of of) { return Json(of.triangles); }, "Triangles",
         Shown::Count},
        {"vertices", "number of vertices", [](Of of) { return Json(of.vertices); }, "Vertices",
         Shown::Count},
        {"components", "number of pieces",
         [](Of of) { return Json(std::ssize(of.topology.components)); }, "Pieces", Shown::Count},
        {"genus", "handles of all pieces; `null` unless closed, 2-manifold and oriented",
         [](Of of) { return orNull(of.topology.genus()); }, "Genus", Shown::Count},
        {"closed", "no open border", [](Of of) { return Json(of.topology.isClosed()); }},
        {"areaMm2", "area", [](Of of) { return number(of.areaMm2); }, "Area, mm²", Shown::Measure}};
    return kRows;
}

double FrameChange::roundingMm(const TriangleMesh& mesh) const {
    double largest = 0;
    if (!move) return largest;
    const AffineTransform back = inverse(*move);
    for (const Vec3& p : mesh.points) largest = std::max(largest, norm(back((*move)(p)) - p));
    return largest;
}

FrameChange changeFrame(const MeshFile& input, const std::filesystem::path& file,
                        std::optional<CoordinateFrame> wanted,
                        const std::filesystem::path& output) {
    const MeshFormat& format = meshFormatOf(output);
    const FrameChange change =
        naming(baseName(file), [&] { return changeOf(input, wanted, format); });
    if (change.frame == CoordinateFrame::Voxel && !format.holdsVoxelFrame) {
        throw UsageError(output.string() + ": " + std::string(format.name) +
                         " holds points in mm only, not voxel indices");
    }
    return change;
}

MeshFile SurfaceChangeRun::readInput(const std::vector<CoordinateFrame>& stated,
                                     const std::string& purpose,
                                     const std::function<void(TriangleMesh&)>& prepare) {
    MeshFile file = stage("read", [&] {
        return readMesh(input.file, {.keepsFaults = static_cast<bool>(prepare),
                                     .keepsPointArrays = true,
                                     .inputCoordinates = statedFrame(stated, 0)});
    });
    if (prepare) prepare(file.mesh);
    addWarnings(warnings, file.warnings, baseName(input.file));
    input.format = file.format;
    input.frame = file.frame;
    summarize(file.mesh, input);
    if (input.areaMm2 > 0) return file;
    throw InvalidInput(input.file.string() +
                       ": its triangles have no area, so there is nothing to " + purpose);
}

void SurfaceChangeRun::warnOfSize(std::optional<double> maxErrorMm, const TriangleMesh& mesh) {
    if (!maxErrorMm) return;
    const auto warning = boundOverSize("--max-error", *maxErrorMm, norm(boundingBox(mesh).size()),
                                       baseName(input.file));
    if (warning) warnings.push_back(*warning);
}

void SurfaceChangeRun::scaleOutput(const PrintScale& asked, const TriangleMesh& result,
                                   FrameChange& change) {
    output.scale =
        chooseScale(asked, result, change.move.value_or(AffineTransform{}), baseName(output.file));
    change.scale(output.scale);
    if (change.isSaid) output.frame = change.frame;
}

std::vector<PointArray> SurfaceChangeRun::takeValues(const MeshFile& file,
                                                     const TriangleMesh& result,
                                                     std::optional<PointTransfer>& transfer) {
    std::vector<PointArray> taken;
    for (const PointArray* const array :
         heldArrays(file, *output.format, baseName(input.file), baseName(output.file), warnings)) {
        if (!transfer) transfer.emplace(file.mesh, result);
        taken.push_back(transferred(*array, *transfer));
        keptArrays.push_back(array->name);
    }
    return taken;
}

MeshFile SurfaceChangeRun::writeSurface(TriangleMesh result, std::vector<PointArray> values,
                                        const MeshFile& file, const FrameChange& change,
                                        const std::filesystem::path& ownFolder) {
    roundingMm =
        settleRounding(result, output.format->precision, change.move.value_or(AffineTransform{}))
            .roundingMm;
    MeshWriteOptions write;
    write.frame = change.frame;
    write.volume = file.volume;
    write.pointArrays = std::move(values);
    write.isInFrame = true;
    write.saysFrame = change.isSaid;
    AtomicOutput& written = addOutput(output.file, ownFolder);
    written.write([&](const auto& path) { writeMesh(change.apply(result), path, write); });
    bytes = std::filesystem::file_size(written.temporary());
    return readMesh(written.temporary());
}

void SurfaceChangeRun::requireDigits(double maxErrorMm) const {
    const auto fault = roundingFault(roundingMm, maxErrorMm, *output.format);
    if (fault) throw InvalidInput(baseName(output.file) + ": " + *fault);
}

void SurfaceChangeRun::warnOfRounding(double reachedMm, double maxErrorMm) {
    const auto warning = roundingWarning(baseName(output.file), reachedMm,
                                         maxErrorMm * output.scale, roundingMm, *output.format);
    if (warning) warnings.push_back(*warning);
}

void SurfaceChangeRun::show(TriangleMesh before, const TriangleMesh& result,
                            const ShownFrame& frame, Report& report) const {
    report.frame = frame.name;
    const auto& rows = summaryFigures();
    ReportTable table{
        "Surfaces", figureColumns({"Surface"}, rows), {figureCells({"read"}, rows, input)}};
    if (result.triangles.empty()) {
        report.surfaces.push_back({baseName(input.file), std::move(before)});
    } else {
        TriangleMesh after = transformed(result, frame.toLps);
        std::vector<double> distances = vertexDistancesMm(after, before);
        for (double& mm : distances) mm *= output.scale;
        report.valuesAre = "from the input";
        report.surfaces.push_back({output.file.empty() ? "result" : baseName(output.file),
                                   std::move(after), std::move(distances)});
        table.rows.push_back(figureCells({bytes > 0 ? "written" : "result"}, rows, output));
    }
    report.tables.push_back(std::move(table));
}

int SurfaceChangeRun::finish(bool isWritten, const std::function<std::string()>& makeJson,
                             const std::function<void(std::ostream&)>& printText) {
    if (isWritten) next = "adaptiso-check " + shellQuoted(output.file.string());
    deliver(makeJson, printText);
    return end(isWritten ? output.file.string() + " is written" : "no surface is written");
}

Json verificationJson(const std::optional<Verification>& verification) {
    if (!verification) return nullptr;
    return {{"samples", verification->samples}, {"maxMm", number(verification->maxMm)}};
}

TriangleMesh withArea(TriangleMesh mesh) {
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return isDegenerate(mesh, t); });
    return mesh;
}

}  // namespace adaptiso
