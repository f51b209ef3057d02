#include <algorithm>
#include <string>
#include <vector>

#include "Common/CommonFrame.h"
#include "Common/OptionValues.h"
#include "Common/PreprocessingOptions.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Pipeline.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::mesher {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kPreprocessing = "Preprocessing (in this order)";
constexpr const char* kSurface = "Surface";
constexpr const char* kOutput = "Output";
constexpr const char* kPieces = "Pieces (of a closed surface)";

std::vector<IsovalueChoice> parseIsovalues(const std::vector<std::string>& texts) {
    std::vector<IsovalueChoice> choices;
    for (const std::string& text : texts) {
        IsovalueChoice choice;
        if (text != "auto") {
            choice.value = parseFiniteNumber(text);
            if (!choice.value) refuseValue("--iso", text, "a finite number, or auto");
        }
        if (std::find(choices.begin(), choices.end(), choice) != choices.end()) {
            throw UsageError("--iso " + text + ": given twice");
        }
        choices.push_back(choice);
    }
    return choices;
}

/// Checks options that make no surface.
void checkLookingOnly(const MeshOptions& options) {
    if (options.image.showsPhi && !options.image.listsSeries && !options.image.tellsInfo) {
        throw UsageError("--show-phi: is for --list-series and --info");
    }
    if (options.image.tellsInfo && (!options.isovalues.empty() || !options.output.empty())) {
        throw UsageError("--info: makes no surface, so not with --iso, -o");
    }
}

/// Checks options against each other.
void checkCombinations(const MeshOptions& options) {
    if (options.inputs.empty() && options.batch.list.empty()) {
        throw UsageError("INPUT is missing: the image to make surfaces of");
    }
    refuseOutputAsInput(options.inputs, options.output, options.batch);
    checkLookingOnly(options);
    if (options.isovalues.empty() && !options.image.listsSeries && !options.image.tellsInfo) {
        throw UsageError(
            "--iso is missing: a value of the image (--info shows its range), or auto");
    }
    if (options.index.border == Border::Open && options.needsClosedSurfaces()) {
        throw UsageError(
            "--min-volume and --fill-cavities need closed surfaces, not --border open");
    }
    if (options.extraction.discretized.adjustVertices &&
        options.extraction.method != Method::DiscretizedMarchingCubes) {
        throw UsageError(
            "--adjust-vertices: is for --method dmc; no other method has its vertices at "
            "midpoints");
    }
    const bool isForAdaptive =
        !(options.extraction.adaptive == AdaptiveOptions{}) || options.verifies;
    if (isForAdaptive && options.extraction.method != Method::Adaptive) {
        throw UsageError(namesOf(aimOptions(AimedSurface::OfScan)) +
                         " and --verify are for --method adaptive");
    }
    requireOneCount(options.extraction.adaptive);
    if (options.extraction.discretized.mergeWithinBlocks &&
        options.extraction.method != Method::DiscretizedMarchingCubes) {
        throw UsageError(
            "--merge-within-blocks: is for --method dmc; no other method can merge within blocks");
    }
}

void declareInput(CLI::App& app, MeshOptions& options) {
    OptionGroup(app).text(
        "INPUT", "", options.inputs,
        "A 3-D image: NIfTI, NRRD, MetaImage, MGH, a DICOM file or DICOMDIR, MINC and others by "
        "ITK's readers, or a folder that holds the slices of a DICOM series, an OME-Zarr or N5; "
        "several make a batch");
    declareImageOptions(app, options.image, kInput);
    declarePreprocessingOptions(app, options.preprocessing, kPreprocessing);
}

void declareSurface(CLI::App& app, MeshOptions& options) {
    const OptionGroup surface(app, kSurface);
    surface.values(
        "--iso", "V|auto",
        [&options](const std::vector<std::string>& texts) {
            options.isovalues = parseIsovalues(texts);
        },
        "The isovalue: inside is where the image is >= V; auto lets Otsu's method choose. "
        "Give it several times for several surfaces");
    surface.rows(methodOptions(), options.extraction);
    surface.rows(aimOptions(AimedSurface::OfScan), options.extraction.adaptive);
    surface.flag(
        "--verify", options.verifies,
        "Method adaptive: also check the result against the surface of mc, by other "
        "code than made it: crossings, pieces, their orientation, genus and sampled distance "
        "of the file's points. Takes long");
    surface.rows(discretizedOptions(), options.extraction.discretized);
    surface.rows(indexOptions(), options.index);
    OptionGroup(app, kPieces).rows(pieceOptions(), options.selection);
}

void declareOutput(CLI::App& app, MeshOptions& options) {
    const OptionGroup output(app, kOutput);
    output.text(
        "-o,--output", "OUT", options.output,
        "The file to write, or a folder (default: <INPUT>-iso<V>.vtp in the current one). {iso} in "
        "its name stands for the isovalue, to five digits where these tell it from the others, "
        "{isolabel} for all of it in letters and digits (411p5, m300); without them, several "
        "surfaces get -iso<V> before the extension. The "
        "format follows from the extension: " +
            meshExtensions());
    declareCoordinates(output, options.frame,
                       "The points' frame: scanner RAS mm (default), scanner LPS mm, "
                       "FreeSurfer's surface RAS mm (default for its formats), or voxel "
                       "indices");
    output.rows(scaleOptions(), options.scale);
    output.flag(
        "--no-check-crossings", [&options] { options.checksCrossings = false; },
        "Do not count the pairs of triangles that cross each other. The method adaptive makes "
        "none and counts none, whether given or not");
    declareReportOptions(app, options.report, kOutput);
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-mesh brain.nii.gz --iso 100
      writes brain-iso100.vtp into the current folder
  adaptiso-mesh head.nrrd --iso auto --largest --fill-cavities -o head.stl
  adaptiso-mesh ct/ --iso -300 --iso 250 -o 'ct-{iso}.ply' --json report.json
      one DICOM series, skin and bone, from one reading
  adaptiso-mesh study/ --list-series
      what a DICOM folder holds
  adaptiso-mesh head.nii.gz --info
      geometry, range, percentiles, histogram, and isovalues to try
  adaptiso-mesh ct/ --iso 250 --crop :,:,40: --smooth 0.7 --resample 1
  adaptiso-mesh T1.mgz --iso 90 -o lh.pial
      a FreeSurfer surface in tkRAS
  adaptiso-mesh *.nii.gz --iso auto -o '{name}.stl' --output-dir meshes --jobs 4
      each image a run of its own; with --skip-existing it goes on where it was
      interrupted

Exit codes: 0 done, 1 one or more of many inputs failed, or a warning with
--strict, 2 wrong usage, 3 bad input (or no memory or disk left), 4 internal
error. When it is not 0, no file was written (of many inputs: no mesh of those
that failed; with --strict: none but reports).)";

Program meshProgram() {
    return {"adaptiso-mesh",
            "Makes adaptive, watertight triangle meshes of isosurfaces from MRI and CT images.",
            kFooter};
}

void declareMeshOptions(CLI::App& app, MeshOptions& options) {
    declareInput(app, options);
    declareSurface(app, options);
    declareOutput(app, options);
    declareBatchOptions(app, options.batch);
    declareCommonOptions(app, options.common, "no surface is then written, reports are");
    afterParsing(app, [&app, &options] {
        if (!options.inputs.empty()) options.input = options.inputs.front();
        checkCombinations(options);
        requirePlaceholders("--output", options.output.filename(),
                            {"{iso}", "{isolabel}", "{name}"});
        checkPlaceholders({{"--output", options.output.parent_path()},
                           {"--report", options.report.page},
                           {"--pictures", options.report.pictures}},
                          options.batch, options.common);
        if (options.isBatch() || options.image.tellsInfo) keepRunOptions(app, options.batch);
        if (options.isBatch()) takeFolder(options.output, options.batch);
    });
}

}  // namespace
}  // namespace adaptiso::mesher

int main(int argc, char** argv) {
    adaptiso::keepFreedMemory();
    return adaptiso::runApp(argc, argv, adaptiso::mesher::meshProgram(),
                            adaptiso::mesher::declareMeshOptions, adaptiso::mesher::runMesh);
}
