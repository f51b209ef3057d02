#include <gtest/gtest.h>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"

namespace adaptiso::testing {

TEST(MarchingCubes, MeasuresASphereToSecondOrder) {
    const AnalyticVolume truth = sampled<double>(sphere({}, 16), centredGeometry({40, 40, 40}));
    const TriangleMesh mesh =
        extractFrom(truth.volume, truth.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
    expectSound(mesh);
    // chords of one voxel: about h^2 / (8 r) = 0.8 % of a voxel deep, over r / 3 for the volume
    EXPECT_NEAR(enclosedVolume(mesh), *truth.shape.volumeMm3, 0.004 * *truth.shape.volumeMm3);
    EXPECT_NEAR(surfaceArea(mesh), *truth.shape.areaMm2, 0.006 * *truth.shape.areaMm2);
}

TEST(MarchingCubes, DoesNotDependOnTheBlockSize) {
    const HardVolume hard = hardVolume(5, 14);
    for (const Border border : {Border::Closed, Border::Open}) {
        const TriangleMesh two =
            extractFrom(hard.volume, hard.isovalue, Method::MarchingCubes, 2, border).mesh;
        for (const int blockSize : {4, 8, 16}) {
            const TriangleMesh other =
                extractFrom(hard.volume, hard.isovalue, Method::MarchingCubes, blockSize, border)
                    .mesh;
            EXPECT_EQ(other.triangles.size(), two.triangles.size());
            EXPECT_EQ(other.points.size(), two.points.size());
            EXPECT_NEAR(surfaceArea(other), surfaceArea(two), 1e-9 * surfaceArea(two));
        }
    }
}

TEST(MarchingCubes, DecidesAnAmbiguousFaceByItsSaddle) {
    // inside on one diagonal of the only face; the saddle is (a d - b c) / (a + d - b - c)
    ImageGeometry geometry;
    geometry.size = {2, 2, 1};
    const auto components = [&](double high, double low) {
        const Volume volume =
            Volume::fromSamples(std::vector<double>{high, low, low, high}, geometry);
        return extractFrom(volume, 0, Method::MarchingCubes, 2, Border::Closed);
    };
    // joined: one piece of surface round both voxels; apart: two octahedra of eight triangles
    EXPECT_EQ(components(1, -3).mesh.triangles.size(), 16u);
    EXPECT_NE(components(3, -1).mesh.triangles.size(), 16u);
    expectSound(components(3, -1).mesh);
}

}  // namespace adaptiso::testing
