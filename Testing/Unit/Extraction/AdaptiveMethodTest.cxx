#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

Extraction extractWith(const VolumeView& volume, double isovalue, const AdaptiveOptions& adaptive,
                       Border border = Border::Closed) {
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = Method::Adaptive;
    options.adaptive = adaptive;
    return extractSurface(volume, SpanSpaceIndex::build(volume, {4, border}), options);
}

/// A ball in a grid of `side` samples, a distance-like ramp around its surface.
Volume ball(std::int64_t side, double radius, const Mat3& indexToPhysical) {
    ImageGeometry geometry;
    geometry.size = {side, side, side};
    geometry.indexToPhysical = indexToPhysical;
    const double middle = 0.5 * static_cast<double>(side - 1);
    std::vector<float> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const Vec3 d{static_cast<double>(i % side) - middle,
                     static_cast<double>(i / side % side) - middle,
                     static_cast<double>(i / (side * side)) - middle};
        samples.push_back(static_cast<float>(radius - norm(indexToPhysical * d)));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Numbers from 0 to 1 by chance, and then the mean of their neighbours along each axis, again and
/// again.
Volume smoothNoise(const ImageGeometry& geometry, int times) {
    std::vector<float> samples;
    std::uint64_t state = 1;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        samples.push_back(static_cast<float>(nextRandom(state) >> 40) / 16777216.F);
    }
    const Index3& n = geometry.size;
    const std::array<std::int64_t, 3> stride{1, n[0], n[0] * n[1]};
    for (int pass = 0; pass < 3 * times; ++pass) {
        const std::int64_t step = stride[pass % 3];
        const std::vector<float> before = samples;
        for (std::int64_t i = step; i + step < geometry.voxelCount(); ++i) {
            samples[i] = (before[i - step] + before[i] + before[i + step]) / 3;
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

void expectWithin(const TriangleMesh& mesh, const TriangleMesh& full, double boundMm) {
    DistanceOptions options;
    options.samples = 20000;
    const DistanceReport distance = surfaceDistance(mesh, full, options);
    // coordinates are rounded to float on the way: 1e-5 voxel is ample
    EXPECT_LE(distance.combined.maxMm, boundMm + 1e-5);
}

}  // namespace

TEST(AdaptiveMethod, KeepsItsBoundAndCrossesNothingOnRandomVolumes) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const HardVolume hard = hardVolume(seed, 14);
        AdaptiveOptions adaptive;
        adaptive.maxErrorMm = 0.05 * std::pow(2.0, static_cast<double>(seed % 5));
        const Extraction ours = extractWith(hard.volume, hard.isovalue, adaptive);
        if (ours.mesh.triangles.empty()) continue;
        const Extraction full =
            extractFrom(hard.volume, hard.isovalue, Method::MarchingCubes, 4, Border::Closed);
        ASSERT_LE(*ours.statistics.errorBoundMm, *adaptive.maxErrorMm) << seed;
        ASSERT_EQ(findSelfIntersections(ours.mesh).pairCount, 0) << seed;
        ASSERT_EQ(findSelfIntersections(full.mesh).pairCount, 0) << "mc " << seed;
        expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
    }
}

TEST(AdaptiveMethod, KeepsItsPromisesOnRandomVolumes) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const int blockSize = 2 << seed % 4;
        for (const Border border : {Border::Closed, Border::Open}) {
            ASSERT_TRUE(keepsItsPromises(hardVolume(seed, 12), Method::Adaptive, blockSize, border))
                << "seed " << seed << (border == Border::Open ? ", open" : ", closed");
        }
    }
}

TEST(AdaptiveMethod, MakesTheFullSurfaceWhenMoreIsAskedFor) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const HardVolume hard = hardVolume(seed, 6);
        AdaptiveOptions adaptive;
        adaptive.maxErrorMm = 0.01;
        adaptive.maxTriangles = 100'000;
        const Extraction full =
            extractFrom(hard.volume, hard.isovalue, Method::MarchingCubes, 4, Border::Closed);
        EXPECT_EQ(extractWith(hard.volume, hard.isovalue, adaptive).mesh.triangles.size(),
                  full.mesh.triangles.size())
            << seed;
    }
}

TEST(AdaptiveMethod, LeavesNoiseAtFullResolution) {
    // every sample inside or outside by chance: nothing is flat
    ImageGeometry geometry;
    geometry.size = {20, 20, 20};
    std::vector<std::uint8_t> samples;
    std::uint64_t state = 1;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        samples.push_back(static_cast<std::uint8_t>(nextRandom(state) >> 56));
    }
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    const Extraction ours = extractWith(volume, 127.5, {});
    const Extraction full = extractFrom(volume, 127.5, Method::MarchingCubes, 4, Border::Closed);
    EXPECT_EQ(ours.mesh.triangles.size(), full.mesh.triangles.size());
    EXPECT_TRUE(isSound(ours.mesh));
    AdaptiveOptions fewer;  // a count is met all the same
    fewer.reduction = 0.2;
    EXPECT_LT(extractWith(volume, 127.5, fewer).mesh.triangles.size(),
              full.mesh.triangles.size() * 81 / 100);
}

// 1.4 is what a bound may cost more than a count that reaches it: a bound is kept at every place, a
// count's is that of its farthest.
TEST(AdaptiveMethod, UsesAStatedBoundOnNoise) {
    ImageGeometry geometry;
    geometry.size = {36, 36, 36};
    const Volume clean = ball(36, 13, geometry.indexToPhysical);
    std::vector<float> samples(clean.view().as<float>().samples,
                               clean.view().as<float>().samples + geometry.voxelCount());
    std::uint64_t state = 5;
    for (float& sample : samples) {  // more than the ramp: specks all around
        sample += 12 * (static_cast<float>(nextRandom(state) >> 40) / 16777216.F - 0.5F);
    }
    const Volume noisy = Volume::fromSamples(std::move(samples), geometry);
    const auto work = [](const Extraction& made) { return *made.statistics.adaptiveWork; };
    const auto triangles = [](const Extraction& made) { return std::ssize(made.mesh.triangles); };
    const Extraction byDefault = extractWith(noisy, 0, {});
    EXPECT_GT(work(byDefault).trianglesKept, triangles(byDefault) / 2);
    AdaptiveOptions stated;
    for (const double bound : {AdaptiveOptions::kDefaultMaxErrorVoxels, 1.0, 3.0}) {
        stated.maxErrorMm = bound;
        const Extraction ours = extractWith(noisy, 0, stated);
        EXPECT_EQ(work(ours).trianglesKept, 0) << bound;
        EXPECT_LT(triangles(ours), triangles(byDefault)) << bound;
        EXPECT_LE(*ours.statistics.errorBoundMm, bound);
        AdaptiveOptions counted;
        counted.maxTriangles =
            static_cast<std::int64_t>(static_cast<double>(triangles(ours)) / 1.4);
        const Extraction fewer = extractWith(noisy, 0, counted);  // or as few as pieces allow
        if (*fewer.statistics.errorBoundMm <= bound) {
            EXPECT_LE(static_cast<double>(triangles(ours)),
                      1.4 * static_cast<double>(triangles(fewer)))
                << bound;
        }
    }
    stated.maxErrorMm = 2;
    stated.leavesNoise = true;  // as tiles do by the default bound, of which they have a share
    EXPECT_GT(work(extractWith(noisy, 0, stated)).trianglesKept, 0);
}

TEST(AdaptiveMethod, SimplifiesParallelSheetsThatFillTheVolume) {
    ImageGeometry geometry;
    geometry.size = {36, 34, 38};
    const auto sheetsOf = [&](const Vec3& slope, double period) {
        std::vector<float> samples;
        for (std::int64_t z = 0; z < geometry.size[2]; ++z) {
            for (std::int64_t y = 0; y < geometry.size[1]; ++y) {
                for (std::int64_t x = 0; x < geometry.size[0]; ++x) {
                    const double at = dot(slope, {static_cast<double>(x), static_cast<double>(y),
                                                  static_cast<double>(z)});
                    // from sheet to sheet as straight as can be
                    samples.push_back(
                        static_cast<float>(std::abs(std::remainder(at, period)) - period / 4));
                }
            }
        }
        return Volume::fromSamples(std::move(samples), geometry);
    };
    // along the lattice and tilted, one and two voxels apart
    for (const auto& [slope, period, part] :
         {std::tuple{Vec3{0, 0, 1}, 2.0, 0.02}, {Vec3{0.31, 0.17, 1}, 4.0, 0.2}}) {
        const Volume volume = sheetsOf(slope, period);
        const Extraction full = extractFrom(volume, 0.1, Method::MarchingCubes, 4, Border::Closed);
        const Extraction ours = extractWith(volume, 0.1, {});
        EXPECT_LT(static_cast<double>(ours.mesh.triangles.size()),
                  part * static_cast<double>(full.mesh.triangles.size()))
            << period;
        EXPECT_TRUE(isSound(ours.mesh));
        EXPECT_EQ(findSelfIntersections(ours.mesh).pairCount, 0);
        expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
    }
}

TEST(AdaptiveMethod, ReachesACountWhereFewPatchesTellForAll) {
    // long ground with hills: all along it, or in every second piece of 32 cells, where patches
    // that are tried may all be flat
    ImageGeometry geometry;
    geometry.size = {1060, 40, 24};
    for (const bool isEven : {true, false}) {
        std::vector<float> samples;
        for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
            const auto x = static_cast<double>(i % 1060), y = static_cast<double>(i / 1060 % 40),
                       z = static_cast<double>(i / (1060 * 40));
            const bool isHilly = isEven || i % 1060 / 32 % 2 == 1;
            const double hill = isHilly ? 2 * std::sin(0.19 * x) * std::sin(0.31 * y) : 0;
            samples.push_back(static_cast<float>(12.3 + hill - z));
        }
        const Volume volume = Volume::fromSamples(std::move(samples), geometry);
        for (const std::int64_t wanted : {80'000, 50'000, 20'000, 6'000}) {
            AdaptiveOptions adaptive;
            adaptive.maxTriangles = wanted;
            const auto count = std::ssize(extractWith(volume, 0, adaptive).mesh.triangles);
            EXPECT_LE(count, wanted);
            EXPECT_GE(count, wanted - 1);
        }
    }
}

TEST(AdaptiveMethod, ReachesACountWhereAllCostsAreEqual) {
    // a flat slab: any edge is as good
    ImageGeometry geometry;
    geometry.size = {90, 80, 12};
    std::vector<float> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        samples.push_back(6.3F - static_cast<float>(i / (90 * 80)));
    }
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    const auto full =
        std::ssize(extractFrom(volume, 0, Method::MarchingCubes, 4, Border::Closed).mesh.triangles);
    for (const double part : {0.95, 0.8, 0.5, 0.2}) {
        AdaptiveOptions adaptive;
        adaptive.maxTriangles = static_cast<std::int64_t>(part * static_cast<double>(full));
        const Extraction ours = extractWith(volume, 0, adaptive);
        const auto count = std::ssize(ours.mesh.triangles);
        EXPECT_LE(count, *adaptive.maxTriangles) << part;
        EXPECT_GE(count, *adaptive.maxTriangles - 1) << part;
        EXPECT_TRUE(isSound(ours.mesh)) << part;
    }
    const Extraction fewest = extractWith(volume, 0, {});
    EXPECT_LT(std::ssize(fewest.mesh.triangles), full / 20);
    EXPECT_LT(*fewest.statistics.errorBoundMm, 0.15);
}

TEST(AdaptiveMethod, MeetsSmallBoundsWithoutTheFullSurface) {
    // smooth lumps everywhere: places beyond the bound came back in other ones, run after run
    ImageGeometry geometry;
    geometry.size = {40, 40, 40};
    const Volume volume = smoothNoise(geometry, 4);
    const Extraction full = extractFrom(volume, 0.5, Method::MarchingCubes, 4, Border::Closed);
    const auto count = static_cast<double>(full.mesh.triangles.size());
    // shares found, and a tenth more
    for (const auto& [bound, share] : {std::pair{0.02, 0.9}, {0.05, 0.74}}) {
        AdaptiveOptions adaptive;
        adaptive.maxErrorMm = bound;
        const Extraction ours = extractWith(volume, 0.5, adaptive);
        EXPECT_LT(static_cast<double>(ours.mesh.triangles.size()), share * count) << bound;
        EXPECT_LE(*ours.statistics.errorBoundMm, bound);
        expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
    }
}

TEST(AdaptiveMethod, KeepsTheBorderOpenWhereItIs) {
    // half a ball: the rim lies in the plane of the border's samples
    ImageGeometry geometry;
    geometry.size = {40, 40, 20};
    std::vector<float> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const Vec3 d{static_cast<double>(i % 40) - 19.5, static_cast<double>(i / 40 % 40) - 19.5,
                     static_cast<double>(i / 1600)};
        samples.push_back(static_cast<float>(15.2 - norm(d)));
    }
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    const Extraction ours = extractWith(volume, 0, {}, Border::Open);
    const TopologyReport topology = checkTopology(ours.mesh);
    EXPECT_GT(topology.count(TopologyDefect::BoundaryEdge), 0);
    EXPECT_EQ(topology.components.size(), 1u);
    EXPECT_EQ(topology.components[0].eulerCharacteristic(), 1);  // a disc
    EXPECT_TRUE(isSound(ours.mesh, openOnlyAtBorder(geometry)));
    const Extraction full = extractFrom(volume, 0, Method::MarchingCubes, 4, Border::Open);
    EXPECT_LT(ours.mesh.triangles.size(), full.mesh.triangles.size() / 4);
    expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
}

TEST(AdaptiveMethod, GivesTheSameBytesWhateverTheThreads) {
    const Volume volume = ball(100, 40, Mat3{});  // eight bricks
    AdaptiveOptions adaptive;
    adaptive.maxTriangles = 5000;
    const Extraction many = extractWith(volume, 0, adaptive);
    const ThreadLimitGuard one(1);
    EXPECT_EQ(many.mesh, extractWith(volume, 0, adaptive).mesh);
}

TEST(AdaptiveMethod, IsWithinItsBoundOnABallInAShearedMirroredGrid) {
    const Mat3 steps{{{{-0.8, 0.1, 0}, {0.2, 1.1, 0.1}, {0.1, -0.2, 1.6}}}};
    const Volume volume = ball(40, 11, steps);
    for (const double bound : {0.02, 0.1, 0.4}) {
        AdaptiveOptions adaptive;
        adaptive.maxErrorMm = bound;
        const Extraction ours = extractWith(volume, 0, adaptive);
        const Extraction full = extractFrom(volume, 0, Method::MarchingCubes, 4, Border::Closed);
        EXPECT_TRUE(isSound(ours.mesh));
        EXPECT_LE(*ours.statistics.errorBoundMm, bound);
        expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
        EXPECT_LT(ours.mesh.triangles.size(), full.mesh.triangles.size());
        // a shell of twice the bound around the sphere's own area
        const double area = 4 * M_PI * 11 * 11;
        EXPECT_NEAR(enclosedVolume(ours.mesh), area * 11 / 3, area * (bound + 0.05));
    }
}

TEST(AdaptiveMethod, MakesTheCountThatIsAskedFor) {
    const Volume volume = ball(48, 18, Mat3{});
    const auto full = extractFrom(volume, 0, Method::MarchingCubes, 4, Border::Closed);
    const auto all = static_cast<std::int64_t>(full.mesh.triangles.size());
    for (const std::int64_t count : {all / 2, all / 10, all / 40}) {
        AdaptiveOptions adaptive;
        adaptive.maxTriangles = count;
        const Extraction ours = extractWith(volume, 0, adaptive);
        const auto triangles = static_cast<std::int64_t>(ours.mesh.triangles.size());
        EXPECT_LE(triangles, count + 1);
        EXPECT_GE(triangles, count - 1);
        EXPECT_TRUE(isSound(ours.mesh));
        expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
    }
    AdaptiveOptions adaptive;
    adaptive.reduction = 0.75;
    const Extraction ours = extractWith(volume, 0, adaptive);
    EXPECT_NEAR(static_cast<double>(ours.mesh.triangles.size()), 0.25 * static_cast<double>(all),
                2);
}

TEST(AdaptiveMethod, MakesTheCountAtClosedBordersAndWholeIsovalues) {
    // folded sheets a voxel or two apart, in whole numbers: a tenth of the samples equal the
    // isovalue
    ImageGeometry geometry;
    geometry.size = {66, 68, 70};
    const Volume smooth = smoothNoise(geometry, 2);
    std::vector<std::uint8_t> samples;
    const auto view = smooth.view().as<float>();
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        const double value = 20 + 60 * (view.samples[i] - 0.5);
        samples.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 40.0))));
    }
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    for (const Border border : {Border::Closed, Border::Open}) {
        for (const double isovalue : {19.0, 20.0, 21.0}) {
            const Extraction full = extractFrom(volume, isovalue, Method::MarchingCubes, 4, border);
            AdaptiveOptions adaptive;
            adaptive.maxTriangles = std::ssize(full.mesh.triangles) / 4;
            const Extraction ours = extractWith(volume, isovalue, adaptive, border);
            EXPECT_LE(std::ssize(ours.mesh.triangles), *adaptive.maxTriangles) << isovalue;
            EXPECT_GE(std::ssize(ours.mesh.triangles), *adaptive.maxTriangles - 1) << isovalue;
            EXPECT_EQ(ours.statistics.wantedTriangles, adaptive.maxTriangles);
            EXPECT_EQ(findSelfIntersections(ours.mesh).pairCount, 0) << isovalue;
        }
    }
}

TEST(AdaptiveMethod, SaysWhatWasWantedWhereTopologyDoesNotAllowIt) {
    // single voxels: each keeps a closed surface of its own, of four triangles at least
    const HardVolume dots = binaryVolume({40, 40, 40}, [](auto x, auto y, auto z) {
        return x % 4 == 2 && y % 4 == 2 && z % 4 == 2;
    });
    AdaptiveOptions adaptive;
    adaptive.maxTriangles = 3;
    const Extraction ours = extractWith(dots.volume, dots.isovalue, adaptive);
    EXPECT_EQ(std::ssize(ours.mesh.triangles), 4 * 1000);
    EXPECT_EQ(ours.statistics.wantedTriangles, 3);
    EXPECT_TRUE(isSound(ours.mesh));
    EXPECT_FALSE(extractWith(dots.volume, dots.isovalue, {}).statistics.wantedTriangles);
}

TEST(AdaptiveMethod, BoundsTheDistanceOfTrianglesFarFromTheSurface) {
    // a shell 1 voxel thick: with few triangles its faces leave the shell by many voxels
    const HardVolume shell = binaryVolume({80, 80, 80}, [](auto x, auto y, auto z) {
        const double r = std::hypot(static_cast<double>(x) - 40, static_cast<double>(y) - 40,
                                    static_cast<double>(z) - 40);
        return r < 36 && r > 34.5;
    });
    const Extraction full =
        extractFrom(shell.volume, shell.isovalue, Method::MarchingCubes, 4, Border::Closed);
    AdaptiveOptions adaptive;
    adaptive.maxTriangles = 60;
    const Extraction ours = extractWith(shell.volume, shell.isovalue, adaptive);
    ASSERT_TRUE(ours.statistics.errorBoundMm);
    EXPECT_GT(*ours.statistics.errorBoundMm, 3);
    EXPECT_LT(*ours.statistics.errorBoundMm, 80);
    expectWithin(ours.mesh, full.mesh, *ours.statistics.errorBoundMm);
}

TEST(AdaptiveMethod, NeedsTwelveTrianglesForAFlatBox) {
    // a box between samples: its surface is bevelled by half a voxel, so a bound of half a voxel
    // leaves the corners alone, and a larger one nothing but the box.
    // 24 triangles would do for the first; collapses end at 26
    const HardVolume box = binaryVolume({24, 20, 16}, [](auto x, auto y, auto z) {
        return x > 3 && x < 20 && y > 3 && y < 16 && z > 3 && z < 12;
    });
    for (const auto& [bound, triangles] : {std::pair{0.5, 26U}, {0.6, 12U}, {1.0, 12U}}) {
        AdaptiveOptions adaptive;
        adaptive.maxErrorMm = bound;
        const Extraction ours = extractWith(box.volume, box.isovalue, adaptive);
        EXPECT_LE(ours.mesh.triangles.size(), triangles) << bound;
        EXPECT_TRUE(isSound(ours.mesh));
    }
}

// Faces of one triangle over thousands: parts of it, each looked at in turn, took twenty times as
// long by half a voxel as by the default bound.
TEST(AdaptiveMethod, MakesNoSharperAngleThanAsked) {
    const Volume volume = ball(40, 14, Mat3{});
    AdaptiveOptions adaptive;
    adaptive.maxErrorMm = 0.1;
    adaptive.minAngleDeg = 20;
    const Extraction ours = extractWith(volume, 0, adaptive);
    double sharpest = 180;
    for (const Triangle& t : ours.mesh.triangles) {
        for (int c = 0; c < 3; ++c) {
            const Vec3& p = ours.mesh.points[t[c]];
            const Vec3 u = ours.mesh.points[t[(c + 1) % 3]] - p,
                       v = ours.mesh.points[t[(c + 2) % 3]] - p;
            sharpest = std::min(sharpest, std::atan2(norm(cross(u, v)), dot(u, v)) * 180 / M_PI);
        }
    }
    EXPECT_GE(sharpest, 10);  // slivers of marching cubes that nothing could mend may stay
    EXPECT_TRUE(isSound(ours.mesh));
}

TEST(AdaptiveMethod, HasABoundOfAPartOfTheLeastDistanceBetweenPlanesUnlessAsked) {
    // steps of 2 mm along i and j at 60 degrees: their planes are sqrt(3) mm apart, those of k 2.5
    const Mat3 steps{{{{2, 0, 0}, {1, std::sqrt(3.0), 0}, {0, 0, 2.5}}}};
    const Volume volume = ball(32, 16, steps);
    AdaptiveOptions stated;
    stated.maxErrorMm = 0.15 * std::sqrt(3.0);
    const Extraction ours = extractWith(volume, 0, {});
    EXPECT_LE(*ours.statistics.errorBoundMm, *stated.maxErrorMm + 1e-12);  // sqrt(3) is rounded
    EXPECT_EQ(ours.mesh.triangles.size(), extractWith(volume, 0, stated).mesh.triangles.size());
    // another bound makes another mesh, so that the counts above tell something
    stated.maxErrorMm = 0.15 * 2;
    EXPECT_NE(ours.mesh.triangles.size(), extractWith(volume, 0, stated).mesh.triangles.size());
}

TEST(AdaptiveMethod, RefusesLimitsThatMeanNothing) {
    const Volume volume = ball(8, 3, Mat3{});
    for (AdaptiveOptions bad :
         {AdaptiveOptions{{.maxErrorMm = 0.0}, {}}, AdaptiveOptions{{.maxTriangles = -1}, {}},
          AdaptiveOptions{{.reduction = 1.5}, {}}}) {
        EXPECT_THROW(extractWith(volume, 0, bad), InvalidInput);
    }
}

}  // namespace adaptiso::testing
