#include "adaptiso/Labels/Labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "DualComplex.h"
#include "Placement.h"
#include "WholeWalls.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Memory.h"

namespace adaptiso {
namespace {

using namespace detail;

/// Leaves out the points that no triangle uses.
void dropUnused(LabelComplex& complex) {
    std::vector<VertexId> number(complex.points.size(), -1);
    for (const Triangle& t : complex.triangles) {
        for (const VertexId v : t) number[v] = 0;
    }
    VertexId used = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] < 0) continue;
        number[v] = used;
        complex.points[used++] = complex.points[v];
    }
    complex.points.resize(used);
    for (Triangle& t : complex.triangles) {
        for (VertexId& v : t) v = number[v];
    }
}

/// Where the vertices of groups lie. Makes the complex's polygons, and takes its adjacencies: all
/// of it at once is large.
std::vector<Vec3> placePoints(const LabelGrid& grid, DualComplex& dual, bool isSmooth,
                              LabelStatistics& statistics) {
    const std::vector<Room> rooms = roomsOf(grid, dual);
    std::vector<Vec3> points = startPoints(grid, dual, rooms);
    if (!isSmooth) {
        addPolygons(grid, dual);
        return points;
    }
    {
        const Neighbours neighbours = neighboursOf(dual);
        freeMemory(dual.adjacencies);
        points = smooth(rooms, neighbours, std::move(points));
        addPolygons(grid, dual);
        takeBackShift(grid, dual, rooms, neighbours, points);
    }
    restoreVolumes(grid, dual, rooms, points);
    statistics.heldVertices = countHeld(dual, rooms, points);
    return points;
}

/// \param grid  its labels are taken: all of it at once is large
LabelResult makeWalls(LabelGrid& grid, const ImageGeometry& geometry, const LabelOptions& options) {
    const auto tell = [&](double fraction) {
        if (options.progress) options.progress("walls", fraction);
    };
    LabelResult result;
    LabelStatistics& statistics = result.statistics;
    tell(0);
    DualComplex dual = makeDualComplex(grid);
    statistics.cells = static_cast<std::int64_t>(dual.cells.size());
    statistics.dividedCells =
        std::count_if(dual.cells.begin(), dual.cells.end(),
                      [](const WallCell& cell) { return !cell.pattern().isWhole(); });
    tell(0.2);
    std::vector<Vec3> points = placePoints(grid, dual, options.smooth, statistics);
    appendFacePoints(grid, dual, points);
    freeMemory(dual.cells);
    freeMemory(grid.labels);
    tell(0.6);
    Walls walls = cutPolygons(std::move(dual), grid, std::move(points), geometry);
    statistics.mendedCrossings = walls.mendedCrossings;
    statistics.fullTriangles = static_cast<std::int64_t>(walls.complex.triangles.size());
    result.complex = std::move(walls.complex);
    tell(1);
    return result;
}

/// The goal that the options ask for; empty: the full walls.
std::optional<SimplifyAims> simplification(const LabelOptions& options,
                                           const ImageGeometry& geometry,
                                           std::int64_t fullTriangles) {
    SimplifyAims wanted = options;
    if (options.reduction) {
        const auto left = static_cast<std::int64_t>(
            std::ceil((1 - *options.reduction) * static_cast<double>(fullTriangles)));
        wanted.maxTriangles = std::min(left, wanted.maxTriangles.value_or(left));
    }
    if (!wanted.maxErrorMm && !wanted.maxTriangles) {
        wanted.maxErrorMm = LabelOptions::kDefaultMaxErrorVoxels * leastPlaneDistanceMm(geometry);
    }
    if (wanted.maxErrorMm == 0.0 || wanted.maxTriangles.value_or(0) >= fullTriangles) return {};
    return wanted;
}

}  // namespace

LabelResult extractLabels(const VolumeView& volume, const LabelOptions& options) {
    requireInRange(options, "extractLabels", true);
    requireNoNeedles(volume.geometry());
    LabelGrid grid = makeGrid(volume, options.labels);
    const ImageGeometry geometry = grid.partOf(volume.geometry());
    LabelResult result = makeWalls(grid, geometry, options);
    // cells have corners beside the chosen regions too
    if (!options.labels.empty()) dropUnused(result.complex);
    const auto wanted = simplification(options, geometry, result.statistics.fullTriangles);
    if (wanted) {
        SimplifiedWalls walls =
            simplifyWalls(std::move(result.complex), geometry, *wanted, options.progress);
        result.complex = std::move(walls.complex);
        result.statistics.errorBoundMm = walls.errorBoundMm;
        result.statistics.wantedTriangles = wanted->maxTriangles;
    }
    return result;
}

}  // namespace adaptiso
