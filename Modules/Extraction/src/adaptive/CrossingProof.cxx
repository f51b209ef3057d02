#include "CrossingProof.h"

#include <algorithm>
#include <array>
#include <vector>

#include "../Certificate.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::detail {
namespace {

/// Two triangles that do not cross, for sure.
bool areClear(const TriangleMesh& mesh, std::int64_t a, std::int64_t b, double gap) {
    const Triangle &s = mesh.triangles[a], &t = mesh.triangles[b];
    std::array<int, 3> inT{};
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        const auto at = std::find(t.begin(), t.end(), s[i]);
        inT[i] = at == t.end() ? -1 : static_cast<int>(at - t.begin());
        if (inT[i] >= 0) ++shared;
    }
    const auto cornersFrom = [&](const Triangle& u, int first) {
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

std::vector<Vec3> crossingPlaces(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) return {};
    constexpr std::int64_t kPiece = 1024;
    const AabbTree tree(mesh);
    const BoundingBox box = boundingBox(mesh);
    const double gap = 1e-13 * (norm(box.maximum) + norm(box.minimum));  // rounding of coordinates
    const auto count = static_cast<std::int64_t>(mesh.triangles.size());
    const auto cornersOf = [&](std::int64_t t) {
        const Triangle& c = mesh.triangles[t];
        return Corners{mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]};
    };
    std::vector<std::vector<Vec3>> places((count + kPiece - 1) / kPiece);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            tree.forEachOverlap(tree.triangleBox(t), [&](std::int64_t other) {
                if (other <= t || areClear(mesh, t, other, gap)) return;
                const Corners a = cornersOf(t), b = cornersOf(other);
                if (!trianglesCross(a, b)) return;
                for (const Corners& c : {a, b}) {
                    places[begin / kPiece].push_back((1.0 / 3) * (c[0] + c[1] + c[2]));
                }
            });
        }
    });
    std::vector<Vec3> all;
    for (const auto& some : places) all.insert(all.end(), some.begin(), some.end());
    return all;
}

}  // namespace adaptiso::detail
