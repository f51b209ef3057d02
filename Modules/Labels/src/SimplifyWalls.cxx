#include "SimplifyWalls.h"

#include <algorithm>
#include <cmath>

#include "WholeWalls.h"

namespace adaptiso::detail {
namespace {

/// Sides of the cubes that are simplified side by side, in voxels: few enough triangles to stay in
/// a processor's own memory, enough that few reach out of the cube.
constexpr double kCubeVoxels = 64;
/// Where the limit is large, so are the triangles: the least side, of the limit.
constexpr double kCubeLimits = 24;

}  // namespace

SimplifiedWalls simplifyWalls(LabelComplex&& full, const ImageGeometry& geometry,
                              const SimplifyOptions& options) {
    const double h = std::cbrt(geometry.voxelVolumeMm3());
    const auto tell = [&](double part) {
        if (options.progress) options.progress("simplify", part);
    };
    WallAim aim;
    aim.limitMm = options.maxErrorMm.value_or(0.05 * h);
    aim.mayGrow = !options.maxErrorMm;
    aim.minAngleDeg = options.minAngleDeg;
    aim.enough = options.maxTriangles.value_or(0);
    SimplifiedWalls walls;
    WholeWalls whole(std::move(full), geometry);
    if (options.maxTriangles) {  // which edges are the cheapest is asked of all
        const auto all = static_cast<double>(
            std::max({geometry.size[0], geometry.size[1], geometry.size[2]}) + 1);
        walls.errorBoundMm = whole.simplify(CubeCut(geometry.size, 2 * all, false), aim);
    } else {
        const double side = std::max(kCubeVoxels, kCubeLimits * aim.limitMm / h);
        const CubeCut cut(geometry.size, side, false), shifted(geometry.size, side, true);
        walls.errorBoundMm = whole.simplify(cut, aim);
        tell(0.6);
        if (cut.count() > 1) whole.simplify(shifted, aim);
    }
    walls.complex = whole.complex();
    tell(1);
    return walls;
}

}  // namespace adaptiso::detail
