#include <algorithm>
#include <string>

#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Winding.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso::mesher {
namespace {

constexpr const char* kBroken = "--verify: the surface breaks its promise: ";

void require(bool holds, const std::string& what) {
    if (!holds) throw InternalError(kBroken + what);
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
    require(hasSameShape(ours, theirs), "its components or holes are not those of marching cubes");
    const bool isJudged = options.index.border == Border::Closed && ours.isWatertight();
    if (isJudged) {
        const auto insideOut = findInsideOutPieces(mesh, ours);
        require(!insideOut || insideOut->empty(), "pieces are inside out");
    }

    const TriangleMesh written = asStored(mesh, digits.format->precision, digits.toFrame);
    double roundingMm = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        roundingMm = std::max(roundingMm, norm(written.points[v] - mesh.points[v]));
    }
    return verifyDistance(written, full, record.statistics.errorBoundMm.value_or(0) + roundingMm,
                          "the surface of marching cubes", kBroken);
}

}  // namespace adaptiso::mesher
