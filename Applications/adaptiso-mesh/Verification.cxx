#include <algorithm>
#include <string>

#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso::mesher {
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

Verification verify(const VolumeView& volume, const SpanSpaceIndex& index, const TriangleMesh& mesh,
                    const FileDigits& digits, const MeshOptions& options,
                    const SurfaceRecord& record) {
    const SelfIntersections crossings = findSelfIntersections(mesh, {.maxPairs = 0});
    require(crossings.isClear(), crossingText(crossings));

    ExtractionOptions atFullResolution;
    atFullResolution.isovalue = record.isovalue;
    atFullResolution.method = Method::MarchingCubes;
    atFullResolution.computeNormals = false;
    TriangleMesh full = extractSurface(volume, index, atFullResolution).mesh;
    if (record.isPart) full = selectComponents(full, options.selection);
    const TopologyReport ours = checkTopology(mesh), theirs = checkTopology(full);
    require(ours.components.size() == theirs.components.size() &&
                eulerCharacteristic(ours) == eulerCharacteristic(theirs),
            "its components or holes are not those of marching cubes");
    const bool isJudged = options.index.border == Border::Closed && ours.isWatertight();
    if (isJudged) {
        const auto insideOut = findInsideOutPieces(mesh, ours);
        require(!insideOut || insideOut->empty(), "pieces are inside out");
    }

    constexpr double kRounding = 1e-9;    // of the bound: coordinates in other frames
    constexpr double kMeasuring = 1e-14;  // of the surface's extent: what distances are measured to
    const TriangleMesh written = asStored(mesh, digits.format->precision, digits.toFrame);
    double roundingMm = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        roundingMm = std::max(roundingMm, norm(written.points[v] - mesh.points[v]));
    }
    const DistanceReport distance = surfaceDistance(written, full);
    const BoundingBox box = boundingBox(full);
    const double maxMm = distance.combined.maxMm;
    double boundMm = record.statistics.errorBoundMm.value_or(0) + roundingMm +
                     kMeasuring * std::max({norm(box.minimum), norm(box.maximum),
                                            norm(box.maximum - box.minimum)});
    if (maxMm > boundMm) boundMm += measuringErrorMm(written) + measuringErrorMm(full);
    require(maxMm <= (1 + kRounding) * boundMm, "a point lies " + formatNumber(maxMm) +
                                                    " mm from the surface of marching cubes, not " +
                                                    formatNumber(boundMm));
    return {distance.combined.measured(), maxMm};
}

}  // namespace adaptiso::mesher
