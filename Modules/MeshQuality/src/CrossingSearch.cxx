#include "adaptiso/MeshQuality/CrossingSearch.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "ExactTriangle.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/HugePages.h"
#include "adaptiso/MeshQuality/Certificate.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {
namespace {

constexpr std::size_t kMostNumbers = std::numeric_limits<std::uint32_t>::max();

/// The triangles of a mesh whose corners are finite, by 32-bit numbers.
struct FiniteTriangles {
    std::vector<TriangleView::Triangle> triangles;
    std::vector<std::int64_t> numbers;  ///< in the mesh

    explicit FiniteTriangles(const TriangleMesh& mesh) {
        if (mesh.points.size() > kMostNumbers || mesh.triangles.size() > kMostNumbers) {
            throw InvalidInput("findSelfIntersections: the mesh has more than " +
                               std::to_string(kMostNumbers) + " points or triangles");
        }
        const auto pointCount = static_cast<std::int64_t>(mesh.points.size());
        reserveInHugePages(triangles, mesh.triangles.size());
        reserveInHugePages(numbers, mesh.triangles.size());
        for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
            const auto& [a, b, c] = mesh.triangles[n];
            for (const VertexId v : {a, b, c}) {
                if (v >= 0 && v < pointCount) continue;
                throw InvalidInput("findSelfIntersections: triangle " + std::to_string(n) +
                                   " names vertex " + std::to_string(v) + " of a mesh with " +
                                   std::to_string(pointCount) + " points");
            }
            if (!areFinite(cornersOf(mesh, n))) continue;
            triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                 static_cast<std::uint32_t>(c)});
            numbers.push_back(n);
        }
    }
};

/// Leaves the `count` smallest, in any order.
void keepFirst(std::vector<TrianglePair>& pairs, std::int64_t count) {
    if (std::ssize(pairs) <= count) return;
    std::nth_element(pairs.begin(), pairs.begin() + count, pairs.end());
    pairs.resize(static_cast<std::size_t>(count));
}

}  // namespace

CrossingSearch::CrossingSearch(const TriangleView& mesh) : mesh_(mesh) {
    parallelInvoke([&] { tree_ = TriangleTree(mesh); },
                   [&] { fans_.emplace(mesh.points, mesh.triangles); });
    const BoundingBox box = mesh.box();
    gap_ = mesh.triangles.empty() ? 0 : 1e-13 * (norm(box.maximum) + norm(box.minimum));
}

bool CrossingSearch::cross(std::uint32_t a, std::uint32_t b) const {
    return !areClear(a, b) && trianglesCross(mesh_.cornersOf(a), mesh_.cornersOf(b));
}

/// Two triangles that do not cross, for sure.
bool CrossingSearch::areClear(std::uint32_t a, std::uint32_t b) const {
    const TriangleView::Triangle &s = mesh_.triangles[a], &t = mesh_.triangles[b];
    std::array<int, 3> inT{};
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        const auto at = std::find(t.begin(), t.end(), s[i]);
        inT[i] = at == t.end() ? -1 : static_cast<int>(at - t.begin());
        if (inT[i] < 0) continue;
        if (fans_->isClear(s[i])) return true;
        ++shared;
    }
    const auto cornersFrom = [&](const TriangleView::Triangle& u, int first) {
        return Corners{mesh_.points[u[first]], mesh_.points[u[(first + 1) % 3]],
                       mesh_.points[u[(first + 2) % 3]]};
    };
    if (shared == 0) return areApart(cornersFrom(s, 0), cornersFrom(t, 0), gap_);
    if (shared == 1) {
        const int i = inT[0] >= 0 ? 0 : inT[1] >= 0 ? 1 : 2;
        return touchAtVertexOnly(cornersFrom(s, i), cornersFrom(t, inT[i]), gap_);
    }
    if (shared == 3) return false;
    const int other = inT[0] < 0 ? 0 : inT[1] < 0 ? 1 : 2;
    const Corners fromEdge = cornersFrom(s, (other + 1) % 3);
    const int otherInT = 3 - inT[(other + 1) % 3] - inT[(other + 2) % 3];
    return touchAtEdgeOnly(fromEdge, {fromEdge[1], fromEdge[0], mesh_.points[t[otherInT]]}, 0);
}

std::vector<std::int64_t> crossingTriangles(const TriangleView& mesh) {
    const CrossingSearch search(mesh);
    std::vector<std::vector<std::int64_t>> ofPiece(search.pieceCount());
    search.forEachPair([&](std::int64_t piece, std::uint32_t a, std::uint32_t b) {
        ofPiece[piece].insert(ofPiece[piece].end(), {a, b});
    });
    std::vector<std::int64_t> all;
    for (const auto& some : ofPiece) all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::vector<std::int64_t> crossingTriangles(const TriangleMesh& mesh) {
    const FiniteTriangles finite(mesh);
    std::vector<std::int64_t> crossing = crossingTriangles({mesh.points, finite.triangles});
    for (std::int64_t& t : crossing) t = finite.numbers[t];
    return crossing;
}

SelfIntersections findSelfIntersections(const TriangleMesh& mesh,
                                        const SelfIntersectionOptions& options) {
    if (options.maxPairs < 0) {
        throw InvalidInput("findSelfIntersections: maxPairs is " +
                           std::to_string(options.maxPairs) + ", must be at least 0");
    }
    const FiniteTriangles finite(mesh);
    const CrossingSearch search({mesh.points, finite.triangles});
    std::vector<SelfIntersections> ofPiece(search.pieceCount());
    search.forEachPair([&](std::int64_t piece, std::uint32_t a, std::uint32_t b) {
        SelfIntersections& found = ofPiece[piece];
        ++found.pairCount;
        if (options.maxPairs == 0) return;
        found.pairs.push_back({finite.numbers[a], finite.numbers[b]});
        if (std::ssize(found.pairs) / 2 > options.maxPairs) {
            keepFirst(found.pairs, options.maxPairs);
        }
    });
    SelfIntersections result;
    for (const SelfIntersections& piece : ofPiece) {
        result.pairCount += piece.pairCount;
        result.pairs.insert(result.pairs.end(), piece.pairs.begin(), piece.pairs.end());
    }
    keepFirst(result.pairs, options.maxPairs);
    std::sort(result.pairs.begin(), result.pairs.end());
    return result;
}

}  // namespace adaptiso
