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
/// Points answered of a piece; with fewer it was in vain.
constexpr std::int64_t kFew = kPlacePiece / 16;
/// Triangles looked at for points that are open, all together.
constexpr std::int64_t kMostInAll = 1 << 24;

using PointOf = std::function<std::optional<Vec3>(std::int64_t)>;
using Take = std::function<void(std::int64_t, const ClosestPoint&)>;

/// Tries pieces in parallel. Where some, evenly spread, are all in vain, the others would be: they
/// are not tried, so that all together cost no more than these.
/// \param isInVain  isInVain(piece) tries one
/// \return for each piece whether it was in vain, or not tried
template <class IsInVain>
std::vector<std::uint8_t> tryPieces(std::int64_t pieces, const IsInVain& isInVain) {
    constexpr std::int64_t kFirst = 8;
    std::vector<std::uint8_t> areInVain(static_cast<std::size_t>(pieces), 1);
    const std::int64_t step = std::max<std::int64_t>(1, pieces / kFirst);
    const auto tryPiece = [&](std::int64_t n) { areInVain[n] = isInVain(n) ? 1 : 0; };
    parallelForPieces((pieces + step - 1) / step, 1,
                      [&](std::int64_t n, std::int64_t) { tryPiece(n * step); });
    if (std::ranges::find(areInVain, 0) == areInVain.end()) return areInVain;
    parallelForPieces(pieces, 1, [&](std::int64_t n, std::int64_t) {
        if (n % step != 0) tryPiece(n);
    });
    return areInVain;
}

/// Pieces where boxes along the axes do not tell triangles apart, ascending; all other points are
/// answered.
std::vector<std::int64_t> searchTree(const AabbTree& tree, std::int64_t count,
                                     const PointOf& pointOf, const Take& take, bool areNear) {
    constexpr std::int64_t kMost = 256 * kPlacePiece;  // triangles to look at, for a piece
    constexpr std::int64_t kFirst = 64, kMostOfFirst = 4096 * kFirst;  // and for its first points
    const std::int64_t pieces = (count + kPlacePiece - 1) / kPlacePiece;
    const std::vector<std::uint8_t> isHard = tryPieces(pieces, [&](std::int64_t piece) {
        const std::int64_t begin = piece * kPlacePiece, end = std::min(count, begin + kPlacePiece);
        SearchEffort effort{kMost};
        std::int64_t hint = -1;
        for (std::int64_t n = begin; n < end; ++n) {
            const std::optional<Vec3> point = pointOf(n);
            if (!point) continue;
            const ClosestPoint nearest = tree.closestPoint(*point, hint, &effort);
            const bool isCostly = n < begin + kFirst && kMost - effort.triangles > kMostOfFirst;
            if (effort.isUsedUp() || isCostly) return true;
            if (areNear) hint = nearest.triangle;
            take(n, nearest);
        }
        return false;
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

    /// Triangles to look at.
    struct Effort {
        std::int64_t ofPiece = 64 * kPlacePiece;
        std::int64_t ofEach = 128;  ///< where that is used up, before a point is rough
    };

    /// Answers a piece's points, roughly where its effort is used up.
    /// \param endsAtOpen  the first point that is open ends it, unanswered
    /// \return the first point that is not answered
    std::int64_t searchPiece(std::int64_t begin, std::int64_t end, bool endsAtOpen,
                             const Effort& most, RoughDistances& rough) const {
        SearchEffort effort{most.ofPiece};
        std::int64_t hint = -1;
        for (std::int64_t n = begin; n < end; ++n) {
            const std::optional<Vec3> point = pointOf_(n);
            if (!point) continue;
            effort.triangles = std::max(effort.triangles, most.ofEach);
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

/// Numbers of points that follow each other.
struct Range {
    std::int64_t begin, end;
};

/// Searches the hard pieces of `count` points.
/// \return what is left: pieces that are not tried, and where `endsAtOpen` those that are from
/// their first point that is open
std::vector<Range> searchPieces(const GroupSearch& search, const std::vector<std::int64_t>& hard,
                                std::int64_t count, bool endsAtOpen, RoughDistances& sum) {
    std::vector<RoughDistances> rough(hard.size());
    std::vector<Range> left;
    for (const std::int64_t piece : hard) {
        const std::int64_t begin = piece * kPlacePiece;
        left.push_back({begin, std::min(count, begin + kPlacePiece)});
    }
    tryPieces(std::ssize(hard), [&](std::int64_t h) {
        const auto [begin, end] = left[h];
        left[h].begin = search.searchPiece(begin, end, endsAtOpen, {}, rough[h]);
        return left[h].begin - begin - rough[h].open < kFew;
    });
    for (const RoughDistances& some : rough) sum += some;
    std::erase_if(left, [](const Range& range) { return range.begin == range.end; });
    return left;
}

/// Answers points by few triangles each.
void searchRoughly(const GroupSearch& search, const std::vector<Range>& left, RoughDistances& sum) {
    constexpr std::int64_t kLeast = 8, kMost = 512;  // to look at
    if (left.empty()) return;
    const std::int64_t ofEach =
        std::clamp(kMostInAll / (std::ssize(left) * kPlacePiece), kLeast, kMost) -
        SearchEffort::kMore;
    std::vector<RoughDistances> rough(left.size());
    parallelForPieces(std::ssize(left), 1, [&](std::int64_t n, std::int64_t) {
        search.searchPiece(left[n].begin, left[n].end, false, {ofEach, ofEach}, rough[n]);
    });
    for (const RoughDistances& some : rough) sum += some;
}

/// Answers some points, evenly spread. \return what stands for the others
std::vector<StandIn> searchEvenly(const GroupSearch& search, const std::vector<Range>& left,
                                  const PointOf& pointOf) {
    constexpr std::int64_t kOfEach = 256;  // triangles to look at
    constexpr std::int64_t kMostParts = kMostInAll / (kOfEach * kPlacePiece);
    std::vector<std::int64_t> open;
    for (const auto& [begin, end] : left) {
        for (std::int64_t n = begin; n < end; ++n) {
            if (pointOf(n)) open.push_back(n);
        }
    }
    const std::int64_t most = std::max(kOfEach * kPlacePiece, search.triangleCount());
    const std::int64_t count = std::ssize(open),
                       part = std::max(most / kOfEach, (count + kMostParts - 1) / kMostParts);
    std::vector<std::vector<StandIn>> ofPart((count + part - 1) / part);
    parallelForPieces(count, part, [&](std::int64_t begin, std::int64_t end) {
        search.searchSome({open.data() + begin, open.data() + end}, most, ofPart[begin / part]);
    });
    std::vector<StandIn> standIns;
    for (const auto& some : ofPart) standIns.insert(standIns.end(), some.begin(), some.end());
    return standIns;
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
    RoughDistances sum;
    const std::vector<Range> left = searchPieces(search, hard, count, standIns != nullptr, sum);
    if (standIns != nullptr) {
        *standIns = searchEvenly(search, left, pointOf);
    } else {
        searchRoughly(search, left, sum);
    }
    return sum;
}

}  // namespace adaptiso
