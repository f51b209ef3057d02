#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "LabelMaps.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {
namespace {

using testing::centredGeometry;
using testing::fullResolution;
using testing::keepsPromises;
using testing::longCells;
using testing::Map;
using testing::mirroredGeometry;
using testing::nextRandom;
using testing::noise;
using testing::obliqueGeometry;
using testing::shearedGeometry;

TEST(ExtractLabels, HoldsForEveryWayToLabelACellsCorners) {
    // every partition of eight corners, with and without 0 among the labels
    std::array<Label, 8> labels{};
    std::int64_t patterns = 0;
    const auto visit = [&](const auto& self, int c, int kinds) -> void {
        if (c == 8) {
            for (const Label first : {0, 1}) {
                const Map map(centredGeometry({2, 2, 2}), [&](const Index3& i) {
                    return labels[i[0] + 2 * i[1] + 4 * i[2]] + first;
                });
                ASSERT_TRUE(keepsPromises(map, fullResolution()))
                    << ::testing::PrintToString(labels);
            }
            ++patterns;
            return;
        }
        for (int kind = 0; kind <= kinds; ++kind) {
            labels[c] = kind;
            self(self, c + 1, std::max(kinds, kind + 1));
            if (::testing::Test::HasFatalFailure()) return;
        }
    };
    visit(visit, 1, 1);
    EXPECT_EQ(patterns, 4140);  // the eighth Bell number
}

TEST(ExtractLabels, HoldsForRandomNoise) {
    std::uint64_t seed = 1;
    for (int round = 0; round < 300; ++round) {
        const auto side = [&] { return static_cast<std::int64_t>(1 + nextRandom(seed) % 6); };
        const Index3 size{side(), side(), side()};
        const int kinds = static_cast<int>(2 + nextRandom(seed) % 6);
        const std::vector<ImageGeometry> geometries{
            centredGeometry(size), obliqueGeometry(size, {0.7, 1, 2.5}),
            shearedGeometry(size, {1, 1.2, 3}), mirroredGeometry(size, {0.9, 0.9, 4})};
        LabelOptions options;
        options.smooth = round % 5 != 0;
        options.maxErrorMm = std::array{0.0, 0.1, 0.5, 3.0}[round % 4];
        const Map map = noise(geometries[round % 4], kinds, nextRandom(seed));
        ASSERT_TRUE(keepsPromises(map, options)) << "round " << round;
    }
}

TEST(ExtractLabels, HoldsForCheckerboardsSheetsAndSingleVoxels) {
    const ImageGeometry geometry = centredGeometry({8, 7, 6});
    const auto sum = [](const Index3& i) { return i[0] + i[1] + i[2]; };
    const std::vector<Map> maps{
        {geometry, [&](const Index3& i) { return static_cast<Label>(sum(i) % 2); }},
        {geometry, [&](const Index3& i) { return static_cast<Label>(1 + sum(i) % 2); }},
        {geometry, [&](const Index3& i) { return static_cast<Label>(sum(i) % 3); }},
        {geometry, [&](const Index3& i) { return sum(i) == 9 ? 5 : 0; }},
        {geometry, [&](const Index3& i) { return sum(i) == 9  ? 5
                                                 : sum(i) < 9 ? 3
                                                              : 4; }},
        {geometry, [](const Index3& i) { return i[2] == 3  ? 5
                                                : i[2] < 3 ? 3
                                                           : 4; }},
        {geometry,
         [](const Index3& i) {
             return i == Index3{3, 3, 3} ? 9 : 0;
         }},
        {geometry, [](const Index3& i) { return i[0] % 2 + i[1] % 2 + i[2] % 2 == 0 ? 9 : 2; }},
        {geometry, [](const Index3&) { return 12101; }}};
    for (std::size_t n = 0; n < maps.size(); ++n)
        EXPECT_TRUE(keepsPromises(maps[n])) << "map " << n;
}

// All walls, and enough of them for many rounds of taking back; larger ones: LabelsNoiseTest.py.
TEST(ExtractLabels, HoldsForLargerNoiseAndCheckerboards) {
    const ImageGeometry geometry = centredGeometry({9, 9, 9});
    EXPECT_TRUE(keepsPromises(noise(geometry, 5, 18)));
    EXPECT_TRUE(keepsPromises({geometry, [](const Index3& i) {
                                   return static_cast<Label>(1 + (i[0] + i[1] + i[2]) % 2);
                               }}));
}

TEST(ExtractLabels, HoldsForRoundWallsThatMeet) {
    // smooth maps let walls leave the middle of their cells, as noise does not
    std::uint64_t seed = 5;
    for (int round = 0; round < 8; ++round) {
        std::array<Vec3, 7> sites;
        for (Vec3& site : sites) {
            for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
                site.*axis = static_cast<double>(nextRandom(seed) % 1000) / 50 - 10;
            }
        }
        const ImageGeometry geometry = round % 2 == 0 ? centredGeometry({22, 22, 22})
                                                      : mirroredGeometry({22, 22, 22}, {1, 1, 1.4});
        const Map map = Map::inSpace(geometry, [&](const Vec3& p) {
            Label nearest = 0;
            double least = 81;
            for (std::size_t n = 0; n < sites.size(); ++n) {
                const double d = squaredNorm(p - sites[n]);
                if (d < least) {
                    least = d;
                    nearest = static_cast<Label>(n + 1);
                }
            }
            return nearest;
        });
        EXPECT_TRUE(keepsPromises(map)) << "round " << round;
    }
}

TEST(ExtractLabels, HoldsWhereCubesThatAreSimplifiedSideBySideMeet) {
    for (const double maxErrorMm : {0.05, 0.15, 0.6}) {
        LabelOptions options;
        options.maxErrorMm = maxErrorMm;
        EXPECT_TRUE(keepsPromises(longCells(centredGeometry({200, 14, 13}), 3), options));
        EXPECT_TRUE(
            keepsPromises(longCells(shearedGeometry({9, 150, 12}, {1, 1.2, 3}), 4), options));
        EXPECT_TRUE(
            keepsPromises(noise(mirroredGeometry({4, 3, 170}, {0.9, 0.9, 4}), 4, 5), options));
    }
}

TEST(ExtractLabels, HoldsWhereARegionOnlyReachesIntoACube) {
    // all of the triangles that a cube has may reach out of it
    for (std::int64_t length = 126; length < 134; ++length) {
        const Map map(centredGeometry({length, length, 3}), [&](const Index3& i) {
            return i[0] >= 55 && i[0] < 65 && i[1] >= 55 && i[1] < 65 && i[2] == 1 ? 1 : 0;
        });
        ASSERT_TRUE(keepsPromises(map)) << length;
    }
}

// Walks could not prove triangles that are large beside those of the full walls: 956 were left.
TEST(ExtractLabels, ProvesTrianglesAsLargeAsAFlatWall) {
    const Map map(centredGeometry({60, 20, 12}), [](const Index3& i) { return i[2] < 6 ? 1 : 2; });
    EXPECT_LT(extractLabels(map.view(), {}).complex.triangles.size(), 350);
}

TEST(ExtractLabels, LeavesNoTrianglesWhereCubesMeet) {
    // a slab from end to end: its walls need no more triangles in three cubes than in one
    const auto slab = [](std::int64_t length) {
        const Map map(centredGeometry({length, 20, 12}),
                      [](const Index3& i) { return i[2] < 6 ? 1 : 2; });
        return extractLabels(map.view(), {}).complex;
    };
    const LabelComplex complex = slab(190);
    // its four rims have 1.7 triangles for each voxel of length, in one cube as in several
    EXPECT_LT(complex.triangles.size(), slab(60).triangles.size() + 130 * 2);
    // its full walls have some 800 triangles at the two planes between the cubes
    int small = 0;
    for (const Triangle& t : complex.triangles) {
        const auto [a, b, c] =
            std::array{complex.points[t[0]], complex.points[t[1]], complex.points[t[2]]};
        const bool isAtEnd = std::abs(a.x) > 80;
        small += norm(areaVector2(a, b, c)) / 2 < 1.5 && !isAtEnd ? 1 : 0;
    }
    EXPECT_LT(small, 20);
}

}  // namespace
}  // namespace adaptiso
