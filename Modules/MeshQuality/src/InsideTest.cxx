#include "adaptiso/MeshQuality/InsideTest.h"

#include <optional>

#include "ExactTriangle.h"
#include "RayHit.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

bool everyEdgeIsInTwo(const TriangleMesh& mesh) {
    const TopologyReport report = checkTopology(mesh, {.maxExamplesPerDefect = 0});
    if (!report.isClosed() || report.count(TopologyDefect::NonManifoldEdge) > 0) return false;
    if (report.count(TopologyDefect::NonFiniteVertex) == 0) return true;
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        if (!areFinite(cornersOf(mesh, n))) return false;
    }
    return true;
}

/// Whether the ray crosses an odd number of triangles; none when `p` is on one.
std::optional<bool> crossesOddly(const Vec3& p, const Ray& ray, const TriangleMesh& mesh,
                                 const AabbTree& tree) {
    bool isOdd = false, isOn = false;
    tree.forEachOverlap(boxOf(p, ray), [&](std::int64_t triangle) {
        const Hit found = hitOf(p, ray, cornersOf(mesh, triangle));
        isOn = isOn || found.isOn;
        isOdd = isOdd != found.crosses;
    });
    if (isOn) return std::nullopt;
    return isOdd;
}

}  // namespace

InsideTest::InsideTest(const TriangleMesh& mesh, const AabbTree& tree)
    : mesh_(&mesh), tree_(&tree), isClosed_(everyEdgeIsInTwo(mesh)) {}

Side InsideTest::sideOf(const Vec3& p) const {
    constexpr int kRays = 6, kMajority = 4;
    int inside = 0;
    for (int n = 0; n < kRays; ++n) {
        const auto isOdd = crossesOddly(p, {n % 3, n < 3 ? 1 : -1}, *mesh_, *tree_);
        if (!isOdd) return Side::On;
        if (isClosed_) return *isOdd ? Side::Inside : Side::Outside;
        inside += *isOdd ? 1 : 0;
    }
    return inside >= kMajority ? Side::Inside : Side::Outside;
}

}  // namespace adaptiso
