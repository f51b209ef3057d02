#include "adaptiso/MeshQuality/TriangleDistance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>
#include <tuple>
#include <vector>

#include "ExactTriangle.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kGrain = 1024;
/// Bounds below and distances are both rounded: a pair is passed over only when its bound is
/// larger by more than that, so that every pair at the smallest distance is looked at.
constexpr double kSlack = 1 + 1e-12;

struct Best {
    double squared = std::numeric_limits<double>::infinity();
    Vec3 a, b;

    void offer(const Vec3& p, const Vec3& q) {
        const double candidate = squaredNorm(p - q);
        if (candidate < squared) *this = {candidate, p, q};
    }
};

/// The nearest points of two segments [Ericson2005, section 5.1.9].
void offerSegments(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2, Best& best) {
    const Vec3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
    const double a = squaredNorm(d1), e = squaredNorm(d2), f = dot(d2, r);
    const double b = dot(d1, d2), c = dot(d1, r);
    if (!(a > 0) || !(e > 0)) return;  // a point: the corners' turn
    const double denominator = a * e - b * b;
    double s = denominator > 0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0;
    double t = (b * s + f) / e;
    if (t < 0) {
        t = 0;
        s = std::clamp(-c / a, 0.0, 1.0);
    } else if (t > 1) {
        t = 1;
        s = std::clamp((b - c) / a, 0.0, 1.0);
    }
    best.offer(p1 + s * d1, p2 + t * d2);
}

/// The point where a segment passes the triangle's plane, if it does, and the nearest of the
/// triangle: one point where the segment goes through.
template <class Offer>
void offerPassage(const Vec3& p, const Vec3& q, const Corners& t, const Offer& offer) {
    const Vec3 normal = areaVector2(t[0], t[1], t[2]);
    const double hp = dot(normal, p - t[0]), hq = dot(normal, q - t[0]);
    if (!(hp * hq <= 0) || hp == hq) return;
    const Vec3 x = p + hp / (hp - hq) * (q - p);
    offer(x, closestPointOnTriangle(x, t[0], t[1], t[2]));
}

Best nearestPoints(const Corners& a, const Corners& b) {
    Best best;
    for (int n = 0; n < 3; ++n) {
        best.offer(a[n], closestPointOnTriangle(a[n], b[0], b[1], b[2]));
        best.offer(closestPointOnTriangle(b[n], a[0], a[1], a[2]), b[n]);
        for (int m = 0; m < 3; ++m) {
            offerSegments(a[n], a[(n + 1) % 3], b[m], b[(m + 1) % 3], best);
        }
    }
    return best;
}

/// A point that two triangles have in common, as nearly as doubles tell.
Best commonPoint(const Corners& a, const Corners& b) {
    Best best = nearestPoints(a, b);
    for (int n = 0; n < 3; ++n) {
        offerPassage(a[n], a[(n + 1) % 3], b,
                     [&](const Vec3& x, const Vec3& y) { best.offer(x, y); });
        offerPassage(b[n], b[(n + 1) % 3], a,
                     [&](const Vec3& x, const Vec3& y) { best.offer(y, x); });
    }
    best.b = best.a;
    best.squared = 0;
    return best;
}

/// Whether a slab across the line along `across` that lies between the triangles is thicker than
/// the root of `squaredReach`.
bool isSlabThicker(const Vec3& across, const Corners& a, const Corners& b, double squaredReach) {
    const double high = std::max(std::max(dot(across, a[0]), dot(across, a[1])), dot(across, a[2]));
    const double low = std::min(std::min(dot(across, b[0]), dot(across, b[1])), dot(across, b[2]));
    // both are rounded by some 1e-15 of their size
    const double gap = low - high - 1e-14 * (std::abs(low) + std::abs(high));
    return gap > 0 && gap * gap > squaredReach * squaredNorm(across);
}

/// The corner farthest along a direction.
const Vec3& support(const Corners& t, const Vec3& along) {
    const double h0 = dot(along, t[0]), h1 = dot(along, t[1]), h2 = dot(along, t[2]);
    return h0 >= h1 ? (h0 >= h2 ? t[0] : t[2]) : (h1 >= h2 ? t[1] : t[2]);
}

/// Whether two triangles surely lie further apart than the root of `squaredReach`: first steps of
/// [Gilbert1988]. Tight for triangles that face each other, where boxes are not.
bool areFartherThan(double squaredReach, const Corners& a, const Corners& b) {
    const Vec3 across = (b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2]);
    if (isSlabThicker(across, a, b, squaredReach)) return true;
    return isSlabThicker(support(b, -across) - support(a, across), a, b, squaredReach);
}

/// The smallest squared distance that any thread has found.
class SharedReach {
public:
    explicit SharedReach(double squared) : squared_(squared) {}
    double squared() const { return squared_.load(std::memory_order_relaxed); }
    void shrinkTo(double squared) {
        double seen = squared_.load();
        while (squared < seen && !squared_.compare_exchange_weak(seen, squared)) {
        }
    }

private:
    std::atomic<double> squared_;
};

/// A reach to begin with: the smallest distance of some vertices of `a` to `b`.
double firstReach(const TriangleMesh& a, const AabbTree& treeB) {
    constexpr std::int64_t kProbes = 512;
    const std::int64_t count = std::ssize(a.triangles);
    double reach = std::numeric_limits<double>::infinity();
    for (std::int64_t n = 0; n < count; n += std::max<std::int64_t>(1, count / kProbes)) {
        const Corners corners = cornersOf(a, n);
        if (!areFinite(corners)) continue;
        reach = std::min(reach, treeB.closestPoint(corners[0]).squaredDistanceMm2);
    }
    return reach;
}

constexpr std::int64_t kGroup = 4;  // a leaf of the tree

/// Triangles that lie near each other.
struct Group {
    Group(const TriangleMesh& mesh, const AabbTree& tree, std::span<const std::int64_t> numbers)
        : triangles(numbers), count(std::ssize(numbers)), box(tree.triangleBox(numbers[0])) {
        for (std::int64_t n = 0; n < count; ++n) {
            corners[n] = cornersOf(mesh, numbers[n]);
            box.add(tree.triangleBox(numbers[n]));
        }
    }

    std::span<const std::int64_t> triangles;
    std::int64_t count;
    BoundingBox box;
    std::array<Corners, kGroup> corners;
};

struct GapCandidate {
    double squared = std::numeric_limits<double>::infinity();
    std::int64_t triangleA = -1, triangleB = -1;

    bool operator<(const GapCandidate& other) const {
        return std::tie(squared, triangleA, triangleB) <
               std::tie(other.squared, other.triangleA, other.triangleB);
    }
};

}  // namespace

NearestPoints triangleDistance(const Corners& a, const Corners& b) {
    const Best best = trianglesMeet(a, b) ? commonPoint(a, b) : nearestPoints(a, b);
    return {std::sqrt(best.squared), best.a, best.b};
}

SurfaceGap surfaceGap(const TriangleMesh& a, const AabbTree& treeA, const TriangleMesh& b,
                      const AabbTree& treeB) {
    SharedReach reach(firstReach(a, treeB));
    // neighbours in the tree's order are asked for together
    const std::span<const std::int64_t> triangles = treeA.triangles();
    const std::int64_t count = std::ssize(triangles);
    std::vector<GapCandidate> ofPiece((count + kGrain - 1) / kGrain);
    const auto slackReach = [&] { return reach.squared() * kSlack; };
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        GapCandidate& best = ofPiece[begin / kGrain];
        for (std::int64_t i = begin; i < end; i += kGroup) {
            const Group group(a, treeA, triangles.subspan(i, std::min(kGroup, end - i)));
            treeB.forEachNear(group.box, slackReach, [&](std::int64_t other) {
                const Corners others = cornersOf(b, other);
                for (std::int64_t n = 0; n < group.count; ++n) {
                    const Corners& corners = group.corners[n];
                    if (areFartherThan(slackReach(), corners, others)) continue;
                    const double squared =
                        trianglesMeet(corners, others) ? 0 : nearestPoints(corners, others).squared;
                    best = std::min(best, {squared, group.triangles[n], other});
                    reach.shrinkTo(squared);
                }
            });
        }
    });
    const auto best = std::min_element(ofPiece.begin(), ofPiece.end());
    if (best == ofPiece.end() || best->triangleA < 0) return {};
    return {triangleDistance(cornersOf(a, best->triangleA), cornersOf(b, best->triangleB)),
            best->triangleA, best->triangleB};
}

}  // namespace adaptiso
