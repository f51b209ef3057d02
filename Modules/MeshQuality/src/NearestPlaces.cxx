#include "adaptiso/MeshQuality/NearestPlaces.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>
#include <vector>

#include "NumberedTriangles.h"
#include "TriangleGroups.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kPlacePiece = 4096;

using PointOf = std::function<std::optional<Vec3>(std::int64_t)>;
using Take = std::function<void(std::int64_t, const ClosestPoint&)>;

/// Pieces where boxes along the axes do not tell triangles apart, ascending; all other points are
/// answered.
std::vector<std::int64_t> searchTree(const AabbTree& tree, std::int64_t count,
                                     const PointOf& pointOf, const Take& take, bool areNear) {
    constexpr std::int64_t kMost = 256 * kPlacePiece;  // triangles to look at, for a piece
    constexpr std::int64_t kFirst = 64, kMostOfFirst = 4096 * kFirst;  // and for its first points
    const std::int64_t pieces = (count + kPlacePiece - 1) / kPlacePiece;
    std::vector<std::uint8_t> isHard(static_cast<std::size_t>(pieces));
    parallelForPieces(count, kPlacePiece, [&](std::int64_t begin, std::int64_t end) {
        SearchEffort effort{kMost};
        std::int64_t hint = -1;
        for (std::int64_t n = begin; n < end; ++n) {
            const std::optional<Vec3> point = pointOf(n);
            if (!point) continue;
            const ClosestPoint nearest = tree.closestPoint(*point, hint, &effort);
            const bool isCostly = n < begin + kFirst && kMost - effort.triangles > kMostOfFirst;
            if (effort.isUsedUp() || isCostly) {
                isHard[begin / kPlacePiece] = 1;
                return;
            }
            if (areNear) hint = nearest.triangle;
            take(n, nearest);
        }
    });
    std::vector<std::int64_t> hard;
    for (std::int64_t n = 0; n < pieces; ++n) {
        if (isHard[n] != 0) hard.push_back(n);
    }
    return hard;
}

/// Searches by boxes along the triangles' own axes.
class GroupSearch {
public:
    GroupSearch(const TriangleMesh& mesh, const PointOf& pointOf, const Take& take)
        : mesh_(mesh),
          pointOf_(pointOf),
          take_(take),
          numbered_(mesh),
          groups_(numbered_.view(), false),
          boxes_(groups_) {}

    std::int64_t triangleCount() const { return std::ssize(numbered_.numbers); }

    /// Answers a piece's points, roughly where its budget is used up.
    /// \param endsAtOpen  the first point that is open ends it, unanswered
    /// \return the first point that is not answered
    std::int64_t searchPiece(std::int64_t begin, std::int64_t end, bool endsAtOpen,
                             RoughDistances& rough) const {
        constexpr std::int64_t kMost = 64 * kPlacePiece, kOfEach = 128;  // where it is used up
        SearchEffort effort{kMost};
        std::int64_t hint = -1;
        for (std::int64_t n = begin; n < end; ++n) {
            const std::optional<Vec3> point = pointOf_(n);
            if (!point) continue;
            effort.triangles = std::max(effort.triangles, kOfEach);
            const ClosestPoint nearest = boxes_.closestPoint(*point, hinted(*point, hint), effort);
            if (effort.isOpen && endsAtOpen) return n;
            hint = nearest.triangle;
            answer(n, nearest);
            rough += {effort.isRough && !effort.isOpen, effort.isOpen};
        }
        return end;
    }

    /// Answers points exactly, evenly spread, as many as `most` triangles to look at allow, one at
    /// least. \param standIns  gets the others
    void searchSome(std::span<const std::int64_t> points, std::int64_t most,
                    std::vector<StandIn>& standIns) const {
        constexpr std::int64_t kAll = std::numeric_limits<std::int64_t>::max();
        const std::int64_t count = std::ssize(points);
        std::vector<std::uint8_t> isDone(points.size());
        SearchEffort effort{kAll};
        const auto bits = static_cast<int>(std::bit_width(points.size() - 1));
        for (std::int64_t i = 0; i < std::int64_t{1} << bits && kAll - effort.triangles < most;
             ++i) {
            std::int64_t at = 0;  // the bits of i, mirrored
            for (int bit = 0; bit < bits; ++bit) at |= (i >> bit & 1) << (bits - 1 - bit);
            if (at >= count) continue;
            answer(points[at], boxes_.closestPoint(*pointOf_(points[at]), {}, effort));
            isDone[at] = 1;
        }
        std::int64_t before = -1;
        for (std::int64_t n = 0, after = 0; n < count; ++n) {
            if (isDone[n] != 0) {
                before = n;
                continue;
            }
            for (after = std::max(after, n); after < count && isDone[after] == 0;) ++after;
            const bool isBefore = before >= 0 && (after == count || n - before <= after - n);
            standIns.push_back({points[n], points[isBefore ? before : after]});
        }
    }

private:
    ClosestPoint hinted(const Vec3& point, std::int64_t hint) const {
        if (hint < 0) return {};
        const Corners c = cornersOf(mesh_, numbered_.numbers[hint]);
        const Vec3 nearest = closestPointOnTriangle(point, c[0], c[1], c[2]);
        return {hint, squaredNorm(point - nearest), nearest};
    }

    void answer(std::int64_t n, ClosestPoint nearest) const {
        nearest.triangle = numbered_.numbers[nearest.triangle];
        take_(n, nearest);
    }

    const TriangleMesh& mesh_;
    const PointOf& pointOf_;
    const Take& take_;
    NumberedTriangles numbered_;
    TriangleGroups groups_;
    TriangleGroups::Boxes boxes_;
};

template <class Item>
std::vector<Item> joined(const std::vector<std::vector<Item>>& parts) {
    std::vector<Item> all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace

RoughDistances findNearestPlaces(const TriangleMesh& mesh, const AabbTree& tree, std::int64_t count,
                                 const PointOf& pointOf, const Take& take, bool areNear,
                                 std::vector<StandIn>* standIns) {
    if (mesh.points.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw InvalidInput("findNearestPlaces: the mesh has more than 2^32 points");
    }
    const std::vector<std::int64_t> hard = searchTree(tree, count, pointOf, take, areNear);
    if (hard.empty()) return {};
    const GroupSearch search(mesh, pointOf, take);
    std::vector<RoughDistances> rough(hard.size());
    std::vector<std::vector<std::int64_t>> openOf(hard.size());
    parallelForPieces(std::ssize(hard), 1, [&](std::int64_t h, std::int64_t) {
        const std::int64_t begin = hard[h] * kPlacePiece,
                           end = std::min(count, begin + kPlacePiece);
        for (std::int64_t n = search.searchPiece(begin, end, standIns != nullptr, rough[h]);
             n < end; ++n) {
            if (pointOf(n)) openOf[h].push_back(n);
        }
    });
    RoughDistances sum;
    for (const RoughDistances& some : rough) sum += some;
    const std::vector<std::int64_t> open = joined(openOf);
    if (open.empty()) return sum;
    constexpr std::int64_t kOfEach = 256;  // triangles to look at
    const std::int64_t most = std::max(kOfEach * kPlacePiece, search.triangleCount());
    const std::int64_t part = most / kOfEach, openCount = std::ssize(open);  // points of a part
    std::vector<std::vector<StandIn>> ofPart((openCount + part - 1) / part);
    parallelForPieces(openCount, part, [&](std::int64_t begin, std::int64_t end) {
        search.searchSome({open.data() + begin, open.data() + end}, most, ofPart[begin / part]);
    });
    *standIns = joined(ofPart);
    return sum;
}

}  // namespace adaptiso
