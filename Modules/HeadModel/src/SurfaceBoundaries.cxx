#include <algorithm>
#include <cmath>
#include <string>

#include "BallTopology.h"
#include "FinishBoundaries.h"
#include "Voxelized.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

using namespace headmodel;

namespace {

constexpr double kUsualStepMm = 1;
constexpr double kCrackMm = 2;  ///< closing of what the vote leaves open

/// Axes along x, y, z around all surfaces.
ImageGeometry gridAround(std::span<const TriangleMesh> surfaces, double step, double marginMm) {
    BoundingBox box = boundingBox(surfaces.front());
    for (const TriangleMesh& surface : surfaces) box.add(boundingBox(surface));
    ImageGeometry grid;
    grid.indexToPhysical = Mat3::diagonal(step, step, step);
    for (int a = 0; a < 3; ++a) {
        const double extent = box.maximum[a] - box.minimum[a];
        if (!(extent >= 20 && extent <= 1000)) {
            throw InvalidInput("a surface is " + shortNumber(extent) +
                               " mm wide, must be 20 to 1000 mm (metres?)");
        }
        grid.originMm[a] = box.minimum[a] - marginMm;
        grid.size[a] = static_cast<std::int64_t>(std::ceil((extent + 2 * marginMm) / step)) + 1;
    }
    return grid;
}

/// The inside of a surface that may have holes, crossings, stray pieces, turned triangles. What is
/// no ball then has tunnels: those that `closingMm` closes are filled, before any are cut.
Mask enclosedBy(const TriangleMesh& surface, const ImageGeometry& grid, double closingMm) {
    const Mask inside = voxelized(surface, grid);
    const Mask whole =
        filled(closed(largestComponent(inside, grid.size), grid, kCrackMm), grid.size);
    if (isBall(whole, grid.size)) return whole;
    const Mask solid = filled(closed(whole, grid, closingMm), grid.size);
    return isBall(solid, grid.size) ? solid : whole;
}

}  // namespace

std::vector<float> headmodel::surfacePart(const TriangleMesh& surface, const ImageGeometry& grid,
                                          double closingMm) {
    TriangleMesh outward = surface;
    outward.normals.clear();
    if (enclosedVolume(outward) < 0) flipOrientation(outward);
    const Mask inside = enclosedBy(outward, grid, closingMm);
    if (voxelsIn(inside) == 0) {
        throw InvalidInput("a surface encloses nothing");
    }
    const double step = stepMm(grid);
    const std::vector<float> depth = depthMm(inside, grid, DepthBand::within(3 * step));
    const AabbTree tree(outward);
    std::vector<float> part(depth.size());
    parallelForPieces(std::ssize(depth), 1 << 14, [&](std::int64_t begin, std::int64_t end) {
        std::int64_t hint = -1;
        for (std::int64_t n = begin; n < end; ++n) {
            double mm = depth[n];
            if (std::abs(mm) < 2 * step) {
                const std::int64_t slice = grid.size[0] * grid.size[1];
                const Vec3 index{static_cast<double>(n % grid.size[0]),
                                 static_cast<double>(n / grid.size[0] % grid.size[1]),
                                 static_cast<double>(n / slice)};
                const ClosestPoint nearest = tree.closestPoint(grid.toPhysical(index), hint);
                hint = nearest.triangle;
                const double distance = std::sqrt(nearest.squaredDistanceMm2);
                if (distance < 2 * step) mm = inside[n] != 0 ? distance : -distance;
            }
            part[n] = partAtDepth(mm, step);
        }
    });
    return part;
}

HeadBoundaries boundariesFromSurfaces(std::span<const TriangleMesh> surfaces,
                                      const BoundaryOptions& options) {
    checkOptions(options);
    const std::size_t wanted = options.surfaceCount();
    if (surfaces.size() != wanted) {
        throw InvalidInput("there are " + std::to_string(surfaces.size()) + " surfaces, must be " +
                           std::to_string(wanted));
    }
    RawBoundaries raw;
    raw.grid =
        gridAround(surfaces, options.stepMm > 0 ? options.stepMm : kUsualStepMm, marginMm(options));
    for (std::size_t n = 0; n < wanted; ++n) {
        tell(options, "mend", static_cast<double>(n) / static_cast<double>(wanted));
        const bool isInner = n < options.innerSurfaces;
        std::vector<float> part =
            surfacePart(surfaces[n], raw.grid, isInner ? options.sulciMm : options.closingMm);
        auto& parts = isInner ? raw.inner : raw.parts;
        parts.insert(isInner ? parts.begin() : parts.end(), std::move(part));
    }
    return finished(std::move(raw), options);
}

}  // namespace adaptiso
