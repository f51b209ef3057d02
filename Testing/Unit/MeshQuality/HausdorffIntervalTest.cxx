#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"

namespace adaptiso {
namespace {

using testing::cubeMesh;
using testing::icosphere;
using testing::merged;
using testing::planeMesh;
using testing::translated;

/// mm; twice the rounding that an interval includes where coordinates are up to 100 mm.
constexpr double kRounding = 1e-10;

HausdorffOptions oneWay() {
    HausdorffOptions options;
    options.isSymmetric = false;
    return options;
}

/// The interval holds the truth, and is as narrow as it says.
void expectHolds(const HausdorffInterval& interval, double truthMm, double sizeMm) {
    EXPECT_LE(interval.lowerMm, truthMm);
    EXPECT_GE(interval.upperMm, truthMm);
    EXPECT_TRUE(interval.isComplete);
    EXPECT_LE(interval.upperMm - interval.lowerMm, std::max(1e-3 * truthMm, 1e-6 * sizeMm));
    EXPECT_NEAR(norm(interval.pointMm - interval.nearestMm), interval.lowerMm, kRounding);
}

TriangleMesh pointsAsTriangles(const std::vector<Vec3>& points) {
    TriangleMesh mesh;
    for (const Vec3& p : points) {
        const VertexId v = std::ssize(mesh.points);
        mesh.points.push_back(p);
        mesh.triangles.push_back({v, v, v});
    }
    return mesh;
}

TriangleMesh loneTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {{a, b, c}, {}, {{0, 1, 2}}};
}

TEST(HausdorffInterval, HoldsTheShiftOfPlanes) {
    const HausdorffReport report = hausdorffDistance(planeMesh(7, 10), planeMesh(3, 10, 2.5));
    for (const HausdorffInterval& i : {report.aToB, *report.bToA, report.combined}) {
        expectHolds(i, 2.5, 15);
    }
}

TEST(HausdorffInterval, OfAMeshAndItselfIsZeroToRounding) {
    const TriangleMesh mesh = testing::torusMesh(60, 40, 50, 20);
    const HausdorffInterval interval = hausdorffDistance(mesh, mesh).combined;
    EXPECT_EQ(interval.lowerMm, 0);
    EXPECT_LE(interval.upperMm, kRounding);
}

TEST(HausdorffInterval, HoldsTheGapOfConcentricSpheres) {
    // A vertex of the outer one is nearest to that of the inner one on its ray: 2 mm. Faces of the
    // inner one have those of the outer one over them, nearer by the cosine of their angle.
    const HausdorffReport report = hausdorffDistance(icosphere(5, {}, 12), icosphere(5, {}, 10));
    expectHolds(report.aToB, 2, 42);
    expectHolds(report.combined, 2, 42);
    EXPECT_LT(report.bToA->upperMm, 2);
    EXPECT_GT(report.bToA->lowerMm, 2 * 0.999);  // facets are 2 degrees wide
}

TEST(HausdorffInterval, HoldsASpike) {
    TriangleMesh spike = planeMesh(10, 10);
    spike.points[60].z = 40;  // (5, 5)
    const HausdorffInterval interval = hausdorffDistance(spike, planeMesh(10, 10)).aToB;
    expectHolds(interval, 40, 45);
    EXPECT_EQ(interval.pointMm, (Vec3{5, 5, 40}));
    EXPECT_EQ(interval.nearestMm, (Vec3{5, 5, 0}));
}

TEST(HausdorffInterval, HoldsTheCornerOfACubeInAnother) {
    const HausdorffReport report = hausdorffDistance(cubeMesh(), cubeMesh({0, 0, 0}, {2, 2, 2}));
    expectHolds(report.aToB, 1, 4);
    expectHolds(*report.bToA, std::numbers::sqrt3, 4);
}

TEST(HausdorffInterval, FindsTheFarthestPointWithinATriangle) {
    // three points at the corners: farthest from them is the circumcentre (2, 1), the root of 5
    // away
    const std::vector<Vec3> corners{{0, 0, 0}, {4, 0, 0}, {1, 3, 0}};
    const HausdorffInterval interval =
        hausdorffDistance(loneTriangle(corners[0], corners[1], corners[2]),
                          pointsAsTriangles(corners), oneWay())
            .aToB;
    expectHolds(interval, std::sqrt(5.0), 5);
    EXPECT_NEAR(norm(interval.pointMm - Vec3{2, 1, 0}), 0, 0.1);
}

TEST(HausdorffInterval, TakesTrianglesWithoutArea) {
    // a segment, half-way between two points
    const TriangleMesh segment = loneTriangle({0, 0, 0}, {10, 0, 0}, {3, 0, 0});
    const HausdorffReport report =
        hausdorffDistance(segment, pointsAsTriangles({{0, 0, 0}, {10, 0, 0}}));
    expectHolds(report.aToB, 5, 10);
    EXPECT_LE(report.bToA->upperMm, kRounding);
    // a needle of 1e-13 of its length: beside its middle, not beside its corners
    const TriangleMesh needle = loneTriangle({0, 0, 0}, {100, 0, 0}, {30, 1e-11, 0});
    expectHolds(hausdorffDistance(pointsAsTriangles({{50, 0, 7}}), needle).aToB, 7, 100);
}

TEST(HausdorffInterval, IsOneSidedWhereASurfaceIsPartOfAnother) {
    const HausdorffReport report = hausdorffDistance(planeMesh(2, 1), planeMesh(4, 4));
    EXPECT_LE(report.aToB.upperMm, kRounding);
    expectHolds(*report.bToA, 3 * std::numbers::sqrt2, 6);
    expectHolds(report.combined, 3 * std::numbers::sqrt2, 6);
    const HausdorffReport one = hausdorffDistance(planeMesh(2, 1), planeMesh(4, 4), oneWay());
    EXPECT_FALSE(one.bToA);
    EXPECT_EQ(one.combined.upperMm, report.aToB.upperMm);
}

TEST(HausdorffInterval, HoldsTheFarPartOfTwo) {
    const TriangleMesh cube = cubeMesh();
    const HausdorffReport report =
        hausdorffDistance(merged({cube, translated(cube, {100, 0, 0})}), cube);
    expectHolds(report.aToB, 100, 101);
    EXPECT_LE(report.bToA->upperMm, kRounding);
}

TEST(HausdorffInterval, HoldsFarFromTheOrigin) {
    const Vec3 far{1e6, -1e6, 1e6};
    HausdorffOptions options;
    options.partOfSize = 1e-4;  // coordinates are rounded to 2e-10, an end to 5e-7
    const HausdorffInterval interval =
        hausdorffDistance(translated(planeMesh(9, 10), far),
                          translated(planeMesh(4, 10, 0.25), far), options)
            .combined;
    EXPECT_LE(interval.lowerMm, 0.25);
    EXPECT_GE(interval.upperMm, 0.25);
    EXPECT_TRUE(interval.isComplete);
}

constexpr double kTurnedSize = 565;  // the diagonal of the next one's box
/// A square of other triangles in the same plane, turned by an angle.
TriangleMesh turnedPlane(int steps, double heightMm) {
    TriangleMesh mesh = planeMesh(steps, 300, heightMm);
    for (Vec3& p : mesh.points) {
        p = {0.9 * (p.x - 150) - 0.43 * (p.y - 150), 0.43 * (p.x - 150) + 0.9 * (p.y - 150), p.z};
    }
    return mesh;
}

TEST(HausdorffInterval, HoldsBetweenOtherTrianglesInOnePlane) {
    const TriangleMesh plane = translated(planeMesh(37, 100), {-50, -50, 0});
    const HausdorffInterval same = hausdorffDistance(plane, turnedPlane(61, 0), oneWay()).aToB;
    EXPECT_EQ(same.lowerMm, 0);
    EXPECT_LE(same.upperMm, 1e-6 * kTurnedSize);
    EXPECT_TRUE(same.isComplete);
    expectHolds(hausdorffDistance(plane, turnedPlane(61, 0.3), oneWay()).aToB, 0.3, kTurnedSize);
}

TEST(HausdorffInterval, IsNarrowedUntilALimitIsJudged) {
    const TriangleMesh plane = translated(planeMesh(37, 100), {-50, -50, 0});
    const TriangleMesh other = turnedPlane(61, 0.3);
    const auto upper = [&](double limitMm) {
        HausdorffOptions options = oneWay();
        options.limitMm = limitMm;
        return hausdorffDistance(plane, other, options).aToB.upperMm;
    };
    EXPECT_LE(upper(0.300001), 0.300001);  // the tolerance alone is 6e-4
    EXPECT_GT(upper(0.299999), 0.299999);
    EXPECT_GT(upper(0.3), 0.3);  // nothing that rounding may change is shown
    EXPECT_LE(upper(0.3), 0.3 + 2 * kRounding);
}

TEST(HausdorffInterval, BeginsWithPointsThatAreGiven) {
    // the circumcentre: no vertex is as far
    const TriangleMesh large = loneTriangle({0, 0, 0}, {4, 0, 0}, {1, 3, 0});
    HausdorffOptions options = oneWay();
    options.farOnA = Vec3{2, 1, 0};
    const HausdorffInterval interval =
        hausdorffDistance(large, pointsAsTriangles(large.points), options).aToB;
    EXPECT_EQ(interval.pointMm, (Vec3{2, 1, 0}));
    expectHolds(interval, std::sqrt(5.0), 5);
}

class RandomMeshes {
public:
    explicit RandomMeshes(unsigned seed) : random_(seed) {}

    /// Triangles anywhere, of all sizes; some are needles, flat or points, some in one plane.
    TriangleMesh triangles() {
        TriangleMesh mesh;
        const int count = 1 + static_cast<int>(30 * number());
        for (int n = 0; n < count; ++n) {
            const Vec3 middle = vector(10);
            const double size = std::pow(10, 1 - 3 * number());
            const VertexId v = std::ssize(mesh.points);
            for (int i = 0; i < 3; ++i) mesh.points.push_back(middle + vector(size));
            const double kind = number();
            Vec3* const p = &mesh.points[v];
            if (kind < 0.1) p[2] = p[0] + number() * (p[1] - p[0]);
            if (kind >= 0.1 && kind < 0.2) p[2] = p[0] + 0.4 * (p[1] - p[0]) + vector(1e-9);
            if (kind >= 0.2 && kind < 0.25) p[1] = p[2] = p[0];
            if (kind >= 0.25 && kind < 0.4) p[0].z = p[1].z = p[2].z = 0;
            mesh.triangles.push_back({v, v + 1, v + 2});
        }
        return mesh;
    }

    TriangleMesh roughSphere(int subdivisions, double roughness) {
        TriangleMesh mesh = icosphere(subdivisions, {}, 10);
        for (Vec3& p : mesh.points) p += vector(roughness);
        return mesh;
    }

private:
    double number() { return std::uniform_real_distribution<>(0, 1)(random_); }
    Vec3 vector(double size) {
        return {size * (number() - 0.5), size * (number() - 0.5), size * (number() - 0.5)};
    }

    std::mt19937 random_;
};

using Precise = std::array<long double, 3>;

Precise operator-(const Precise& a, const Precise& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Precise along(const Precise& a, long double t, const Precise& e) {
    return {a[0] + t * e[0], a[1] + t * e[1], a[2] + t * e[2]};
}
long double product(const Precise& a, const Precise& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Squared; of needles too: from its sides, and from its face where that is below the point.
long double preciseDistance(const Precise& p, std::array<Precise, 3> t) {
    const auto length = [&](int i) {
        return product(t[(i + 1) % 3] - t[i], t[(i + 1) % 3] - t[i]);
    };
    while (length(0) < length(1) || length(0) < length(2)) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
    }
    long double least = std::numeric_limits<long double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const Precise e = t[(i + 1) % 3] - t[i];
        const long double part =
            length(i) > 0 ? std::clamp(product(p - t[i], e) / length(i), 0.0L, 1.0L) : 0;
        const Precise way = p - along(t[i], part, e);
        least = std::min(least, product(way, way));
    }
    if (!(length(0) > 0)) return least;
    const Precise e = t[1] - t[0], f = t[2] - t[0], q = p - t[0];
    const long double foot = product(e, f) / length(0);
    const Precise height = along(f, -foot, e);
    if (!(product(height, height) > 0)) return least;
    const long double up = product(q, height) / product(height, height),
                      side = product(q, e) / length(0) - up * foot;
    if (up < 0 || side < 0 || up + side > 1) return least;
    const Precise way = along(along(q, -up, f), -side, e);
    return std::min(least, product(way, way));
}

double bruteDistance(const Vec3& p, const TriangleMesh& mesh) {
    const auto precise = [](const Vec3& v) { return Precise{v.x, v.y, v.z}; };
    long double squared = std::numeric_limits<long double>::infinity();
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
        const Corners c = cornersOf(mesh, t);
        squared = std::min(
            squared, preciseDistance(precise(p), {precise(c[0]), precise(c[1]), precise(c[2])}));
    }
    return static_cast<double>(std::sqrt(squared));
}

/// The largest distance of a lattice of points on each triangle.
double sampledDistance(const TriangleMesh& from, const TriangleMesh& to, int steps) {
    double largest = 0;
    for (std::int64_t t = 0; t < std::ssize(from.triangles); ++t) {
        const Corners c = cornersOf(from, t);
        for (int i = 0; i <= steps; ++i) {
            for (int j = 0; i + j <= steps; ++j) {
                const Vec3 p = c[0] + (double(i) / steps) * (c[1] - c[0]) +
                               (double(j) / steps) * (c[2] - c[0]);
                largest = std::max(largest, bruteDistance(p, to));
            }
        }
    }
    return largest;
}

// the width of the needles, where long doubles lose the digits
constexpr double kOfNeedle = 1e-9;

void expectHoldsSamples(const TriangleMesh& a, const TriangleMesh& b, int steps) {
    const HausdorffReport report = hausdorffDistance(a, b);
    const auto expect = [&](const HausdorffInterval& interval, const TriangleMesh& from,
                            const TriangleMesh& to) {
        EXPECT_TRUE(interval.isComplete);
        EXPECT_LE(sampledDistance(from, to, steps), interval.upperMm);
        EXPECT_LE(interval.lowerMm, bruteDistance(interval.pointMm, to) + kRounding);
        EXPECT_LE(bruteDistance(interval.pointMm, from), kOfNeedle);
        EXPECT_LE(bruteDistance(interval.nearestMm, to), kOfNeedle);
    };
    expect(report.aToB, a, b);
    expect(*report.bToA, b, a);
    EXPECT_EQ(report.combined.lowerMm, std::max(report.aToB.lowerMm, report.bToA->lowerMm));
    EXPECT_EQ(report.combined.upperMm, std::max(report.aToB.upperMm, report.bToA->upperMm));
}

TEST(HausdorffInterval, HoldsWhatSamplesFindOnRandomTriangles) {
    for (unsigned seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE(seed);
        RandomMeshes random(seed);
        const TriangleMesh a = random.triangles();
        expectHoldsSamples(a, random.triangles(), 8);
    }
}

TEST(HausdorffInterval, HoldsWhatSamplesFindOnRandomSpheres) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(seed);
        RandomMeshes random(seed);
        const TriangleMesh a = random.roughSphere(2, 1 + seed);
        expectHoldsSamples(a, random.roughSphere(seed % 3, 0.1), 4);
    }
}

TEST(HausdorffInterval, IsTheSameWhateverTheNumberOfThreads) {
    RandomMeshes random(7);
    const TriangleMesh a = random.roughSphere(4, 0.3), b = random.roughSphere(5, 0.2);
    const auto run = [&](int threads) {
        const ThreadLimitGuard control(threads);
        return hausdorffDistance(a, b);
    };
    const HausdorffReport one = run(1), two = run(2);
    for (const auto& [l, r] : {std::pair{one.aToB, two.aToB}, {*one.bToA, *two.bToA}}) {
        EXPECT_EQ(l.lowerMm, r.lowerMm);
        EXPECT_EQ(l.upperMm, r.upperMm);
        EXPECT_EQ(l.pointMm, r.pointMm);
        EXPECT_EQ(l.nearestMm, r.nearestMm);
    }
}

/// Triangles around the origin that all cross each other.
TriangleMesh crossingTriangles(int count) {
    TriangleMesh mesh;
    for (int n = 0; n < count; ++n) {
        const double a = 2 * std::numbers::pi * n * 0.618034,
                     b = std::acos(1 - 2 * std::fmod(n * 0.7548777, 1));
        const Vec3 u{std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b)};
        const Vec3 v{-std::sin(a), std::cos(a), 0};
        const VertexId first = std::ssize(mesh.points);
        mesh.points.insert(mesh.points.end(), {50 * u, 50 * v, -50 * (u + v)});
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

TEST(HausdorffInterval, EndsAndHoldsWhereThousandsCross) {
    // budgets are counted, not timed: a fraction of a second each
    const TriangleMesh piled = crossingTriangles(2000);
    const HausdorffInterval shifted =
        hausdorffDistance(piled, translated(piled, {0.1, 0, 0}), oneWay()).aToB;
    EXPECT_LE(shifted.lowerMm, 0.1);
    EXPECT_GE(shifted.upperMm, shifted.lowerMm);
    EXPECT_TRUE(std::isfinite(shifted.upperMm));
    EXPECT_EQ(shifted.isComplete, shifted.upperMm - shifted.lowerMm <= 1e-6 * 200);
    const HausdorffInterval fromSphere =
        hausdorffDistance(icosphere(4, {}, 50), piled, oneWay()).aToB;
    EXPECT_LE(fromSphere.lowerMm, 50);
    EXPECT_LE(fromSphere.upperMm, 50 + kRounding);  // the origin lies on all triangles
}

TEST(HausdorffInterval, HoldsAtTheCentreOfASphere) {
    // as far from all triangles as from each
    const HausdorffInterval interval =
        hausdorffDistance(icosphere(0, {}, 1e-3), icosphere(6, {}, 10), oneWay()).aToB;
    EXPECT_GT(interval.lowerMm, 9.98);
    EXPECT_LE(interval.upperMm, 10.01);  // its tolerance is 0.01
    EXPECT_TRUE(interval.isComplete);
}

TEST(HausdorffInterval, UnusedVerticesDoNotCount) {
    TriangleMesh cube = testing::withUnusedVertex(cubeMesh());
    cube.points.back() = {1e3, std::nan(""), 0};
    EXPECT_LE(hausdorffDistance(cube, cubeMesh()).combined.upperMm, kRounding);
}

/// An unused vertex that comes first was taken for the farthest of vertices that all lie at 0.
TEST(HausdorffInterval, UnusedVerticesDoNotCountWhereAllElseIsEqual) {
    TriangleMesh cube = cubeMesh(), first = cube;
    first.points.insert(first.points.begin(), {7, 7, 7});
    for (Triangle& t : first.triangles) {
        for (VertexId& v : t) ++v;
    }
    EXPECT_LE(hausdorffDistance(first, cube).combined.upperMm, kRounding);
}

TEST(HausdorffInterval, RefusesWhatCannotBeMeasured) {
    const TriangleMesh cube = cubeMesh();
    EXPECT_THROW(hausdorffDistance({}, cube), InvalidInput);
    EXPECT_THROW(hausdorffDistance(cube, {}), InvalidInput);
    EXPECT_THROW(hausdorffDistance(testing::withNanCoordinate(cube), cube), InvalidInput);
    EXPECT_THROW(hausdorffDistance(cube, testing::withIndexOutOfRange(cube)), InvalidInput);
}

TEST(HausdorffInterval, TellsItsProgress) {
    std::vector<double> told;
    HausdorffOptions options;
    options.progress = [&](std::string_view, double fraction) { told.push_back(fraction); };
    hausdorffDistance(cubeMesh(), cubeMesh(), options);
    EXPECT_EQ(told, (std::vector<double>{0, 0.5, 1}));
}

}  // namespace
}  // namespace adaptiso
