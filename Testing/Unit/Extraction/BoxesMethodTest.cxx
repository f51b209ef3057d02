#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

constexpr int kBlockSizes[] = {2, 4, 8, 16};
constexpr Border kBorders[] = {Border::Closed, Border::Open};

Volume filled(const Index3& size, std::uint8_t value) {
    ImageGeometry geometry;
    geometry.size = size;
    return Volume::fromSamples(
        std::vector<std::uint8_t>(static_cast<std::size_t>(geometry.voxelCount()), value),
        geometry);
}

/// A volume of zeros in which `isInside(x, y, z)` says where 100 stands.
template <class F>
HardVolume binary(const Index3& size, const F& isInside) {
    ImageGeometry geometry;
    geometry.size = size;
    std::vector<std::uint8_t> samples;
    for (std::int64_t z = 0; z < size[2]; ++z) {
        for (std::int64_t y = 0; y < size[1]; ++y) {
            for (std::int64_t x = 0; x < size[0]; ++x) {
                samples.push_back(isInside(x, y, z) ? 100 : 0);
            }
        }
    }
    return {Volume::fromSamples(std::move(samples), geometry), 50};
}

}  // namespace

TEST(BoxesMethod, KeepsItsPromisesOnRandomVolumes) {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        const HardVolume hard = hardVolume(seed, 12);
        for (const int blockSize : kBlockSizes) {
            for (const Border border : kBorders) {
                ASSERT_TRUE(keepsItsPromises(hard, blockSize, border))
                    << "seed " << seed << ", N = " << blockSize << ", border "
                    << (border == Border::Closed ? "closed" : "open");
            }
        }
    }
}

TEST(BoxesMethod, IsSoundForEveryCellBesideEveryNeighbourPattern) {
    // all 256 cells in the middle of noise: each meets many of its neighbours' cases
    for (unsigned corners = 0; corners < 256; ++corners) {
        for (std::uint64_t round = 0; round < 4; ++round) {
            std::uint64_t state = corners * 97 + round;
            const HardVolume hard = binary({4, 4, 4}, [&](auto x, auto y, auto z) {
                const bool isMiddle = x >= 1 && x <= 2 && y >= 1 && y <= 2 && z >= 1 && z <= 2;
                const bool noise = nextRandom(state) % 2 == 0;
                return isMiddle ? (corners >> ((x - 1) + 2 * (y - 1) + 4 * (z - 1)) & 1u) != 0
                                : noise;
            });
            for (const int blockSize : {2, 4}) {
                ASSERT_TRUE(keepsItsPromises(hard, blockSize, Border::Closed))
                    << "corners " << corners << ", round " << round << ", N = " << blockSize;
            }
        }
    }
}

TEST(BoxesMethod, IsSoundWhereAnAmbiguousFaceMeetsFinerBoxes) {
    // a checkerboard of columns (every face across z ambiguous) beside noise, at each distance
    for (std::uint64_t round = 0; round < 72; ++round) {
        std::uint64_t state = round;
        const std::int64_t edge = 1 + static_cast<std::int64_t>(round % 9);
        const std::int64_t width = 1 + static_cast<std::int64_t>(round % 5);
        const HardVolume hard = binary({10, 10, 10}, [&](auto x, auto y, auto z) {
            const bool noise = nextRandom(state) % 4 == 0;
            return z < edge ? (x / width + y / width) % 2 == 0 : noise;
        });
        for (const int blockSize : kBlockSizes) {
            for (const Border border : kBorders) {
                ASSERT_TRUE(keepsItsPromises(hard, blockSize, border))
                    << "round " << round << ", N = " << blockSize;
            }
        }
    }
}

TEST(BoxesMethod, KeepsSingleVoxelsAsOctahedra) {
    const HardVolume hard = binary(
        {9, 9, 9}, [](auto x, auto y, auto z) { return x % 4 == 2 && y % 4 == 2 && z % 4 == 2; });
    for (const int blockSize : kBlockSizes) {
        const Extraction result =
            extractFrom(hard.volume, 50, Method::Boxes, blockSize, Border::Closed);
        expectSound(result.mesh);
        EXPECT_EQ(checkTopology(result.mesh).components.size(), 8u);
        EXPECT_EQ(result.mesh.triangles.size(), 8u * 8u);
        EXPECT_NEAR(enclosedVolume(result.mesh), 8 * 4.0 / 3 / 8, 1e-12);  // octahedra, radius 1/2
    }
}

TEST(BoxesMethod, KeepsSheetsOneVoxelThick) {
    for (int axis = 0; axis < 3; ++axis) {
        for (std::int64_t at = 0; at < 9; ++at) {
            const HardVolume hard = binary({9, 9, 9}, [&](auto x, auto y, auto z) {
                return (axis == 0 ? x : axis == 1 ? y : z) == at;
            });
            for (const int blockSize : kBlockSizes) {
                for (const Border border : kBorders) {
                    ASSERT_TRUE(keepsItsPromises(hard, blockSize, border))
                        << "axis " << axis << " at " << at << ", N = " << blockSize;
                }
            }
        }
    }
}

TEST(BoxesMethod, MergesAWallAlongAndAcrossBlocksToFewTriangles) {
    for (std::int64_t at = 2; at < 12; ++at) {  // on a block's face, beside it, within a block
        const HardVolume hard = binary({32, 32, 16}, [&](auto, auto, auto z) { return z < at; });
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

TEST(BoxesMethod, ClosesAVolumeThatIsAllInsideHalfAVoxelBeyondItsSamples) {
    for (const Index3& size : {Index3{1, 1, 1}, Index3{5, 3, 2}, Index3{8, 8, 8}}) {
        const Volume volume = filled(size, 7);
        for (const double isovalue : {7.0, 0.0, -3.0}) {
            for (const int blockSize : kBlockSizes) {
                const Extraction result =
                    extractFrom(volume, isovalue, Method::Boxes, blockSize, Border::Closed);
                expectSound(result.mesh);
                const BoundingBox box = boundingBox(result.mesh);
                for (int axis = 0; axis < 3; ++axis) {
                    EXPECT_DOUBLE_EQ(box.minimum[axis], -0.5);
                    EXPECT_DOUBLE_EQ(box.maximum[axis], static_cast<double>(size[axis]) - 0.5);
                }
                EXPECT_TRUE(extractFrom(volume, isovalue, Method::Boxes, blockSize, Border::Open)
                                .mesh.triangles.empty());
            }
        }
        EXPECT_TRUE(extractFrom(volume, 7.5, Method::Boxes, 4, Border::Closed).mesh.points.empty());
    }
}

TEST(BoxesMethod, KeepsTopologyOfSphereShellAndTorus) {
    const ImageGeometry geometry = centredGeometry({40, 40, 40});
    for (const Shape& shape :
         {sphere({0.3, -0.2, 0.1}, 14), shell({0, 0, 0}, 7, 15), torus({0, 0, 0}, 11, 5)}) {
        const AnalyticVolume truth = sampled<float>(shape, geometry);
        for (const int blockSize : kBlockSizes) {
            const Extraction result =
                extractFrom(truth.volume, truth.isovalue, Method::Boxes, blockSize, Border::Closed);
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

TEST(BoxesMethod, PutsEveryVertexOnTheSurface) {
    // depth is exact and interpolated linearly: off the sphere only by its bend within an edge
    const AnalyticVolume truth = sampled<double>(sphere({}, 15), centredGeometry({36, 36, 36}));
    const Extraction result =
        extractFrom(truth.volume, truth.isovalue, Method::Boxes, 4, Border::Closed);
    for (const Vec3& p : result.mesh.points) {
        EXPECT_NEAR(norm(p), 15.0, 0.125 / 15 + 1e-3);  // h^2 / 8 r, and kHair
    }
}

TEST(BoxesMethod, NormalsPointOutOfTheHighSide) {
    for (const ImageGeometry& geometry :
         {centredGeometry({36, 36, 36}), obliqueGeometry({40, 40, 30}, {1, 0.9, 1.5}),
          shearedGeometry({44, 44, 44}, {1, 1, 1.2}),
          mirroredGeometry({40, 40, 40}, {1, 1, 1.2})}) {
        const AnalyticVolume truth = sampled<double>(sphere({}, 12), geometry);
        for (const Method method : {Method::Boxes, Method::MarchingCubes}) {
            const Extraction result =
                extractFrom(truth.volume, truth.isovalue, method, 4, Border::Closed);
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
}

TEST(BoxesMethod, GeometryOnlyMovesTheMesh) {
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
                extractFrom(moved, truth.isovalue, Method::Boxes, blockSize, Border::Closed).mesh;
            expectSound(boxes);
            EXPECT_GT(enclosedVolume(boxes), 0);
        }
    }
}

TEST(BoxesMethod, GivesTheSameBytesWhateverTheThreads) {
    const HardVolume hard = hardVolume(77, 40);
    const AnalyticVolume smooth =
        sampled<std::int16_t>(torus({}, 14, 6), centredGeometry({48, 48, 24}));
    for (const Method method : {Method::Boxes, Method::MarchingCubes}) {
        std::vector<TriangleMesh> meshes;
        for (const int threads : {1, 2, 5}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            meshes.push_back(
                extractFrom(hard.volume, hard.isovalue, method, 2, Border::Closed).mesh);
            meshes.push_back(
                extractFrom(smooth.volume, smooth.isovalue, method, 4, Border::Closed).mesh);
        }
        for (std::size_t i = 2; i < meshes.size(); ++i) EXPECT_EQ(meshes[i], meshes[i % 2]);
    }
}

TEST(BoxesMethod, LiesAsCloseToMarchingCubesAsItsBoxesAreLarge) {
    // on a plane sheet there is no bend: any block size lies on the surface, to the last digit
    const ImageGeometry geometry = centredGeometry({24, 24, 24});
    const AnalyticVolume truth = sampled<double>(halfSpace({0.25, 0, 0}, {1, 0, 0}), geometry);
    const TriangleMesh full =
        extractFrom(truth.volume, truth.isovalue, Method::MarchingCubes, 4, Border::Open).mesh;
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh =
            extractFrom(truth.volume, truth.isovalue, Method::Boxes, blockSize, Border::Open).mesh;
        EXPECT_LT(surfaceDistance(mesh, full).combined.maxMm, 1e-9);
        EXPECT_EQ(findSelfIntersections(mesh).pairCount, 0);
    }
}

TEST(BoxesMethod, ValuesEqualToTheIsovalueAreInside) {
    ImageGeometry geometry;
    geometry.size = {5, 5, 5};
    std::vector<std::int16_t> samples(125, -4);
    samples[62] = 3;  // the middle
    const Volume volume = Volume::fromSamples(samples, geometry);
    for (const int blockSize : kBlockSizes) {
        const Extraction at = extractFrom(volume, 3, Method::Boxes, blockSize, Border::Closed);
        expectSound(at.mesh);
        EXPECT_EQ(at.mesh.triangles.size(), 8u);  // a speck, a hair off the sample
        EXPECT_TRUE(extractFrom(volume, 3.0001, Method::Boxes, blockSize, Border::Closed)
                        .mesh.points.empty());
    }
}

TEST(BoxesMethod, TakesNotANumberAndInfinityAsSamples) {
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
        ASSERT_TRUE(keepsItsPromises(hard, 4, Border::Closed)) << "seed " << seed;
        ASSERT_TRUE(keepsItsPromises(hard, 2, Border::Open)) << "seed " << seed;
    }
}

}  // namespace adaptiso::testing
