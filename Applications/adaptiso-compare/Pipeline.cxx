#include "Pipeline.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/PortableMath.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/Report/Report.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"

namespace adaptiso::compare {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "adaptiso-compare";

/// Checks the outputs before a file is read.
void checkOutputs(const CompareOptions& options) {
    const std::array inputs{options.a, options.b, options.volume};
    OutputPlan plan(inputs);
    if (!options.colored.empty()) {
        if (meshFormatOf(options.colored).extensions.front() != ".vtp") {
            throw UsageError("--colored " + options.colored.string() + ": must be a .vtp file");
        }
        plan.add("--colored", options.colored);
    }
    plan.check(options.common, options.report);
}

NamedMesh readSurface(CompareRun& run, const fs::path& path,
                      std::optional<CoordinateFrame> stated) {
    NamedMesh surface{path, readMesh(path, {.inputCoordinates = stated})};
    addWarnings(run.warnings, surface.file.warnings, baseName(path));
    freeMemory(surface.file.mesh.normals);  // those of the triangles are compared
    return surface;
}

/// \param frame  as the file has it
SurfaceSummary summarize(const NamedMesh& surface, std::optional<CoordinateFrame> frame) {
    return {measureSize(surface.file.mesh, surface.path.string()), surface.path,
            surface.file.format, frame};
}

/// The side of a cube as large as a voxel.
double meanVoxelSideMm(const ImageGeometry& geometry) {
    return portable::cubeRoot(geometry.voxelVolumeMm3());
}

void readImage(CompareRun& run) {
    run.voxelMm = run.options.voxelMm;
    if (run.options.volume.empty()) return;
    ReadVolume read = readImage(run.options.volume, run.options.read);
    run.volume = VolumeSummary{read.format, read.volume.view().geometry()};
    run.voxelMm = meanVoxelSideMm(run.volume->geometry);
    if (run.options.report.isWanted()) run.image = read.volume;
    addWarnings(run.warnings, read.warnings, baseName(run.options.volume));
}

/// Reads all inputs; afterwards both meshes are in the frame that the program works in.
CommonFrame readInputs(CompareRun& run, std::array<NamedMesh, 2>& surfaces) {
    readImage(run);
    auto& [a, b] = surfaces;
    a = readSurface(run, run.options.a, statedFrame(run.options.inputCoordinates, 0));
    b = readSurface(run, run.options.b, statedFrame(run.options.inputCoordinates, 1));
    const auto frameA = a.file.frame, frameB = b.file.frame;
    std::optional<ImageGeometry> image;
    if (run.volume) image = run.volume->geometry;
    CommonFrame common = bringToOneFrame(surfaces, image);
    run.a = summarize(a, frameA);
    run.b = summarize(b, frameB);
    run.frame = common.known();
    run.toFrame = lpsToFrame(common.frame, common.volume);
    addWarnings(run.warnings, common.warnings);
    return common;
}

/// Dice, and the volume between the surfaces spread over their mean area.
void measureOverlap(CompareRun& run, const TriangleMesh& a, const TriangleMesh& b) {
    if (!run.volume) return;
    if (!run.a.volumeMm3 || !run.b.volumeMm3) {
        const bool isAOpen = !run.a.volumeMm3, isBOpen = !run.b.volumeMm3;
        run.warnings.push_back(
            {"overlap-unmeasured",
             (isAOpen ? baseName(run.options.a) : "") + (isAOpen && isBOpen ? " and " : "") +
                 (isBOpen ? baseName(run.options.b) : "") + (isAOpen && isBOpen ? " are" : " is") +
                 " not closed, so the overlap (Dice) is not measured"});
        return;
    }
    const ImageGeometry& image = run.volume->geometry;
    OverlapSummary overlap;
    overlap.voxels = voxelOverlap(a, b, image);
    const std::int64_t inOne = overlap.voxels.voxelsEither() - overlap.voxels.voxelsBoth;
    overlap.meanBoundaryOffsetMm =
        static_cast<double>(inOne) * image.voxelVolumeMm3() / ((run.a.areaMm2 + run.b.areaMm2) / 2);
    if (overlap.voxels.voxelsEither() == 0) {
        run.warnings.push_back({"overlap-unmeasured",
                                "no voxel's centre lies inside either surface",
                                baseName(run.options.volume)});
    }
    run.overlap = overlap;
}

std::vector<Color> colorsOf(const std::vector<double>& values, double maximum) {
    std::vector<Color> colors;
    colors.reserve(values.size());
    for (const double value : values) colors.push_back(viridis(maximum > 0 ? value / maximum : 0));
    return colors;
}

/// Writes A under its temporary name, with the distances of its vertices to B.
void writeColored(CompareRun& run, const TriangleMesh& a, const TriangleMesh& b,
                  const CommonFrame& common) {
    std::vector<double> distances = vertexDistancesMm(a, b);
    ColoredSummary colored;
    colored.maximumMm = *std::max_element(distances.begin(), distances.end());
    std::vector<Color> colors = colorsOf(distances, colored.maximumMm);

    MeshWriteOptions write;
    write.frame = common.frame;
    write.saysFrame = common.isKnown;
    write.volume = common.volume;
    write.pointArrays.push_back({"DistanceMm", std::move(distances)});
    write.pointArrays.push_back({"DistanceColor", std::move(colors)});
    AtomicOutput& output = run.addOutput(run.options.colored);
    output.write([&](const fs::path& path) { writeMesh(a, path, write); });
    colored.bytes = fs::file_size(output.temporary());
    run.colored = colored;
}

/// Makes the report that page and pictures show.
Report describe(const CompareRun& run, TriangleMesh a, TriangleMesh b) {
    ShownSurfaces shown;
    shown.aToBMm = vertexDistancesMm(a, b);
    if (run.options.isSymmetric) shown.bToAMm = vertexDistancesMm(b, a);
    shown.a = std::move(a);
    shown.b = std::move(b);
    return makeReport(run, shown);
}

/// Encloses the largest distance.
void encloseHausdorff(CompareRun& run, const TriangleMesh& a, const TriangleMesh& b) {
    HausdorffOptions options;
    options.limitMm = run.options.maxHausdorffMm;
    options.isSymmetric = run.options.isSymmetric;
    options.progress = run.progress.callback();
    options.farOnA = run.distances.aToB.maxPointMm;
    if (run.options.isSymmetric) options.farOnB = run.distances.bToA.maxPointMm;
    run.hausdorff = hausdorffDistance(a, b, options);
}

std::vector<Check> makeChecks(const CompareRun& run) {
    const double meanMm = run.distances.combined.meanMm;
    const HausdorffInterval& hausdorff = run.hausdorff.combined;
    std::vector<Check> checks;
    if (const auto& limit = run.options.maxMeanMm) {
        checks.push_back({"mean distance", "maxMean", *limit, meanMm, meanMm});
    }
    if (const auto& limit = run.options.maxHausdorffMm) {
        checks.push_back(
            {"maximum distance", "maxHausdorff", *limit, hausdorff.lowerMm, hausdorff.upperMm});
    }
    return checks;
}

/// Limits that fit no surface of this size. \param diagonalMm  of the smaller surface
void warnOfSize(double diagonalMm, CompareRun& run) {
    for (const auto& [name, limit] : {std::pair{"--max-mean", run.options.maxMeanMm},
                                      std::pair{"--max-hausdorff", run.options.maxHausdorffMm}}) {
        if (!limit) continue;
        const auto warning = boundOverSize(name, *limit, diagonalMm, {});
        if (warning) run.warnings.push_back(*warning);
    }
}

/// The value of a failed check in the fewest digits that differ from the limit.
std::string digitsApart(const Check& check) {
    const std::string text = formatShort(check.valueMm);
    return parseFiniteNumber(text) <= check.limitMm ? formatNumber(check.valueMm) : text;
}

/// Prints on stderr which checks failed.
void printFailed(const CompareRun& run) {
    for (const Check& check : run.checks) {
        if (check.hasPassed()) continue;
        printError(kProgram, "check failed: " + check.name +
                                 (check.hasFailed() ? " " : " may be ") + digitsApart(check) +
                                 " mm, at most " + formatNumber(check.limitMm) + " mm");
    }
}

}  // namespace

int runCompare(const CompareOptions& options) {
    CompareRun run(options);
    checkOutputs(options);

    std::array<NamedMesh, 2> surfaces;
    const CommonFrame common = run.stage("read", [&] { return readInputs(run, surfaces); });
    TriangleMesh &a = surfaces[0].file.mesh, &b = surfaces[1].file.mesh;
    run.distances = run.stage("distance", [&] {
        return surfaceDistance(a, b,
                               {options.samples, options.isSymmetric, run.progress.callback()});
    });
    run.stage("hausdorff", [&] { encloseHausdorff(run, a, b); });
    addWarnings(run.warnings,
                roughDistanceWarnings(run.distances.combined, run.hausdorff.combined));
    run.checks = makeChecks(run);
    warnOfSize(std::min(norm(boundingBox(a).size()), norm(boundingBox(b).size())), run);
    run.stage("overlap", [&] { measureOverlap(run, a, b); });
    run.stage("write", [&] {
        if (!options.colored.empty()) writeColored(run, a, b, common);
    });
    if (options.report.isWanted()) {
        run.writePage([&] { return describe(run, std::move(a), std::move(b)); });
    }
    const bool havePassed = std::ranges::all_of(run.checks, std::mem_fn(&Check::hasPassed));
    run.verdict.exitCode = havePassed ? kExitOk : kExitCheckFailed;
    if (!options.colored.empty()) {
        run.next = "open " + shellQuoted(options.colored.string()) + " in ParaView";
    }
    run.deliver([&] { return jsonReport(run); }, [&](std::ostream& out) { printReport(out, run); });
    printFailed(run);
    return run.end(options.colored.empty() ? "the distances are measured"
                                           : options.colored.string() + " is written");
}

}  // namespace adaptiso::compare
