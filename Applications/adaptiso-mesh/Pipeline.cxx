#include "Pipeline.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "Common/Batch.h"
#include "Common/CommonFrame.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/PreprocessingOptions.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Common/Warnings.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ImageNames.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ImageIO/SampleStatistics.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"
#include "adaptiso/SurfacePipeline/SurfaceWarnings.h"

namespace adaptiso::mesher {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "adaptiso-mesh";

/// Pairs of triangles that cross, to be shown on the page; all are counted.
constexpr std::int64_t kMaxShownPairs = 1000;

/// An isovalue as names of files have it.
struct NamedIsovalue {
    std::string text;   ///< "135.83"
    std::string exact;  ///< "135.83333"; "auto" while it is not known
};

/// To five digits, but for whole ones.
std::string shortNumber(double value) {
    constexpr double kDigits = 5, kMostDecimals = 15;
    const double decimals = kDigits - 1 - std::floor(std::log10(std::abs(value)));
    if (!(decimals <= kMostDecimals)) return formatNumber(value);
    const double unit = std::pow(10, std::max(decimals, 0.0));
    return formatNumber(std::round(value * unit) / unit);
}

/// All digits where fewer would name a surface of another value that was asked for.
/// \param number  of the choice, whose value this is \param value  none: not known yet
NamedIsovalue named(const MeshOptions& options, std::size_t number, std::optional<double> value) {
    if (!value) return {"auto", "auto"};
    NamedIsovalue name{shortNumber(*value), formatNumber(*value)};
    for (std::size_t n = 0; n < options.isovalues.size(); ++n) {
        const auto& other = options.isovalues[n].value;
        if (n != number && other && shortNumber(*other) == name.text) name.text = name.exact;
    }
    return name;
}

/// \param isOne  there is one isovalue
fs::path outputPath(const fs::path& output, bool isOne, const NamedIsovalue& isovalue) {
    const std::string name = output.filename().string();
    const std::string filled =
        replaced(replaced(name, "{iso}", isovalue.text), kIsoLabel, bidsLabel(isovalue.exact));
    if (filled != name) return output.parent_path() / filled;
    return isOne ? output : insertBeforeExtension(output, "-iso" + isovalue.text);
}

/// The file that the surface at an isovalue goes to.
///
/// Without an output in `options`: "<stem>-iso<isovalue>.vtp" in the current folder, or in the
/// folder that it names. An output with "{iso}" in its name has the isovalue in that place.
/// Otherwise the output is taken as it is for one isovalue, and for several gets "-iso<isovalue>"
/// before its extension.
fs::path outputPath(const MeshOptions& options, const NamedIsovalue& isovalue) {
    if (options.output.empty() || isFolder(options.output)) {
        return options.output / (inputStem(options.input) + "-iso" + isovalue.text + ".vtp");
    }
    return outputPath(options.output, options.isovalues.size() == 1, isovalue);
}

/// Empty for a file as --output names it, else its folder: the name is made here.
fs::path ownFolder(const MeshOptions& options, const fs::path& file) {
    return file == options.output ? fs::path() : detail::folderOf(file);
}

/// Checks the outputs before the volume is read.
void checkOutputs(const MeshOptions& options) {
    OutputPlan plan({&options.input, 1});
    for (std::size_t n = 0; n < options.isovalues.size(); ++n) {
        const fs::path file = outputPath(options, named(options, n, options.isovalues[n].value));
        const MeshFormat& format = meshFormatOf(file);
        checkScale(options.scale, format, outputFrame(options.frame, format));
        plan.add("--output", file, ownFolder(options, file));
    }
    plan.check(options.common, options.report);
}

/// The input, as messages name it: without folders.
std::string inputName(const MeshOptions& options) {
    const std::string name = baseName(options.input);
    return name.empty() ? "the image" : name;
}

std::string rangeText(double isovalue, const MeshRun& run) {
    const ValueRange& range = run.range();
    const std::string file = inputName(run.options);
    if (range.minimum > range.maximum) return file + " holds no numbers";
    const auto texts = formatApart({range.minimum, range.maximum, isovalue});
    return "the range of " + file + (run.preprocessed ? ", preprocessed, is " : " is ") + texts[0] +
           " to " + texts[1];
}

/// \throws InvalidInput when the surface would be empty, or the border of the image alone
void checkIsovalue(double isovalue, const MeshRun& run) {
    const std::string name = "--iso " + shown(formatNumber(isovalue));
    if (const auto fault = isovalueFault(isovalue, run.range())) {
        throw InvalidInput(name + ": " + *fault + "; " + rangeText(isovalue, run));
    }
}

/// The isovalues to take: Otsu's for auto, all of them checked against the volume.
std::vector<double> chooseIsovalues(const VolumeView& volume, const MeshRun& run) {
    std::vector<double> isovalues;
    for (const IsovalueChoice& choice : run.options.isovalues) {
        const double isovalue = choice.isAutomatic()
                                    ? naming("--iso auto: " + inputName(run.options),
                                             [&] { return otsuThreshold(volume); })
                                    : *choice.value;
        checkIsovalue(isovalue, run);
        if (std::find(isovalues.begin(), isovalues.end(), isovalue) != isovalues.end()) {
            throw InvalidInput("--iso auto: is " + formatNumber(isovalue) +
                               " here, which is given as well");
        }
        isovalues.push_back(isovalue);
    }
    return isovalues;
}

/// Adds the warning about isovalues among labels: the first of them.
void warnOfLabels(const VolumeView& volume, const std::vector<double>& isovalues, MeshRun& run) {
    const auto labels = findLabelValues(volume);
    for (const double isovalue : isovalues) {
        const auto warning = labelsWarning(labels, isovalue, "adaptiso-labels");
        if (!warning) continue;
        addWarnings(run.warnings, {&*warning, 1}, inputName(run.options));
        break;
    }
    run.printNewWarnings();
}

InputSummary summarize(const ReadVolume& read) {
    const VolumeView& view = read.volume.view();
    return {read.format, view.geometry(), view.pixelType(), valueRange(view), read.warnings};
}

/// The volume to work on.
Volume prepare(Volume read, MeshRun& run) {
    if (run.options.preprocessing.changesNothing()) return read;
    return run.stage("preprocess", [&] {
        Preprocessed done =
            preprocessImage(std::move(read), run.options.preprocessing, run.options.input);
        const VolumeView& view = done.volume.view();
        run.preprocessed = {view.geometry(), view.pixelType(), valueRange(view)};
        addWarnings(run.input.warnings, done.warnings);
        return std::move(done.volume);
    });
}

/// Calls `work`, which chooses pieces. \throws InvalidInput when nothing is left
template <class Work>
auto choosingPieces(const MeshOptions& options, const Work& work) {
    try {
        return work();
    } catch (const NothingLeft& error) {
        throw InvalidInput("--min-volume " + formatNumber(options.selection.minVolumeMm3) + ": " +
                           error.what());
    }
}

/// The surface before it is finished.
TriangleMesh extract(const VolumeView& volume, const SpanSpaceIndex& index, MeshRun& run,
                     SurfaceSummary& summary) {
    const MeshOptions& options = run.options;
    TriangleMesh mesh = run.stage("extract", [&] {
        ExtractionOptions extract = options.extraction;
        extract.isovalue = summary.isovalue;
        extract.computeNormals = summary.format->holdsNormals;
        extract.progress = run.progress.callback();
        const auto extractor = [&](const ExtractionOptions& each) {
            return naming(inputName(options), [&] { return extractSurface(volume, index, each); });
        };
        return choosingPieces(
            options, [&] { return extractPieces(extractor, extract, options.selection, summary); });
    });
    if (mesh.triangles.empty()) {
        throw InvalidInput("--iso " + formatNumber(summary.isovalue) +
                           ": the surface is empty; no two neighbouring voxels lie on both sides");
    }
    return mesh;
}

/// The factor of --scale and --fit for the pieces that are kept.
double chooseScale(const TriangleMesh& mesh, const AffineTransform& toFile,
                   const SurfaceSummary& summary, const MeshOptions& options) {
    const std::string file = baseName(summary.file);
    const bool isWhole = options.selection.keepsAll() || summary.choseFirst;
    if (isWhole || !options.scale.bedMm) return chooseScale(options.scale, mesh, toFile, file);
    return chooseScale(options.scale, selectComponents(mesh, options.selection), toFile, file);
}

/// Brings the figures of a surface in the scan to those of its file.
void scaleFigures(SurfaceSummary& surface) {
    const double factor = surface.scale, square = factor * factor, cube = square * factor;
    surface.sizeMm = factor * surface.sizeMm;
    surface.areaMm2 *= square;
    if (surface.volumeMm3) *surface.volumeMm3 *= cube;
    if (surface.roundingMm) *surface.roundingMm *= factor;
    if (surface.statistics.errorBoundMm) *surface.statistics.errorBoundMm *= factor;
    if (surface.verification) surface.verification->maxMm *= factor;
    for (SurfaceComponent& component : surface.topology.components) {
        component.areaMm2 *= square;
        component.signedVolumeMm3 *= cube;
    }
}

/// Makes one surface and writes it under its temporary name.
/// \param number  of the choice
SurfaceSummary makeSurface(const VolumeView& volume, const SpanSpaceIndex& index, double isovalue,
                           std::size_t number, MeshRun& run) {
    const MeshOptions& options = run.options;
    SurfaceSummary summary;
    summary.isovalue = isovalue;
    summary.isAutomatic = options.isovalues[number].isAutomatic();
    summary.file = outputPath(options, named(options, number, isovalue));
    summary.format = &meshFormatOf(summary.file);
    summary.frame = outputFrame(options.frame, *summary.format);

    TriangleMesh mesh = extract(volume, index, run, summary);

    MeshWriteOptions write;
    write.frame = summary.frame;
    // tkRAS and voxel indices are those of the image that the user has
    write.volume = frameVolume(summary.frame, run.input.geometry);
    const AffineTransform toFrame = lpsToFrame(write.frame, write.volume);
    summary.scale = chooseScale(mesh, toFrame, summary, options);
    const FileDigits digits{summary.format, scaled(toFrame, summary.scale),
                            requestedBoundMm(options.extraction, volume.geometry())};
    if (options.verifies) {
        summary.verification = run.stage(
            "verify", [&] { return verify(volume, index, mesh, digits, options, summary); });
    }

    const bool isShown = options.report.isWanted();
    FinishOptions finish;
    finish.selection = options.selection;
    finish.digits = digits;
    finish.method = options.extraction.method;
    finish.border = options.index.border;
    finish.countsCrossings = options.checksCrossings;
    finish.maxCrossingPairs = isShown ? kMaxShownPairs : 0;
    finish.runStage = [&](std::string_view stage, const std::function<void()>& work) {
        run.stage(stage, work);
    };
    FinishedSurface finished = choosingPieces(options, [&] {
        try {
            return finishSurface(std::move(mesh), finish, summary);
        } catch (const TooFewDigits& error) {
            throw InvalidInput(summary.file.string() + ": " + error.what());
        }
    });

    summary.diagonalMm = norm(boundingBox(finished.mesh).size());
    run.stage("write", [&] {
        AtomicOutput& output = run.addOutput(summary.file, ownFolder(options, summary.file));
        output.write([&](const fs::path& path) {
            if (summary.scale == 1) return writeMesh(finished.mesh, path, write);
            write.isInFrame = true;
            write.saysFrame = false;
            writeMesh(transformed(finished.mesh, digits.toFrame), path, write);
        });
        summary.bytes = fs::file_size(output.temporary());
    });
    scaleFigures(summary);
    if (isShown) {
        run.shown.push_back({std::move(finished.mesh), std::move(finished.crossings)});
    }
    return summary;
}

/// Where a count could not be met. With --max-error as well the bound may end it before: that was
/// asked for.
std::optional<Warning> countWarning(const SurfaceSummary& surface, const MeshOptions& options) {
    if (surface.countMet().value_or(true) || options.extraction.adaptive.maxErrorMm)
        return std::nullopt;
    const bool isOpen = options.index.border == Border::Open;
    return countMissed(
        surface.file.filename().string(), "triangles", surface.topology.triangles,
        *surface.statistics.wantedTriangles,
        std::string("all its pieces and holes") + (isOpen ? " and its open border" : ""),
        *surface.errorBoundMm());
}

const ImageGeometry& meshedGeometry(const MeshRun& run) {
    return run.preprocessed ? run.preprocessed->geometry : run.input.geometry;
}

std::optional<Warning> digitsWarning(const SurfaceSummary& surface, const MeshRun& run) {
    const auto asked = requestedBoundMm(run.options.extraction, meshedGeometry(run));
    if (!asked) return std::nullopt;
    return roundingWarning(surface.file.filename().string(), *surface.errorBoundMm(),
                           *asked * surface.scale, surface.roundingMm.value_or(0), *surface.format);
}

std::optional<Warning> insideOutWarning(const SurfaceSummary& surface) {
    const std::int64_t count = surface.insideOutPieces.value_or(0);
    if (count == 0) return std::nullopt;
    return Warning{"pieces-inside-out",
                   counted(count, "piece is", "pieces are") +
                       " inside out; the method adaptive keeps all facing outward",
                   surface.file.filename().string()};
}

std::optional<Warning> sizeWarning(const SurfaceSummary& surface, const MeshOptions& options) {
    if (!options.extraction.adaptive.maxErrorMm) return std::nullopt;
    return boundOverSize("--max-error", *options.extraction.adaptive.maxErrorMm, surface.diagonalMm,
                         surface.file.filename().string());
}

/// Adds the warnings about the surfaces as their files hold them.
void warnOfSurfaces(MeshRun& run) {
    for (const SurfaceSummary& surface : run.surfaces) {
        auto noise =
            noiseWarning(surface, run.options.extraction, meshedGeometry(run), "--max-error ",
                         run.options.preprocessing.smoothSigmaMm ? "" : "--smooth ");
        if (noise) noise->file = surface.file.filename().string();
        for (const auto& warning :
             {countWarning(surface, run.options), digitsWarning(surface, run),
              insideOutWarning(surface), noise, sizeWarning(surface, run.options)}) {
            if (warning) run.warnings.push_back(*warning);
        }
        noteScale(surface.scale, surface.file.filename().string(), run.warnings);
    }
    run.printNewWarnings();
}

/// "adaptiso-check brain.ply"
std::string checkCommand(const MeshRun& run) {
    std::string command = "adaptiso-check";
    bool needsImage = false;
    for (const SurfaceSummary& surface : run.surfaces) {
        command += " " + shellQuoted(surface.file.string());
        needsImage = needsImage || surface.frame == CoordinateFrame::Voxel;
    }
    return needsImage ? command + " --volume " + shellQuoted(run.options.input.string()) : command;
}

/// "brain-100.ply and brain-120.ply are written"
std::string writtenText(const MeshRun& run) {
    std::string text;
    for (std::size_t n = 0; n < run.surfaces.size(); ++n) {
        text += n == 0 ? "" : n + 1 == run.surfaces.size() ? " and " : ", ";
        text += run.surfaces[n].file.string();
    }
    return text + (run.surfaces.size() == 1 ? " is written" : " are written");
}

/// A run for each of many inputs. \return, \throws as runBatch()
int runMeshBatch(const MeshOptions& options) {
    BatchProgram program{"adaptiso-mesh",
                         "{name}-iso{iso}.vtp",
                         {},
                         {"--output", "--report", "--pictures"},
                         "--iso"};
    program.surfaceFiles = [&options](const fs::path& output, const auto&) {
        std::vector<fs::path> files;
        for (std::size_t n = 0; n < options.isovalues.size(); ++n) {
            files.push_back(outputPath(output, options.isovalues.size() == 1,
                                       named(options, n, options.isovalues[n].value)));
        }
        return files;
    };
    return runBatch(program, findBatchItems(options.batch, options.inputs, inputStem),
                    options.batch, options.common);
}

}  // namespace

int runMesh(const MeshOptions& options) {
    if (options.isBatch()) return runMeshBatch(options);
    if (options.image.listsSeries) {
        return runSeriesList(options.input, options.image, options.common, kProgram);
    }
    if (options.image.tellsInfo) return runInfo(options);
    MeshRun run(options);
    checkOutputs(options);

    ReadVolume read =
        run.stage("read", [&] { return readImage(options.input, options.image.read); });
    run.input = run.stage("read", [&] { return summarize(read); });
    const Volume prepared = prepare(std::move(read.volume), run);
    const VolumeView& volume = prepared.view();
    addWarnings(run.warnings, run.input.warnings, inputName(options));
    run.printNewWarnings();
    const std::vector<double> isovalues =
        run.stage("read", [&] { return chooseIsovalues(volume, run); });

    run.stage("read", [&] { warnOfLabels(volume, isovalues, run); });

    const SpanSpaceIndex index = run.stage("index", [&] {
        return naming(baseName(options.input),
                      [&] { return SpanSpaceIndex::build(volume, options.index); });
    });
    run.index = {index.search(), index.memoryBytes()};

    for (std::size_t n = 0; n < isovalues.size(); ++n) {
        run.surfaces.push_back(makeSurface(volume, index, isovalues[n], n, run));
    }
    warnOfSurfaces(run);
    if (run.failsStrict()) run.dropOutputs();
    if (options.report.isWanted()) run.writePage([&] { return makeReport(run, volume); });
    if (!run.failsStrict()) run.next = checkCommand(run);
    run.deliver([&] { return jsonReport(run); }, [&](std::ostream& out) { printReport(out, run); });
    return run.end(run.failsStrict() ? "no surface is written" : writtenText(run));
}

}  // namespace adaptiso::mesher
