#include "adaptiso/MeshQuality/InsideTest.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include "Triangles.h"
#include "adaptiso/Core/Parallel.h"
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

/// True if the ray crosses an odd number of triangles; empty when `p` is on one.
std::optional<bool> crossesOddly(const Vec3& p, const Ray& ray, const TriangleMesh& mesh,
                                 const AabbTree& tree, std::int64_t* tests) {
    bool isOdd = false, isOn = false;
    tree.forEachOverlap(boxOf(p, ray), [&](std::int64_t triangle) {
        if (tests != nullptr) ++*tests;
        const Hit found = hitOf(p, ray, cornersOf(mesh, triangle));
        isOn = isOn || found.isOn;
        isOdd = isOdd != found.crosses;
    });
    if (isOn) return std::nullopt;
    return isOdd;
}

}  // namespace

InsideTest::InsideTest(const TriangleMesh& mesh, const AabbTree& tree)
    : mesh_(&mesh), tree_(&tree), box_(BoundingBox::empty()), isClosed_(everyEdgeIsInTwo(mesh)) {
    for (const std::int64_t triangle : tree.triangles()) box_.add(tree.triangleBox(triangle));
}

Side InsideTest::sideOf(const Vec3& p, std::int64_t* tests) const {
    constexpr int kRays = 6, kMajority = 4;
    if (!box_.overlaps({p, p})) return Side::Outside;
    int inside = 0, outside = 0;
    for (int n = 0; inside < kMajority && outside <= kRays - kMajority; ++n) {
        const auto isOdd = crossesOddly(p, {n % 3, n < 3 ? 1 : -1}, *mesh_, *tree_, tests);
        if (!isOdd) return Side::On;
        if (isClosed_) return *isOdd ? Side::Inside : Side::Outside;
        ++(*isOdd ? inside : outside);
    }
    return inside == kMajority ? Side::Inside : Side::Outside;
}

namespace {

/// \pre p lies in the triangle's plane
bool isOnTriangle(const Vec3& p, const Corners& t) {
    const int axis = axisWithArea(t);
    if (axis < 0) return false;
    const Point2 q = dropAxis(p, axis);
    const Point2 a = dropAxis(t[0], axis), b = dropAxis(t[1], axis), c = dropAxis(t[2], axis);
    return haveOneSign(orient2d(a, b, q), orient2d(b, c, q), orient2d(c, a, q));
}

}  // namespace

namespace {

/// \param side  orient2d of from, to and the point; 0 is broken as perturbedSide() has it
int brokenTie(int side, const Point2& from, const Point2& to) {
    if (side != 0) return side;
    const double along = to[0] - from[0], up = to[1] - from[1];
    if (along != 0) return along > 0 ? 1 : -1;
    return up > 0 ? -1 : up < 0 ? 1 : 0;
}

}  // namespace

int perturbedSide(const Point2& p, const Point2& from, const Point2& to) {
    return brokenTie(orient2d(from, to, p), from, to);
}

Hit hitOf(const Vec3& p, const Ray& ray, const Corners& t) {
    const Point2 q = dropAxis(p, ray.axis);
    const Point2 a = dropAxis(t[0], ray.axis), b = dropAxis(t[1], ray.axis),
                 c = dropAxis(t[2], ray.axis);
    const std::array<int, 3> sides{orient2d(a, b, q), orient2d(b, c, q), orient2d(c, a, q)};
    if (!haveOneSign(sides[0], sides[1], sides[2])) return {};  // the line passes beside it
    const int height = orient3d(t[0], t[1], t[2], p);
    if (height == 0 && isOnTriangle(p, t)) return {.isOn = true};
    const int facing = brokenTie(sides[0], a, b);  // 1: the normal points along the axis
    if (facing == 0 || brokenTie(sides[1], b, c) != facing || brokenTie(sides[2], c, a) != facing) {
        return {};
    }
    return {.crosses = height * facing * ray.sign < 0};
}

BoundingBox boxOf(const Vec3& p, const Ray& ray) {
    BoundingBox box{p, p};
    (ray.sign > 0 ? box.maximum : box.minimum)[ray.axis] =
        ray.sign * std::numeric_limits<double>::infinity();
    return box;
}

namespace {

/// Signed solid angle of a triangle seen from the origin: positive seen from behind.
double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double triple = dot(a, cross(b, c));
    return 2 * std::atan2(triple, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

double solidAngleShare(const TriangleMesh& mesh, const Vec3& p) {
    requireIndices(mesh, "solidAngleShare");
    constexpr std::int64_t kGrain = 4096;
    const std::int64_t count = std::ssize(mesh.triangles);
    std::vector<double> sums((count + kGrain - 1) / kGrain);
    parallelForPieces(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
        double sum = 0;
        for (std::int64_t n = begin; n < end; ++n) {
            const Corners t = cornersOf(mesh, n);
            sum += solidAngle(t[0] - p, t[1] - p, t[2] - p);
        }
        sums[begin / kGrain] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0) / (4 * std::numbers::pi);
}

SolidAngleCriterion solidAngleFromMean(const TriangleMesh& mesh) {
    if (mesh.points.empty()) return {std::numeric_limits<double>::quiet_NaN()};
    Vec3 sum;
    for (const Vec3& p : mesh.points) sum += p;
    return {solidAngleShare(mesh, 1.0 / static_cast<double>(mesh.points.size()) * sum)};
}

}  // namespace adaptiso
