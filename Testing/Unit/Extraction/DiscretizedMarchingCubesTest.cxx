#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::testing {
namespace {

constexpr Method kDmc = Method::DiscretizedMarchingCubes;

using HalfSteps = std::array<std::int64_t, 3>;  // of the lattice: a midpoint has one odd number

HalfSteps halfSteps(const Vec3& index) {
    return {std::llround(2 * index.x), std::llround(2 * index.y), std::llround(2 * index.z)};
}

Vec3 indexAt(const HalfSteps& p) {
    return 0.5 *
           Vec3{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

std::set<HalfSteps> placesOf(const TriangleMesh& mesh) {
    std::set<HalfSteps> places;
    for (const Vec3& p : mesh.points) places.insert(halfSteps(p));
    return places;
}

/// The axis of the lattice edge in whose middle p lies; none if it lies in no edge's middle.
std::optional<int> edgeAxisAt(const HalfSteps& p) {
    std::optional<int> axis;
    for (int a = 0; a < 3; ++a) {
        if (p[a] % 2 == 0) continue;
        if (axis) return std::nullopt;
        axis = a;
    }
    return axis;
}

/// Inside, with all samples beyond the border outside.
bool isInside(const HardVolume& hard, const Index3& p) {
    const auto view = hard.volume.view().as<std::uint8_t>();
    for (int a = 0; a < 3; ++a) {
        if (p[a] < 0 || p[a] >= view.geometry.size[a]) return false;
    }
    return view.at(p[0], p[1], p[2]) >= hard.isovalue;
}

/// The lattice edge that a point of the full grid's surface lies on, by its midpoint.
HalfSteps edgeOf(const Vec3& index) {
    HalfSteps edge{};
    for (int a = 0; a < 3; ++a) {
        const double nearest = std::round(index[a]);
        // crossings keep 0.001 of an edge from samples; the other two are whole numbers
        edge[a] = std::abs(index[a] - nearest) < 1e-6
                      ? 2 * static_cast<std::int64_t>(nearest)
                      : 2 * static_cast<std::int64_t>(std::floor(index[a])) + 1;
    }
    return edge;
}

}  // namespace

TEST(DiscretizedMarchingCubes, PutsVerticesExactlyInTheMiddleOfCrossedEdges) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const HardVolume hard = hardVolume(seed, 12);
        const Extraction result = extractFrom(hard.volume, hard.isovalue, kDmc, 4, Border::Closed);
        // vertices that halve doubled edges come last
        const std::size_t placed =
            result.mesh.points.size() - static_cast<std::size_t>(result.statistics.edgesSplit);
        std::set<HalfSteps> places;
        for (std::size_t v = 0; v < placed; ++v) {
            const Vec3& p = result.mesh.points[v];
            const HalfSteps at = halfSteps(p);
            ASSERT_EQ(p, indexAt(at)) << "seed " << seed;  // voxels of 1 mm: no rounding
            const std::optional<int> axis = edgeAxisAt(at);
            ASSERT_TRUE(axis) << "seed " << seed;
            Index3 low, high;
            for (int a = 0; a < 3; ++a) {
                low[a] = static_cast<std::int64_t>(std::floor(p[a]));
                high[a] = low[a] + (a == *axis);
            }
            ASSERT_NE(isInside(hard, low), isInside(hard, high)) << "seed " << seed;
            ASSERT_TRUE(places.insert(at).second) << "seed " << seed;
        }
    }
}

// why midpoints never have to be moved to keep triangles from being flat
TEST(DiscretizedMarchingCubes, HasNoThreeMidpointsOfACellOnALine) {
    std::vector<Vec3> midpoints;
    for (std::int64_t x = 0; x <= 2; ++x) {
        for (std::int64_t y = 0; y <= 2; ++y) {
            for (std::int64_t z = 0; z <= 2; ++z) {
                if (edgeAxisAt({x, y, z})) midpoints.push_back(indexAt({x, y, z}));
            }
        }
    }
    ASSERT_EQ(midpoints.size(), 12u);
    for (std::size_t a = 0; a < 12; ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            for (std::size_t c = 0; c < b; ++c) {
                EXPECT_GT(norm(areaVector2(midpoints[a], midpoints[b], midpoints[c])), 0.2);
            }
        }
    }
}

TEST(DiscretizedMarchingCubes, CutsAnAxisAlignedPlaneIntoTwoTriangles) {
    for (std::int64_t at = 1; at < 9; ++at) {
        const HardVolume hard =
            binaryVolume({20, 14, 9}, [&](auto, auto, auto z) { return z < at; });
        for (const int blockSize : kBlockSizes) {
            const TriangleMesh mesh =
                extractFrom(hard.volume, 50, kDmc, blockSize, Border::Open).mesh;
            expectSound(mesh, openOnlyAtBorder(hard.volume.view().geometry()));
            EXPECT_EQ(mesh.triangles.size(), 2u);
            const std::int64_t z = 2 * at - 1;
            EXPECT_EQ(placesOf(mesh),
                      (std::set<HalfSteps>{{0, 0, z}, {38, 0, z}, {0, 26, z}, {38, 26, z}}));
        }
    }
}

TEST(DiscretizedMarchingCubes, CutsAPlaneAt45DegreesIntoTwoTriangles) {
    const HardVolume hard =
        binaryVolume({20, 20, 9}, [](auto x, auto y, auto) { return x + y <= 11; });
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh = extractFrom(hard.volume, 50, kDmc, blockSize, Border::Open).mesh;
        expectSound(mesh, openOnlyAtBorder(hard.volume.view().geometry()));
        EXPECT_EQ(mesh.triangles.size(), 2u);
        EXPECT_EQ(placesOf(mesh),
                  (std::set<HalfSteps>{{23, 0, 0}, {0, 23, 0}, {23, 0, 16}, {0, 23, 16}}));
    }
}

TEST(DiscretizedMarchingCubes, CutsAPlaneThroughThreeAxesIntoOneTriangle) {
    const HardVolume hard =
        binaryVolume({20, 20, 20}, [](auto x, auto y, auto z) { return x + y + z <= 11; });
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh = extractFrom(hard.volume, 50, kDmc, blockSize, Border::Open).mesh;
        EXPECT_EQ(mesh.triangles.size(), 1u);
        EXPECT_EQ(placesOf(mesh), (std::set<HalfSteps>{{23, 0, 0}, {0, 23, 0}, {0, 0, 23}}));
    }
}

TEST(DiscretizedMarchingCubes, BevelsACube) {
    // 6 squares, 12 rectangles along the edges, 8 triangles at the corners; 24 vertices
    const std::int64_t low = 3, side = 7;
    const auto isIn = [&](auto c) { return c >= low && c <= low + side; };
    const HardVolume hard = binaryVolume(
        {16, 16, 16}, [&](auto x, auto y, auto z) { return isIn(x) && isIn(y) && isIn(z); });
    std::set<HalfSteps> expected;
    for (int corner = 0; corner < 8; ++corner) {
        HalfSteps p{};
        for (int a = 0; a < 3; ++a) p[a] = 2 * (corner >> a & 1 ? low + side : low);
        for (int a = 0; a < 3; ++a) {
            HalfSteps q = p;
            q[a] += corner >> a & 1 ? 1 : -1;
            expected.insert(q);
        }
    }
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh =
            extractFrom(hard.volume, 50, kDmc, blockSize, Border::Closed).mesh;
        expectSound(mesh);
        EXPECT_EQ(mesh.points.size(), 24u);
        EXPECT_EQ(mesh.triangles.size(), 44u);
        EXPECT_EQ(placesOf(mesh), expected);
        // s^3, six slabs of 1/2, twelve prisms over right triangles of sides 1/2, an octahedron
        const double s = static_cast<double>(side);
        EXPECT_NEAR(enclosedVolume(mesh), s * s * s + 3 * s * s + 1.5 * s + 1.0 / 6, 1e-9);
    }
}

TEST(DiscretizedMarchingCubes, CutsAWallWithAWindowAroundTheWindow) {
    // a plane region with a hole: 8 corners, so 8 triangles on either side of the wall
    const HardVolume hard = binaryVolume({16, 16, 9}, [](auto x, auto y, auto z) {
        const bool isWindow = x >= 6 && x <= 9 && y >= 6 && y <= 9;
        return z >= 3 && z <= 5 && !isWindow;
    });
    const TriangleMesh mesh = extractFrom(hard.volume, 50, kDmc, 4, Border::Closed).mesh;
    expectSound(mesh);
    for (const std::int64_t z : {5, 11}) {
        EXPECT_EQ(std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                                [&](const Triangle& t) {
                                    return std::all_of(t.begin(), t.end(), [&](VertexId v) {
                                        return halfSteps(mesh.points[v])[2] == z;
                                    });
                                }),
                  // the window's corners are cut off: a hole of 4 sides and 4 bevels
                  8 + 4);
    }
}

TEST(DiscretizedMarchingCubes, MergingAndDroppingChangeNoGeometry) {
    // marching cubes of a volume of two values has the midpoints too, and a smooth solid no
    // ambiguous cell, where the two might fill a loop differently
    const AnalyticVolume truth = sampled<double>(torus({}, 11, 5), centredGeometry({40, 40, 20}));
    const auto view = truth.volume.view().as<double>();
    const HardVolume hard = binaryVolume(view.geometry.size, [&](auto x, auto y, auto z) {
        return view.at(x, y, z) >= truth.isovalue;
    });
    const TriangleMesh full =
        extractFrom(hard.volume, 50, Method::MarchingCubes, 4, Border::Closed).mesh;
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh =
            extractFrom(hard.volume, 50, kDmc, blockSize, Border::Closed).mesh;
        expectSound(mesh);
        EXPECT_LT(mesh.triangles.size(), full.triangles.size() / 2);
        EXPECT_NEAR(enclosedVolume(mesh), enclosedVolume(full), 1e-9 * enclosedVolume(full));
        EXPECT_NEAR(surfaceArea(mesh), surfaceArea(full), 1e-9 * surfaceArea(full));
    }
}

TEST(DiscretizedMarchingCubes, DoesNotDependOnTheBlockSize) {
    const HardVolume hard = hardVolume(5, 14);
    for (const Border border : {Border::Closed, Border::Open}) {
        const TriangleMesh two = extractFrom(hard.volume, hard.isovalue, kDmc, 2, border).mesh;
        for (const int blockSize : {4, 8, 16}) {
            const TriangleMesh other =
                extractFrom(hard.volume, hard.isovalue, kDmc, blockSize, border).mesh;
            EXPECT_EQ(other.triangles.size(), two.triangles.size());
            EXPECT_EQ(placesOf(other), placesOf(two));
        }
    }
}

TEST(DiscretizedMarchingCubes, AdjustedVerticesLieWhereMarchingCubesHasThem) {
    for (const ImageGeometry& geometry :
         {centredGeometry({36, 36, 36}), obliqueGeometry({40, 40, 30}, {1, 0.9, 1.5})}) {
        const AnalyticVolume truth = sampled<float>(sphere({0.1, 0.2, 0.3}, 12), geometry);
        const auto meshBy = [&](const MethodChoice& choice) {
            return extractFrom(truth.volume, truth.isovalue, choice, 4, Border::Closed).mesh;
        };
        std::map<HalfSteps, Vec3> crossings;
        for (const Vec3& p : meshBy(Method::MarchingCubes).points) {
            crossings[edgeOf(geometry.toIndex(p))] = p;
        }
        const TriangleMesh plain = meshBy(kDmc), adjusted = meshBy({kDmc, true});
        expectSound(adjusted);
        EXPECT_EQ(adjusted.triangles, plain.triangles);
        for (const Vec3& p : adjusted.points) {
            const auto crossing = crossings.find(edgeOf(geometry.toIndex(p)));
            ASSERT_NE(crossing, crossings.end());
            EXPECT_EQ(p, crossing->second);
        }
    }
}

TEST(DiscretizedMarchingCubes, AdjustedVerticesOfNoiseLieOnTheCrossingsButForFlatTriangles) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const HardVolume hard = hardVolume(seed, 12);
        const auto resultBy = [&](const MethodChoice& choice) {
            return extractFrom(hard.volume, hard.isovalue, choice, 4, Border::Closed);
        };
        std::map<HalfSteps, Vec3> crossings;
        const Extraction full = resultBy(Method::MarchingCubes);
        for (std::size_t v = 0; v + full.statistics.edgesSplit < full.mesh.points.size(); ++v) {
            crossings[edgeOf(full.mesh.points[v])] = full.mesh.points[v];
        }
        const Extraction result = resultBy({kDmc, true});
        for (std::size_t v = 0; v + result.statistics.edgesSplit < result.mesh.points.size(); ++v) {
            const Vec3& p = result.mesh.points[v];
            const auto crossing = crossings.find(edgeOf(p));
            ASSERT_NE(crossing, crossings.end()) << "seed " << seed;
            // a flat triangle's corners are moved by a few thousandths of an edge at a time
            ASSERT_LT(norm(p - crossing->second), 0.02) << "seed " << seed;
        }
    }
}

TEST(DiscretizedMarchingCubes, NormalsAreCentralDifferencesAtTheMidpoint) {
    // of x^2 central differences are exact, and linear along the edge: 2 x at the midpoint
    ImageGeometry geometry;
    geometry.size = {12, 12, 12};
    std::vector<double> samples;
    for (int z = 0; z < 12; ++z) {
        for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 12; ++x) samples.push_back(x * x + 3.0 * y * y + z * z);
        }
    }
    const Volume volume = Volume::fromSamples(std::move(samples), geometry);
    const TriangleMesh mesh = extractFrom(volume, 80.3, kDmc, 4, Border::Open).mesh;
    int checked = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const Vec3& p = mesh.points[v];
        // at the border differences are one-sided
        if (std::min({p.x, p.y, p.z}) < 1 || std::max({p.x, p.y, p.z}) > 10) continue;
        const Vec3 expected = -normalized(Vec3{2 * p.x, 6 * p.y, 2 * p.z});
        EXPECT_LT(norm(toVec3(mesh.normals[v]) - expected), 1e-6);  // normals are float
        ++checked;
    }
    EXPECT_GT(checked, 20);
}

TEST(DiscretizedMarchingCubes, CountsUnitBoxesAlone) {
    const AnalyticVolume truth = sampled<float>(sphere({}, 10), centredGeometry({28, 28, 28}));
    const ExtractionStatistics statistics =
        extractFrom(truth.volume, truth.isovalue, kDmc, 4, Border::Closed).statistics;
    ASSERT_EQ(statistics.boxes.size(), 1u);
    EXPECT_EQ(statistics.boxes[0].size, 1);
    EXPECT_EQ(statistics.boxes[0].shared, 0);
    EXPECT_GT(statistics.boxes[0].unshared, 0);
    EXPECT_EQ(statistics.boxesChangingTopology, 0);
}

TEST(DiscretizedMarchingCubes, MergedWithinBlocksCutsAPlaneIntoTwoTrianglesABlock) {
    const HardVolume hard = binaryVolume({20, 14, 9}, [](auto, auto, auto z) { return z < 5; });
    for (const int blockSize : kBlockSizes) {
        const TriangleMesh mesh =
            extractFrom(hard.volume, 50, {kDmc, false, true}, blockSize, Border::Open).mesh;
        expectSound(mesh, openOnlyAtBorder(hard.volume.view().geometry()));
        const auto size = static_cast<std::size_t>(blockSize);
        const std::size_t columns = (19 + size - 1) / size, rows = (13 + size - 1) / size;  // cells
        EXPECT_EQ(mesh.triangles.size(), 2 * columns * rows) << "N = " << blockSize;
        EXPECT_EQ(mesh.points.size(), (columns + 1) * (rows + 1)) << "N = " << blockSize;
    }
}

TEST(DiscretizedMarchingCubes, MergedWithinBlocksIsTheSameSurfaceInMoreTriangles) {
    const AnalyticVolume truth = sampled<double>(torus({}, 11, 5), centredGeometry({40, 40, 20}));
    const TriangleMesh plain =
        extractFrom(truth.volume, truth.isovalue, kDmc, 4, Border::Closed).mesh;
    std::size_t finer = 0;
    for (const int blockSize : {16, 8, 4, 2}) {
        const TriangleMesh mesh = extractFrom(truth.volume, truth.isovalue, {kDmc, false, true},
                                              blockSize, Border::Closed)
                                      .mesh;
        expectSound(mesh);
        EXPECT_GT(mesh.triangles.size(), std::max(plain.triangles.size(), finer));
        finer = mesh.triangles.size();
        EXPECT_NEAR(enclosedVolume(mesh), enclosedVolume(plain), 1e-9 * enclosedVolume(plain));
        EXPECT_NEAR(surfaceArea(mesh), surfaceArea(plain), 1e-9 * surfaceArea(plain));
    }
}

TEST(DiscretizedMarchingCubes, AloneHasVerticesToAdjustAndBlocksToMergeWithin) {
    const HardVolume hard = hardVolume(5, 6);
    for (const Method method : {Method::Boxes, Method::SkeletonClimbing, Method::MarchingCubes}) {
        EXPECT_THROW(extractFrom(hard.volume, hard.isovalue, {method, true}, 4, Border::Closed),
                     InvalidInput);
        EXPECT_THROW(
            extractFrom(hard.volume, hard.isovalue, {method, false, true}, 4, Border::Closed),
            InvalidInput);
    }
}

}  // namespace adaptiso::testing
