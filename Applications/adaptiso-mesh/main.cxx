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
    checkLookingOnly(options);
    if (options.isovalues.empty() && !options.image.listsSeries && !options.image.tellsInfo) {
        throw UsageError(
            "--iso is missing: a value of the image (--info shows its range), or auto");
    }
    if (options.index.border == Border::Open && options.needsClosedSurfaces()) {
        throw UsageError(
            "--min-volume and --fill-cavities need closed surfaces, not --border open");
    }
    if (options.adjustVertices && options.method != Method::DiscretizedMarchingCubes) {
        throw UsageError(
            "--adjust-vertices: is for --method dmc; no other method has its vertices at "
            "midpoints");
    }
    const bool isForAdaptive = !(options.adaptive == AdaptiveOptions{}) || options.verifies;
    if (isForAdaptive && options.method != Method::Adaptive) {
        throw UsageError(
            "--max-error, --triangles, --reduction, --min-angle and --verify are for --method "
            "adaptive");
    }
    if (options.adaptive.maxTriangles && options.adaptive.reduction) {
        throw UsageError("--triangles and --reduction: are two ways to ask for one count");
    }
    if (options.mergeWithinBlocks && options.method != Method::DiscretizedMarchingCubes) {
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

void declareAdaptive(CLI::App& app, AdaptiveOptions& options) {
    const OptionGroup surface(app, kSurface);
    surface.number(
        "--max-error", "MM", options.maxErrorMm, {.least = 0, .isAbove = true, .unit = "mm"},
        "Method adaptive: no point of the surface of mc is farther than MM (a number above "
        "0) from the mesh, nor the other way round (default, unless a count is given: 0.15 "
        "of the least distance between planes of voxels)");
    surface.count("--triangles", options.maxTriangles, 0, kAnyCount,
                  "Method adaptive: simplify to N triangles, as close to the surface as the method "
                  "gets; of the pieces that are kept");
    surface.number("--reduction", "F", options.reduction, {.least = 0, .most = 1},
                   "Method adaptive: the share F of mc's triangles to drop, 0 to 1");
    surface.number("--min-angle", "DEG", options.minAngleDeg,
                   {.least = 0, .most = 40, .unit = "degrees"},
                   "Method adaptive: make no new angle below DEG, 0 to 40, at the price of more "
                   "triangles (default: 0)");
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
    surface.choice<Method>(
        "--method", options.method,
        {{"adaptive", Method::Adaptive},
         {"boxes", Method::Boxes},
         {"dmc", Method::DiscretizedMarchingCubes},
         {"asc", Method::SkeletonClimbing},
         {"mc", Method::MarchingCubes}},
        "adaptive: few triangles within a stated distance of the surface, none "
        "crossing another (default); "
        "boxes: cubes of several sizes, merged where the surface is flat; "
        "dmc: discretized marching cubes, coplanar facets between edge midpoints "
        "merged; "
        "asc: adaptive skeleton climbing, rectangular boxes, unmerged; "
        "mc: marching cubes, every voxel at full resolution");
    declareAdaptive(app, options.adaptive);
    surface.flag(
        "--verify", options.verifies,
        "Method adaptive: also check the result against the surface of mc, by other "
        "code than made it: crossings, pieces, their orientation, genus and sampled distance "
        "of the file's points. Takes long");
    surface.flag("--adjust-vertices", options.adjustVertices,
                 "Move the vertices of the method dmc from the midpoints to where the image "
                 "reaches the isovalue");
    surface.flag("--merge-within-blocks", options.mergeWithinBlocks,
                 "Merge facets of the method dmc within blocks of --block-size voxels only");
    surface.choice<int>(
        "--block-size", options.index.blockSize, {{"2", 2}, {"4", 4}, {"8", 8}, {"16", 16}},
        "Voxels a side of the index's blocks, and of the largest box of the methods boxes "
        "and asc (default: 4)");
    surface.choice<Border>(
        "--border", options.index.border, {{"closed", Border::Closed}, {"open", Border::Open}},
        "Where a surface meets the border of the image: closed there (default), or "
        "left open");
    surface.choice<BlockSearchKind>("--search", options.index.search,
                                    {{"kdtree", BlockSearchKind::KdTree},
                                     {"octree", BlockSearchKind::Octree},
                                     {"linear", BlockSearchKind::Linear}},
                                    "How the blocks that a surface touches are found: kd-tree over "
                                    "their minima and maxima (default), octree, or a look at every "
                                    "block. The surface is the same");
}

void declarePieces(CLI::App& app, MeshOptions& options) {
    const OptionGroup pieces(app, kPieces);
    pieces.flag("--fill-cavities", options.selection.fillCavities,
                "Drop inner surfaces, and all that lies inside them");
    pieces.number(
        "--min-volume", "MM3", options.selection.minVolumeMm3, {.least = 0, .unit = "mm3"},
        "Drop pieces with less than MM3 cubic millimetres of material, fill cavities with "
        "less");
    pieces.flag("--largest", options.selection.largestOnly,
                "Keep the piece with the most material only (with --border open: the largest "
                "area)");
}

void declareOutput(CLI::App& app, MeshOptions& options) {
    const OptionGroup output(app, kOutput);
    output.text(
        "-o,--output", "OUT", options.output,
        "The file to write (default: <INPUT>-iso<V>.vtp in the current folder). {iso} in "
        "its name stands for the isovalue, {isolabel} for the same in letters and digits "
        "(411p5, m300); without them, several surfaces get -iso<V> before the extension. The "
        "format follows from the extension: " +
            meshExtensions());
    declareCoordinates(output, options.frame,
                       "The points' frame: scanner RAS mm (default), scanner LPS mm, "
                       "FreeSurfer's surface RAS mm (default for its formats), or voxel "
                       "indices");
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
    declarePieces(app, options);
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
    });
}

}  // namespace
}  // namespace adaptiso::mesher

int main(int argc, char** argv) {
    adaptiso::keepFreedMemory();
    return adaptiso::runApp(argc, argv, adaptiso::mesher::meshProgram(),
                            adaptiso::mesher::declareMeshOptions, adaptiso::mesher::runMesh);
}
