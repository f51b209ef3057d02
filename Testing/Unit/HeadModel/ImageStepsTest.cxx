#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "HeadPhantoms.h"
#include "ImageSteps.h"
#include "WorkingGrid.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::headmodel {
namespace {

using namespace adaptiso::testing;

Mask randomMask(const Index3& size, std::uint64_t seed, int oneIn) {
    Mask mask(static_cast<std::size_t>(size[0] * size[1] * size[2]));
    for (std::uint8_t& voxel : mask) voxel = nextRandom(seed) % oneIn == 0 ? 1 : 0;
    return mask;
}

TEST(DepthMm, IsTheDistanceToTheNearestVoxelOfTheOtherSide) {
    const Index3 size{9, 7, 11};
    const ImageGeometry grid = obliqueGeometry(size, {1.5, 1.5, 1.5});
    for (const int oneIn : {2, 5, 60}) {
        const Mask mask = randomMask(size, 7 + oneIn, oneIn);
        const std::vector<float> depth = depthMm(mask, grid);
        for (std::int64_t a = 0; a < std::ssize(mask); ++a) {
            double nearest = std::numeric_limits<double>::infinity();
            for (std::int64_t b = 0; b < std::ssize(mask); ++b) {
                if (mask[a] == mask[b]) continue;
                const double dx = static_cast<double>(a % 9 - b % 9);
                const double dy = static_cast<double>(a / 9 % 7 - b / 9 % 7);
                const double dz = static_cast<double>(a / 63 - b / 63);
                nearest = std::min(nearest, std::sqrt(dx * dx + dy * dy + dz * dz));
            }
            const double expected = (mask[a] != 0 ? 1 : -1) * 1.5 * (nearest - 0.5);
            ASSERT_NEAR(depth[a], expected, 1e-5);  // float
        }
    }
}

TEST(DepthMm, IsTheSameWithinABandAndItsEndBeyond) {
    const Index3 size{31, 37, 29};
    const ImageGeometry grid = obliqueGeometry(size, {1.5, 1.5, 1.5});
    // few voxels make deep places, many make none; bands of 16 and of 32 bits
    for (const int oneIn : {3, 300, 9000}) {
        const Mask mask = randomMask(size, 11 + oneIn, oneIn);
        const std::vector<float> depth = depthMm(mask, grid);
        for (const DepthBand& band :
             {DepthBand::within(4), DepthBand{1.5, 20}, DepthBand{40, 0}, DepthBand::within(300)}) {
            std::vector<float> expected = depth;
            for (float& mm : expected) {
                mm = std::clamp(mm, -static_cast<float>(band.outsideMm),
                                static_cast<float>(band.insideMm));
            }
            EXPECT_EQ(depthMm(mask, grid, band), expected) << oneIn << " " << band.insideMm;
        }
    }
}

TEST(Morphology, IsWhatDepthsSay) {
    const Index3 size{31, 37, 29};
    const ImageGeometry grid = obliqueGeometry(size, {0.7, 0.7, 0.7});
    for (const int oneIn : {3, 300, 9000}) {
        const Mask mask = randomMask(size, 5 + oneIn, oneIn);
        Mask outside(mask.size());
        for (std::size_t n = 0; n < mask.size(); ++n) outside[n] = mask[n] ^ 1;
        // the last is farther than any two voxels of the grid are
        for (const double radius : {0.1, 0.35, 1.05, 3.0, 7.7, 60.0}) {
            EXPECT_EQ(dilated(mask, grid, radius), above(depthMm(mask, grid), -radius)) << radius;
            Mask expected = dilated(outside, grid, radius);
            for (std::uint8_t& voxel : expected) voxel ^= 1;
            EXPECT_EQ(eroded(mask, grid, radius), expected) << radius;
        }
    }
}

TEST(DepthMm, IsInfiniteWithoutTheOtherSide) {
    const ImageGeometry grid = centredGeometry({4, 4, 4});
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(depthMm(Mask(64, 0), grid), std::vector<float>(64, -infinity));
    EXPECT_EQ(depthMm(Mask(64, 1), grid), std::vector<float>(64, infinity));
}

TEST(Morphology, ClosingFillsGapsNarrowerThanTwiceTheRadius) {
    const Index3 size{60, 40, 40};
    const ImageGeometry grid = centredGeometry(size, {0.8, 0.8, 0.8});
    // two blocks, 8 voxels (6.4 mm) apart; to a voxel
    Mask mask(60 * 40 * 40, 0);
    for (int k = 12; k < 28; ++k) {
        for (int j = 12; j < 28; ++j) {
            for (int i = 15; i < 45; ++i) mask[i + 60 * (j + 40 * k)] = i < 26 || i >= 34 ? 1 : 0;
        }
    }
    const auto middle = 30 + 60 * (20 + 40 * 20);
    EXPECT_EQ(closed(mask, grid, 2.6)[middle], 0);
    EXPECT_EQ(closed(mask, grid, 3.6)[middle], 1);
    EXPECT_EQ(closed(mask, grid, 0), mask);
    // opening takes away what is thinner than twice the radius: blocks of 11 x 16 x 16 voxels
    EXPECT_GT(voxelsIn(opened(mask, grid, 4.0)), 0);
    EXPECT_EQ(voxelsIn(opened(mask, grid, 4.8)), 0);
}

TEST(Morphology, ClosingLeavesDilationsAndOpeningThemselvesAsTheyAre) {
    // by the rules of an adjunction, also at radii that are distances between voxels
    const ImageGeometry grid = centredGeometry({40, 40, 40}, {2, 2, 2});
    const Mask ball = above(partInside(sphere({0.7, -0.3, 1}, 24), grid), 0.5);
    for (const double radius : {1.0, 2.5, 3.0, 5.0}) {
        const Mask grown = dilated(ball, grid, radius);
        EXPECT_EQ(dilated(closed(ball, grid, radius), grid, radius), grown) << radius;
        EXPECT_EQ(opened(grown, grid, radius), grown) << radius;
        // flat caps of a ball get no second layer
        EXPECT_LE(voxelsIn(closed(ball, grid, radius)) - voxelsIn(ball), 40) << radius;
    }
}

TEST(Morphology, DilationOfAVoxelIsABall) {
    const ImageGeometry grid = centredGeometry({31, 31, 31});
    Mask mask(31 * 31 * 31, 0);
    mask[15 + 31 * (15 + 31 * 15)] = 1;
    // the voxel itself reaches half a step from its centre
    const Mask expected = above(partInside(sphere({}, 10.5), grid), 0.5);
    EXPECT_EQ(dilated(mask, grid, 10), expected);
    EXPECT_EQ(eroded(expected, grid, 10), mask);
}

TEST(Components, LargestFilledAndReached) {
    const Index3 size{30, 30, 30};
    const ImageGeometry grid = centredGeometry(size);
    Mask mask = above(partInside(shell({}, 4, 10), grid), 0.5);
    const Mask ball = above(partInside(sphere({}, 10), grid), 0.5);
    EXPECT_EQ(filled(mask, size), ball);
    mask[1 + 30 * (1 + 30 * 1)] = 1;
    EXPECT_EQ(filled(largestComponent(mask, size), size), ball);
    Mask corner(mask.size(), 0);
    corner[1 + 30 * (1 + 30 * 1)] = 1;
    EXPECT_EQ(componentsWith(corner, mask, size), corner);
}

TEST(Components, OfThoseEquallyGoodTheFirst) {
    const Index3 size{9, 9, 9};
    Mask mask(9 * 9 * 9, 0);
    const auto at = [&](int i, int j, int k) -> std::uint8_t& { return mask[i + 9 * (j + 9 * k)]; };
    // a fork whose prongs join behind, and an L of as many voxels with a larger box
    at(1, 1, 1) = at(3, 1, 1) = at(1, 2, 1) = at(2, 2, 1) = at(3, 2, 1) = 1;
    const Mask fork = mask;
    at(5, 5, 5) = at(5, 6, 5) = at(5, 7, 5) = at(5, 7, 6) = at(6, 7, 6) = 1;
    EXPECT_EQ(largestComponent(mask, size), fork);
    Mask ell = mask;
    for (std::size_t n = 0; n < mask.size(); ++n) ell[n] ^= fork[n];
    EXPECT_EQ(widestComponent(mask, size), ell);
    EXPECT_EQ(componentsWith(ell, mask, size), ell);
    // touching by an edge is not hanging together
    at(4, 3, 1) = 1;
    EXPECT_EQ(largestComponent(mask, size), fork);
    EXPECT_EQ(largestComponent(Mask(mask.size(), 0), size), Mask(mask.size(), 0));
}

TEST(Smoothed, MovesASphereBySigmaSquaredOverItsRadius) {
    const ImageGeometry grid = centredGeometry({71, 71, 71});
    const Shape ball = sphere({0.3, -0.2, 0.1}, 25);
    FractionField field{grid, partInside(ball, grid)};
    for (const double sigma : {1.0, 2.0, 3.0}) {
        const SurfaceError error = surfaceError({grid, smoothed(field.part, grid, sigma)}, ball);
        // the recursive filter is a Gaussian to about 1 %, parts by depth are exact to 0.02
        EXPECT_NEAR(error.meanMm, -sigma * sigma / 25, 0.03) << sigma;
        EXPECT_LE(error.largestMm, sigma * sigma / 25 + 0.08) << sigma;
    }
    EXPECT_EQ(smoothed(field.part, grid, 0.2), field.part);
}

TEST(Smoothed, IsAsNearToAGaussianBesideTheBorderAsWhereThereIsRoom) {
    // cubes of ones in a grid much larger, in a corner of it and in a grid that they fill: what is
    // left out because it is 0 makes no difference
    const ImageGeometry grid = obliqueGeometry({70, 61, 53}, {0.8, 0.8, 0.8});
    for (const Index3& first : {Index3{20, 22, 24}, Index3{0, 45, 30}, Index3{0, 0, 0}}) {
        const Index3 last = first == Index3{0, 0, 0}
                                ? Index3{69, 60, 52}
                                : Index3{first[0] + 9, first[1] + 9, first[2] + 9};
        std::vector<float> values(static_cast<std::size_t>(grid.voxelCount()), 0);
        std::uint64_t seed = 3;
        for (std::int64_t n = 0; n < std::ssize(values); ++n) {
            const Index3 at{n % 70, n / 70 % 61, n / (70 * 61)};
            bool isIn = true;
            for (int a = 0; a < 3; ++a) isIn &= at[a] >= first[a] && at[a] <= last[a];
            if (isIn) values[n] = static_cast<float>(nextRandom(seed) % 1000) / 1000.0f;
        }
        const Volume exact = smoothVolume(VolumeView(values.data(), grid), 1.5);
        const std::vector<float> found = smoothed(values, grid, 1.5);
        const auto view = exact.view().as<float>();
        for (std::size_t n = 0; n < values.size(); ++n) {
            // the recursive filter is a Gaussian to about 1 % of what it smooths
            ASSERT_NEAR(found[n], view.samples[n], 0.01) << n;
        }
    }
    const std::vector<float> none(static_cast<std::size_t>(grid.voxelCount()), 0);
    EXPECT_EQ(smoothed(none, grid, 1.5), none);
}

TEST(WorkingGrid, IsTheImagesOwnWhereVoxelsAreCubes) {
    const ImageGeometry image = mirroredGeometry({50, 60, 40}, {1.1, 1.1, 1.1});
    const ImageGeometry grid = workingGrid(image, {10, 10, 10}, {30, 40, 30}, 0, 5);
    EXPECT_EQ(grid.indexToPhysical, image.indexToPhysical);
    const Vec3 first = image.toIndex(grid.originMm);
    for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR(first[a], std::round(first[a]), 1e-9);
        EXPECT_LE(first[a], 10 - 5 / 1.1);  // the margin, and the voxel's own half
        EXPECT_GE(first[a], 10 - 5 / 1.1 - 2);
    }
    EXPECT_NEAR(stepMm(workingGrid(image, {0, 0, 0}, {9, 9, 9}, 2, 0)), 2, 1e-12);
}

TEST(WorkingGrid, HasRightAnglesAndCubesWhereTheImageHasNot) {
    for (const ImageGeometry& image : {shearedGeometry({40, 40, 40}, {0.5, 0.5, 3}),
                                       obliqueGeometry({40, 40, 20}, {0.4, 0.4, 5})}) {
        const ImageGeometry grid = workingGrid(image, {0, 0, 0}, {39, 39, 19}, 0, 4);
        const auto& axes = grid.indexToPhysical.column;
        for (int a = 0; a < 3; ++a) {
            EXPECT_NEAR(norm(axes[a]), 1, 1e-12);
            EXPECT_NEAR(dot(axes[a], axes[(a + 1) % 3]), 0, 1e-12);
        }
        // every sample's voxel lies in it with the margin
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 index = grid.toIndex(image.toPhysical(
                {corner & 1 ? 39.0 : 0, corner & 2 ? 39.0 : 0, corner & 4 ? 19.0 : 0}));
            for (int a = 0; a < 3; ++a) {
                EXPECT_GE(index[a], 4);
                EXPECT_LE(index[a], static_cast<double>(grid.size[a] - 1) - 4);
            }
        }
    }
    EXPECT_THROW(workingGrid(centredGeometry({999, 999, 999}), {0, 0, 0}, {998, 998, 998}, 0.1, 0),
                 InvalidInput);
}

TEST(Resampled, KeepsALinearImageInEveryGeometry) {
    const auto value = [](const Vec3& p) { return 3 + 0.5 * p.x - 0.25 * p.y + p.z; };
    for (const ImageGeometry& geometry :
         {shearedGeometry({30, 30, 30}, {1, 1, 2}), mirroredGeometry({30, 30, 30}, {0.5, 1, 2})}) {
        FloatImage image{geometry, {}};
        for (std::int64_t n = 0; n < geometry.voxelCount(); ++n) {
            image.values.push_back(static_cast<float>(value(
                geometry.toPhysical({static_cast<double>(n % 30), static_cast<double>(n / 30 % 30),
                                     static_cast<double>(n / 900)}))));
        }
        const ImageGeometry grid = workingGrid(geometry, {5, 5, 5}, {24, 24, 24}, 1, 0);
        const std::vector<float> result = resampled(image, grid, -1000);
        for (std::int64_t n = 0; n < grid.voxelCount(); ++n) {
            const Vec3 p =
                grid.toPhysical({static_cast<double>(n % grid.size[0]),
                                 static_cast<double>(n / grid.size[0] % grid.size[1]),
                                 static_cast<double>(n / (grid.size[0] * grid.size[1]))});
            const Vec3 index = geometry.toIndex(p);
            bool isWellInside = true;
            for (int a = 0; a < 3; ++a) isWellInside &= index[a] > 1.5 && index[a] < 27.5;
            if (isWellInside) {
                ASSERT_NEAR(result[n], value(p), 1e-4);  // float
            }
        }
    }
}

TEST(Resampled, EndsHalfAVoxelBeyondTheSamples) {
    const FloatImage image{centredGeometry({4, 4, 4}, {2, 2, 2}), std::vector<float>(64, 5)};
    ImageGeometry line;
    line.size = {100, 1, 1};
    line.originMm = {-5, 0, 0};
    line.indexToPhysical = Mat3::diagonal(0.1, 0.1, 0.1);
    const std::vector<float> result = resampled(image, line, -1);
    for (int n = 0; n < 100; ++n) {
        const double x = -5 + 0.1 * n;                   // samples lie at -3, -1, 1, 3
        if (std::abs(std::abs(x) - 4) < 0.06) continue;  // a voxel at the very end
        EXPECT_EQ(result[n], std::abs(x) < 4 ? 5 : -1) << x;
    }
}

TEST(FilledAtBorder, FillsAirwaysThatOpenAtOneFaceAndNoOthers) {
    const ImageGeometry image = centredGeometry({30, 30, 30});
    const ImageGeometry grid = workingGrid(image, {0, 0, 0}, {29, 29, 29}, 0, 3);
    const std::vector<std::uint8_t> faces = imageFaces(image, grid);
    Mask body(faces.size(), 0);
    const auto at = [&](int i, int j, int k) -> std::uint8_t& {
        // voxel of the grid where the image's lies: a margin of 3 and half a voxel
        const Vec3 index = grid.toIndex(image.toPhysical(
            {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        return body[std::lround(index.x) +
                    grid.size[0] * (std::lround(index.y) + grid.size[1] * std::lround(index.z))];
    };
    for (int k = 0; k < 25; ++k) {
        for (int j = 5; j < 25; ++j) {
            for (int i = 5; i < 25; ++i) at(i, j, k) = 1;
        }
    }
    const Mask solid = body;
    for (int k = 0; k < 12; ++k) at(14, 14, k) = at(15, 14, k) = 0;  // opens at the image's bottom
    EXPECT_EQ(filledAtBorder(body, faces, grid.size), solid);
    for (int j = 5; j < 15; ++j) at(14, j, 0) = 0;  // a groove that leads outside
    EXPECT_EQ(filledAtBorder(body, faces, grid.size), body);
}

TEST(FilledAtBorder, TakesTheGridsOwnBorderForOutside) {
    // the image goes on beyond the grid: none of its faces is there
    const ImageGeometry image = centredGeometry({90, 90, 90});
    const ImageGeometry grid = workingGrid(image, {35, 35, 35}, {54, 54, 54}, 0, 6);
    const Mask ball = above(partInside(sphere({}, 9), grid), 0.5);
    const Mask hollow = above(partInside(shell({}, 4, 9), grid), 0.5);
    EXPECT_EQ(filledAtBorder(hollow, imageFaces(image, grid), grid.size), ball);
}

}  // namespace
}  // namespace adaptiso::headmodel
