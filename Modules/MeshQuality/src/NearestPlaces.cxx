#include "adaptiso/MeshQuality/NearestPlaces.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "NumberedTriangles.h"
#include "TriangleGroups.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {

RoughDistances findNearestPlaces(const TriangleMesh& mesh, const AabbTree& tree, std::int64_t count,
                                 const std::function<std::optional<Vec3>(std::int64_t)>& pointOf,
                                 const std::function<void(std::int64_t, const ClosestPoint&)>& take,
                                 bool areNear) {
    constexpr std::int64_t kPiece = 4096;
    constexpr std::int64_t kMost = 256 * kPiece;  // triangles to look at by the tree, for a piece
    constexpr std::int64_t kFirst = 64, kMostOfFirst = 4096 * kFirst;  // and for its first points
    constexpr std::int64_t kMostByGroups = 64 * kPiece;
    constexpr std::int64_t kOfEach = 128;  // for a point where these are used up
    const std::int64_t pieces = (count + kPiece - 1) / kPiece;
    std::vector<std::uint8_t> isHard(static_cast<std::size_t>(pieces));
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        SearchEffort effort{kMost};
        std::int64_t hint = -1;
        for (std::int64_t n = begin; n < end; ++n) {
            const std::optional<Vec3> point = pointOf(n);
            if (!point) continue;
            const ClosestPoint nearest = tree.closestPoint(*point, hint, &effort);
            if (areNear) hint = nearest.triangle;
            take(n, nearest);
            const bool isCostly = n < begin + kFirst && kMost - effort.triangles > kMostOfFirst;
            if (!effort.isUsedUp() && !isCostly) continue;
            isHard[begin / kPiece] = 1;
            return;
        }
    });
    std::vector<std::int64_t> hard;
    for (std::int64_t n = 0; n < pieces; ++n) {
        if (isHard[n] != 0) hard.push_back(n);
    }
    if (hard.empty() || mesh.points.size() > std::numeric_limits<std::uint32_t>::max()) return {};
    const NumberedTriangles numbered(mesh);
    const TriangleGroups groups(numbered.view(), false);
    const TriangleGroups::Boxes boxes(groups);
    std::vector<RoughDistances> rough(hard.size());
    parallelForPieces(std::ssize(hard), 1, [&](std::int64_t h, std::int64_t) {
        SearchEffort effort{kMostByGroups};
        std::int64_t hint = -1;
        const std::int64_t begin = hard[h] * kPiece, end = std::min(count, begin + kPiece);
        for (std::int64_t n = begin; n < end; ++n) {
            const std::optional<Vec3> point = pointOf(n);
            if (!point) continue;
            ClosestPoint nearest;
            if (hint >= 0) {
                const Corners c = cornersOf(mesh, numbered.numbers[hint]);
                nearest.triangle = hint;
                nearest.pointMm = closestPointOnTriangle(*point, c[0], c[1], c[2]);
                nearest.squaredDistanceMm2 = squaredNorm(*point - nearest.pointMm);
            }
            effort.triangles = std::max(effort.triangles, kOfEach);
            nearest = boxes.closestPoint(*point, nearest, effort);
            hint = nearest.triangle;
            nearest.triangle = numbered.numbers[hint];
            take(n, nearest);
            rough[h] += {effort.isRough && !effort.isOpen, effort.isOpen};
        }
    });
    RoughDistances sum;
    for (const RoughDistances& some : rough) sum += some;
    return sum;
}

}  // namespace adaptiso
