#include "Verification.h"

#include <string>

#include "Common/Numbers.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

void require(bool holds, const std::string& what) {
    if (!holds) throw InternalError("--verify: the surface breaks its promise: " + what);
}

std::int64_t eulerCharacteristic(const TopologyReport& topology) {
    std::int64_t sum = 0;
    for (const auto& component : topology.components) sum += component.eulerCharacteristic();
    return sum;
}

}  // namespace

Verification verify(const VolumeView& volume, const SpanSpaceIndex& index, double isovalue,
                    const Extraction& extraction) {
    const std::int64_t crossing = findSelfIntersections(extraction.mesh, {.maxPairs = 0}).pairCount;
    require(crossing == 0, std::to_string(crossing) + " pairs of triangles cross");

    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = Method::MarchingCubes;
    options.computeNormals = false;
    const TriangleMesh full = extractSurface(volume, index, options).mesh;
    const TopologyReport ours = checkTopology(extraction.mesh), theirs = checkTopology(full);
    require(ours.components.size() == theirs.components.size() &&
                eulerCharacteristic(ours) == eulerCharacteristic(theirs),
            "its components or holes are not those of marching cubes");

    constexpr double kRounding = 1e-9;  // of the bound: coordinates in other frames
    const DistanceReport distance = surfaceDistance(extraction.mesh, full);
    const double maxMm = distance.combined.maxMm,
                 boundMm = extraction.statistics.errorBoundMm.value_or(0);
    require(maxMm <= (1 + kRounding) * boundMm, "a point lies " + formatNumber(maxMm) +
                                                    " mm from the surface of marching cubes, not " +
                                                    formatNumber(boundMm));
    return {distance.combined.samples, maxMm};
}

}  // namespace adaptiso
