#include "adaptiso/MeshQuality/HausdorffInterval.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "PieceSearch.h"
#include "Triangles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/NearestPlaces.h"

namespace adaptiso {
namespace {

using Corner = PieceSearch::Corner;

/// \throws InvalidInput when there is nothing to measure
BoundingBox measurableBox(const TriangleMesh& mesh) {
    requireIndices(mesh, "hausdorffDistance");
    if (mesh.triangles.empty()) throw InvalidInput("hausdorffDistance: a surface has no triangle");
    BoundingBox box = BoundingBox::empty();
    for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
        for (const Vec3& p : cornersOf(mesh, n)) {
            if (!std::isfinite(squaredNorm(p))) {
                throw InvalidInput("hausdorffDistance: triangle " + std::to_string(n) +
                                   " has a coordinate that is not finite");
            }
            box.add(p);
        }
    }
    return box;
}

double largestCoordinate(const BoundingBox& box) {
    double largest = 0;
    for (const Vec3& p : {box.minimum, box.maximum}) {
        largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    return largest;
}

/// The vertices that triangles use, each with a triangle near it.
std::vector<Corner> vertexCorners(const TriangleMesh& from, const DistanceTarget& to) {
    std::vector<std::uint8_t> isUsed(from.points.size());
    for (const Triangle& t : from.triangles) {
        for (const VertexId v : t) isUsed[v] = 1;
    }
    std::vector<Corner> corners(from.points.size());
    findNearestPlaces(
        to.mesh, to.tree, std::ssize(from.points),
        [&](VertexId v) { return isUsed[v] != 0 ? std::optional(from.points[v]) : std::nullopt; },
        [&](VertexId v, const ClosestPoint& nearest) {
            const Vec3& p = from.points[v];
            corners[v] = {p, nearest.triangle, to.squaredTo(p, nearest.triangle)};
        });
    return corners;
}

/// Bounds of the distance of some triangles from the other surface.
struct Bounds {
    FarPoint farthest;
    double closed = 0;  ///< squared bound of those that are done with
    double open = 0;    ///< of the others
    std::vector<std::int64_t> left;
    std::int64_t effort = 0;

    void add(const Bounds& more) {
        if (more.farthest.distance > farthest.distance) farthest = more.farthest;
        closed = std::max(closed, more.closed);
        open = std::max(open, more.open);
        left.insert(left.end(), more.left.begin(), more.left.end());
        effort += more.effort;
    }
};

/// Encloses the distance of one direction.
class Direction {
public:
    Direction(const TriangleMesh& from, const TriangleMesh& to, const Tolerance& tolerance)
        : from_(from), to_(to), tolerance_(tolerance), vertices_(vertexCorners(from, to_)) {}

    HausdorffInterval enclose(const std::optional<Vec3>& far) const {
        // Each triangle has the same effort, and those that need more eight times as much, until
        // all are done or would have no more. A triangle of a surface takes some 60, many hundreds
        // where one of the two is far coarser.
        constexpr std::int64_t kFirst = 2048, kGrowth = 8, kOfEach = 512, kLeast = 1 << 22;
        const std::int64_t count = std::ssize(from_.triangles);
        const std::int64_t budget = kLeast + kOfEach * (count + std::ssize(to_.mesh.triangles));
        Bounds all;
        all.farthest = farthestVertex(far);
        all.left.resize(from_.triangles.size());
        std::iota(all.left.begin(), all.left.end(), 0);
        const bool isInVain = isFirstInVain(kFirst, budget, all);
        if (isInVain) spend(0, all);
        for (std::int64_t each = kFirst, before = 0;
             !isInVain && !all.left.empty() && each > before;) {
            spend(each, all);
            before = each;
            each = all.left.empty()
                       ? 0
                       : std::min(kGrowth * each, (budget - all.effort) / std::ssize(all.left));
        }
        HausdorffInterval result;
        result.lowerMm = std::max(all.farthest.distance - tolerance_.roundingMm, 0.0);
        result.upperMm = std::sqrt(std::max(all.closed, all.open)) + tolerance_.roundingMm;
        result.toleranceMm = tolerance_.at(result.lowerMm);
        result.isComplete = result.upperMm - result.lowerMm <= result.toleranceMm;
        result.pointMm = all.farthest.point;
        result.nearestMm = all.farthest.nearest;
        return result;
    }

private:
    /// \param far  counts too
    FarPoint farthestVertex(const std::optional<Vec3>& far) const {
        const Corner& corner = *std::max_element(
            vertices_.begin(), vertices_.end(), [](const Corner& l, const Corner& r) {
                const bool isUsed = r.triangle >= 0;  // others have none
                return (l.triangle >= 0) == isUsed ? l.squared < r.squared : isUsed;
            });
        std::int64_t effort = 0;
        FarPoint farthest = to_.farPoint(corner.point, corner.triangle, effort);
        if (!far) return farthest;
        const FarPoint other = to_.farPoint(*far, corner.triangle, effort);
        return other.distance > farthest.distance ? other : farthest;
    }

    /// Whether an effort for each triangle would be more than a budget and leave many of them, by
    /// some that are evenly spread.
    bool isFirstInVain(std::int64_t each, std::int64_t budget, const Bounds& all) const {
        constexpr std::int64_t kSome = 1024;
        const std::int64_t count = std::ssize(all.left);
        if (count < kSome || budget > each * count) return false;
        Bounds some;
        some.farthest = all.farthest;
        for (std::int64_t n = 0; n < kSome; ++n) some.left.push_back(n * count / kSome);
        spend(each, some);
        return std::ssize(some.left) > kSome / 16 && some.effort / kSome > budget / count;
    }

    /// \param each  effort for each of the triangles that are left
    void spend(std::int64_t each, Bounds& all) const {
        constexpr std::int64_t kGrain = 64;
        std::vector<Bounds> parts((all.left.size() + kGrain - 1) / kGrain);
        parallelForPieces(std::ssize(all.left), kGrain, [&](std::int64_t begin, std::int64_t end) {
            PieceSearch search(to_, tolerance_, all.farthest);
            Bounds& part = parts[begin / kGrain];
            for (std::int64_t n = begin; n < end; ++n) {
                const auto& [a, b, c] = from_.triangles[all.left[n]];
                std::int64_t effort = each;
                const double bound =
                    search.bound({vertices_[a], vertices_[b], vertices_[c]}, effort);
                part.effort += each - effort;
                if (bound <= search.squaredEnough()) {
                    part.closed = std::max(part.closed, bound);
                } else {
                    part.open = std::max(part.open, bound);
                    part.left.push_back(all.left[n]);
                }
            }
            part.farthest = search.farthest();
        });
        all.left.clear();
        all.open = 0;
        for (const Bounds& part : parts) all.add(part);
    }

    const TriangleMesh& from_;
    DistanceTarget to_;
    const Tolerance& tolerance_;
    std::vector<Corner> vertices_;
};

HausdorffInterval larger(const HausdorffInterval& a, const HausdorffInterval& b) {
    HausdorffInterval result = a.lowerMm >= b.lowerMm ? a : b;
    result.upperMm = std::max(a.upperMm, b.upperMm);
    result.isComplete = a.isComplete && b.isComplete;
    return result;
}

}  // namespace

HausdorffReport hausdorffDistance(const TriangleMesh& a, const TriangleMesh& b,
                                  const HausdorffOptions& options) {
    const BoundingBox boxA = measurableBox(a), boxB = measurableBox(b);
    const Tolerance tolerance{
        options, std::max(norm(boxA.size()), norm(boxB.size())),
        Tolerance::roundingAt(std::max(largestCoordinate(boxA), largestCoordinate(boxB)))};
    const auto tell = [&](double fraction) {
        if (options.progress) options.progress("largest distance", fraction);
    };
    HausdorffReport report;
    tell(0);
    report.aToB = report.combined = Direction(a, b, tolerance).enclose(options.farOnA);
    if (options.isSymmetric) {
        tell(0.5);
        report.bToA = Direction(b, a, tolerance).enclose(options.farOnB);
        report.combined = larger(report.aToB, *report.bToA);
    }
    tell(1);
    return report;
}

}  // namespace adaptiso
