#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "RandomVolumes.h"
#include "adaptive/bricks/Bricks.h"

namespace adaptiso::testing {
namespace {

using detail::BrickMesher;
using detail::Bricks;
using detail::FineSurface;

/// A triangle by its corners, in ten millionths of a voxel, the least one first.
using PlacesOfTriangle = std::array<std::array<std::int64_t, 3>, 3>;

PlacesOfTriangle placesOf(const Vec3& a, const Vec3& b, const Vec3& c) {
    PlacesOfTriangle key;
    for (int i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            key[i][axis] = std::llround(1e7 * (i == 0 ? a : i == 1 ? b : c)[axis]);
        }
    }
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    return key;
}

PlacesOfTriangle placesOf(const FineSurface& fine, std::size_t t) {
    const auto& [a, b, c] = fine.triangles[t];
    return placesOf(fine.vertices[a].index, fine.vertices[b].index, fine.vertices[c].index);
}

}  // namespace

// Ambiguous faces, open and closed borders, one brick and many.
TEST(BrickMesher, MakesTheSurfaceOfMarchingCubes) {
    std::size_t most = 0;
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
        const HardVolume hard = hardVolume(seed, seed % 4 == 0 ? 40 : 12);
        const Border border = seed % 2 == 0 ? Border::Closed : Border::Open;
        const int blockSize = 2 << seed % 3;
        const Extraction mc =
            extractFrom(hard.volume, hard.isovalue, Method::MarchingCubes, blockSize, border);
        std::vector<PlacesOfTriangle> expected, keys;
        for (const auto& [a, b, c] : mc.mesh.triangles) {
            expected.push_back(placesOf(mc.mesh.points[a], mc.mesh.points[b], mc.mesh.points[c]));
        }
        const auto index = SpanSpaceIndex::build(hard.volume.view(), {blockSize, border});
        const auto sampler =
            detail::LatticeSampler::make(hard.volume.view(), hard.isovalue, border);
        const Bricks bricks(index.grid(), index.blocksAt(hard.isovalue).blocks);
        BrickMesher mesher(*sampler, index.grid());
        FineSurface fine;
        for (std::int64_t b = 0; b < bricks.count(); ++b) {
            mesher.mesh(bricks[b], fine);
            for (std::size_t t = 0; t < fine.triangles.size(); ++t)
                keys.push_back(placesOf(fine, t));
        }
        std::sort(expected.begin(), expected.end());
        std::sort(keys.begin(), keys.end());
        ASSERT_EQ(keys, expected) << seed;
        most = std::max(most, static_cast<std::size_t>(bricks.count()));
    }
    EXPECT_GE(most, 4U);
}

}  // namespace adaptiso::testing
