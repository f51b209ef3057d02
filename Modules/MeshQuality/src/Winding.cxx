#include "adaptiso/MeshQuality/Winding.h"

#include "ExactTriangle.h"
#include "RayHit.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

/// For every piece, whether it lies in an odd number of the others.
std::vector<std::uint8_t> findCavities(const TriangleMesh& mesh, const TopologyReport& topology) {
    const std::vector<VertexId> label = findComponentRoots(mesh);
    const AabbTree tree(mesh);
    std::vector<std::uint8_t> isCavity(topology.components.size());
    parallelForPieces(std::ssize(isCavity), 1, [&](std::int64_t n, std::int64_t) {
        const VertexId own = topology.components[n].firstVertex;
        const Vec3& p = mesh.points[own];
        const Ray ray{0, 1};
        tree.forEachOverlap(boxOf(p, ray), [&](std::int64_t triangle) {
            if (label[mesh.triangles[triangle][0]] == own) return;
            if (hitOf(p, ray, cornersOf(mesh, triangle)).crosses) isCavity[n] ^= 1;
        });
    });
    return isCavity;
}

}  // namespace

std::vector<std::int64_t> findInsideOutPieces(const TriangleMesh& mesh,
                                              const TopologyReport& topology) {
    if (!topology.isWatertight() || topology.count(TopologyDefect::NonFiniteVertex) > 0) {
        throw InvalidInput(
            "findInsideOutPieces: the mesh must be closed, manifold, oriented and finite");
    }
    std::vector<std::uint8_t> isCavity(topology.components.size());
    if (topology.components.size() > 1) isCavity = findCavities(mesh, topology);
    std::vector<std::int64_t> insideOut;
    for (std::size_t n = 0; n < isCavity.size(); ++n) {
        const bool isRight = topology.components[n].isOutward() == (isCavity[n] == 0);
        if (!isRight) insideOut.push_back(static_cast<std::int64_t>(n));
    }
    return insideOut;
}

}  // namespace adaptiso
