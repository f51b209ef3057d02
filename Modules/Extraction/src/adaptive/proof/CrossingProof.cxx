#include "adaptive/proof/CrossingProof.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "Certificate.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/ClearFans.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::detail {
namespace {

/// Two triangles that do not cross, for sure.
bool areClear(const TriangleView& mesh, const ClearFans& fans, std::uint32_t a, std::uint32_t b,
              double gap) {
    const TriangleView::Triangle &s = mesh.triangles[a], &t = mesh.triangles[b];
    std::array<int, 3> inT{};
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        const auto at = std::find(t.begin(), t.end(), s[i]);
        inT[i] = at == t.end() ? -1 : static_cast<int>(at - t.begin());
        if (inT[i] < 0) continue;
        if (fans.isClear(s[i])) return true;
        ++shared;
    }
    const auto cornersFrom = [&](const TriangleView::Triangle& u, int first) {
        return Corners{mesh.points[u[first]], mesh.points[u[(first + 1) % 3]],
                       mesh.points[u[(first + 2) % 3]]};
    };
    if (shared == 0) return areApart(cornersFrom(s, 0), cornersFrom(t, 0), gap);
    if (shared == 1) {
        const int i = inT[0] >= 0 ? 0 : inT[1] >= 0 ? 1 : 2;
        return touchAtVertexOnly(cornersFrom(s, i), cornersFrom(t, inT[i]), gap);
    }
    if (shared == 3) return false;
    const int other = inT[0] < 0 ? 0 : inT[1] < 0 ? 1 : 2;
    const Corners fromEdge = cornersFrom(s, (other + 1) % 3);
    const int otherInT = 3 - inT[(other + 1) % 3] - inT[(other + 2) % 3];
    return touchAtEdgeOnly(fromEdge, {fromEdge[1], fromEdge[0], mesh.points[t[otherInT]]}, 0);
}

}  // namespace

std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh) {
    std::vector<TriangleView::Triangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                             static_cast<std::uint32_t>(c)});
    }
    return crossingTriangles(TriangleView{mesh.points, triangles});
}

std::vector<std::int64_t> crossingTriangles(const TriangleView& mesh) {
    if (mesh.triangles.empty()) return {};
    constexpr std::int64_t kPiece = 128;  // leaves
    TriangleTree tree;
    std::optional<ClearFans> fans;
    parallelInvoke([&] { tree = TriangleTree(mesh); },
                   [&] { fans.emplace(mesh.points, mesh.triangles); });
    CornerBox box{mesh.points[0], mesh.points[0]};
    for (const Vec3& p : mesh.points) box.add(p);
    const double gap = 1e-13 * (norm(box.high) + norm(box.low));  // rounding of coordinates
    const TriangleTree::Pairs pairs(tree, mesh);
    std::vector<std::vector<std::int64_t>> crossing((tree.leafCount() + kPiece - 1) / kPiece);
    parallelForPieces(tree.leafCount(), kPiece, [&](std::int64_t begin, std::int64_t end) {
        std::vector<std::int64_t>& here = crossing[begin / kPiece];
        pairs.forEach(begin, end, [&](std::uint32_t a, std::uint32_t b) {
            if (areClear(mesh, *fans, a, b, gap)) return;
            if (trianglesCross(mesh.cornersOf(a), mesh.cornersOf(b)))
                here.insert(here.end(), {a, b});
        });
    });
    std::vector<std::int64_t> all;
    for (const auto& some : crossing) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

}  // namespace adaptiso::detail
