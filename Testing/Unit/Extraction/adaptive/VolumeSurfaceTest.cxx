#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "NoisyScenes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptive/full/VolumeSurface.h"
#include "adaptive/proof/DistanceProof.h"

namespace adaptiso::testing {
namespace {

using detail::SimplifiedSurface;
using detail::VolumeSurface;

/// The frames that images come in.
ImageGeometry geometryOf(int kind, const Index3& size) {
    switch (kind % 6) {
        case 0:
            return unitGeometry(size);
        case 1:
            return centredGeometry(size, {0.3, 1, 4});
        case 2:
            return obliqueGeometry(size, {0.7, 0.9, 1.4});
        case 3:
            return shearedGeometry(size, {1, 1, 2});
        case 4:
            return mirroredGeometry(size, {1, 0.5, 1});
        default: {
            ImageGeometry far = obliqueGeometry(size, {0.7, 0.9, 1.4});
            far.originMm = {-1234.5678, 5432.10987, 1e4};
            return far;
        }
    }
}

/// Noise of many kinds; the surface lies at 0.
Volume noiseOf(int kind, const ImageGeometry& geometry, std::mt19937& random) {
    const Index3& size = geometry.size;
    std::vector<float> samples(static_cast<std::size_t>(geometry.voxelCount()));
    for (float& s : samples) {
        switch (kind % 4) {
            case 0:  // white
                s = static_cast<float>(random() % 200001) / 1000 - 100;
                break;
            case 1:  // binary
                s = random() % 2 == 0 ? -1 : 1;
                break;
            default:  // whole-numbered: many samples equal the isovalue
                s = static_cast<float>(random() % 7) - 3;
        }
    }
    if (kind % 4 == 3) {  // blurred along all axes
        for (const std::int64_t step : {std::int64_t{1}, size[0], size[0] * size[1]}) {
            for (std::size_t i = static_cast<std::size_t>(step); i < samples.size(); ++i) {
                samples[i] += 0.5F * samples[i - static_cast<std::size_t>(step)];
            }
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

/// Triangles that a proof finds to be the full surface's.
std::vector<std::uint8_t> fineOnes(const VolumeSurface& full, const SimplifiedSurface& surface) {
    detail::DistanceProof proof(full.fineOf(surface), full.frame(), 0.3);
    proof.prove(surface);
    return proof.isFine();
}
std::vector<std::uint64_t> cellsOf(const VolumeSurface& full, const SimplifiedSurface& surface) {
    return full.cellsOf(surface, fineOnes(full, surface));
}

/// Checks the search that knows the cells against the one that does not.
/// \return how many triangles cross
std::size_t compareSearches(const VolumeSurface& full, const SimplifiedSurface& surface) {
    const TriangleMesh mesh = full.meshOf(surface);
    const auto known = crossingTriangles(mesh, cellsOf(full, surface));
    EXPECT_EQ(known, crossingTriangles(mesh));
    EXPECT_EQ(known, full.crossingTriangles(surface, fineOnes(full, surface)));
    SelfIntersectionOptions all;
    all.maxPairs = 1'000'000;
    std::set<std::int64_t> named;
    for (const auto& pair : findSelfIntersections(mesh, all).pairs) {
        named.insert(pair.begin(), pair.end());
    }
    EXPECT_EQ(known, std::vector<std::int64_t>(named.begin(), named.end()));
    return known.size();
}

/// Takes some vertices elsewhere, so that triangles cross.
void spoil(SimplifiedSurface& surface, std::mt19937& random, double mm) {
    std::uniform_real_distribution<double> step(-mm, mm);
    for (int n = 0; n < 4; ++n) {
        Vec3& p = surface.points[random() % surface.points.size()];
        p += Vec3{step(random), step(random), step(random)};
    }
}

}  // namespace

TEST(VolumeSurface, KnowsCellsOfWhatIsAtFullResolution) {
    const Scene scene(noiseBesideSmooth({70, 20, 20}, {}, 5), 0, Border::Open);
    const VolumeSurface full(scene.volume.view().geometry(), *scene.sampler, scene.bricks);
    const SimplifiedSurface surface = full.firstRound(limitsThatLeaveNoise(), nullptr);
    const std::vector<std::uint64_t> cells = cellsOf(full, surface);
    ASSERT_EQ(cells.size(), surface.triangles.size());
    std::size_t known = 0;
    for (std::size_t t = 0; t < cells.size(); ++t) {
        Vec3 middle;
        for (const std::uint32_t v : surface.triangles[t]) {
            middle += (1.0 / 3) * surface.points[v];
        }
        if (middle.x < detail::Brick::kSide) {
            ASSERT_NE(cells[t], kNoCell) << t;
        }
        known += cells[t] != kNoCell ? 1 : 0;
        for (std::size_t other = t; cells[t] != kNoCell && other-- > 0;) {
            if (cells[other] != cells[t]) break;  // those of a cell come one after the other
            const double x = surface.points[surface.triangles[other][0]].x;
            ASSERT_LE(std::abs(x - middle.x), 1 + 1e-9);
        }
    }
    EXPECT_LT(known, cells.size());
}

TEST(VolumeSurface, KnowsNoCellsWithoutNoise) {
    const Scene scene = ballScene();
    const VolumeSurface full(scene.volume.view().geometry(), *scene.sampler, scene.bricks);
    EXPECT_TRUE(cellsOf(full, full.firstRound(limitsThatLeaveNoise(), nullptr)).empty());
}

// At 1e8 voxels from the origin rounding is 1e-8 of a voxel, and triangles could come together.
TEST(VolumeSurface, KnowsNoCellsWhereRoundingIsCoarse) {
    for (const double farMm : {1e4, 1e8}) {
        ImageGeometry geometry = unitGeometry({12, 12, 12});
        geometry.originMm = {farMm, 0, 0};
        std::mt19937 random(3);
        const Scene scene(noiseOf(0, geometry, random), 0, Border::Open);
        const VolumeSurface full(scene.volume.view().geometry(), *scene.sampler, scene.bricks);
        const SimplifiedSurface surface = full.firstRound(limitsThatLeaveNoise(), nullptr);
        EXPECT_EQ(cellsOf(full, surface).empty(), farMm > 1e6) << farMm;
    }
}

// The search that leaves out pairs of different cells finds all the same: nothing as the surface
// is, and what crosses once vertices are taken elsewhere.
TEST(VolumeSurface, TrianglesOfDifferentCellsDoNotCross) {
    std::mt19937 random(7);
    std::size_t withCells = 0, crossing = 0;
    for (int n = 0; n < 240; ++n) {
        const Index3 size{5 + static_cast<std::int64_t>(random() % 8),
                          5 + static_cast<std::int64_t>(random() % 8),
                          5 + static_cast<std::int64_t>(random() % 8)};
        const ImageGeometry geometry = geometryOf(n, size);
        const Border border = n / 6 % 2 == 0 ? Border::Open : Border::Closed;
        const Scene scene(noiseOf(n / 12, geometry, random), 0, border);
        const VolumeSurface full(scene.volume.view().geometry(), *scene.sampler, scene.bricks);
        SimplifiedSurface surface = full.firstRound(limitsThatLeaveNoise(), nullptr);
        if (!cellsOf(full, surface).empty()) ++withCells;
        ASSERT_EQ(compareSearches(full, surface), 0U) << n;
        spoil(surface, random, scene.frame.narrowestMm());
        crossing += compareSearches(full, surface);
        ASSERT_FALSE(HasFailure()) << n;
    }
    EXPECT_GT(withCells, 90U);
    EXPECT_GT(crossing, 240U);
}

TEST(VolumeSurface, TrianglesOfWholeAndOfSimplifiedBricksAreCompared) {
    std::mt19937 random(8);
    std::size_t withCells = 0, crossing = 0;
    for (int n = 0; n < 12; ++n) {
        const Index3 size{70, 14, 14};
        const Border border = n / 6 % 2 == 0 ? Border::Open : Border::Closed;
        const Volume volume = noiseBesideSmooth(size, geometryOf(n, size), 8 + n);
        const Scene scene(volume, 0, border);
        const VolumeSurface full(scene.volume.view().geometry(), *scene.sampler, scene.bricks);
        SimplifiedSurface surface = full.firstRound(limitsThatLeaveNoise(), nullptr);
        if (!cellsOf(full, surface).empty()) ++withCells;
        compareSearches(full, surface);
        for (Vec3& p : surface.points) {  // of the first smooth brick, into the noise
            const Vec3 index = scene.frame.toIndex(p);
            if (index.x > 32.5 && index.x < 60 && random() % 2 == 0) {
                p += scene.frame.fromIndex({28 - index.x, 0, 0});
            }
        }
        crossing += compareSearches(full, surface);
        ASSERT_FALSE(HasFailure()) << n;
    }
    EXPECT_EQ(withCells, 12U);
    EXPECT_GT(crossing, 100U);
}

}  // namespace adaptiso::testing
