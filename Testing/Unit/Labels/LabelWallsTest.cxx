#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "LabelMaps.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso {
namespace {

using testing::centredGeometry;
using testing::fullResolution;
using testing::halfBalls;
using testing::keepsPromises;
using testing::longCells;
using testing::Map;
using testing::mirroredGeometry;
using testing::noise;
using testing::obliqueGeometry;

// Bars of the measures: what a smooth wall through the labels of a ball can be expected to have.
// The voxels themselves are 0.3 % (radius 10) and less away from the ball's volume.
TEST(ExtractLabels, GivesBallsTheirVolumeAndArea) {
    for (const double radius : {10.0, 20.0, 40.0}) {
        const auto side = static_cast<std::int64_t>(2 * radius + 6);
        const Map map = Map::inSpace(centredGeometry({side, side, side}), [&](const Vec3& p) {
            return norm(p - Vec3{0.13, -0.21, 0.37}) < radius ? 1 : 0;
        });
        const double volume = 4 * std::numbers::pi * std::pow(radius, 3) / 3,
                     area = 4 * std::numbers::pi * std::pow(radius, 2);
        for (const LabelOptions& options : {fullResolution(), LabelOptions{}}) {
            const auto measures = measureRegions(extractLabels(map.view(), options).complex);
            ASSERT_EQ(measures.size(), 1U);
            EXPECT_NEAR(measures[0].volumeMm3, volume, 0.002 * volume) << radius;
            EXPECT_NEAR(measures[0].areaMm2, area, 0.005 * area) << radius;
            EXPECT_EQ(measures[0].eulerCharacteristic, 2);
        }
    }
}

TEST(ExtractLabels, KeepsTheVolumeOfThinTubes) {
    // round ends of radius r at a distance of 40; thinner tubes lose some of their volume
    const Vec3 along = normalized({1, 2, 3}), middle{0.13, -0.21, 0.37};
    for (const auto& [radius, part] : std::map<double, double>{{4, 0.005}, {1.5, 0.03}}) {
        const Map map = Map::inSpace(centredGeometry({49, 57, 61}), [&, r = radius](const Vec3& p) {
            const double t = std::clamp(dot(p - middle, along), -20.0, 20.0);
            return norm(p - middle - t * along) < r ? 1 : 0;
        });
        const auto measures = measureRegions(extractLabels(map.view(), fullResolution()).complex);
        const double volume = std::numbers::pi * radius * radius * 40 +
                              4 * std::numbers::pi * std::pow(radius, 3) / 3;
        ASSERT_EQ(measures.size(), 1U);
        EXPECT_NEAR(measures[0].volumeMm3, volume, part * volume) << radius;
    }
}

TEST(ExtractLabels, GivesSmallRegionsTheVolumeOfTheirVoxels) {
    // blocks of 1 x 1 x 1 to 4 x 3 x 3 voxels among others and alone
    const std::vector<Index3> sides{{1, 1, 1}, {2, 1, 1}, {2, 2, 1},
                                    {2, 2, 2}, {3, 3, 2}, {4, 3, 3}};
    const Map map(centredGeometry({60, 12, 12}), [&](const Index3& i) {
        const auto n = static_cast<std::size_t>(i[0] / 10);
        const bool isIn = i[0] % 10 >= 3 && i[0] % 10 < 3 + sides[n][0] && i[1] >= 4 &&
                          i[1] < 4 + sides[n][1] && i[2] >= 4 && i[2] < 4 + sides[n][2];
        return isIn ? static_cast<Label>(n + 1) : n % 2 == 0 ? 0 : 10;
    });
    EXPECT_TRUE(keepsPromises(map));
    for (const RegionMeasure& m :
         measureRegions(extractLabels(map.view(), fullResolution()).complex)) {
        if (m.label == 10) continue;
        const Index3& side = sides[m.label - 1];
        const auto voxels = static_cast<double>(side[0] * side[1] * side[2]);
        EXPECT_NEAR(m.volumeMm3, voxels, 0.05 * voxels) << m.label;
    }
}

// Smoothing shuts the corner of a block down to a thousandth of its volume, and what has no area
// left counted as thick: thick regions are left as they are.
TEST(ExtractLabels, GivesTheCornerOfABlockItsVolume) {
    const Map map(centredGeometry({12, 12, 12}), [](const Index3& i) {
        return i == Index3{7, 7, 7} ? 2 : i[0] < 8 && i[1] < 8 && i[2] < 8 ? 1 : 0;
    });
    const auto measures = measureRegions(extractLabels(map.view(), fullResolution()).complex, {2});
    // three walls meet around it in a curve that stays in its cells: three quarters are what is
    // left
    EXPECT_GT(measures.front().volumeMm3, 0.7);
}

// A voxel in the surface of a small region that is short of volume, too: the mean over walls by
// area left it a tenth of its own.
TEST(ExtractLabels, GivesAVoxelInASmallRegionsSurfaceItsVolume) {
    const Map map = Map::inSpace(centredGeometry({14, 14, 14}), [](const Vec3& p) {
        return norm(p) > 3 ? 0 : p.x > 2 && p.y > 1 && p.z > 0 ? 2 : 1;
    });
    ASSERT_EQ(std::ranges::count(map.labels, 2), 1);
    const auto measures = measureRegions(extractLabels(map.view(), fullResolution()).complex);
    EXPECT_GT(measures[1].volumeMm3, 0.7);
    EXPECT_NEAR(measures[0].volumeMm3, static_cast<double>(std::ranges::count(map.labels, 1)), 1.5);
}

/// The triangles between two labels.
TriangleMesh wallOf(const LabelComplex& complex, const std::array<Label, 2>& labels) {
    TriangleMesh wall;
    wall.points = complex.points;
    for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
        if (complex.labels[t] == labels) wall.triangles.push_back(complex.triangles[t]);
    }
    return wall;
}

TEST(ExtractLabels, LeavesAFlatWallFlatAndOfFewTriangles) {
    for (const double radius : {20.0, 40.0}) {
        const Map map = halfBalls(radius);
        for (const LabelOptions& options : {fullResolution(), LabelOptions{}}) {
            const TriangleMesh wall = wallOf(extractLabels(map.view(), options).complex, {1, 2});
            double farthest = 0;
            for (const Triangle& t : wall.triangles) {
                for (const VertexId v : t) {
                    farthest = std::max(farthest, std::abs(wall.points[v].x));
                }
            }
            ASSERT_FALSE(wall.triangles.empty());
            EXPECT_LE(farthest, 0.05);
            if (!options.maxErrorMm) {
                EXPECT_LT(wall.triangles.size(), 150U);
            }
        }
    }
}

/// The largest distance of points of one wall (every triangle at 28 places) to the other.
double sampledDistance(const TriangleMesh& from, const TriangleMesh& to) {
    constexpr int kSteps = 6;
    const AabbTree tree(to);
    double farthest2 = 0;
    for (const Triangle& t : from.triangles) {
        for (int a = 0; a <= kSteps; ++a) {
            for (int b = 0; a + b <= kSteps; ++b) {
                const Vec3 p = (1.0 / kSteps) * (a * from.points[t[0]] + b * from.points[t[1]] +
                                                 (kSteps - a - b) * from.points[t[2]]);
                farthest2 = std::max(farthest2, tree.closestPoint(p).squaredDistanceMm2);
            }
        }
    }
    return std::sqrt(farthest2);
}

TEST(ExtractLabels, KeepsEveryWallWithinTheStatedDistanceOfItself) {
    const std::vector<Map> maps{
        halfBalls(12), noise(obliqueGeometry({9, 8, 7}, {1, 1.5, 2}), 4, 9),
        Map::inSpace(mirroredGeometry({24, 24, 24}, {1, 1, 1.4}), [](const Vec3& p) {
            return norm(p) < 10 ? 1 + (p.x + p.y > 1.3) + 2 * (p.z - p.x > 0.7) : 0;
        })};
    for (const Map& map : maps) {
        const LabelComplex full = extractLabels(map.view(), fullResolution()).complex;
        std::set<std::array<Label, 2>> pairs(full.labels.begin(), full.labels.end());
        // the square of the last is infinite
        for (const double maxErrorMm : {0.1, 0.4, 2.0, 1e300}) {
            LabelOptions options;
            options.maxErrorMm = maxErrorMm;
            const LabelResult result = extractLabels(map.view(), options);
            EXPECT_LE(result.statistics.errorBoundMm, maxErrorMm);
            EXPECT_LT(result.complex.triangles.size(), full.triangles.size());
            EXPECT_EQ(std::set(result.complex.labels.begin(), result.complex.labels.end()), pairs);
            for (const auto& labels : pairs) {
                const TriangleMesh a = wallOf(full, labels), b = wallOf(result.complex, labels);
                // rounding of a sample of a triangle, not of the surfaces
                EXPECT_LE(sampledDistance(a, b), result.statistics.errorBoundMm + 1e-9);
                EXPECT_LE(sampledDistance(b, a), result.statistics.errorBoundMm + 1e-9);
            }
        }
    }
}

// The allowed distance doubles in vain then: it is not what is stated.
TEST(ExtractLabels, StatesTheDistanceItHasWhereACountCannotBeMet) {
    const Map map = halfBalls(20);
    const LabelComplex full = extractLabels(map.view(), fullResolution()).complex;
    LabelOptions options;
    options.maxTriangles = 1;
    const LabelResult few = extractLabels(map.view(), options);
    double farthestMm = 0;
    for (const auto& labels : std::set(full.labels.begin(), full.labels.end())) {
        const TriangleMesh a = wallOf(full, labels), b = wallOf(few.complex, labels);
        farthestMm = std::max({farthestMm, sampledDistance(a, b), sampledDistance(b, a)});
    }
    EXPECT_GE(few.statistics.errorBoundMm, farthestMm);
    EXPECT_LE(few.statistics.errorBoundMm, 1.5 * farthestMm);
}

TEST(ExtractLabels, ReachesAWantedCountAndStatesItsDistance) {
    const Map map = halfBalls(20);
    const LabelResult full = extractLabels(map.view(), fullResolution());
    LabelOptions options;
    options.maxTriangles = 700;
    const LabelResult few = extractLabels(map.view(), options);
    EXPECT_LE(few.complex.triangles.size(), 700U);
    EXPECT_GT(few.complex.triangles.size(), 650U);
    EXPECT_EQ(few.statistics.wantedTriangles, 700);
    EXPECT_LE(sampledDistance(wallOf(full.complex, {1, 0}), wallOf(few.complex, {1, 0})),
              few.statistics.errorBoundMm);
    EXPECT_TRUE(keepsPromises(map, options));
    options.maxTriangles = {};
    options.reduction = 0.5;
    const LabelResult half = extractLabels(map.view(), options);
    EXPECT_LE(2 * half.complex.triangles.size(), full.complex.triangles.size() + 1);
    options.reduction = 0;
    EXPECT_EQ(extractLabels(map.view(), options).complex, full.complex);
}

/// Triangles with an angle below one.
std::int64_t countSharper(const LabelComplex& complex, double degrees) {
    const double cosine = std::cos(degrees * std::numbers::pi / 180);
    return std::ranges::count_if(complex.triangles, [&](const Triangle& t) {
        for (int c = 0; c < 3; ++c) {
            const Vec3 at = complex.points[t[c]], a = complex.points[t[(c + 1) % 3]] - at,
                       b = complex.points[t[(c + 2) % 3]] - at;
            if (dot(a, b) > cosine * norm(a) * norm(b)) return true;
        }
        return false;
    });
}

TEST(ExtractLabels, MakesNoAngleBelowTheOneAskedFor) {
    const Map map = halfBalls(20);
    LabelOptions options;
    const LabelComplex any = extractLabels(map.view(), options).complex;
    EXPECT_GT(countSharper(any, 20), 0);
    options.minAngleDeg = 20;
    const LabelComplex round = extractLabels(map.view(), options).complex;
    EXPECT_EQ(countSharper(round, 19.999), 0);
    EXPECT_GE(round.triangles.size(), any.triangles.size());
    EXPECT_LT(round.triangles.size(), 2 * any.triangles.size());
    EXPECT_TRUE(keepsPromises(map, options));
}

/// Chosen regions alone, and what they are in the whole map.
struct ChosenWalls {
    LabelComplex chosen, all;
    ChosenWalls(const Map& map, LabelOptions options, const std::vector<Label>& labels) {
        all = extractLabels(map.view(), options).complex;
        options.labels = labels;
        chosen = extractLabels(map.view(), options).complex;
    }
};

TEST(ExtractLabels, GivesChosenRegionsTheWallsOfTheWholeMapBeforeSmoothing) {
    // noise: the regions' box is the whole map, so that coordinates have the same digits
    const Map map = noise(obliqueGeometry({9, 8, 7}, {1, 1.5, 2}), 5, 77);
    LabelOptions options;
    options.smooth = false;
    options.maxErrorMm = 0;
    const ChosenWalls walls(map, options, {4, 2});
    std::set<Label> seen;
    for (const auto& pair : walls.chosen.labels) {
        EXPECT_TRUE(pair[0] == 2 || pair[0] == 4 || pair[1] == 2 || pair[1] == 4);
        seen.insert(pair.begin(), pair.end());
    }
    EXPECT_EQ(seen, (std::set<Label>{0, 1, 2, 3, 4}));  // the other sides keep their numbers
    for (const Label label : {2, 4}) {
        EXPECT_EQ(regionSurface(walls.chosen, label), regionSurface(walls.all, label));
    }
    EXPECT_EQ(measureRegions(walls.chosen, {2})[0], measureRegions(walls.all, {2})[0]);
    std::vector<bool> isUsed(walls.chosen.points.size(), false);
    for (const Triangle& t : walls.chosen.triangles) {
        for (const VertexId v : t) isUsed[v] = true;
    }
    EXPECT_EQ(std::count(isUsed.begin(), isUsed.end(), false), 0);
}

TEST(ExtractLabels, KeepsThePromisesForChosenRegions) {
    const Map noisy = noise(obliqueGeometry({12, 10, 9}, {1, 1.5, 2}), 5, 78);
    const Map cells = longCells(obliqueGeometry({40, 14, 13}, {1, 1.5, 2}), 8);
    for (const Map* map : {&noisy, &cells}) {
        for (const std::vector<Label>& labels : {std::vector<Label>{2}, {4, 1}}) {
            for (const double errorMm : {0.0, 0.5}) {
                LabelOptions options;
                options.maxErrorMm = errorMm;
                options.labels = labels;
                EXPECT_TRUE(keepsPromises(*map, options));
                const ChosenWalls walls(*map, options, labels);
                for (const RegionMeasure& own : measureRegions(walls.chosen, labels)) {
                    const RegionMeasure other = measureRegions(walls.all, {own.label}).front();
                    EXPECT_EQ(own.components, other.components);
                    EXPECT_TRUE(std::ranges::equal(own.neighbours, other.neighbours, {},
                                                   &RegionContact::label, &RegionContact::label));
                }
            }
        }
    }
}

// A wall that is left out does not let the curve at its end go: the wall to each neighbour keeps
// its own bound.
TEST(ExtractLabels, KeepsCurvesWhereNeighboursOfAChosenRegionMeet) {
    // half a ball on two blocks, whose border runs straight below it
    const Map map(centredGeometry({24, 24, 24}), [](const Index3& i) {
        if (i[2] < 10) return i[0] < 12 ? 1 : 2;
        const auto square = [](std::int64_t x) { return static_cast<double>(x * x); };
        return square(i[0] - 12) + square(i[1] - 12) + square(i[2] - 10) < 64 ? 3 : 0;
    });
    LabelOptions options;
    options.maxErrorMm = 0.2;
    options.labels = {3};
    const LabelComplex chosen = extractLabels(map.view(), options).complex;
    std::set<VertexId> ofFirst, ofSecond;
    for (std::size_t t = 0; t < chosen.triangles.size(); ++t) {
        if (chosen.labels[t] == std::array<Label, 2>{1, 3}) {
            ofFirst.insert(chosen.triangles[t].begin(), chosen.triangles[t].end());
        }
        if (chosen.labels[t] == std::array<Label, 2>{2, 3}) {
            ofSecond.insert(chosen.triangles[t].begin(), chosen.triangles[t].end());
        }
    }
    std::int64_t onBoth = 0;
    for (const VertexId v : ofFirst) {
        if (!ofSecond.contains(v)) continue;
        ++onBoth;
        // centres of voxels 11 and 12 lie half a mm from the middle; the curve is straight there
        const double x =
            chosen.points[v].x - 0.5 * (map.centre(11, 0, 0).x + map.centre(12, 0, 0).x);
        EXPECT_LE(std::abs(x), 0.2 + 0.05);  // and 0.05 for what smoothing does at its ends
    }
    EXPECT_GE(onBoth, 2);
    EXPECT_LT(onBoth, 9);  // of some 16 at full resolution
}

TEST(ExtractLabels, LooksAtTheCellsOfChosenRegionsAlone) {
    const Map map(centredGeometry({24, 24, 24}), [](const Index3& i) {  // blocks of 6^3 voxels
        return static_cast<Label>(1 + i[0] / 6 + 4 * (i[1] / 6) + 16 * (i[2] / 6));
    });
    LabelOptions options = fullResolution();
    options.labels = {22};  // the second along each axis
    const LabelResult one = extractLabels(map.view(), options);
    EXPECT_EQ(one.statistics.cells, 7 * 7 * 7 - 5 * 5 * 5);
    EXPECT_EQ(one.statistics.fullTriangles, std::ssize(one.complex.triangles));
    EXPECT_EQ(measureRegions(one.complex, {22}).front().neighbours.size(), 26U - 20U);
}

TEST(ExtractLabels, GivesTheSameBytesForAnyNumberOfThreads) {
    const Map map = noise(obliqueGeometry({20, 16, 18}, {1, 1.5, 2}), 4, 3);
    const Map balls = halfBalls(15), cells = longCells(centredGeometry({200, 14, 13}), 8);
    for (const Map* of : {&map, &balls, &cells}) {
        const LabelComplex many = extractLabels(of->view(), {}).complex;
        const ThreadLimitGuard one(1);
        EXPECT_EQ(extractLabels(of->view(), {}).complex, many);
    }
}

TEST(ExtractLabels, NamesTheSmallerLabelFirstAndZeroLast) {
    const Map map(centredGeometry({4, 1, 1}), [](const Index3& i) {
        return std::array<Label, 4>{7, -3, 0, 2}[i[0]];
    });
    std::set<std::array<Label, 2>> pairs;
    for (const auto& pair : extractLabels(map.view(), {}).complex.labels) pairs.insert(pair);
    EXPECT_TRUE(pairs.contains({7, -3}));
    EXPECT_TRUE(pairs.contains({2, 0}));
    EXPECT_TRUE(pairs.contains({-3, 0}));
}

TEST(ExtractLabels, TakesEveryPixelTypeAlike) {
    const ImageGeometry geometry = centredGeometry({6, 5, 4});
    const Map map = noise(geometry, 4, 21);
    const LabelComplex expected = extractLabels(map.view(), {}).complex;
    const std::vector<std::uint8_t> bytes(map.labels.begin(), map.labels.end());
    const std::vector<float> floats(map.labels.begin(), map.labels.end());
    EXPECT_EQ(extractLabels(VolumeView(bytes.data(), geometry), {}).complex, expected);
    EXPECT_EQ(extractLabels(VolumeView(floats.data(), geometry), {}).complex, expected);
}

TEST(ExtractLabels, RefusesWhatIsNoLabelMap) {
    const ImageGeometry geometry = centredGeometry({2, 1, 1});
    for (const double sample : {0.5, std::numeric_limits<double>::quiet_NaN(), 2147483648.0}) {
        const std::vector<double> samples{1, sample};
        EXPECT_THROW(extractLabels(VolumeView(samples.data(), geometry), {}), InvalidInput);
        EXPECT_THROW(findLabels(VolumeView(samples.data(), geometry)), InvalidInput);
    }
}

// Found by random calls from Python: cubes of so many limits of a distance as there is no memory
// for.
TEST(ExtractLabels, RefusesVoxelsThatAreNeedles) {
    ImageGeometry geometry;
    geometry.size = {4, 4, 4};
    std::vector<std::uint8_t> samples(64, 0);
    samples[21] = 1;
    geometry.indexToPhysical = Mat3::diagonal(1e-3, 2, 1);
    EXPECT_FALSE(extractLabels(VolumeView(samples.data(), geometry), {}).complex.triangles.empty());
    for (const double thinMm : {1e-7, 1e-38}) {
        geometry.indexToPhysical = Mat3::diagonal(thinMm, 2, 1);
        EXPECT_THROW(extractLabels(VolumeView(samples.data(), geometry), {}), InvalidInput);
    }
}

TEST(ExtractLabels, RefusesOptionsThatBreakTheirRules) {
    const Map map(centredGeometry({2, 1, 1}),
                  [](const Index3& i) { return static_cast<Label>(i[0]); });
    const auto refuses = [&](const auto& change) {
        LabelOptions options;
        change(options);
        EXPECT_THROW(extractLabels(map.view(), options), InvalidInput);
    };
    refuses([](LabelOptions& o) { o.maxErrorMm = -1; });
    refuses([](LabelOptions& o) { o.maxErrorMm = std::nan(""); });
    refuses([](LabelOptions& o) { o.maxTriangles = -1; });
    refuses([](LabelOptions& o) { o.reduction = 1.5; });
    refuses([](LabelOptions& o) { o.minAngleDeg = 41; });
    refuses([](LabelOptions& o) { o.minAngleDeg = std::nan(""); });
    refuses([](LabelOptions& o) { o.labels = {2}; });
    refuses([](LabelOptions& o) { o.labels = {1, 1}; });
    refuses([](LabelOptions& o) { o.labels = {0}; });
}

TEST(ExtractLabels, GivesNothingForAMapOfZeros) {
    const Map map(centredGeometry({3, 3, 3}), [](const Index3&) { return 0; });
    const LabelResult result = extractLabels(map.view(), {});
    EXPECT_TRUE(result.complex.points.empty());
    EXPECT_TRUE(result.complex.triangles.empty());
    EXPECT_TRUE(findLabels(map.view()).empty());
}

TEST(FindLabels, ListsThemAscendingWithoutZero) {
    const Map map(centredGeometry({5, 1, 1}), [](const Index3& i) {
        return std::array<Label, 5>{7, -3, 0, 7, 2}[i[0]];
    });
    EXPECT_EQ(findLabels(map.view()), (std::vector<Label>{-3, 2, 7}));
}

}  // namespace
}  // namespace adaptiso
