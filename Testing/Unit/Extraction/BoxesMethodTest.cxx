#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {

/// The methods that cover the surface with simple boxes of several sizes.
class BoxMethods : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(, BoxMethods, ::testing::Values(Method::Boxes, Method::SkeletonClimbing),
                         [](const auto& method) { return std::string(toString(method.param)); });

TEST(BoxesMethod, MergesAWallAlongAndAcrossBlocksToFewTriangles) {
    for (std::int64_t at = 2; at < 12; ++at) {  // on a block's face, beside it, within a block
        const HardVolume hard =
            binaryVolume({32, 32, 16}, [&](auto, auto, auto z) { return z < at; });
        for (const int blockSize : kBlockSizes) {
            const Extraction open =
                extractFrom(hard.volume, 50, Method::Boxes, blockSize, Border::Open);
            expectSound(open.mesh, openOnlyAtBorder(hard.volume.view().geometry()));
            // a square of 31 x 31 voxels, plane: area is exact whatever the triangles
            EXPECT_NEAR(surfaceArea(open.mesh), 31.0 * 31.0, 1e-9);
            EXPECT_LE(open.mesh.triangles.size(), 150u) << "N = " << blockSize << ", at " << at;
        }
    }
}

TEST(SkeletonClimbing, CutsAWallIntoADikeByDikeGrid) {
    // 31 cells a side: blocks of N, the last one cut into dikes of N/2, ..., 2 and 1
    constexpr std::pair<int, std::size_t> kDikesASide[] = {{2, 16}, {4, 9}, {8, 6}, {16, 5}};
    for (std::int64_t at = 2; at < 12; ++at) {  // on a block's face, beside it, within a block
        const HardVolume hard =
            binaryVolume({32, 32, 16}, [&](auto, auto, auto z) { return z < at; });
        for (const auto& [blockSize, dikes] : kDikesASide) {
            const Extraction open =
                extractFrom(hard.volume, 50, Method::SkeletonClimbing, blockSize, Border::Open);
            expectSound(open.mesh, openOnlyAtBorder(hard.volume.view().geometry()));
            EXPECT_NEAR(surfaceArea(open.mesh), 31.0 * 31.0, 1e-9);
            EXPECT_EQ(open.mesh.triangles.size(), 2 * dikes * dikes)
                << "N = " << blockSize << ", at " << at;
        }
    }
}

TEST_P(BoxMethods, KeepsTopologyOfSphereShellAndTorus) {
    const ImageGeometry geometry = centredGeometry({40, 40, 40});
    for (const Shape& shape :
         {sphere({0.3, -0.2, 0.1}, 14), shell({0, 0, 0}, 7, 15), torus({0, 0, 0}, 11, 5)}) {
        const AnalyticVolume truth = sampled<float>(shape, geometry);
        for (const int blockSize : kBlockSizes) {
            const Extraction result =
                extractFrom(truth.volume, truth.isovalue, GetParam(), blockSize, Border::Closed);
            expectSound(result.mesh);
            const TopologyReport topology = checkTopology(result.mesh);
            EXPECT_EQ(topology.components.size(), static_cast<std::size_t>(shape.components));
            EXPECT_EQ(topology.genus(), shape.genus);
            EXPECT_EQ(result.statistics.boxesChangingTopology, 0);
            // chords of boxes of N voxels cut inside a convex surface, never outside by more than
            // a torus' inner side bulges
            EXPECT_GT(enclosedVolume(result.mesh), 0.5 * *shape.volumeMm3);
            EXPECT_LT(enclosedVolume(result.mesh), 1.05 * *shape.volumeMm3);
        }
    }
}

TEST_P(BoxMethods, PutsEveryVertexOnTheSurface) {
    // depth is exact and interpolated linearly: off the sphere only by its bend within an edge
    const AnalyticVolume truth = sampled<double>(sphere({}, 15), centredGeometry({36, 36, 36}));
    const Extraction result =
        extractFrom(truth.volume, truth.isovalue, GetParam(), 4, Border::Closed);
    for (const Vec3& p : result.mesh.points) {
        EXPECT_NEAR(norm(p), 15.0, 0.125 / 15 + 1e-3);  // h^2 / 8 r, and kHair
    }
}

TEST_P(BoxMethods, GeometryOnlyMovesTheMesh) {
    const ImageGeometry plain = centredGeometry({30, 28, 26});
    const AnalyticVolume truth = sampled<std::uint8_t>(torus({}, 8, 4), plain);
    const TriangleMesh reference =
        extractFrom(truth.volume, truth.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
    for (const ImageGeometry& geometry :
         {obliqueGeometry(plain.size, {0.5, 1, 2}), shearedGeometry(plain.size, {1, 1, 1}),
          mirroredGeometry(plain.size, {1, 2, 1})}) {
        const VolumeView moved(truth.volume.view().samples(), PixelType::UInt8, geometry);
        TriangleMesh mesh =
            extractFrom(moved, truth.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
        expectSound(mesh);
        ASSERT_EQ(mesh.points.size(), reference.points.size());
        for (std::size_t i = 0; i < mesh.points.size(); ++i) {
            const Vec3 expected = geometry.toPhysical(plain.toIndex(reference.points[i]));
            EXPECT_LT(norm(mesh.points[i] - expected), 1e-9);
        }
        EXPECT_NEAR(enclosedVolume(mesh),
                    enclosedVolume(reference) * geometry.voxelVolumeMm3() / plain.voxelVolumeMm3(),
                    1e-6 * enclosedVolume(mesh));
        for (const int blockSize : kBlockSizes) {
            const TriangleMesh boxes =
                extractFrom(moved, truth.isovalue, GetParam(), blockSize, Border::Closed).mesh;
            expectSound(boxes);
            EXPECT_GT(enclosedVolume(boxes), 0);
        }
    }
}

TEST_P(BoxMethods, LiesAsCloseToMarchingCubesAsItsBoxesAreLarge) {
    // on a plane sheet there is no bend: any block size lies on the surface, to the last digit
    const ImageGeometry geometry = centredGeometry({24, 24, 24});
    const AnalyticVolume truth = sampled<double>(halfSpace({0.25, 0, 0}, {1, 0, 0}), geometry);
    const TriangleMesh full =
        extractFrom(truth.volume, truth.isovalue, Method::MarchingCubes, 4, Border::Open).mesh;
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh =
            extractFrom(truth.volume, truth.isovalue, GetParam(), blockSize, Border::Open).mesh;
        EXPECT_LT(surfaceDistance(mesh, full).combined.maxMm, 1e-9);
        EXPECT_EQ(findSelfIntersections(mesh).pairCount, 0);
    }
}

}  // namespace adaptiso::testing
