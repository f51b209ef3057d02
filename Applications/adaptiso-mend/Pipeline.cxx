#include "Pipeline.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <utility>

#include "Common/Batch.h"
#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/Mending/MendJson.h"

namespace adaptiso::mender {
namespace {

namespace fs = std::filesystem;

/// Empty where --output names the file, else its folder: the name is made here.
fs::path ownFolder(const MendRun& run) {
    return run.output.file == run.command.output ? fs::path() : detail::folderOf(run.output.file);
}

/// Names the output and checks it before a file is read.
void checkOutputs(MendRun& run) {
    const MendCommand& command = run.command;
    run.input.file = command.input;
    OutputPlan plan(std::array{command.input, command.around});
    if (!command.output.empty() || !command.isDryRun) {
        run.output.file = surfaceFile(command.output, command.input, "-mended");
        run.output.format = &meshFormatOf(run.output.file);
        checkScale(command.scale, *run.output.format, command.frame);
        plan.add("--output", run.output.file, ownFolder(run));
    }
    plan.check(command.common, command.report);
}

void requireMendable(const MeshFile& input, const MendRun& run) {
    if (input.frame != CoordinateFrame::Voxel) return;
    throw InvalidInput(run.input.file.string() +
                       ": is in voxel indices, in which a distance is no length; bring it to "
                       "mm first (adaptiso-simplify --coordinates ras --max-error ...)");
}

/// A message of mend() with the names of the command line's options, what was found and what helps.
std::string inWordsOfOptions(std::string text, const std::string& found) {
    constexpr std::pair<std::string_view, std::string_view> kWords[] = {
        {"mend: ", ""},
        {"maxHoleMm", "--max-hole"},
        {"maxErrorMm", "--max-error"},
        {"minVolumeMm3", "--min-volume"}};
    for (const auto& [ours, theirs] : kWords) {
        const std::size_t at = text.find(ours);
        if (at != std::string::npos) text.replace(at, ours.size(), theirs);
    }
    const bool isOfHole = text.find("--max-hole") != std::string::npos;
    if (!found.empty()) text += "; found: " + found;
    if (isOfHole) text += "; a larger --max-hole closes it, --open leaves it open";
    return text;
}

/// The mended mesh; where it can't be mended as asked, the run gets the reason.
TriangleMesh mendSurface(const TriangleMesh& mesh, MendRun& run) {
    MendOptions options = run.command.aim;
    options.progress = run.progress.callback();
    try {
        Mended result = mend(mesh, options);
        run.statistics = std::move(result.statistics);
        run.isSearched = true;
        return std::move(result.mesh);
    } catch (const MendRefusal& refusal) {
        run.statistics = refusal.statistics;
        run.isSearched = true;
        run.refusal = inWordsOfOptions(refusal.what(), joined(mendFaultTexts(run.statistics)));
    } catch (const InvalidInput& refusal) {
        run.refusal = inWordsOfOptions(refusal.what(), {});
    }
    return {};
}

bool isGzip(const fs::path& file) {
    std::array<char, 2> head{};
    std::ifstream(file, std::ios::binary).read(head.data(), head.size());
    return head == std::array{'\x1f', '\x8b'};
}

/// The surface that the result is to lie around, in the frame of the input's file.
TriangleMesh readFixed(const MeshFile& input, MendRun& run) {
    const fs::path& file = run.command.around;
    std::optional<CoordinateFrame> stated;  // one frame is of the mesh alone
    if (run.command.inputCoordinates.size() > 1) stated = run.command.inputCoordinates[1];
    std::array<NamedMesh, 2> both{
        {{run.command.input, input}, {file, readMesh(file, {.inputCoordinates = stated})}}};
    MeshFile &own = both[0].file, &fixed = both[1].file;
    addWarnings(run.warnings, fixed.warnings, baseName(file));
    const CommonFrame common =
        bringToOneFrame(both, std::nullopt,
                        "bring one to the other's frame first (adaptiso-simplify --coordinates)");
    addWarnings(run.warnings, common.warnings);
    if (!isOneSolid(fixed.mesh)) {
        throw InvalidInput(file.string() +
                           ": --around takes a closed, oriented 2-manifold in one piece; mend it "
                           "first (adaptiso-mend)");
    }
    return transformed(fixed.mesh, lpsToFrame(*own.frame, own.volume));
}

/// Moves the mended mesh to lie around `fixed`; where that can't be had, the run gets the reason.
void keepAround(const TriangleMesh& fixed, TriangleMesh& mesh, MendRun& run) {
    const BoundingBox box = boundingBox(mesh);
    const double digitsMm =
        1e-6 * std::max(norm(box.minimum), norm(box.maximum));  // of a file's 24 bits
    try {
        NestedAround nested = nestAround(mesh, fixed, *run.command.gapMm + digitsMm);
        run.move = nested.move;
        run.gapMm = nested.gap.mm;
        mesh.points = std::move(nested.points);
        if (run.move.movedVertices > 0) mesh.normals.clear();
    } catch (const InvalidInput& refusal) {
        run.refusal = "--around " + baseName(run.command.around) + ": " + refusal.what();
    }
}

/// A sound mesh keeps its very bytes, where nothing else about the file is to change.
bool isCopied(const MeshFile& input, const FrameChange& change, const MendRun& run) {
    return run.isUnchanged() && input.format == run.output.format && !change.move &&
           !run.command.frame && run.command.inputCoordinates.empty() && !isGzip(run.input.file);
}

void copyFile(MendRun& run) {
    AtomicOutput& output = run.addOutput(run.output.file, ownFolder(run));
    output.write([&](const fs::path& path) {
        fs::copy_file(run.input.file, path, fs::copy_options::overwrite_existing);
    });
    run.bytes = fs::file_size(output.temporary());
    run.isCopy = true;
}

/// Writes the result, with the values at its points, in the frame that is asked for.
/// \param mended  its points before they were moved \param fixed  no triangles: it lies around none
void finish(TriangleMesh result, std::vector<Vec3> mended, const TriangleMesh& fixed,
            const MeshFile& input, MendRun& run) {
    FrameChange change = changeFrame(input, run.input.file, run.command.frame, run.output.file);
    run.scaleOutput(run.command.scale, result, change);
    if (isCopied(input, change, run)) {
        summarize(result, run.output);
        run.output.topology = run.input.topology;
        return run.stage("write", [&] { copyFile(run); });
    }
    std::swap(result.points, mended);
    std::optional<PointTransfer> transfer;
    std::vector<PointArray> values =
        run.stage("values", [&] { return run.takeValues(input, result, transfer); });
    std::swap(result.points, mended);
    MeshFile written = run.stage("write", [&] {
        if (!run.output.format->holdsNormals) result.normals.clear();
        return run.writeSurface(result, std::move(values), input, change, ownFolder(run));
    });
    run.stage("verify", [&] {
        summarize(written.mesh, run.output);
        const TriangleMesh surface = change.undo(std::move(written.mesh));
        verify({input.mesh, surface, run.shiftMm() + change.roundingMm(result)}, result, run);
        run.requireDigits(run.statistics.maxErrorMm);
        if (!fixed.triangles.empty()) verifyAround(surface, fixed, run);
    });
    // of the file, not of the input
    for (double* const mm :
         {&run.statistics.resultToInputMm, &run.statistics.inputToResultMm, &run.roundingMm,
          &run.verification->maxMm, &run.gapMm, &run.move.maximumMm, &run.move.meanMm}) {
        *mm *= run.output.scale;
    }
    run.warnOfRounding(std::max(run.resultToInputMm(), run.inputToResultMm()) - run.move.maximumMm,
                       run.statistics.maxErrorMm);
    noteScale(run.output.scale, baseName(run.output.file), run.warnings);
}

/// A run for each of many surfaces. \return, \throws as runBatch()
int runMendBatch(const MendCommand& command) {
    BatchProgram program{
        "adaptiso-mend", "{file}", {"--around"}, {"--output", "--report", "--pictures"}};
    BatchOptions batch = command.batch;
    if (command.isDryRun) {
        program.defaultOutput.clear();
        program.keepsRecords = false;
        batch.outputFolder.clear();
    }
    return runBatch(program, findBatchItems(batch, command.inputs, surfaceName), batch,
                    command.common);
}

}  // namespace

int runMend(const MendCommand& command) {
    if (command.isBatch) return runMendBatch(command);
    MendRun run(command);
    checkOutputs(run);

    std::optional<TriangleMesh> broken;  // as read, where triangles are dropped before others look
    const MeshFile input = run.readInput(command.inputCoordinates, "mend", [&](TriangleMesh& mesh) {
        if (!isBroken(mesh)) return;
        broken = mesh;
        dropBrokenTriangles(mesh);
    });
    requireMendable(input, run);
    run.warnOfSize(command.aim.maxErrorMm, input.mesh);
    TriangleMesh fixed;
    if (!command.around.empty()) fixed = run.stage("read", [&] { return readFixed(input, run); });
    run.stage("check", [&] { run.input.topology = checkTopology(input.mesh); });

    TriangleMesh result = run.stage(
        "mend", [&] { return mendSurface(broken ? std::as_const(*broken) : input.mesh, run); });
    std::vector<Vec3> mended = result.points;
    if (run.isMended() && !command.around.empty()) {
        run.stage("nest", [&] { keepAround(fixed, result, run); });
    }
    TriangleMesh shown;
    if (command.report.isWanted() && run.isMended()) shown = result;
    if (run.isMended()) {
        const auto warning =
            mendWarning(run.statistics, run.input.areaMm2, baseName(command.input));
        if (warning) run.warnings.push_back(*warning);
    }
    if (!run.isMended()) {
        run.verdict = {kExitCheckFailed,
                       baseName(command.input) + ": can't be mended as asked: " + run.refusal};
    } else if (command.isDryRun) {
        run.output.format = input.format;
        run.output.frame = input.frame;
        summarize(result, run.output);
        run.stage("verify", [&] { verify({input.mesh, result, run.shiftMm()}, result, run); });
    } else {
        finish(std::move(result), std::move(mended), fixed, input, run);
    }
    if (!run.writesSurface()) run.dropOutputs();
    if (command.report.isWanted()) {
        run.writePage([&] { return makeReport(run, input, shown); });
    }
    return run.finish(
        run.writesSurface(), [&] { return jsonReport(run); },
        [&](std::ostream& out) { printReport(out, run); });
}

}  // namespace adaptiso::mender
