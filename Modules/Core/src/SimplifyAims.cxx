#include "adaptiso/Core/SimplifyAims.h"

#include <cmath>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

constexpr std::string_view kDefaultBound =
    "0.15 of the least distance between planes of voxels, unless a count is given";

Options<SimplifyAims> rowsOf(AimedSurface surface) {
    OptionFacts bound{.name = "max-error",
                      .key = "maxErrorMm",
                      .label = "Largest error",
                      .valueName = "MM",
                      .help =
                          "Method adaptive: largest distance, both ways, between the surface "
                          "of marching cubes and the mesh",
                      .standard = kDefaultBound,
                      .rule = {.least = 0, .isAbove = true, .unit = "mm"}};
    OptionFacts count{.name = "triangles",
                      .key = "maxTriangles",
                      .label = "Triangles at most",
                      .valueName = "N",
                      .help =
                          "Method adaptive: simplify to so many triangles, of the pieces that are "
                          "kept, as close to that surface as the method gets"};
    OptionFacts share{.name = "reduction",
                      .key = "reduction",
                      .label = "Share of triangles to drop",
                      .valueName = "F",
                      .help = "Method adaptive: share of the triangles of marching cubes to drop",
                      .rule = {.least = 0, .most = 1}};
    if (surface == AimedSurface::Mesh) {
        bound.help =
            "Largest distance, both ways, between the given surface and the result, in "
            "the unit of its coordinates";
        bound.standard = "";
        count.key = "triangles";
        count.help = "Simplify to so many triangles, as close to the surface as the method gets";
        share.help = "Share of the triangles to drop";
    }
    if (surface == AimedSurface::Walls) {
        bound.help =
            "Largest distance, both ways, of each wall to itself at full resolution; 0 "
            "keeps the full resolution";
        bound.rule = {.least = 0, .unit = "mm"};
        count.help =
            "Simplify to so many triangles in all walls together, as close to the full "
            "resolution as the method gets";
        share.help = "Share of the full resolution's triangles to drop";
    }
    const OptionFacts angle{.name = "min-angle",
                            .key = "minAngleDeg",
                            .label = "Smallest angle",
                            .valueName = "DEG",
                            .help = "Make no new angle below this, at the price of more triangles",
                            .standard = "0",
                            .rule = {.least = 0, .most = 40, .unit = "degrees"}};
    return {option<&SimplifyAims::maxErrorMm>(bound), option<&SimplifyAims::maxTriangles>(count),
            option<&SimplifyAims::reduction>(share), option<&SimplifyAims::minAngleDeg>(angle)};
}

}  // namespace

void requireInRange(const SimplifyAims& aims, const char* function, bool mayBeZero) {
    const auto refuse = [&](const char* what) {
        throw InvalidInput(std::string(function) + ": " + what);
    };
    const auto isBound = [&](double mm) {
        return std::isfinite(mm) && (mm > 0 || (mayBeZero && mm == 0));
    };
    if (aims.maxErrorMm && !isBound(*aims.maxErrorMm)) {
        refuse(mayBeZero ? "maxErrorMm must be a finite number, 0 or more"
                         : "maxErrorMm must be a finite number above 0");
    }
    if (aims.maxTriangles && *aims.maxTriangles < 0) refuse("maxTriangles is below 0");
    if (aims.reduction && !(*aims.reduction >= 0 && *aims.reduction <= 1)) {
        refuse("reduction must lie between 0 and 1");
    }
    if (!(aims.minAngleDeg >= 0 && aims.minAngleDeg <= 40)) {
        refuse("minAngleDeg must lie between 0 and 40");
    }
}

const Options<SimplifyAims>& aimOptions(AimedSurface surface) {
    static const Options<SimplifyAims> ofScan = rowsOf(AimedSurface::OfScan),
                                       mesh = rowsOf(AimedSurface::Mesh),
                                       walls = rowsOf(AimedSurface::Walls);
    return surface == AimedSurface::OfScan ? ofScan : surface == AimedSurface::Mesh ? mesh : walls;
}

}  // namespace adaptiso
