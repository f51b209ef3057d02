#include "Pipeline.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "Common/Batch.h"
#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Tiles.h"

namespace adaptiso::simplifier {
namespace {

namespace fs = std::filesystem;

/// Values in files of their own belong to points by number.
void requirePointOrder(const MeshFormat& format, const fs::path& data) {
    if (format.sharesVertices) return;
    throw UsageError("--data " + data.string() + ": " + std::string(format.name) +
                     " keeps no order of points, which its values would go by");
}

/// Empty where --output names the file, its folder where --output names that.
fs::path ownFolder(const SimplifyRun& run) {
    return run.output.file == run.command.output ? fs::path() : detail::folderOf(run.output.file);
}

/// Names the outputs and checks them before a file is read.
void checkOutputs(SimplifyRun& run) {
    const SimplifyCommand& command = run.command;
    run.input.file = command.input;
    run.output.file = surfaceFile(command.output, command.input, "-simplified");
    run.output.format = &meshFormatOf(run.output.file);
    checkScale(command.scale, *run.output.format, command.frame);
    std::vector<fs::path> inputs = command.data;
    inputs.push_back(command.input);
    OutputPlan plan(inputs);
    plan.add("--output", run.output.file, ownFolder(run));
    for (const fs::path& data : command.data) {
        requirePointOrder(*run.output.format, data);
        run.data.push_back({data, dataFile(data, run.output.file), findPointDataFormat(data)});
        const fs::path& output = run.data.back().output;
        plan.add("--data", output, detail::folderOf(output));
    }
    plan.check(command.common, command.report);
}

std::vector<PointData> readData(SimplifyRun& run) {
    std::vector<PointData> all;
    for (const DataSummary& summary : run.data) {
        PointData data = readPointData(summary.file);
        addWarnings(run.warnings, data.warnings, baseName(summary.file));
        if (data.points != run.input.vertices) {
            throw InvalidInput(baseName(summary.file) + ": has values for " +
                               formatCount(data.points) + " points; " + baseName(run.input.file) +
                               " has " + formatCount(run.input.vertices));
        }
        all.push_back(std::move(data));
    }
    return all;
}

/// Puts what crosses before what is dropped, as it is kept.
void addCrossing(const TriangleMesh& mesh, const CrossingTriangles& triangles,
                 std::vector<Finding>& findings) {
    std::optional<Finding> crossing = crossingFinding(mesh, triangles);
    if (!crossing) return;
    const auto at = std::find_if(findings.begin(), findings.end(),
                                 [](const Finding& finding) { return finding.isDropped; });
    findings.insert(at, std::move(*crossing));
}

/// Finds the input's faults. Crossings are looked for only where they may end the run; otherwise
/// simplify() reports them.
void check(const TriangleMesh& mesh, std::int64_t joined, SimplifyRun& run) {
    run.input.topology = checkTopology(mesh);
    run.findings = findTopologyFaults(mesh, run.input.topology);
    addJoined(joined, run.findings);
    if (run.command.requiresSound && isSound(run.findings)) {
        addCrossing(mesh, findCrossingTriangles(mesh), run.findings);
    }
}

/// Where a count could not be met. With --max-error as well the bound may end it before: that was
/// asked for.
void warnOfCount(SimplifyRun& run) {
    if (run.countMet().value_or(true) || run.command.aim.maxErrorMm) return;
    run.warnings.push_back(countMissed(baseName(run.output.file), "triangles", run.output.triangles,
                                       *run.statistics.wantedTriangles,
                                       "all its pieces, holes and borders", run.errorBoundMm()));
}

/// Borders that lie at each other and share no points: nothing goes across.
void warnOfPlaces(const TriangleMesh& mesh, SimplifyRun& run) {
    if (run.input.topology.count(TopologyDefect::BoundaryEdge) == 0) return;
    std::vector<std::array<double, 3>> places;
    for (const VertexId v : borderOf(mesh).vertices) {
        const Vec3& p = mesh.points[v];
        places.push_back({p.x, p.y, p.z});
    }
    std::sort(places.begin(), places.end());
    const auto apart = places.end() - std::unique(places.begin(), places.end());
    if (apart == 0) return;
    run.warnings.push_back(
        {"surface-unsound",
         formatCount(apart) + (apart == 1 ? " point lies" : " points lie") +
             " on a border at the place of another, and triangles do not go across; "
             "--weld joins them",
         baseName(run.input.file)});
}

/// Open borders are what some surfaces have; all else is worth a warning.
void warnOfFindings(SimplifyRun& run) {
    for (const Finding& finding : run.findings) {
        if (!finding.isFault || finding.key == "borderEdges") continue;
        run.warnings.push_back({"surface-unsound", finding.text(), baseName(run.input.file)});
    }
}

Simplified simplifySurface(const TriangleMesh& mesh, SimplifyRun& run) {
    SimplifyOptions options = run.command.aim;
    options.progress = run.progress.callback();
    Simplified result = naming(baseName(run.input.file), [&] { return simplify(mesh, options); });
    run.statistics = result.statistics;
    if (!run.command.requiresSound) {
        addCrossing(mesh,
                    {result.statistics.crossingTriangles, result.statistics.undecidedTriangles},
                    run.findings);
    }
    return result;
}

/// Values at points, taken to the result.
struct TakenValues {
    std::vector<PointArray> arrays;  ///< that the surface's own file holds
    std::vector<PointData> data;
};

TakenValues takeValues(const MeshFile& input, const std::vector<PointData>& data,
                       const TriangleMesh& result, SimplifyRun& run) {
    std::optional<PointTransfer> transfer;
    TakenValues taken{run.takeValues(input, result, transfer), {}};
    if (!data.empty() && !transfer) transfer.emplace(input.mesh, result);
    for (std::size_t n = 0; n < data.size(); ++n) {
        taken.data.push_back(transferred(data[n], *transfer));
        run.data[n].arrays = std::ssize(data[n].arrays);
        run.data[n].areLabels =
            std::all_of(data[n].arrays.begin(), data[n].arrays.end(),
                        [](const PointValues& array) { return array.areLabels(); });
    }
    return taken;
}

/// Writes surface and values under their temporary names. \return  the surface as it can be read
MeshFile writeFiles(const TriangleMesh& mesh, TakenValues values, const MeshFile& input,
                    const FrameChange& change, SimplifyRun& run) {
    MeshFile written =
        run.writeSurface(mesh, std::move(values.arrays), input, change, ownFolder(run));
    for (std::size_t n = 0; n < values.data.size(); ++n) {
        const fs::path& file = run.data[n].output;
        run.addOutput(file, detail::folderOf(file)).write([&](const fs::path& path) {
            writePointData(values.data[n], std::ssize(mesh.triangles), path);
        });
    }
    return written;
}

/// Everything from the simplified surface on; the surface is then under its temporary name.
void finish(Simplified result, const MeshFile& input, const std::vector<PointData>& data,
            FrameChange change, SimplifyRun& run) {
    run.scaleOutput(run.command.scale, result.mesh, change);
    TakenValues values =
        run.stage("values", [&] { return takeValues(input, data, result.mesh, run); });
    MeshFile written = run.stage("write", [&] {
        if (!run.output.format->holdsNormals) result.mesh.normals.clear();
        return writeFiles(result.mesh, std::move(values), input, change, run);
    });
    run.stage("verify", [&] {
        summarize(written.mesh, run.output);
        verify({input.mesh, result.mesh, change.undo(std::move(written.mesh)),
                run.roundingMm + change.roundingMm(result.mesh)},
               run);
        if (const auto bound = run.command.aim.maxErrorMm) run.requireDigits(*bound);
    });
    // of the file, not of the input
    for (double* const mm :
         {&run.statistics.errorBoundMm, &run.roundingMm, &run.verification->maxMm}) {
        *mm *= run.output.scale;
    }
}

std::string refusal(const SimplifyRun& run) {
    std::string text;
    for (const Finding& finding : run.findings) {
        if (finding.isFault) addPart(text, finding.text(), "; ");
    }
    return baseName(run.input.file) +
           ": is not sound, as --require-sound asks for, so no surface was written: " + text;
}

/// As simplify() does, in the words of the command line.
void requireProvable(const TriangleMesh& mesh, const SimplifyCommand& command) {
    constexpr double kLeastPart = 1e-12;
    if (!command.aim.maxErrorMm) return;
    const BoundingBox box = boundingBox(mesh);
    if (*command.aim.maxErrorMm >= kLeastPart * norm(box.size())) return;
    throw InvalidInput("--max-error " + formatNumber(*command.aim.maxErrorMm) +
                       ": is less than 1e-12 of the diagonal of " + baseName(command.input) +
                       ", below the resolution of its coordinates; allow more");
}

/// A run for each of many surfaces. \return, \throws as runBatch()
int runSimplifyBatch(const SimplifyCommand& command) {
    return runBatch(
        {"adaptiso-simplify", "{file}", {"--data"}, {"--output", "--report", "--pictures"}},
        findBatchItems(command.batch, command.inputs, surfaceName), command.batch, command.common);
}

}  // namespace

int runSimplify(const SimplifyCommand& command) {
    if (command.isBatch) return runSimplifyBatch(command);
    SimplifyRun run(command);
    checkOutputs(run);

    MeshFile input = run.readInput(command.inputCoordinates, "simplify");
    for (const fs::path& data : command.data) requirePointOrder(*input.format, data);
    requireProvable(input.mesh, command);
    run.warnOfSize(command.aim.maxErrorMm, input.mesh);
    const std::vector<PointData> data = run.stage("read", [&] { return readData(run); });
    const FrameChange change =
        changeFrame(input, run.input.file, run.command.frame, run.output.file);
    checkScale(command.scale, *run.output.format, change.frame);
    run.stage("check", [&] {
        const std::int64_t joined = command.aim.weld ? joinVertices(input.mesh) : 0;
        check(input.mesh, joined, run);
        if (!command.aim.weld) warnOfPlaces(input.mesh, run);
    });

    TriangleMesh shown;
    if (!run.failsSoundness()) {
        Simplified result = run.stage("simplify", [&] { return simplifySurface(input.mesh, run); });
        if (command.report.isWanted()) shown = result.mesh;
        finish(std::move(result), input, data, change, run);
        warnOfFindings(run);
        warnOfCount(run);
        if (const auto bound = command.aim.maxErrorMm) {
            run.warnOfRounding(run.errorBoundMm(), *bound);
        }
        noteScale(run.output.scale, baseName(run.output.file), run.warnings);
    }
    if (!run.writesSurface()) run.dropOutputs();
    if (command.report.isWanted()) {
        run.writePage([&] { return makeReport(run, input, shown); });
    }
    if (run.failsSoundness()) run.verdict = {kExitCheckFailed, refusal(run)};
    return run.finish(
        run.writesSurface(), [&] { return jsonReport(run); },
        [&](std::ostream& out) { printReport(out, run); });
}

}  // namespace adaptiso::simplifier
