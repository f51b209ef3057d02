#include <algorithm>
#include <cmath>
#include <ostream>

#include "Common/ImageOptions.h"
#include "Common/Json.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/ImageIO/ImageRegions.h"

namespace adaptiso::giant {
namespace fs = std::filesystem;

namespace {

/// Whether a tile certainly holds no surface, without reading its samples: all are of one value,
/// and where they are inside the tile does not reach the volume's border.
bool isEmpty(const ImageRegions& image, const TileCut& cut, const Index3& tile, double isovalue) {
    constexpr double kExact = 9007199254740992.0;  // 2^53: beyond it doubles skip integers
    const IndexBox box = cut.samplesOf(tile);
    const std::optional<double> constant = image.constantIn(box.first, box.size());
    if (!constant || std::abs(*constant) > kExact) return false;
    if (*constant < isovalue) return true;
    for (int a = 0; a < 3; ++a) {
        if (tile[a] == 0 || tile[a] + 1 == cut.tiles()[a]) return false;
    }
    return true;
}

std::vector<Index3> tilesOf(const ImageRegions& image, const TileCut& cut, double isovalue) {
    const Index3 count = cut.tiles();
    std::vector<Index3> tiles;
    for (std::int64_t z = 0; z < count[2]; ++z) {
        for (std::int64_t y = 0; y < count[1]; ++y) {
            for (std::int64_t x = 0; x < count[0]; ++x) {
                const Index3 tile{x, y, z};
                if (!isEmpty(image, cut, tile, isovalue)) tiles.push_back(tile);
            }
        }
    }
    return tiles;
}

void requireTileable(const GiantPlan& plan) {
    if (plan.isAdaptive() && !canSimplifyInBoxes(plan.geometry)) {
        throw InvalidInput(
            "the image's axes are not at right angles, which the adaptive method needs in tiles; "
            "take --method mc, or resample the image");
    }
    // vertices are known by the bits of their places, which must differ
    const Vec3 spacing = plan.geometry.spacingMm();
    if (std::max({spacing.x, spacing.y, spacing.z}) > 10'000 * narrowestSpacingMm(plan.geometry)) {
        throw InvalidInput("a voxel is more than 10,000 times as long as it is thin");
    }
}

GiantPlan planOf(const GiantOptions& options) {
    const ImageRegions image = ImageRegions::open(options.input, options.read);
    GiantPlan plan;
    plan.version = programVersion();
    plan.input = fs::weakly_canonical(options.input);
    if (!isUtf8(plan.input.native())) {
        throw InvalidInput(baseName(options.input) +
                           ": its path is not UTF-8, as the plan has to be; rename it");
    }
    plan.read = options.read;
    plan.format = image.format();
    plan.geometry = image.geometry();
    plan.pixelType = image.pixelType();
    plan.isovalue = *options.isovalue;
    plan.method = options.method;
    plan.side = options.side;
    if (plan.isAdaptive()) {
        plan.leavesNoise = !options.aims.maxErrorMm;
        plan.maxErrorMm = options.aims.maxErrorMm.value_or(AdaptiveOptions::kDefaultMaxErrorVoxels *
                                                           narrowestSpacingMm(plan.geometry));
    }
    requireTileable(plan);
    plan.warnings = image.warnings();
    const Index3 tiles = plan.cut().tiles();
    if (!image.readsParts() && tiles[0] * tiles[1] * tiles[2] > 1) {
        plan.warnings.push_back(
            {"whole-image-read",
             "is no Zarr: a step that makes tiles reads or maps the whole image"});
    }
    plan.tiles = tilesOf(image, plan.cut(), plan.isovalue);
    return plan;
}

}  // namespace

int runPlanStep(const GiantOptions& options) {
    const GiantPlan plan = planOf(options);
    for (const char* folder : {"tiles", "seams"}) {
        makeFolders(options.work);
        makeFolders(options.work / folder, options.work);
    }
    std::vector<Warning> warnings;
    addWarnings(warnings, plan.warnings, baseName(plan.input));
    printWarnings(kGiantProgram, options.common, warnings);
    const fs::path file = GiantPlan::fileIn(options.work);
    const std::string text = encodePlan(plan);
    if (!failsStrict(options.common, warnings) && readFoundFile(file, options.work) != text) {
        AtomicOutput output(file, options.work);
        output.writeText(text);
        AtomicOutput::commit({&output, 1});
    }
    const Index3 count = plan.cut().tiles();
    Verdict verdict;
    verdict.failStrict(options.common, warnings, "so no plan was written");
    Json json = reportHead("adaptiso-giant-step/1", kGiantProgram, verdict, warnings);
    json.update(Json{{"step", "plan"},
                     {"tiles", plan.tiles.size()},
                     {"tilesOfVolume", count[0] * count[1] * count[2]},
                     {"seams", plan.seams().size()}});
    deliverReport(options.common, options.input, jsonText(json) + "\n", [&](std::ostream& out) {
        out << formatCount(std::ssize(plan.tiles)) << " of "
            << formatCount(count[0] * count[1] * count[2]) << " tiles may hold surface";
        if (plan.isAdaptive())
            out << ", in " << formatCount(std::ssize(plan.seams())) << " seam boxes";
        out << "\n";
    });
    return printVerdict(kGiantProgram, verdict, "");
}

}  // namespace adaptiso::giant
