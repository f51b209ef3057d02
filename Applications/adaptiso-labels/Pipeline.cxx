#include "Pipeline.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "Common/Batch.h"
#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "OutputFiles.h"
#include "Regions.h"
#include "Run.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/ImageIO/ImageNames.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Scene.h"

namespace adaptiso::labels {
namespace {

namespace fs = std::filesystem;

fs::path outputFolder(const LabelsOptions& options) {
    return options.output.empty() ? fs::path(inputStem(options.input) + "-labels") : options.output;
}

/// The regions' files of a run before, which may have their names.
std::set<std::string, std::less<>> earlierRegionFiles(const fs::path& folder) {
    std::set<std::string, std::less<>> files;
    const auto report = parseJson<Json>(readFoundFile(folder / "report.json", folder).value_or(""));
    if (!report.is_object() || !report.contains("regions") || !report["regions"].is_array()) {
        return files;
    }
    for (const Json& region : report["regions"]) {
        if (!region.is_object() || !region.contains("file") || !region["file"].is_string())
            continue;
        const std::string file = region["file"];
        if (file.starts_with("regions/")) files.insert(file);
    }
    return files;
}

OwnNames replaceable(const LabelsOptions& options, const fs::path& folder) {
    if (!options.mayReplace) return {};
    return OwnNames([earlier = earlierRegionFiles(folder)](std::string_view name) {
        return isOwnFile(name) || earlier.contains(name);
    });
}

/// Checks the outputs before the map is read.
void checkOutputs(const LabelsRun& run) {
    const LabelsOptions& options = run.options;
    std::vector<fs::path> inputs{options.input, options.names, options.volume,
                                 options.priority.list};
    for (const MaskSource& mask : options.masks) inputs.push_back(mask.file);
    OutputPlan plan(inputs);
    if (run.isScene) {
        plan.add("--output", run.folder);
    } else {
        plan.checkFolder(run.folder);
    }
    plan.check(options.common, options.report);
    if (!run.isScene) AtomicFolder::check(run.folder, replaceable(options, run.folder));
}

/// Labels of a merge that the map has not.
void warnOfMissing(const LabelMerge& merge, const LabelCensus& census, const std::string& name,
                   LabelsRun& run) {
    std::string missing;
    bool isThere = false;
    for (const LabelRange& range : merge.labels) {
        const bool isInMap = std::ranges::any_of(census.voxels, [&](const auto& label) {
            return range.contains(run.ids.of(label.first));
        });
        if (isInMap) {
            isThere = true;
        } else {
            addPart(missing, toText(range));
        }
    }
    if (!isThere) {
        run.warnings.push_back(
            {"label-missing", "has none of the labels of --merge " + merge.name, name});
    } else if (!missing.empty()) {
        run.warnings.push_back(
            {"label-missing", "has no label " + missing + " of --merge " + merge.name, name});
    }
}

/// Reads the map, or joins its masks.
ReadVolume readOne(const LabelsOptions& options, LabelsRun& run) {
    if (options.masks.empty()) return readImage(options.input, options.read);
    MaskMap map = joinMasks(run);
    return {std::move(map.volume), map.format, {}};
}

/// Reads the map and learns what it holds.
/// \throws InvalidInput  it is no label map, or holds nothing but 0
/// \param options  the run's; names in them become labels
Volume readMap(LabelsOptions& options, LabelsRun& run, LabelCensus& census) {
    const std::string name = baseName(options.input);
    ReadVolume read = readOne(options, run);
    resolveNames(options);
    // that isovalues can't tell them apart is nothing to labels
    std::erase_if(read.warnings, [](const auto& w) { return w.code == "large-integers"; });
    const VolumeView view = read.volume.view();
    run.map = {read.format, view.geometry(), view.pixelType(), valueRange(view), read.warnings, 0};
    addWarnings(run.warnings, read.warnings, name);
    std::vector<LabelId> merged;
    for (const LabelMerge& merge : options.merges) merged.push_back(merge.number());
    run.ids = naming(name, [&] { return LabelIds(view, merged); });
    if (run.ids.areNumbered()) read.volume = run.ids.numbered(view);
    census = naming(name, [&] { return countLabels(read.volume, read.scaling); });
    run.map.labels = std::ssize(census.voxels);
    if (census.voxels.empty()) {
        throw InvalidInput(name + ": holds no label: all voxels are 0");
    }
    if (census.looksLikeAnImage() && !options.takesAnyMap && options.masks.empty()) {
        throw InvalidInput(
            name + ": is an image, no label map: it has " + formatCount(run.map.labels) +
            " values, which change nearly from voxel to voxel (" +
            formatFixed(census.medianRun, 2) + " in a row); --any-map takes it all the same");
    }
    for (const LabelMerge& merge : options.merges) warnOfMissing(merge, census, name, run);
    census = mergeCounts(std::move(census), options.merges, run.ids);
    return mergeLabels(std::move(read.volume), options.merges, run.ids);
}

/// \throws InvalidInput  a region has no conductivity, or the map has no such region
void checkConductivities(const LabelsRun& run) {
    const std::map<Label, double>& given = run.options.conductivities;
    if (given.empty()) return;
    const std::string file = baseName(run.options.input);
    for (const Region& region : run.regions) {
        if (!given.contains(region.label)) {
            throw InvalidInput(file + ": " + run.nameOf(region.label) +
                               " has no conductivity in --conductivities");
        }
    }
    for (const auto& [label, value] : given) {
        if (run.find(label) == nullptr) {
            throw InvalidInput(file + ": has no region " + std::to_string(label) +
                               ", which --conductivities names");
        }
    }
}

LabelComplex extract(const VolumeView& map, LabelsRun& run) {
    const LabelsOptions& options = run.options;
    LabelOptions extraction;
    static_cast<SimplifyAims&>(extraction) = options.aims;
    extraction.progress = run.progress.callback();
    if (!options.labels.empty()) extraction.labels = labelsOf(run.regions);
    LabelResult result =
        naming(baseName(options.input), [&] { return extractLabels(map, extraction); });
    run.statistics = result.statistics;
    const TriangleMesh walls{result.complex.points, {}, {}};
    run.scale = chooseScale(options.scale, walls,
                            lpsToFrame(run.frame, frameVolume(run.frame, run.map.geometry)),
                            baseName(run.folder));
    run.points = std::ssize(result.complex.points);
    run.triangles = std::ssize(result.complex.triangles);
    return std::move(result.complex);
}

void measure(const LabelComplex& complex, LabelsRun& run) {
    for (RegionMeasure& measure : measureRegions(complex, labelsOf(run.regions))) {
        const auto region =
            std::ranges::lower_bound(run.regions, measure.label, {}, &Region::label);
        if (region != run.regions.end() && region->label == measure.label) {
            region->measure = std::move(measure);
        }
    }
}

/// Brings figures of the scan to those of the file.
void scaleFigures(LabelsRun& run) {
    const double factor = run.scale, square = factor * factor;
    run.statistics.errorBoundMm *= factor;
    run.roundingMm *= factor;
    for (Region& region : run.regions) {
        region.measure.volumeMm3 *= square * factor;
        region.measure.areaMm2 *= square;
        for (RegionContact& contact : region.measure.neighbours) contact.areaMm2 *= square;
    }
    noteScale(factor, baseName(run.folder), run.warnings);
}

/// Where a count could not be met. With --max-error as well the bound may end it before: that was
/// asked for.
void warnOfCount(LabelsRun& run) {
    const std::optional<std::int64_t>& wanted = run.statistics.wantedTriangles;
    if (!wanted || run.triangles <= *wanted || run.options.aims.maxErrorMm) return;
    run.warnings.push_back(countMissed(baseName(run.options.input), "triangles in its walls",
                                       run.triangles, *wanted, "all regions, pieces and junctions",
                                       run.errorBoundMm()));
}

std::string failureText(const LabelsRun& run) {
    std::string text;
    for (const LabelsCheck& check : run.checks) {
        if (check.isPassed) continue;
        addPart(text, check.name + ": " + check.finding, "; ");
    }
    return text;
}

/// \param shown  the image behind the regions: of --volume, or the map
void writePage(LabelsRun& run, const RegionSurfaces& surfaces, const VolumeView& shown) {
    const LabelsOptions& options = run.options;
    const fs::path& file = options.volume.empty() ? options.input : options.volume;
    run.writePage([&] { return makeReport(run, surfaces, baseName(file), shown); });
}

/// Each input as a run of its own. \return an exit code
int runLabelsBatch(const LabelsOptions& options) {
    std::vector<std::string> files{"--names", "--volume"};
    if (!options.priority.list.empty()) files.emplace_back("--priority");
    return runBatch(
        {"adaptiso-labels", "{name}-labels", files, {"--output", "--report", "--pictures"}},
        findBatchItems(options.batch, options.inputs, inputStem), options.batch, options.common);
}

}  // namespace

const MeshFormat* sceneFormatOf(const fs::path& output) {
    std::error_code error;
    const std::string extension = lowerCase(output.extension().string());
    for (const MeshFormat& format : meshFormats()) {
        const bool isMeant =
            std::ranges::find(format.extensions, extension) != format.extensions.end();
        const bool isOne = holdsScene(format) || extension == ".stl";
        if (isMeant && isOne && !fs::is_directory(output, error)) return &format;
    }
    return nullptr;
}

int runLabels(const LabelsOptions& given) {
    if (given.isBatch()) return runLabelsBatch(given);
    LabelsOptions options = given;
    LabelsRun run(options, outputFolder(options));
    const MeshFormat* const scene = sceneFormatOf(options.output);
    run.isScene = run.leavesGiftiOut = scene != nullptr;
    run.format = scene != nullptr ? scene : &findMeshFormat("region" + options.format);
    run.frame = outputFrame(options.frame, *run.format);
    checkScale(options.scale, *run.format, options.frame);
    run.stage("read", [&] { findMasks(options, run); });
    checkOutputs(run);
    requireMesher(options.tetrahedra);

    std::optional<ReadVolume> behind;
    if (!options.volume.empty()) {
        behind = run.stage("read", [&] { return readOnlyImage(options.volume); });
    }
    LabelCensus census;
    const Volume volume = run.stage("read", [&] { return readMap(options, run, census); });
    const VolumeView& map = volume.view();
    run.stage("read", [&] { nameRegions(chooseLabels(census, run), census, run); });
    requireFittingLabels(run);
    checkConductivities(run);
    run.printNewWarnings();

    LabelComplex complex = run.stage("extract", [&] { return extract(map, run); });
    run.stage("fit", [&] { fitToFiles(complex, run); });
    run.stage("measure", [&] { measure(complex, run); });
    const RegionSurfaces surfaces(complex, labelsOf(run.regions));
    if (run.format->precision == CoordinatePrecision::Float64) {
        checkComplex(complex, surfaces, map, run);
    } else {
        const LabelComplex stored = asStored(complex, run);
        checkComplex(stored, RegionSurfaces(stored, labelsOf(run.regions)), map, run);
    }
    if (options.tetrahedra.isRequested() && run.holdsPromises()) {
        run.stage("tetrahedra", [&] { makeTetrahedra(complex, run); });
    }
    scaleFigures(run);
    warnOfCount(run);
    if (!run.leavesGiftiOut && !fitsGifti(run)) {
        run.warnings.push_back({"file-left-out",
                                "all.surf.gii is left out, as the surfaces have more points or "
                                "triangles than GIFTI counts",
                                baseName(options.input)});
    }

    std::optional<AtomicFolder> folder;
    if (run.writesFolder()) {
        run.stage("write", [&] {
            if (run.isScene) return writeSceneFile(surfaces, run);
            folder.emplace(run.folder, replaceable(options, run.folder));
            writeFiles(complex, surfaces, volume, run, *folder);
            folder->writeText("report.json", folderReport(run));
            run.files = folder->files();
        });
    }
    if (options.report.isWanted()) writePage(run, surfaces, behind ? behind->volume.view() : map);
    if (!run.holdsPromises()) {
        run.verdict = {kExitCheckFailed, baseName(options.input) +
                                             ": its walls do not keep their promises, so nothing "
                                             "was written: " +
                                             failureText(run)};
    }
    if (std::ranges::find(run.files, "all.vtm", [](const auto& file) { return file.first; }) !=
        run.files.end()) {
        run.next = "open " + shellQuoted((run.folder / "all.vtm").string()) + " in ParaView";
    } else if (run.isScene && run.writesFolder()) {
        run.next = "open " + shellQuoted(run.folder.string()) +
                   (run.format->holdsNormals ? " in Blender or another viewer of glTF"
                                             : " in a printer's slicer");
    }
    run.deliver([&] { return jsonReport(run); }, [&](std::ostream& out) { printReport(out, run); },
                folder ? &*folder : nullptr);
    return run.end(run.writesFolder() ? run.folder.string() + " is written"
                                      : "no surface is written");
}

}  // namespace adaptiso::labels
