#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kSide = 16;

Volume mapOf(const std::function<int(const Index3&)>& labelAt) {
    ImageGeometry geometry;
    geometry.size = {kSide, kSide, kSide};
    std::vector<std::uint8_t> samples;
    for (std::int64_t k = 0; k < kSide; ++k) {
        for (std::int64_t j = 0; j < kSide; ++j) {
            for (std::int64_t i = 0; i < kSide; ++i) {
                samples.push_back(static_cast<std::uint8_t>(labelAt({i, j, k})));
            }
        }
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

bool isWithin(const Index3& at, std::int64_t first, std::int64_t last) {
    return std::all_of(at.begin(), at.end(), [&](auto n) { return n >= first && n <= last; });
}

/// The label of the voxel whose cube holds a point.
int labelAt(const Volume& map, const Vec3& p) {
    const auto index = [](double x) { return static_cast<std::int64_t>(std::lround(x)); };
    return dispatchPixelType(map.view(), [&](const auto& samples) {
        return static_cast<int>(samples.at(index(p.x), index(p.y), index(p.z)));
    });
}

MesherInput inputOf(const Volume& map, const std::vector<Label>& labels) {
    LabelOptions options;
    options.maxErrorMm = 0.1;
    return labelMesherInput(extractLabels(map.view(), options).complex, labels);
}

TEST(LabelVolumes, EachPieceIsAVolumeWithAPointInIt) {
    // two cubes of label 3 and one of label 5 beside the second
    const Volume map = mapOf([](const Index3& at) {
        if (isWithin(at, 1, 5)) return 3;
        if (isWithin(at, 8, 14)) return at[0] < 11 ? 3 : 5;
        return 0;
    });
    const MesherInput input = inputOf(map, {3, 5});
    ASSERT_EQ(input.volumes.size(), 3u);
    EXPECT_EQ(input.walls.size(), input.triangles.size());
    for (const MesherVolume& volume : input.volumes) {
        EXPECT_EQ(labelAt(map, volume.insideMm), volume.region == 1 ? 3 : 5);
    }
    // the small cube's wall; then of the others the walls outward and the one between them
    EXPECT_EQ(std::set<std::int32_t>(input.walls.begin(), input.walls.end()).size(), 4u);
    std::vector<std::size_t> walls;
    for (const MesherVolume& volume : input.volumes) walls.push_back(volume.walls.size());
    std::sort(walls.begin(), walls.end());
    EXPECT_EQ(walls, (std::vector<std::size_t>{1, 2, 2}));
}

TEST(LabelVolumes, ACavityIsAWallOfThePieceThatHoldsIt) {
    // a shell of label 1 round nothing, round label 2; and another piece of label 1 far from it
    const Volume map = mapOf([](const Index3& at) {
        if (isWithin(at, 14, 15)) return 1;
        if (isWithin(at, 5, 6)) return 2;
        if (isWithin(at, 4, 7)) return 0;
        return isWithin(at, 2, 10) ? 1 : 0;
    });
    const MesherInput input = inputOf(map, {1, 2});
    ASSERT_EQ(input.volumes.size(), 3u);
    std::vector<std::size_t> walls;
    for (const MesherVolume& volume : input.volumes) walls.push_back(volume.walls.size());
    std::sort(walls.begin(), walls.end());
    // all walls are between a volume and label 0: those of a shell, inner and outer, are one
    EXPECT_EQ(walls, (std::vector<std::size_t>{1, 1, 1}));
    for (const MesherVolume& volume : input.volumes) {
        EXPECT_EQ(labelAt(map, volume.insideMm), volume.region);
    }
    const auto shell =
        std::count(input.walls.begin(), input.walls.end(), input.volumes[0].walls[0]);
    EXPECT_GT(shell, 0);
}

TEST(LabelVolumes, WhatOtherLabelsHoldIsNoVolume) {
    const Volume map = mapOf([](const Index3& at) {
        if (isWithin(at, 5, 9)) return 2;
        return isWithin(at, 2, 12) ? 1 : 0;
    });
    LabelOptions options;
    options.labels = {1};
    const MesherInput input = labelMesherInput(extractLabels(map.view(), options).complex, {1});
    ASSERT_EQ(input.volumes.size(), 1u);
    EXPECT_EQ(labelAt(map, input.volumes[0].insideMm), 1);
}

}  // namespace
}  // namespace adaptiso
