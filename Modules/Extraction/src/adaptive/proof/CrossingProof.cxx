#include "adaptive/proof/CrossingProof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "Certificate.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

/// The triangles round each vertex, and whether they are clear of each other.
class Fans {
public:
    explicit Fans(const TriangleView& mesh)
        : mesh_(mesh),
          around_(mesh.points.size(),
                  [&](const auto& give) {
                      for (const auto& [a, b, c] : mesh.triangles) {
                          give(a, Sector{b, c});
                          give(b, Sector{c, a});
                          give(c, Sector{a, b});
                      }
                  }),
          isClear_(mesh.points.size(), 0) {
        constexpr std::int64_t kPiece = 4096;
        parallelForPieces(static_cast<std::int64_t>(isClear_.size()), kPiece,
                          [&](std::int64_t begin, std::int64_t end) {
                              for (std::int64_t v = begin; v < end; ++v) isClear_[v] = prove(v);
                          });
    }

    bool isClear(std::uint32_t v) const { return isClear_[v] != 0; }

private:
    using Sector = std::array<std::uint32_t, 2>;  ///< the other corners of a triangle, in its order

    /// Seen along one direction all are upright and go round the vertex once.
    bool prove(std::int64_t v) {
        const std::span<Sector> sectors = around_.of(static_cast<std::size_t>(v));
        const std::int64_t count = std::ssize(sectors);
        if (count < 3 || count > kFanMost) return false;
        for (std::int64_t i = 1; i < count; ++i) {  // into one ring
            const auto next =
                std::find_if(sectors.begin() + i, sectors.end(),
                             [&](const Sector& s) { return s[0] == sectors[i - 1][1]; });
            if (next == sectors.end()) return false;
            std::swap(sectors[i], *next);
        }
        if (sectors.back()[1] != sectors.front()[0]) return false;
        std::array<Vec3, kFanMost> spoke, area2;
        Vec3 axis;
        for (std::int64_t i = 0; i < count; ++i) {
            spoke[i] = mesh_.points[sectors[i][0]] - mesh_.points[v];
        }
        for (std::int64_t i = 0; i < count; ++i) {
            area2[i] = cross(spoke[i], spoke[(i + 1) % count]);
            axis += area2[i];
        }
        const Vec3 across =
            std::abs(axis.x) < std::abs(axis.y) ? cross(axis, {1, 0, 0}) : cross(axis, {0, 1, 0});
        const double least = kFanCosine * norm(axis);
        int rounds = 0;  // how often the sectors pass the direction from which `across` grows
        for (std::int64_t i = 0; i < count; ++i) {
            const double upright = dot(area2[i], axis);
            if (!(upright > 0 && upright * upright > least * least * squaredNorm(area2[i]))) {
                return false;
            }
            if (dot(spoke[i], across) < 0 && dot(spoke[(i + 1) % count], across) >= 0) ++rounds;
        }
        return rounds == 1;
    }

    const TriangleView& mesh_;
    Buckets<Sector, std::uint32_t> around_;
    std::vector<std::uint8_t> isClear_;
};

/// Two triangles that do not cross, for sure.
bool areClear(const TriangleView& mesh, const Fans& fans, std::uint32_t a, std::uint32_t b,
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
    std::optional<Fans> fans;
    parallelInvoke([&] { tree = TriangleTree(mesh); }, [&] { fans.emplace(mesh); });
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
