#include "Pipeline.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "CheckComplex.h"
#include "Common/AtomicOutput.h"
#include "Common/ExitCodes.h"
#include "Common/ImageOptions.h"
#include "Common/InputNames.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/Numbers.h"
#include "Common/Progress.h"
#include "Common/ResultOutput.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "FileRounding.h"
#include "JsonReport.h"
#include "LabelMap.h"
#include "LabelsBatch.h"
#include "LabelsRun.h"
#include "OutputFiles.h"
#include "Regions.h"
#include "ReportPage.h"
#include "Tetrahedra.h"
#include "TextReport.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "adaptiso-labels";

/// The stages of a run, as progress, `seconds` of the report and README.md name them, beside those
/// of checkComplex().
constexpr const char* kRead = "read";
constexpr const char* kExtract = "extract";
constexpr const char* kFit = "fit";
constexpr const char* kMeasure = "measure";
constexpr const char* kTetrahedra = "tetrahedra";
constexpr const char* kWrite = "write";
constexpr const char* kReport = "report";

fs::path outputFolder(const LabelsOptions& options) {
    return options.output.empty() ? fs::path(inputStem(options.input) + "-labels") : options.output;
}

/// The regions' files of a run before, which may have their names.
std::set<std::string, std::less<>> earlierRegionFiles(const fs::path& folder) {
    std::set<std::string, std::less<>> files;
    std::ifstream stream(folder / "report.json");
    const Json report = Json::parse(stream, nullptr, false);
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

CoordinateFrame frameOf(const LabelsOptions& options, const MeshFormat& format) {
    const CoordinateFrame frame = options.frame.value_or(defaultFrame(format));
    if (frame == CoordinateFrame::Voxel && !format.holdsVoxelFrame) {
        throw UsageError("--coordinates voxel: " + std::string(format.name) +
                         " holds points in mm only");
    }
    return frame;
}

bool hasJsonFile(const LabelsOptions& options) {
    return options.common.wantsJson() && !options.common.wantsJsonOnStdout();
}

/// Everything about the outputs that can be told before the map is read.
void checkOutputs(const LabelsRun& run) {
    const LabelsOptions& options = run.options;
    std::vector<fs::path> inputs;
    for (const fs::path& input : {options.input, options.names, options.volume}) {
        if (!input.empty()) inputs.push_back(input);
    }
    const auto canonical = [](const fs::path& path) {
        std::error_code error;
        return fs::weakly_canonical(fs::absolute(path), error);
    };
    fs::path folder = canonical(run.folder);
    if (!folder.has_filename()) folder = folder.parent_path();
    for (const fs::path& input : inputs) {
        if (hasJsonFile(options)) checkNotInput(options.common.json, input);
        // replacing the folder would take an input in it away
        if (canonical(input).parent_path() == folder || canonical(input) == folder) {
            throw FileError(run.folder.string() + ": holds an input, which is never overwritten");
        }
    }
    if (hasJsonFile(options)) checkOutput(options.common.json);
    checkReportOutputs(options.report, inputs);
    AtomicFolder::check(run.folder, replaceable(options, run.folder));
}

/// Labels of a merge that the map has not.
void warnOfMissing(const LabelMerge& merge, const LabelCensus& census, const std::string& name,
                   LabelsRun& run) {
    std::string missing;
    bool isThere = false;
    for (const LabelRange& range : merge.labels) {
        const auto first = census.voxels.lower_bound(range.first);
        if (first != census.voxels.end() && first->first <= range.last) {
            isThere = true;
        } else {
            missing += (missing.empty() ? "" : ", ") + toText(range);
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

/// Reads the map and learns what it holds.
/// \throws InvalidInput  it is no label map, or holds nothing but 0
/// \param options  the run's; names in them become labels
Volume readMap(LabelsOptions& options, LabelsRun& run, LabelCensus& census) {
    const std::string name = baseName(options.input);
    ReadVolume read = readImage(options.input, options.read);
    resolveNames(options);
    const VolumeView& view = read.volume.view();
    run.map = {read.format, view.geometry(), view.pixelType(), valueRange(view), read.warnings, 0};
    addWarnings(run.warnings, read.warnings, name);
    census = naming(name, [&] { return countLabels(view); });
    run.map.labels = std::ssize(census.voxels);
    if (census.voxels.empty()) {
        throw InvalidInput(name + ": holds no label: all voxels are 0");
    }
    if (census.looksLikeAnImage() && !options.takesAnyMap) {
        throw InvalidInput(
            name + ": is an image, no label map: it has " + formatCount(run.map.labels) +
            " values, which change nearly from voxel to voxel (" +
            formatFixed(census.medianRun, 2) + " in a row); --any-map takes it all the same");
    }
    for (const LabelMerge& merge : options.merges) warnOfMissing(merge, census, name, run);
    census = mergeCounts(std::move(census), options.merges);
    return mergeLabels(std::move(read.volume), options.merges);
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

LabelComplex extract(const VolumeView& map, LabelsRun& run, ProgressLine& progress) {
    const LabelsOptions& options = run.options;
    LabelOptions extraction;
    extraction.maxErrorMm = options.maxErrorMm;
    extraction.maxTriangles = options.maxTriangles;
    extraction.reduction = options.reduction;
    extraction.minAngleDeg = options.minAngleDeg;
    extraction.progress = progress.callback();
    if (!options.labels.empty()) {
        for (const Region& region : run.regions) extraction.labels.push_back(region.label);
    }
    LabelResult result =
        naming(baseName(options.input), [&] { return extractLabels(map, extraction); });
    run.statistics = result.statistics;
    run.points = std::ssize(result.complex.points);
    run.triangles = std::ssize(result.complex.triangles);
    return std::move(result.complex);
}

void measure(const LabelComplex& complex, LabelsRun& run) {
    std::vector<Label> labels;
    for (const Region& region : run.regions) labels.push_back(region.label);
    for (RegionMeasure& measure : measureRegions(complex, labels)) {
        const auto region =
            std::ranges::lower_bound(run.regions, measure.label, {}, &Region::label);
        if (region != run.regions.end() && region->label == measure.label) {
            region->measure = std::move(measure);
        }
    }
}

/// Where a count could not be met. With --max-error as well the bound may end it before: that was
/// asked for.
void warnOfCount(LabelsRun& run) {
    const std::optional<std::int64_t>& wanted = run.statistics.wantedTriangles;
    const std::int64_t triangles = run.statistics.mapTriangles;
    if (!wanted || triangles <= *wanted || run.options.maxErrorMm) return;
    run.warnings.push_back(countMissed(
        baseName(run.options.input), "triangles in its walls", triangles, *wanted,
        std::string("all regions, pieces and junctions") +
            (run.isPart() ? " of the whole map (a count is of all of it, also with --labels)" : ""),
        run.errorBoundMm()));
}

std::string failureText(const LabelsRun& run) {
    std::string text;
    for (const LabelsCheck& check : run.checks) {
        if (check.isPassed) continue;
        text += (text.empty() ? "" : "; ") + check.name + ": " + check.finding;
    }
    return text;
}

/// Writes the page, where one is asked for.
ReportResult show(LabelsRun& run, const RegionSurfaces& surfaces, const VolumeView& map,
                  std::vector<AtomicOutput>& outputs) {
    const LabelsOptions& options = run.options;
    if (!options.report.isWanted()) return {};
    std::optional<ReadVolume> behind;
    if (!options.volume.empty()) behind = readImage(options.volume, {});
    const fs::path& file = options.volume.empty() ? options.input : options.volume;
    ReportResult page = writeReport(
        [&] {
            return makeReport(run, surfaces, baseName(file), behind ? behind->volume.view() : map);
        },
        kProgram, options.report, outputs);
    return page;
}

}  // namespace

int runLabels(const LabelsOptions& given) {
    if (given.isBatch()) return runLabelsBatch(given);
    LabelsOptions options = given;
    const ThreadLimit threads(options.common);
    ProgressLine progress(options.common.isQuiet);
    LabelsRun run{options, outputFolder(options)};
    run.format = &findMeshFormat("region" + options.format);
    run.frame = frameOf(options, *run.format);
    checkOutputs(run);
    requireMesher(options.tetrahedra);

    progress.show(kRead);
    LabelCensus census;
    const Volume volume = run.timer.time(kRead, [&] { return readMap(options, run, census); });
    const VolumeView& map = volume.view();
    run.timer.time(kRead, [&] { nameRegions(chooseLabels(census, options), census, run); });
    requireTetrahedraLabels(run);
    checkConductivities(run);
    progress.clear();
    printWarnings(kProgram, options.common, run.warnings);
    const std::size_t told = run.warnings.size();

    LabelComplex complex = run.timer.time(kExtract, [&] { return extract(map, run, progress); });
    run.timer.time(kFit, [&] { fitToFiles(complex, run); });
    progress.show(kMeasure);
    run.timer.time(kMeasure, [&] { measure(complex, run); });
    const RegionSurfaces surfaces(complex, run.regions);
    if (run.format->precision == CoordinatePrecision::Float64) {
        checkComplex(complex, surfaces, map, run, progress);
    } else {
        const LabelComplex stored = asStored(complex, run);
        checkComplex(stored, RegionSurfaces(stored, run.regions), map, run, progress);
    }
    if (options.tetrahedra.isAsked() && run.holdsPromises()) {
        progress.show(kTetrahedra);
        run.timer.time(kTetrahedra, [&] { makeTetrahedra(complex, run); });
    }
    warnOfCount(run);
    if (!run.leavesGiftiOut && !fitsGifti(run)) {
        run.warnings.push_back({"file-left-out",
                                "all.surf.gii is left out, as the surfaces have more points or "
                                "triangles than GIFTI counts",
                                baseName(options.input)});
    }

    ReportResult page;  // its folder goes, if empty, after what lies in it
    std::vector<AtomicOutput> outputs;
    std::optional<AtomicFolder> folder;
    if (run.writesFolder()) {
        progress.show(kWrite);
        run.timer.time(kWrite, [&] {
            folder.emplace(run.folder, replaceable(options, run.folder));
            writeFiles(complex, surfaces, run, *folder);
            folder->writeText("report.json", folderReport(run));
            run.files = folder->files();
        });
    }
    if (options.report.isWanted()) progress.show(kReport);
    page = run.timer.time(kReport, [&] { return show(run, surfaces, map, outputs); });
    run.verdict.failStrict(options.common, run.warnings, kNotWritten);
    if (!run.holdsPromises()) {
        run.verdict = {kExitCheckFailed, baseName(options.input) +
                                             ": its walls do not keep their promises, so nothing "
                                             "was written: " +
                                             failureText(run)};
    }
    run.verdict.failReport(page.failure);
    const std::string json = options.common.wantsJson() ? jsonReport(run) : "";
    if (hasJsonFile(options)) outputs.emplace_back(options.common.json).writeText(json);
    progress.clear();
    printWarnings(kProgram, options.common, std::span(run.warnings).subspan(told));
    printResults(options.common, json, [&](std::ostream& out) { printReport(out, run); });
    if (folder) {
        folder->commit(outputs);
    } else {
        AtomicOutput::commit(outputs);
    }
    const std::string written =
        run.writesFolder() ? run.folder.string() + " is written" : "no surface is written";
    return printVerdict(kProgram, run.verdict, written);
}

}  // namespace adaptiso
