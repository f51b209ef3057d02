#include "adaptiso/MeshQuality/Winding.h"

#include <algorithm>

#include "ExactTriangle.h"
#include "RayHit.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {
namespace {

/// Which pieces lie in which.
class PieceNesting {
public:
    PieceNesting(const TriangleMesh& mesh, const TopologyReport& topology)
        : mesh_(mesh),
          topology_(topology),
          root_(findComponentRoots(mesh)),
          triangles_(mesh.points.size(),
                     [&](const auto& give) {
                         for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
                             give(rootOf(t), t);
                         }
                     }),
          tree_(mesh) {}

    /// The piece lies in an odd number of the others.
    bool isCavity(std::int64_t piece) const {
        std::vector<VertexId> around = aroundFirstVertex(piece);
        if (!around.empty()) dropCrossed(piece, around);
        return around.size() % 2 == 1;
    }

private:
    VertexId rootOf(std::int64_t triangle) const { return root_[mesh_.triangles[triangle][0]]; }

    /// The other pieces that a piece's first vertex lies in, ascending, by their roots.
    std::vector<VertexId> aroundFirstVertex(std::int64_t piece) const {
        const VertexId own = topology_.components[piece].firstVertex;
        const Vec3& p = mesh_.points[own];
        const Ray ray{0, 1};
        std::vector<VertexId> crossed;
        tree_.forEachOverlap(boxOf(p, ray), [&](std::int64_t t) {
            if (rootOf(t) == own) return;
            if (hitOf(p, ray, cornersOf(mesh_, t)).crosses) crossed.push_back(rootOf(t));
        });
        std::sort(crossed.begin(), crossed.end());
        std::vector<VertexId> around;
        for (const VertexId root : crossed) {
            if (around.empty() || around.back() != root) {
                around.push_back(root);
            } else {
                around.pop_back();  // out of it again
            }
        }
        return around;
    }

    /// \param others  then without those that cross the piece
    void dropCrossed(std::int64_t piece, std::vector<VertexId>& others) const {
        for (const std::int64_t t : triangles_.of(topology_.components[piece].firstVertex)) {
            if (others.empty()) return;
            tree_.forEachOverlap(tree_.triangleBox(t), [&](std::int64_t with) {
                const auto other = std::find(others.begin(), others.end(), rootOf(with));
                if (other == others.end()) return;
                if (trianglesCross(cornersOf(mesh_, t), cornersOf(mesh_, with)))
                    others.erase(other);
            });
        }
    }

    const TriangleMesh& mesh_;
    const TopologyReport& topology_;
    std::vector<VertexId> root_;       ///< of each vertex
    Buckets<std::int64_t> triangles_;  ///< of each root
    AabbTree tree_;
};

}  // namespace

std::vector<std::int64_t> findInsideOutPieces(const TriangleMesh& mesh,
                                              const TopologyReport& topology) {
    if (!topology.isWatertight() || topology.count(TopologyDefect::NonFiniteVertex) > 0) {
        throw InvalidInput(
            "findInsideOutPieces: the mesh must be closed, manifold, oriented and finite");
    }
    std::vector<std::uint8_t> isCavity(topology.components.size());
    if (isCavity.size() > 1) {
        const PieceNesting nesting(mesh, topology);
        parallelForPieces(std::ssize(isCavity), 1, [&](std::int64_t n, std::int64_t) {
            isCavity[n] = nesting.isCavity(n) ? 1 : 0;
        });
    }
    std::vector<std::int64_t> insideOut;
    for (std::size_t n = 0; n < isCavity.size(); ++n) {
        const bool isRight = topology.components[n].isOutward() == (isCavity[n] == 0);
        if (!isRight) insideOut.push_back(static_cast<std::int64_t>(n));
    }
    return insideOut;
}

}  // namespace adaptiso
