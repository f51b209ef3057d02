
#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

namespace adaptiso::compare {
namespace {

constexpr const char* kDistances = "Distances";
constexpr const char* kOutput = "Output";
constexpr const char* kChecks = "Checks (exit code 1 when one fails)";

void declareInput(CLI::App& app, CompareOptions& options) {
    required(OptionGroup(app).text("A", "", options.a,
                                   "A triangle surface, in any format adaptiso-mesh writes"));
    required(
        OptionGroup(app).text("B", "", options.b, "The surface to compare it with: the reference"));
    declareInputCoordinates(OptionGroup(app), options.inputCoordinates,
                            "both surfaces; given twice, that of A and that of B");
}

void declareDistances(CLI::App& app, CompareOptions& options) {
    const OptionGroup distances(app, kDistances);
    constexpr std::int64_t kMaxSamples = 1'000'000'000;
    distances.count("--samples", options.samples, 1, kMaxSamples,
                    "Points laid on a surface, evenly over its area, for each direction (default: "
                    "200000)");
    CLI::Option* const symmetric = distances.flag(
        "--symmetric", [&options] { options.isSymmetric = true; },
        "From A to B and from B to A (default)");
    excludeEachOther(symmetric, distances.flag(
                                    "--one-sided", [&options] { options.isSymmetric = false; },
                                    "From A to B only"));
    CLI::Option* const voxel = distances.number("--voxel", "MM", options.voxelMm,
                                                {.least = 0, .isAbove = true, .unit = "mm"},
                                                "Give distances in voxels of this size as well");
    excludeEachOther(
        voxel,
        declareVolume(app, options.volume, options.read,
                      "The image that the surfaces were made from: gives distances in its voxels, "
                      "the overlap (Dice) on its grid, and a place to tkRAS and voxel coordinates",
                      kDistances));
}

void declareChecks(CLI::App& app, CompareOptions& options) {
    const OptionGroup checks(app, kChecks);
    const NumberRule length{.least = 0, .unit = "mm"};
    checks.number("--max-mean", "MM", options.maxMeanMm, length,
                  "Largest mean distance that passes");
    checks.number("--max-hausdorff", "MM", options.maxHausdorffMm, length,
                  "Largest Hausdorff distance that passes: no point may lie farther, which is "
                  "proved. The distance is known to a thousandth of itself or a millionth of the "
                  "surfaces' size, whichever is more");
}

void declareOutput(CLI::App& app, CompareOptions& options) {
    const OptionGroup output(app, kOutput);
    output.text("--colored", "OUT.vtp", options.colored,
                "Write A with the distance of every vertex to B, and its colour (viridis from "
                "0 to the largest)");
    declareReportOptions(app, options.report, kOutput);
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-compare adaptive.vtp reference.ply
  adaptiso-compare a.stl b.stl --volume head.nii.gz --json report.json
  adaptiso-compare lh.pial lh.vtp --colored difference.vtp
  adaptiso-compare new.vtp old.vtp --quiet --max-mean 0.1 --max-hausdorff 1

Exit codes: 0 done, 1 a check failed, or a warning with --strict, 2 wrong usage,
3 bad input (or no memory or disk left), 4 internal error. When it is above 1,
no file was written.)";

Program compareProgram() {
    return {"adaptiso-compare",
            "Measures how far two triangle surfaces lie apart: distances, normals, area, volume.",
            kFooter};
}

void declareCompareOptions(CLI::App& app, CompareOptions& options) {
    declareInput(app, options);
    declareDistances(app, options);
    declareChecks(app, options);
    declareOutput(app, options);
    declareCommonOptions(app, options.common, "all files are written all the same");
    afterParsing(app, [&options] { checkInputCoordinates(options.inputCoordinates, 2); });
}

}  // namespace
}  // namespace adaptiso::compare

int main(int argc, char** argv) {
    return adaptiso::runApp(argc, argv, adaptiso::compare::compareProgram(),
                            adaptiso::compare::declareCompareOptions,
                            adaptiso::compare::runCompare);
}
