#include "CommandLine.h"

#include <optional>
#include <string>

#include "Common/ImageOptions.h"
#include "Common/Numbers.h"

namespace adaptiso {
namespace {

constexpr const char* kDistances = "Distances";
constexpr const char* kOutput = "Output";
constexpr const char* kChecks = "Checks (exit code 1 when one fails)";

/// An option that takes a length in mm.
void addLength(CLI::App& app, const std::string& name, std::optional<double>& target,
               bool mayBeZero, const std::string& description, const char* group) {
    app.add_option_function<std::string>(
           name,
           [&target, name, mayBeZero](const std::string& text) {
               target = parseFiniteNumber(text);
               if (!target || *target < 0 || (!mayBeZero && *target == 0)) {
                   throw UsageError(name + " " + text + ": must be a number of mm, " +
                                    (mayBeZero ? "0 or more" : "more than 0"));
               }
           },
           description)
        ->type_name("MM")
        ->group(group);
}

void declareInput(CLI::App& app, CompareOptions& options) {
    app.add_option("A", options.a, "A triangle surface, in any format adaptiso-mesh writes")
        ->type_name("")
        ->required();
    app.add_option("B", options.b, "The surface to compare it with: the reference")
        ->type_name("")
        ->required();
}

void declareDistances(CLI::App& app, CompareOptions& options) {
    constexpr std::int64_t kMaxSamples = 1'000'000'000;
    app.add_option("--samples", options.samples,
                   "Points laid on a surface, evenly over its area, for each direction (default: "
                   "200000)")
        ->type_name("N")
        ->check(CLI::Range(std::int64_t{1}, kMaxSamples).description(""))
        ->group(kDistances);
    CLI::Option* const symmetric = app.add_flag_callback(
                                          "--symmetric", [&options] { options.isSymmetric = true; },
                                          "From A to B and from B to A (default)")
                                       ->group(kDistances);
    app.add_flag_callback(
           "--one-sided", [&options] { options.isSymmetric = false; }, "From A to B only")
        ->excludes(symmetric)
        ->group(kDistances);
    addLength(app, "--voxel", options.voxelMm, false,
              "Give distances in voxels of this size as well", kDistances);
    declareVolume(app, options.volume, options.read,
                  "The image that the surfaces were made from: gives distances in its voxels, "
                  "the overlap (Dice) on its grid, and a place to tkRAS and voxel coordinates",
                  kDistances)
        ->excludes("--voxel");
}

void declareChecks(CLI::App& app, CompareOptions& options) {
    addLength(app, "--max-mean", options.maxMeanMm, true, "Largest mean distance that passes",
              kChecks);
    addLength(app, "--max-hausdorff", options.maxHausdorffMm, true,
              "Largest maximum distance (Hausdorff) that passes", kChecks);
}

void declareOutput(CLI::App& app, CompareOptions& options) {
    app.add_option("--colored", options.colored,
                   "Write A with the distance of every vertex to B, and its colour (viridis from "
                   "0 to the largest)")
        ->type_name("OUT.vtp")
        ->group(kOutput);
    declareReportOptions(app, options.report, kOutput);
}

constexpr const char* kFooter = R"(Examples:
  adaptiso-compare adaptive.vtp reference.ply
  adaptiso-compare a.stl b.stl --volume head.nii.gz --json report.json
  adaptiso-compare lh.pial lh.vtp --colored difference.vtp
  adaptiso-compare new.vtp old.vtp --quiet --max-mean 0.1 --max-hausdorff 1

Exit codes: 0 done, 1 a check failed, 2 wrong usage, 3 bad input (or no memory
or disk left), 4 internal error. When it is above 1, no file was written.)";

}  // namespace

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
    declareCommonOptions(app, options.common);
}

}  // namespace adaptiso
