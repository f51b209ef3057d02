#include "Pipeline.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/SurfacePipeline/MendJson.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso::mender {
namespace {

namespace fs = std::filesystem;

/// The output, or "scan-mended.ply" of "scan.ply" in the folder that it names or the current one.
fs::path outputPath(const MendCommand& command) {
    const fs::path& output = command.output;
    if (!output.empty() && !isFolder(output)) return output;
    return output / insertBeforeExtension(command.input.filename(), "-mended");
}

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
        run.output.file = outputPath(command);
        run.output.format = &meshFormatOf(run.output.file);
        checkScale(command.scale, *run.output.format, command.frame);
        plan.add("--output", run.output.file, ownFolder(run));
    }
    plan.check(command.common, command.report);
}

void requireMendable(const MeshFile& input, const MendRun& run) {
    if (!(run.input.areaMm2 > 0)) {
        throw InvalidInput(run.input.file.string() +
                           ": its triangles have no area, so there is nothing to mend");
    }
    if (input.frame == CoordinateFrame::Voxel) {
        throw InvalidInput(run.input.file.string() +
                           ": is in voxel indices, in which a distance is no length; bring it to "
                           "mm first (adaptiso-simplify --coordinates ras --max-error ...)");
    }
}

void warnOfSize(const TriangleMesh& mesh, MendRun& run) {
    if (!run.command.aim.maxErrorMm) return;
    const auto warning = boundOverSize("--max-error", *run.command.aim.maxErrorMm,
                                       norm(boundingBox(mesh).size()), baseName(run.input.file));
    if (warning) run.warnings.push_back(*warning);
}

/// A message of mend() with the names of the command line's options, what was found and what helps.
std::string inWordsOfOptions(std::string text, const std::string& found) {
    constexpr std::pair<std::string_view, std::string_view> kWords[] = {
        {"mend: ", ""}, {"maxHoleMm", "--max-hole"}, {"maxErrorMm", "--max-error"}};
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

std::vector<PointArray> takeValues(const MeshFile& input, const TriangleMesh& result,
                                   MendRun& run) {
    std::vector<PointArray> taken;
    const auto held = heldArrays(input, *run.output.format, baseName(run.input.file),
                                 baseName(run.output.file), run.warnings);
    if (held.empty()) return taken;
    const PointTransfer transfer(input.mesh, result);
    for (const PointArray* const array : held) {
        taken.push_back(transferred(*array, transfer));
        run.keptArrays.push_back(array->name);
    }
    return taken;
}

/// Writes the surface under its temporary name. \return  as it can be read
MeshFile writeFile(const TriangleMesh& mesh, std::vector<PointArray> values, const MeshFile& input,
                   const FrameChange& change, MendRun& run) {
    MeshWriteOptions write;
    write.frame = change.frame;
    write.volume = input.volume;
    write.pointArrays = std::move(values);
    write.isInFrame = true;
    write.saysFrame = change.isSaid;
    AtomicOutput& output = run.addOutput(run.output.file, ownFolder(run));
    output.write([&](const fs::path& path) { writeMesh(mesh, path, write); });
    run.bytes = fs::file_size(output.temporary());
    return readMesh(output.temporary());
}

/// \throws InvalidInput  the output's digits alone are beyond the bound
void requireDigits(const MendRun& run) {
    const auto fault = roundingFault(run.roundingMm, run.statistics.maxErrorMm, *run.output.format);
    if (fault) throw InvalidInput(baseName(run.output.file) + ": " + *fault);
}

void warnOfRounding(MendRun& run) {
    const double bound =
        std::max(run.resultToInputMm(), run.inputToResultMm()) - run.move.maximumMm;
    const auto warning = roundingWarning(baseName(run.output.file), bound,
                                         run.statistics.maxErrorMm * run.output.scale,
                                         run.roundingMm, *run.output.format);
    if (warning) run.warnings.push_back(*warning);
}

/// Brings distances, proved and measured in the input, to those of the file.
void scaleDistances(double factor, MendRun& run) {
    run.output.scale = factor;
    for (double* const mm :
         {&run.statistics.resultToInputMm, &run.statistics.inputToResultMm, &run.roundingMm,
          &run.verification->maxMm, &run.gapMm, &run.move.maximumMm, &run.move.meanMm}) {
        *mm *= factor;
    }
}

/// Writes the result, with the values at its points, in the frame that is asked for.
/// \param mended  its points before they were moved \param fixed  no triangles: it lies around none
void finish(TriangleMesh result, std::vector<Vec3> mended, const TriangleMesh& fixed,
            const MeshFile& input, MendRun& run) {
    FrameChange change = changeFrame(input, run.input.file, run.command.frame, run.output.file);
    const double factor =
        chooseScale(run.command.scale, result, change.move.value_or(AffineTransform{}),
                    baseName(run.output.file));
    change.scale(factor);
    if (change.isSaid) run.output.frame = change.frame;
    if (isCopied(input, change, run)) {
        summarize(result, run.output);
        run.output.topology = run.input.topology;
        return run.stage("write", [&] { copyFile(run); });
    }
    std::swap(result.points, mended);
    std::vector<PointArray> values =
        run.stage("values", [&] { return takeValues(input, result, run); });
    std::swap(result.points, mended);
    MeshFile written = run.stage("write", [&] {
        if (!run.output.format->holdsNormals) result.normals.clear();
        TriangleMesh settled = result;
        run.roundingMm = settleRounding(settled, run.output.format->precision,
                                        change.move.value_or(AffineTransform{}))
                             .roundingMm;
        return writeFile(change.apply(settled), std::move(values), input, change, run);
    });
    run.stage("verify", [&] {
        summarize(written.mesh, run.output);
        const TriangleMesh surface = change.undo(std::move(written.mesh));
        verify({input.mesh, surface, run.shiftMm() + change.roundingMm(result)}, result, run);
        requireDigits(run);
        if (!fixed.triangles.empty()) verifyAround(surface, fixed, run);
    });
    scaleDistances(factor, run);
    warnOfRounding(run);
    noteScale(factor, baseName(run.output.file), run.warnings);
}

}  // namespace

int runMend(const MendCommand& command) {
    MendRun run(command);
    checkOutputs(run);

    const MeshFile input = run.stage("read", [&] {
        return readMesh(command.input,
                        {.keepsPointArrays = true,
                         .inputCoordinates = statedFrame(command.inputCoordinates, 0)});
    });
    addWarnings(run.warnings, input.warnings, baseName(command.input));
    run.input.format = input.format;
    run.input.frame = input.frame;
    summarize(input.mesh, run.input);
    requireMendable(input, run);
    warnOfSize(input.mesh, run);
    TriangleMesh fixed;
    if (!command.around.empty()) fixed = run.stage("read", [&] { return readFixed(input, run); });
    run.stage("check", [&] { run.input.topology = checkTopology(input.mesh); });

    TriangleMesh result = run.stage("mend", [&] { return mendSurface(input.mesh, run); });
    std::vector<Vec3> mended = result.points;
    if (run.isMended() && !command.around.empty()) {
        run.stage("nest", [&] { keepAround(fixed, result, run); });
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
    if (run.writesSurface()) {
        run.next = "adaptiso-check " + shellQuoted(run.output.file.string());
    }
    run.deliver([&] { return jsonReport(run); }, [&](std::ostream& out) { printReport(out, run); });
    return run.end(run.writesSurface() ? run.output.file.string() + " is written"
                                       : "no surface is written");
}

}  // namespace adaptiso::mender
