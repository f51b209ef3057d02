#include <gtest/gtest.h>

#include <cmath>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

constexpr Border kBorders[] = {Border::Closed, Border::Open};

Volume filled(const Index3& size, std::uint8_t value) {
    ImageGeometry geometry;
    geometry.size = size;
    return Volume::fromSamples(
        std::vector<std::uint8_t>(static_cast<std::size_t>(geometry.voxelCount()), value),
        geometry);
}

}  // namespace

/// What every method must keep to.
class SurfaceMethods : public ::testing::TestWithParam<MethodChoice> {};

TEST_P(SurfaceMethods, KeepsItsPromisesOnRandomVolumes) {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        const HardVolume hard = hardVolume(seed, 12);
        for (const int blockSize : kBlockSizes) {
            for (const Border border : kBorders) {
                ASSERT_TRUE(keepsItsPromises(hard, GetParam(), blockSize, border))
                    << "seed " << seed << ", N = " << blockSize << ", border "
                    << (border == Border::Closed ? "closed" : "open");
            }
        }
    }
}

TEST_P(SurfaceMethods, IsSoundForEveryCellBesideEveryNeighbourPattern) {
    // all 256 cells in the middle of noise: each meets many of its neighbours' cases
    for (unsigned corners = 0; corners < 256; ++corners) {
        for (std::uint64_t round = 0; round < 4; ++round) {
            std::uint64_t state = corners * 97 + round;
            const HardVolume hard = binaryVolume({4, 4, 4}, [&](auto x, auto y, auto z) {
                const bool isMiddle = x >= 1 && x <= 2 && y >= 1 && y <= 2 && z >= 1 && z <= 2;
                const bool noise = nextRandom(state) % 2 == 0;
                return isMiddle ? (corners >> ((x - 1) + 2 * (y - 1) + 4 * (z - 1)) & 1u) != 0
                                : noise;
            });
            for (const int blockSize : {2, 4}) {
                ASSERT_TRUE(keepsItsPromises(hard, GetParam(), blockSize, Border::Closed))
                    << "corners " << corners << ", round " << round << ", N = " << blockSize;
            }
        }
    }
}

TEST_P(SurfaceMethods, IsSoundWhereAnAmbiguousFaceMeetsFinerBoxes) {
    // a checkerboard of columns (every face across z ambiguous) beside noise, at each distance
    for (std::uint64_t round = 0; round < 72; ++round) {
        std::uint64_t state = round;
        const std::int64_t edge = 1 + static_cast<std::int64_t>(round % 9);
        const std::int64_t width = 1 + static_cast<std::int64_t>(round % 5);
        const HardVolume hard = binaryVolume({10, 10, 10}, [&](auto x, auto y, auto z) {
            const bool noise = nextRandom(state) % 4 == 0;
            return z < edge ? (x / width + y / width) % 2 == 0 : noise;
        });
        for (const int blockSize : kBlockSizes) {
            for (const Border border : kBorders) {
                ASSERT_TRUE(keepsItsPromises(hard, GetParam(), blockSize, border))
                    << "round " << round << ", N = " << blockSize;
            }
        }
    }
}

TEST_P(SurfaceMethods, KeepsSingleVoxelsAsOctahedra) {
    const HardVolume hard = binaryVolume(
        {9, 9, 9}, [](auto x, auto y, auto z) { return x % 4 == 2 && y % 4 == 2 && z % 4 == 2; });
    for (const int blockSize : kBlockSizes) {
        const Extraction result =
            extractFrom(hard.volume, 50, GetParam(), blockSize, Border::Closed);
        expectSound(result.mesh);
        EXPECT_EQ(checkTopology(result.mesh).components.size(), 8u);
        EXPECT_EQ(result.mesh.triangles.size(), 8u * 8u);
        EXPECT_NEAR(enclosedVolume(result.mesh), 8 * 4.0 / 3 / 8, 1e-12);  // octahedra, radius 1/2
    }
}

TEST_P(SurfaceMethods, KeepsSheetsOneVoxelThick) {
    for (int axis = 0; axis < 3; ++axis) {
        for (std::int64_t at = 0; at < 9; ++at) {
            const HardVolume hard = binaryVolume({9, 9, 9}, [&](auto x, auto y, auto z) {
                return (axis == 0 ? x : axis == 1 ? y : z) == at;
            });
            for (const int blockSize : kBlockSizes) {
                for (const Border border : kBorders) {
                    ASSERT_TRUE(keepsItsPromises(hard, GetParam(), blockSize, border))
                        << "axis " << axis << " at " << at << ", N = " << blockSize;
                }
            }
        }
    }
}

TEST_P(SurfaceMethods, ClosesAVolumeThatIsAllInsideHalfAVoxelBeyondItsSamples) {
    for (const Index3& size : {Index3{1, 1, 1}, Index3{5, 3, 2}, Index3{8, 8, 8}}) {
        const Volume volume = filled(size, 7);
        for (const double isovalue : {7.0, 0.0, -3.0}) {
            for (const int blockSize : kBlockSizes) {
                const Extraction result =
                    extractFrom(volume, isovalue, GetParam(), blockSize, Border::Closed);
                expectSound(result.mesh);
                const BoundingBox box = boundingBox(result.mesh);
                for (int axis = 0; axis < 3; ++axis) {
                    EXPECT_DOUBLE_EQ(box.minimum[axis], -0.5);
                    EXPECT_DOUBLE_EQ(box.maximum[axis], static_cast<double>(size[axis]) - 0.5);
                }
                EXPECT_TRUE(extractFrom(volume, isovalue, GetParam(), blockSize, Border::Open)
                                .mesh.triangles.empty());
            }
        }
        EXPECT_TRUE(extractFrom(volume, 7.5, Method::Boxes, 4, Border::Closed).mesh.points.empty());
    }
}

TEST_P(SurfaceMethods, NormalsPointOutOfTheHighSide) {
    for (const ImageGeometry& geometry :
         {centredGeometry({36, 36, 36}), obliqueGeometry({40, 40, 30}, {1, 0.9, 1.5}),
          shearedGeometry({44, 44, 44}, {1, 1, 1.2}),
          mirroredGeometry({40, 40, 40}, {1, 1, 1.2})}) {
        const AnalyticVolume truth = sampled<double>(sphere({}, 12), geometry);
        const Extraction result =
            extractFrom(truth.volume, truth.isovalue, GetParam(), 4, Border::Closed);
        expectSound(result.mesh);
        ASSERT_EQ(result.mesh.normals.size(), result.mesh.points.size());
        for (std::size_t i = 0; i < result.mesh.points.size(); ++i) {
            // central differences of a distance field over 2 voxels: within 2 degrees
            EXPECT_GT(dot(toVec3(result.mesh.normals[i]), normalized(result.mesh.points[i])),
                      0.9994);
        }
        EXPECT_GT(enclosedVolume(result.mesh), 0);
    }
}

TEST_P(SurfaceMethods, GivesTheSameBytesWhateverTheThreads) {
    const HardVolume hard = hardVolume(77, 40);
    const AnalyticVolume smooth =
        sampled<std::int16_t>(torus({}, 14, 6), centredGeometry({48, 48, 24}));
    std::vector<TriangleMesh> meshes;
    for (const int threads : {1, 2, 5}) {
        const ThreadLimitGuard limit(threads);
        meshes.push_back(
            extractFrom(hard.volume, hard.isovalue, GetParam(), 2, Border::Closed).mesh);
        meshes.push_back(
            extractFrom(smooth.volume, smooth.isovalue, GetParam(), 4, Border::Closed).mesh);
    }
    for (std::size_t i = 2; i < meshes.size(); ++i) EXPECT_EQ(meshes[i], meshes[i % 2]);
}

TEST_P(SurfaceMethods, ValuesEqualToTheIsovalueAreInside) {
    ImageGeometry geometry;
    geometry.size = {5, 5, 5};
    std::vector<std::int16_t> samples(125, -4);
    samples[62] = 3;  // the middle
    const Volume volume = Volume::fromSamples(samples, geometry);
    for (const int blockSize : kBlockSizes) {
        const Extraction at = extractFrom(volume, 3, GetParam(), blockSize, Border::Closed);
        expectSound(at.mesh);
        EXPECT_EQ(at.mesh.triangles.size(), 8u);  // an octahedron round the sample
        EXPECT_TRUE(
            extractFrom(volume, 3.0001, GetParam(), blockSize, Border::Closed).mesh.points.empty());
    }
}

TEST_P(SurfaceMethods, TakesNotANumberAndInfinityAsSamples) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        std::uint64_t state = seed;
        ImageGeometry geometry;
        geometry.size = {7, 6, 5};
        std::vector<float> samples(7 * 6 * 5);
        for (float& s : samples) {
            const float choices[] = {0, 1, 2, NAN, INFINITY, -INFINITY};
            s = choices[nextRandom(state) % 6];
        }
        const HardVolume hard{Volume::fromSamples(samples, geometry), 1};
        ASSERT_TRUE(keepsItsPromises(hard, GetParam(), 4, Border::Closed)) << "seed " << seed;
        ASSERT_TRUE(keepsItsPromises(hard, GetParam(), 2, Border::Open)) << "seed " << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(
    , SurfaceMethods,
    ::testing::Values(MethodChoice{Method::Boxes}, MethodChoice{Method::DiscretizedMarchingCubes},
                      MethodChoice{Method::DiscretizedMarchingCubes, true},
                      MethodChoice{Method::DiscretizedMarchingCubes, false, true},
                      MethodChoice{Method::DiscretizedMarchingCubes, true, true},
                      MethodChoice{Method::SkeletonClimbing}, MethodChoice{Method::MarchingCubes}),
    ::testing::PrintToStringParamName());

}  // namespace adaptiso::testing
