#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/mending/SurfaceMender.h"

namespace adaptiso::testing {
namespace {

using detail::PlaceBeyond;

PlaceBeyond placeAt(const Vec3& onSimplified, const Vec3& onFine, std::uint32_t triangle) {
    return {onSimplified, onFine, triangle, false};
}

std::uint32_t triangleUnder(const detail::SimplifiedSurface& surface, const Vec3& p) {
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::max();
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        const double squared = detail::squaredDistanceToTriangle(
            p, {surface.points[a], surface.points[b], surface.points[c]});
        if (squared < least) {
            least = squared;
            best = t;
        }
    }
    return best;
}

constexpr double kLimitMm = 0.5;

}  // namespace

TEST(SurfaceMender, SplitsATriangleInThree) {
    detail::SimplifiedSurface surface = surfaceOf(planeMesh(1, 9));
    const Vec3 foot{6, 3, 0};  // the middle of one of the two triangles
    const std::uint32_t t = triangleUnder(surface, foot);
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    EXPECT_EQ(mender.mendDistances({placeAt(foot, {6, 3, 1}, t)}), 1U);
    EXPECT_EQ(surface.triangles.size(), 4U);
    ASSERT_EQ(surface.points.size(), 5U);
    EXPECT_EQ(surface.points[4], (Vec3{6, 3, 1}));
    EXPECT_EQ(surface.states.size(), 5U);
}

TEST(SurfaceMender, SplitsAnEdgeWithBothTriangles) {
    detail::SimplifiedSurface surface = surfaceOf(planeMesh(1, 9));
    const Vec3 middle{4.5, 4.5, 0};  // of the diagonal
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    EXPECT_EQ(
        mender.mendDistances({placeAt(middle, {4.5, 4.5, 0.8}, triangleUnder(surface, middle))}),
        1U);
    EXPECT_EQ(surface.triangles.size(), 4U);
    EXPECT_EQ(surface.points.back(), (Vec3{4.5, 4.5, 0.8}));
    EXPECT_TRUE(crossingTriangles(meshOf(surface)).empty());
}

TEST(SurfaceMender, MovesAVertexThatThePlaceLiesBeside) {
    detail::SimplifiedSurface surface = surfaceOf(planeMesh(2, 4));
    const Vec3 centre{2, 2, 0};
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    EXPECT_EQ(mender.mendDistances({placeAt(centre, {2, 2, 0.4}, triangleUnder(surface, centre))}),
              1U);
    EXPECT_EQ(surface.triangles.size(), 8U);
    EXPECT_NE(std::find(surface.points.begin(), surface.points.end(), Vec3{2, 2, 0.4}),
              surface.points.end());
}

TEST(SurfaceMender, LeavesTheVerticesOfAnOpenBorder) {
    const TriangleMesh before = planeMesh(2, 4);
    detail::SimplifiedSurface surface = surfaceOf(before);
    const Vec3 corner{0, 2, 0};
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    mender.mendDistances({placeAt(corner, {0, 2, 0.4}, triangleUnder(surface, corner))});
    for (std::size_t v = 0; v < before.points.size(); ++v) {
        const Vec3& p = before.points[v];
        const bool isInside = p.x > 0 && p.x < 4 && p.y > 0 && p.y < 4;
        if (!isInside) {
            EXPECT_EQ(surface.points[v], p);
        }
    }
}

// The only way to the place leads through another sheet.
TEST(SurfaceMender, CrossesNoOtherSheet) {
    detail::SimplifiedSurface surface = surfaceOf(merged({planeMesh(3, 9), planeMesh(3, 9, 0.3)}));
    const std::size_t before = surface.triangles.size();
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    mender.mendDistances({placeAt({5, 4, 0}, {5, 4, 1}, triangleUnder(surface, {5, 4, -1}))});
    EXPECT_TRUE(crossingTriangles(meshOf(surface)).empty());
    EXPECT_LE(surface.triangles.size(), before + 2);  // it may come a part of the way
}

// Two sheets that the same point of the full surface is nearest to: the second to reach it stops
// short, for two vertices at one place are one to whoever welds them.
TEST(SurfaceMender, PutsNoVertexOnAnother) {
    detail::SimplifiedSurface surface = surfaceOf(merged({planeMesh(1, 9), planeMesh(1, 9, 1)}));
    const Vec3 target{6, 3, 0.5};
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    EXPECT_EQ(mender.mendDistances({placeAt({6, 3, 0}, target, triangleUnder(surface, {6, 3, -1})),
                                    placeAt({6, 3, 1}, target, triangleUnder(surface, {6, 3, 2}))}),
              2U);
    EXPECT_EQ(std::count(surface.points.begin(), surface.points.end(), target), 1);
    EXPECT_TRUE(crossingTriangles(meshOf(surface)).empty());
}

// A flat square with a sample below its middle, which a vertex above would leave too far away.
TEST(SurfaceMender, TakesNoSampleBeyondTheBound) {
    detail::SimplifiedSurface surface = surfaceOf(planeMesh(1, 9));
    const Vec3 foot{6, 3, 0};
    const std::uint32_t t = triangleUnder(surface, foot);
    surface.samples.emplace_back().setPoint({6, 3, -0.45});
    surface.sampleTriangle.push_back(t);
    detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
    mender.mendDistances({placeAt(foot, {6, 3, 2}, t)});
    for (std::size_t s = 0; s < surface.samples.size(); ++s) {
        const auto& [a, b, c] = surface.triangles[surface.sampleTriangle[s]];
        EXPECT_LE(detail::squaredDistanceToTriangle(
                      surface.samples[s].point(),
                      {surface.points[a], surface.points[b], surface.points[c]}),
                  kLimitMm * kLimitMm * (1 + 1e-6));  // samples are kept in single precision
    }
}

TEST(SurfaceMender, PartsTrianglesThatCross) {
    // a vertex of the lower sheet stands above the upper one; its sample knows better
    TriangleMesh mesh = merged({planeMesh(4, 8), planeMesh(4, 8, 1)});
    const auto at = std::find(mesh.points.begin(), mesh.points.end(), Vec3{4, 4, 0});
    ASSERT_NE(at, mesh.points.end());
    detail::SimplifiedSurface surface = surfaceOf(mesh);
    surface.points[at - mesh.points.begin()] = {4, 4, 1.2};
    const std::vector<std::int64_t> crossing = crossingTriangles(meshOf(surface));
    ASSERT_FALSE(crossing.empty());
    const std::size_t before = surface.triangles.size();
    for (const bool mergesFirst : {false, true}) {
        detail::SimplifiedSurface mended = surface;
        detail::SurfaceMender mender(mended, unitFrame(), kLimitMm);
        EXPECT_GT(mender.mendCrossings(crossing, mergesFirst), 0U);
        EXPECT_TRUE(crossingTriangles(meshOf(mended)).empty());
        EXPECT_TRUE(!mergesFirst || mended.triangles.size() < before);
    }
}

// Places all over a sphere, inside and outside, more than one in many of its triangles.
TEST(SurfaceMender, LeavesASoundSurface) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> part(0, 1);
        std::normal_distribution<double> height(0, 0.8);
        const TriangleMesh sphere = icosphere(2, {}, 10);
        detail::SimplifiedSurface surface = surfaceOf(sphere);
        detail::SurfaceMender mender(surface, unitFrame(), kLimitMm);
        std::size_t mended = 0;
        for (int round = 0; round < 3; ++round) {
            std::vector<PlaceBeyond> places;
            for (std::uint32_t t = 0; t < surface.triangles.size(); t += 2) {
                const auto& [a, b, c] = surface.triangles[t];
                double u = part(random), v = part(random);
                if (u + v > 1) u = 1 - u, v = 1 - v;
                const Vec3 foot =
                    (1 - u - v) * surface.points[a] + u * surface.points[b] + v * surface.points[c];
                places.push_back(placeAt(foot, foot + height(random) * normalized(foot), t));
                places.push_back(places.back());
            }
            mended += mender.mendDistances(places);
        }
        EXPECT_GT(mended, 100U);
        const TriangleMesh mesh = meshOf(surface);
        expectSound(mesh);
        EXPECT_TRUE(crossingTriangles(mesh).empty());
    }
}

}  // namespace adaptiso::testing
