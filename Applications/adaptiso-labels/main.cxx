#include <algorithm>
#include <string>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/Naming.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Pipeline.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::labels {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kRegions = "Regions";
constexpr const char* kWalls = "Walls";
constexpr const char* kTetrahedra = "Tetrahedra";
constexpr const char* kOutput = "Output";

/// The extensions of the formats, all or one of each, without the dot.
std::vector<std::string> formatWords(bool areAll) {
    std::vector<std::string> words;
    for (const MeshFormat& format : meshFormats()) {
        for (const auto extension :
             format.extensions.first(areAll ? format.extensions.size() : 1)) {
            words.emplace_back(extension.substr(1));
        }
    }
    return words;
}

/// "stl" or ".stl" as ".stl". \throws UsageError
std::string parseFormat(std::string text) {
    text = lowerCase(text);
    if (text.starts_with('.')) text.erase(0, 1);
    const std::vector<std::string> known = formatWords(true);
    return "." + known[parseChoice("--format", text, known)];
}

/// Checks options against each other.
void checkCombinations(const LabelsOptions& options) {
    if (options.inputs.empty() && options.batch.list.empty()) {
        throw UsageError("SEG is missing: the label map to make surfaces of");
    }
    refuseOutputAsInput(options.inputs, options.output, options.batch);
    if (!options.volume.empty() && !options.report.isWanted()) {
        throw UsageError("--volume: is shown on the page; it needs --report or --pictures");
    }
    requireOneCount(options.aims);
    if (options.writesLayers && !options.labels.empty()) {
        throw UsageError(
            "--layers: needs all regions, as each wall lies between two of them; "
            "--merge joins those of no interest");
    }
    if (options.writesLayers && options.frame == CoordinateFrame::Voxel) {
        throw UsageError("--coordinates voxel: --layers are in mm only");
    }
    if (!options.conductivities.empty() && !options.writesLayers) {
        throw UsageError("--conductivities: are written with --layers");
    }
    if (options.joinsMasks && options.batch.isRequested()) {
        throw UsageError(
            "--join: makes one map of all INPUTs; many maps of masks are folders of a batch");
    }
    if (options.inputs.size() > 1 && !options.joinsMasks && !options.output.empty() &&
        !holdsName(options.output)) {
        throw UsageError("--output " + options.output.string() +
                         ": several INPUTs make a folder each, -o '{name}-labels'; or with --join "
                         "one map of masks");
    }
    if (options.joinsMasks && options.output.empty()) {
        throw UsageError("--join: needs -o DIR, as no input names the map");
    }
    if (options.joinsSegments &&
        (options.joinsMasks || options.read.series || options.read.volumeIndex)) {
        throw UsageError(
            "--segments all: takes all of one input, so not with --join, --series or "
            "--volume-index");
    }
    if (options.joinsSegments && !options.names.empty()) {
        throw UsageError(
            "--segments all: segments bring their names and numbers; leave --names out");
    }
    requireDisjoint(options.merges);
    const std::filesystem::path& output = options.output;
    const std::string extension = output.extension().string();
    if (sceneFormatOf(output) != nullptr) {
        const std::pair<bool, const char*> folders[] = {
            {options.format != LabelsOptions().format, "--format"},
            {options.namesFiles, "--file-names"},
            {options.writesMap, "--write-map"},
            {options.writesLayers, "--layers"},
            {options.tetrahedra.isRequested(), "--tetrahedra"}};
        for (const auto& [isGiven, option] : folders) {
            if (!isGiven) continue;
            throw UsageError(std::string(option) + ": is for a folder, and -o " + output.string() +
                             " is one file of all regions; give -o " +
                             shellQuoted((output.parent_path() / output.stem()).string()));
        }
    } else {
        if (options.scale.isWanted()) {
            throw UsageError("--scale, --fit: are for one file of all regions; give -o body.3mf");
        }
        requireFolderName("--output", output,
                          "give -o " +
                              shellQuoted((output.parent_path() / output.stem()).string()) +
                              (extension.empty() ? "" : " --format " + extension.substr(1)));
    }
    checkPlaceholders({{"--output", options.output},
                       {"--report", options.report.page},
                       {"--pictures", options.report.pictures}},
                      options.batch, options.common);
}

void declareInput(CLI::App& app, LabelsOptions& options) {
    const OptionGroup input(app, kInput);
    OptionGroup(app).text(
        "INPUT", "", options.inputs,
        "A 3-D label map (SEG): NIfTI, NRRD, MetaImage, MGH, or a DICOM series, of whole "
        "numbers, 0 where no region is; or a folder of masks, a file for each region; several "
        "make a batch");
    declareReadOptions(app, options.read, kInput);
    input.flag("--join", options.joinsMasks,
               "Take the INPUTs for masks of one map, each a region, in place of a batch");
    input.value(
        "--segments", "all",
        [&options](const std::string& text) {
            parseChoice("--segments", text, {"all"});
            options.joinsSegments = true;
        },
        "Take all segments of a DICOM segmentation, or all layers of a 3D Slicer .seg.nrrd, for "
        "masks of one map");
    input.value(
        "--priority", "FILE|largest|smallest",
        [&options](const std::string& text) { options.priority = PriorityOption::parse(text); },
        "Which mask keeps a voxel that several hold: the first of those that FILE names, a name a "
        "line, or the largest, or the smallest (default: the last by name)");
    input.flag("--any-map", options.takesAnyMap,
               "Take the image for a label map even if its values change from voxel to voxel, as "
               "those of a scan do");
    input.text("--names", "FILE", options.names,
               "A table of names and colours (" + labelTableNames() +
                   "), recognised by content (default: what lies beside "
                   "the image under its name, or is its BIDS dataset's, or is in the image: 3D "
                   "Slicer's segments, the LabelTable of a NIfTI extension)");
}

void declareRegions(CLI::App& app, LabelsOptions& options) {
    const OptionGroup regions(app, kRegions);
    regions.value(
        "--labels", "LIST",
        [&options](const std::string& text) {
            options.labels = parseLabelRanges("--labels", text);
        },
        "Write these regions only, by number or name, 1,Hippocampus_L,10-20, or 'rib_*'; time and "
        "memory go with their walls");
    regions.values(
        "--merge", "NAME=LIST",
        [&options](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
                options.merges.push_back(parseLabelMerge(text));
            }
        },
        "Take several labels, numbers or names, for one region, Thalamus=10,49, or 'lung=lung_*', "
        "that goes by "
        "the "
        "first of them; "
        "may be given several times");
}

void declareLayers(CLI::App& app, LabelsOptions& options) {
    const OptionGroup output(app, kOutput);
    output.flag("--layers", options.writesLayers,
                "Write the walls for OpenMEEG too: layers/layers.geom (Domain Description 1.1 with "
                "meshes and signed interfaces), a .tri for each pair of labels that touch, in mm");
    output.value(
        "--conductivities", "LIST",
        [&options](const std::string& text) { options.conductivities = parseConductivities(text); },
        "With --layers: S/m of every region, 1=0.33,2=0.0066, for layers/layers.cond");
}

void declareOutput(CLI::App& app, LabelsOptions& options) {
    const OptionGroup output(app, kOutput);
    output.text("-o,--output", "DIR", options.output,
                "The folder to write, whole or not at all (default: <INPUT>-labels in the "
                "current folder); a file .glb or .3mf: all regions in it, with names and colours; "
                ".stl: without");
    output.flag("--force", options.mayReplace,
                "Replace a folder that this program wrote; one that holds other files is not");
    output.value(
        "--format", choiceName(formatWords(false)),
        [&options](const std::string& text) { options.format = parseFormat(text); },
        "The format of the regions' files (default: vtp)");
    output.flag("--write-map", options.writesMap,
                "Write the label map too, as map.nii.gz: of masks as they were joined, of merged "
                "labels as they were merged");
    output.value(
        "--file-names", choiceName({"number", "name"}),
        [&options](const std::string& text) {
            options.namesFiles = parseChoice("--file-names", text, {"number", "name"}) == 1;
        },
        "The regions' files go by their labels, regions/17.vtp (default), or by their names, "
        "regions/Hippocampus_L.vtp");
    declareCoordinates(output, options.frame,
                       "The points' frame in all files: scanner RAS mm (default), scanner "
                       "LPS mm, FreeSurfer's surface RAS mm (default with --format surf), "
                       "or voxel indices");
    output.rows(scaleOptions(), options.scale);
    declareReportOptions(app, options.report, kOutput);
    output.text("--volume", "IMG", options.volume,
                "With --report: the image to show behind the regions (default: the label map)");
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-labels aseg.mgz -o aseg
      walls.vtp, regions/<label>.vtp, all.vtm, all.surf.gii and all.label.gii,
      regions.tsv and report.json in the folder aseg
  adaptiso-labels aal.nii.gz --max-error 0.3 --report aal.html --volume T1.nii.gz
      names and colours from aal.nii.txt and aal.nii.lut beside it
  adaptiso-labels seg.nrrd --names Colors.ctbl --labels 1,2,10-20 --format stl -o seg
  adaptiso-labels aseg.mgz --merge Thalamus=10,49 --merge Putamen=12,51 -o deep
  adaptiso-labels seg.nii.gz --tetrahedra tetgen --element-size 3 -o volumes
      every region in tetrahedra as well, for finite elements
  adaptiso-labels seg.nii.gz --max-error 0 -o full
      the full resolution, which the bound is measured against
  adaptiso-labels head.nii.gz --layers --conductivities 1=0.33,2=0.0066,3=0.33
      the walls for OpenMEEG as well, in the folder layers
  adaptiso-labels masks -o body --write-map
      a folder of masks, a file for each region, joined to one map
  adaptiso-labels totalseg.nii.gz -o body.glb
      one file of all regions with names and colours, for viewers and slides;
      body.3mf (body.stl) for printers
  adaptiso-labels *_dseg.nii.gz --output-dir surfaces --skip-existing
      each image a run of its own

Exit codes: 0 done, 1 the walls do not keep what is promised of them, one or
more of many inputs failed, or a warning with --strict, 2 wrong usage, 3 bad
input (or no memory or disk left), 4 internal error. When it is not 0, no
folder was written (of many inputs: none of those that failed).)";

Program labelsProgram() {
    return {"adaptiso-labels",
            "Makes surfaces of all regions of a segmentation: neighbours share one wall, and no "
            "two cross.",
            kFooter};
}

void declareLabelsOptions(CLI::App& app, LabelsOptions& options) {
    declareInput(app, options);
    declareRegions(app, options);
    OptionGroup(app, kWalls).rows(aimOptions(AimedSurface::Walls), options.aims);
    declareMesherOptions(app, options.tetrahedra,
                         "tetrahedra.msh, tetrahedra-4.1.msh, tetrahedra.vtu and tetrahedra.dgf",
                         kTetrahedra);
    declareOutput(app, options);
    declareLayers(app, options);
    declareBatchOptions(app, options.batch);
    declareCommonOptions(app, options.common, "no folder is then written, reports are");
    afterParsing(app, [&app, &options] {
        if (!options.inputs.empty()) options.input = options.inputs.front();
        checkCombinations(options);
        if (options.isBatch()) keepRunOptions(app, options.batch);
    });
}

}  // namespace
}  // namespace adaptiso::labels

int main(int argc, char** argv) {
    adaptiso::keepFreedMemory();
    return adaptiso::runApp(argc, argv, adaptiso::labels::labelsProgram(),
                            adaptiso::labels::declareLabelsOptions, adaptiso::labels::runLabels);
}
