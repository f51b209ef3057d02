// The tools that tests rest on: analytic volumes, meshes, the soundness check.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "Support/Soundness.h"

namespace adaptiso::testing {
namespace {

/// Volume (mm3) of the voxels at or above the isovalue.
template <class T>
double voxelVolume(const AnalyticVolume& analytic) {
    const auto view = analytic.volume.view().as<T>();
    std::int64_t inside = 0;
    for (std::int64_t n = 0; n < view.geometry.voxelCount(); ++n) {
        if (static_cast<double>(view.samples[n]) >= analytic.isovalue) ++inside;
    }
    return static_cast<double>(inside) * view.geometry.voxelVolumeMm3();
}

TEST(AnalyticVolumes, VoxelsInsideFillTheKnownVolume) {
    const Index3 size{50, 44, 40};
    for (const ImageGeometry& geometry :
         {centredGeometry(size, {0.5, 0.6, 0.7}), obliqueGeometry(size, {0.5, 0.6, 0.7}),
          shearedGeometry(size, {0.5, 0.6, 0.7}), mirroredGeometry(size, {0.5, 0.6, 0.7})}) {
        for (const Shape& shape :
             {sphere({}, 9), torus({}, 7, 2.5), shell({}, 5, 9), box({0.1, 0.2, 0.3}, {6, 5, 7})}) {
            // Counting voxels of 0.2 mm3 errs by about 0.5 % here; 3 % leaves room for the box,
            // whose faces may run along voxels.
            const double truth = *shape.volumeMm3;
            EXPECT_NEAR(voxelVolume<float>(sampled<float>(shape, geometry)), truth, 0.03 * truth);
            EXPECT_NEAR(voxelVolume<std::int8_t>(sampled<std::int8_t>(shape, geometry)), truth,
                        0.03 * truth);
        }
    }
}

TEST(AnalyticVolumes, SamplesAreTheDepthAboveTheIsovalue) {
    const AnalyticVolume analytic = sampled<double>(sphere({}, 5), centredGeometry({13, 13, 13}));
    const auto view = analytic.volume.view().as<double>();
    EXPECT_DOUBLE_EQ(view.at(6, 6, 6) - analytic.isovalue, 5);
    EXPECT_DOUBLE_EQ(view.at(11, 6, 6), analytic.isovalue);
    EXPECT_DOUBLE_EQ(view.at(12, 6, 6) - analytic.isovalue, -1);
}

TEST(AnalyticVolumes, IntegersSaturateOnlyAwayFromTheSurface) {
    const AnalyticVolume analytic =
        sampled<std::uint8_t>(sphere({}, 20), centredGeometry({50, 50, 50}));
    const auto view = analytic.volume.view().as<std::uint8_t>();
    EXPECT_EQ(view.at(25, 25, 25), 127);
    EXPECT_EQ(view.at(0, 0, 0), 0);
    EXPECT_GT(analytic.sampleErrorMm, 0);
    EXPECT_LT(analytic.sampleErrorMm, 0.05);
}

TEST(AnalyticVolumes, DepthIsTheDistanceAlongTheNormal) {
    EXPECT_DOUBLE_EQ(halfSpace({0, 0, 2}, {0, 0, 5}).depthMm({7, 8, -1}), 3);
    EXPECT_DOUBLE_EQ(box({}, {1, 2, 3}).depthMm({0, 0, 0}), 1);
    EXPECT_DOUBLE_EQ(box({}, {1, 2, 3}).depthMm({4, 6, 3}), -5);
    EXPECT_DOUBLE_EQ(torus({}, 5, 2).depthMm({0, 5, 1}), 1);
    EXPECT_DOUBLE_EQ(shell({}, 3, 6).depthMm({0, 4, 0}), 1);
}

TEST(AnalyticVolumes, EveryPixelTypeHoldsTheSameSolid) {
    const ImageGeometry geometry = centredGeometry({30, 30, 30});
    const auto expectBall = [&]<class T>(T) {
        const AnalyticVolume analytic = sampled<T>(sphere({}, 10), geometry);
        // 4189 voxels, some 1257 of them at the surface; were those in or out by chance, their
        // number would spread by 18. Rounding to integers moves the surface by up to 0.025 mm,
        // 31 voxels more.
        EXPECT_NEAR(voxelVolume<T>(analytic), *analytic.shape.volumeMm3, 84)
            << toString(pixelTypeOf<T>());
    };
    expectBall(std::uint8_t{}), expectBall(std::int8_t{}), expectBall(std::uint16_t{});
    expectBall(std::int16_t{}), expectBall(std::uint32_t{}), expectBall(std::int32_t{});
    expectBall(std::uint64_t{}), expectBall(std::int64_t{}), expectBall(float{});
    expectBall(double{});
}

TEST(AnalyticVolumes, MirroredGeometryHasANegativeDeterminant) {
    EXPECT_TRUE(mirroredGeometry({4, 4, 4}, {1, 2, 3}).isMirrored());
    EXPECT_FALSE(obliqueGeometry({4, 4, 4}, {1, 2, 3}).isMirrored());
}

TEST(RandomVolume, HoldsEveryValueAndIsTheSameEachTime) {
    const Volume a = randomVolume<std::int16_t>({9, 8, 7}, 4, 1);
    const Volume b = randomVolume<std::int16_t>({9, 8, 7}, 4, 1);
    const Volume c = randomVolume<std::int16_t>({9, 8, 7}, 4, 2);
    std::array<int, 4> count{};
    bool differsFromC = false;
    for (std::int64_t n = 0; n < 9 * 8 * 7; ++n) {
        const auto value = a.view().as<std::int16_t>().samples[n];
        ASSERT_EQ(value, b.view().as<std::int16_t>().samples[n]);
        differsFromC = differsFromC || value != c.view().as<std::int16_t>().samples[n];
        ++count.at(value);
    }
    EXPECT_TRUE(differsFromC);
    for (const int n : count) EXPECT_GT(n, 80);  // 126 expected, standard deviation 10
}

TEST(Meshes, SoundShapesAreSoundAndHaveTheirVolume) {
    expectSound(icosphere(3));
    expectSound(torusMesh(30, 20, 5, 2));
    expectSound(cubeMesh({-1, -1, -1}, {1, 2, 3}));
    EXPECT_NEAR(enclosedVolume(icosphere(4, {1, 2, 3}, 2)), 32 * std::numbers::pi / 3, 0.11);
    EXPECT_NEAR(enclosedVolume(torusMesh(90, 60, 5, 2)),
                2 * std::numbers::pi * std::numbers::pi * 5 * 4, 1.5);  // chords: under 0.4 %
    EXPECT_DOUBLE_EQ(enclosedVolume(cubeMesh({-1, -1, -1}, {1, 2, 3})), 24);
    EXPECT_DOUBLE_EQ(surfaceArea(planeMesh(4, 3, 1)), 9);
}

TEST(Soundness, EveryDefectIsNamed) {
    const TriangleMesh good = icosphere(1);
    const auto complaint = [](const TriangleMesh& mesh) {
        const ::testing::AssertionResult result = isSound(mesh);
        return result ? std::string("sound") : std::string(result.message());
    };
    const auto expectNamed = [&](const TriangleMesh& mesh, const char* what) {
        EXPECT_NE(complaint(mesh).find(what), std::string::npos) << complaint(mesh);
    };
    EXPECT_EQ(complaint(good), "sound");
    EXPECT_EQ(complaint({}), "sound");
    expectNamed(withHole(good), "3 x boundary edge");
    expectNamed(withFlippedTriangle(good), "3 x edge whose triangles run the same way");
    expectNamed(withDuplicateTriangle(good), "1 x duplicate triangle");
    expectNamed(withZeroAreaTriangle(good), "1 x triangle without area");
    expectNamed(withRepeatedIndex(good), "1 x triangle without area");
    expectNamed(withUnusedVertex(good), "1 x unused vertex");
    expectNamed(withNanCoordinate(good), "1 x non-finite vertex");
    expectNamed(withIndexOutOfRange(good), "1 x index out of range");
    expectNamed(twoSpheresTouchingAtAVertex(), "1 x vertex whose triangles are not one fan");
    expectNamed(threeTrianglesOnAnEdge(), "1 x edge in more than two triangles");
    expectNamed(threeTrianglesOnAnEdge(), "2 x vertex whose triangles are not one fan");
    TriangleMesh longNormal = good;
    longNormal.normals[3].x += 1;
    expectNamed(longNormal, "1 x normal not of length 1");
    TriangleMesh fewNormals = good;
    fewNormals.normals.pop_back();
    expectNamed(fewNormals, "wrong number of normals");
}

TEST(Soundness, OpenIsForgivenOnlyAtTheBorderOfTheVolume) {
    // A sheet of index 0...4 in the plane z = 1 of a volume of 5 x 5 x 3 voxels.
    ImageGeometry geometry;
    geometry.size = {5, 5, 3};
    const TriangleMesh sheet = planeMesh(4, 4, 1);
    EXPECT_FALSE(isSound(sheet));
    EXPECT_TRUE(isSound(sheet, openOnlyAtBorder(geometry)));
    EXPECT_FALSE(isSound(withHole(planeMesh(4, 3, 1)), openOnlyAtBorder(geometry)));
    // Both ends on the border, but not on one face: cut off at the corner.
    TriangleMesh corner;
    corner.points = {{0, 0, 1}, {2, 0, 1}, {0, 2, 1}};
    corner.triangles = {{0, 1, 2}};
    EXPECT_FALSE(isSound(corner, openOnlyAtBorder(geometry)));
}

}  // namespace
}  // namespace adaptiso::testing
