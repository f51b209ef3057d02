#include <algorithm>
#include <cmath>

#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso::checker {

Isosurface extractIsosurface(const VolumeView& volume, double isovalue) {
    Isosurface isosurface;
    isosurface.isovalue = isovalue;
    isosurface.voxelMm = std::cbrt(volume.geometry().voxelVolumeMm3());
    ExtractionOptions extract;
    extract.isovalue = isovalue;
    extract.method = Method::MarchingCubes;
    extract.computeNormals = false;
    isosurface.mesh = extractSurface(volume, SpanSpaceIndex::build(volume, {}), extract).mesh;
    if (!(surfaceArea(isosurface.mesh) > 0)) {
        const ValueRange range = valueRange(volume);
        throw InvalidInput("there is no surface; the range is " + formatShort(range.minimum) +
                           " to " + formatShort(range.maximum));
    }
    return isosurface;
}

std::optional<DistanceStatistics> isosurfaceDeviation(const TriangleMesh& mesh,
                                                      const Isosurface& isosurface) {
    TriangleMesh finite;
    finite.points = mesh.points;
    std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(finite.triangles),
                 [&](const Triangle& t) {
                     return std::all_of(t.begin(), t.end(), [&](VertexId v) {
                         return std::isfinite(squaredNorm(mesh.points[v]));
                     });
                 });
    if (!(surfaceArea(finite) > 0)) return std::nullopt;
    return surfaceDistance(finite, isosurface.mesh, {.isSymmetric = false}).aToB;
}

}  // namespace adaptiso::checker
