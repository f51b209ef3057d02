#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::testing {
namespace {

void expectMended(const Mended& mended, const char* file = __builtin_FILE(),
                  int line = __builtin_LINE()) {
    expectSound(mended.mesh, {}, file, line);
    EXPECT_EQ(findSelfIntersections(mended.mesh).pairCount, 0) << file << ":" << line;
    const MendStatistics& s = mended.statistics;
    EXPECT_LE(s.resultToInputMm, s.maxErrorMm) << file << ":" << line;
    EXPECT_LE(s.inputToResultMm, s.maxErrorMm) << file << ":" << line;
}

double areaOf(const std::vector<MendedPlace>& places) {
    double area = 0;
    for (const MendedPlace& place : places) area += place.areaMm2;
    return area;
}

TriangleMesh bare(TriangleMesh mesh) {
    mesh.normals.clear();
    return mesh;
}

/// Every triangle has its corners for itself.
TriangleMesh soupOf(const TriangleMesh& mesh) {
    TriangleMesh soup;
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
        const VertexId first = std::ssize(soup.points);
        for (const Vec3& p : cornersOf(mesh, t)) soup.points.push_back(p);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

MendOptions within(double maxErrorMm) {
    MendOptions options;
    options.maxErrorMm = maxErrorMm;
    return options;
}

/// The distances by samples: most points of either surface lie within the bound of the other; the
/// others are no more than what was listed.
void expectBounds(const TriangleMesh& input, const Mended& mended) {
    const auto areaBeyond = [&](const TriangleMesh& from, const TriangleMesh& to) {
        const AabbTree tree(to);
        double area = 0;
        for (std::int64_t t = 0; t < std::ssize(from.triangles); ++t) {
            const Corners c = cornersOf(from, t);
            constexpr int kSteps = 6;  // parts of a side
            const double part =
                norm(areaVector2(c[0], c[1], c[2])) / 2 / (kSteps * (kSteps + 1) / 2);
            for (int i = 0; i < kSteps; ++i) {
                for (int j = 0; i + j < kSteps; ++j) {
                    const double u = (i + 1.0 / 3) / kSteps, v = (j + 1.0 / 3) / kSteps;
                    const Vec3 p = c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0]);
                    const double away = tree.closestPoint(p).squaredDistanceMm2;
                    if (std::sqrt(away) > mended.statistics.maxErrorMm) area += part;
                }
            }
        }
        return area;
    };
    const MendStatistics& s = mended.statistics;
    EXPECT_LE(areaBeyond(mended.mesh, input), 1.05 * areaOf(s.filled) + 1e-3);
    // what the input holds twice counts twice here
    EXPECT_LE(areaBeyond(input, mended.mesh), 1.05 * (areaOf(s.inner) + areaOf(s.thin)) + 1e-3);
}

TEST(Mend, GivesSoundMeshesBack) {
    for (const TriangleMesh& mesh : {icosphere(3), torusMesh(40, 20, 3, 1), cubeMesh()}) {
        const Mended mended = mend(mesh);
        EXPECT_TRUE(mended.statistics.wasSound);
        EXPECT_EQ(mended.mesh, mesh);
    }
}

TEST(Mend, ClosesAHoleOfOneTriangle) {
    const TriangleMesh sphere = bare(icosphere(3));
    MendOptions options;
    options.maxHoleMm = 0.25;
    const Mended mended = mend(withHole(sphere), options);
    EXPECT_EQ(mended.mesh.triangles.size(), 1280u);
    EXPECT_EQ(mended.statistics.cells, 0);
    expectMended(mended);
    EXPECT_EQ(mended.statistics.borderEdges, 3);
    EXPECT_EQ(mended.statistics.filled.size(), 1u);
    EXPECT_NEAR(enclosedVolume(mended.mesh), enclosedVolume(sphere), 1e-3);
    EXPECT_EQ(mended.statistics.keptTriangles, 1279);
}

/// A box with a cavity in which a box stands, all open at the top, and another one beside: a scan
/// that was cut by a plane.
TEST(Mend, ClosesACutThroughCavitiesByItsCorners) {
    const auto openBox = [](const Vec3& low, const Vec3& high, bool isCavity) {
        TriangleMesh box = cubeMesh(low, high);
        std::erase_if(box.triangles, [&](const Triangle& t) {
            return std::ranges::all_of(t, [&](VertexId v) { return box.points[v].z == high.z; });
        });
        for (Triangle& t : box.triangles) {
            if (isCavity) std::swap(t[1], t[2]);
        }
        return box;
    };
    const TriangleMesh cut =
        merged({openBox({0, 0, 0}, {10, 8, 6}, false), openBox({1, 1, 1}, {6, 7, 6}, true),
                openBox({2, 2, 2}, {4, 4, 6}, false), openBox({7, 1, 1}, {9, 7, 6}, true)});
    MendOptions options;
    options.maxHoleMm = 20;
    const Mended mended = mend(cut, options);
    expectMended(mended);
    // a plane with two holes, 12 corners, and the box in the cavity
    EXPECT_EQ(mended.mesh.triangles.size(), cut.triangles.size() + 14 + 2);
    EXPECT_EQ(mended.statistics.cells, 0);
    EXPECT_EQ(mended.statistics.filled.size(), 2u);
    EXPECT_NEAR(enclosedVolume(mended.mesh), 480 - 150 + 16 - 60, 1e-9);

    TriangleMesh tilted = cut;  // rounded to the digits of a file of single precision
    for (Vec3& p : tilted.points) {
        const auto single = [](double x) { return static_cast<double>(static_cast<float>(x)); };
        p = {single(0.8 * p.x - 0.6 * p.z), single(p.y + 0.1), single(0.6 * p.x + 0.8 * p.z)};
    }
    const Mended again = mend(tilted, options);
    expectMended(again);
    EXPECT_EQ(again.mesh.triangles.size(), mended.mesh.triangles.size());
    EXPECT_NEAR(enclosedVolume(again.mesh), 286, 1e-3);
}

/// A box with three cavities that end in a tip: the mouths of two meet at a corner, the third's has
/// the box's corner.
TEST(Mend, ClosesACutWhereItsRingsMeetAtACorner) {
    const auto cavity = [](const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 tip = (1.0 / 3) * (a + b + c) - Vec3{0, 0, 3};
        TriangleMesh mesh;
        mesh.points = {a, b, c, tip};
        mesh.triangles = {Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{2, 0, 3}};
        return mesh;
    };
    TriangleMesh box = cubeMesh({0, 0, 0}, {10, 10, 6});
    std::erase_if(box.triangles, [&](const Triangle& t) {
        return std::ranges::all_of(t, [&](VertexId v) { return box.points[v].z == 6; });
    });
    const TriangleMesh cut = merged({box, cavity({5, 5, 6}, {6, 8, 6}, {4, 8, 6}),
                                     cavity({5, 5, 6}, {3, 2, 6}, {7, 2, 6}),
                                     cavity({10, 10, 6}, {8, 9, 6}, {9, 8, 6})});
    MendOptions options;
    options.maxHoleMm = 20;
    const Mended mended = mend(cut, options);
    expectMended(mended);
    EXPECT_EQ(mended.statistics.cells, 0);
    // 13 corners of a plane with one hole: the mouths that meet; the third is part of the rim
    EXPECT_EQ(mended.mesh.triangles.size(), cut.triangles.size() + 13);
    EXPECT_NEAR(enclosedVolume(mended.mesh), 600 - (3 + 6 + 1.5), 1e-9);
}

/// A hollow ball from which all triangles above a plane were taken: both rims are ragged.
TEST(Mend, ClosesARaggedCutThroughACavityByItsCorners) {
    TriangleMesh inner = bare(icosphere(4, {0, 0, 0}, 6));
    flipOrientation(inner);
    TriangleMesh cut = merged({bare(icosphere(5, {0, 0, 0}, 10)), inner});
    std::erase_if(cut.triangles, [&](const Triangle& t) {
        return std::ranges::any_of(t, [&](VertexId v) {
            const Vec3& p = cut.points[v];
            return p.z + 0.3 * p.x > 2;
        });
    });
    MendOptions options = within(0.05);
    options.maxHoleMm = 30;
    const Mended mended = mend(cut, options);
    expectMended(mended);
    EXPECT_EQ(mended.statistics.cells, 0);  // the lattice makes 400,000 triangles
    EXPECT_LT(mended.mesh.triangles.size(), cut.triangles.size() + 600);
    const double depth = 2 / std::sqrt(1.09);  // of the plane
    const auto capOf = [&](double radius) {
        const double height = radius - depth;
        return std::numbers::pi * height * height * (radius - height / 3);
    };
    const double whole = 4.0 / 3 * std::numbers::pi * (1000 - 216);
    EXPECT_NEAR(enclosedVolume(mended.mesh), whole - capOf(10) + capOf(6), 0.02 * whole);
}

/// The side of a flat lampshade, whose wavy rims lie within an edge of one plane: between them is
/// the side, no material.
TEST(Mend, ClosesBothOpeningsOfAFlatSide) {
    constexpr int kRound = 24;
    for (const double height : {1.5, 3.0}) {
        for (const double tilt : {0.0, 0.7}) {
            TriangleMesh side;
            for (const bool isUpper : {false, true}) {
                for (int n = 0; n < kRound; ++n) {
                    const double angle = 2 * std::numbers::pi * n / kRound,
                                 radius = isUpper ? 5 : 10, x = radius * std::cos(angle),
                                 z = (isUpper ? height : 0) + 0.05 * std::sin(5 * angle);
                    side.points.push_back({std::cos(tilt) * x - std::sin(tilt) * z,
                                           radius * std::sin(angle),
                                           std::sin(tilt) * x + std::cos(tilt) * z});
                }
            }
            for (VertexId n = 0; n < kRound; ++n) {
                const VertexId a = n, b = (n + 1) % kRound;
                side.triangles.push_back({a, b, b + kRound});
                side.triangles.push_back({a, b + kRound, a + kRound});
            }
            MendOptions options = within(0.2);
            options.maxHoleMm = 100;
            const Mended mended = mend(side, options);
            expectMended(mended);
            EXPECT_EQ(checkTopology(mended.mesh).genus(), 0) << height << " " << tilt;
            const double polygon = kRound / 2.0 * std::sin(2 * std::numbers::pi / kRound);
            EXPECT_NEAR(enclosedVolume(mended.mesh), polygon * height / 3 * (100 + 50 + 25), 15);
        }
    }
}

/// A drum without its upper lid, a corner of whose wall reaches over the rim's plane by a hair: the
/// lid crosses the wall there, and is made anew around that place alone.
TEST(Mend, KeepsMostOfALidThatCrossesTheWallByAHair) {
    constexpr VertexId kRound = 400;
    TriangleMesh drum;
    const auto addPoint = [&](double number, double radius, double z) {
        const double angle = 2 * std::numbers::pi * number / kRound;
        drum.points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    };
    for (const double z : {0.0, -3.0}) {
        for (VertexId n = 0; n < kRound; ++n) addPoint(static_cast<double>(n), 10, z);
    }
    addPoint(0, 0, -3);
    const VertexId bottom = 2 * kRound, over = bottom + 1;
    addPoint(0.5, 9.99, 1e-7);
    for (VertexId n = 0; n < kRound; ++n) {
        const VertexId a = n, b = (n + 1) % kRound, c = a + kRound, d = b + kRound;
        drum.triangles.push_back({bottom, d, c});
        if (n > 0) {
            drum.triangles.push_back({a, c, d});
            drum.triangles.push_back({a, d, b});
            continue;
        }
        const std::array<VertexId, 5> round{a, c, d, b, a};
        for (std::size_t i = 0; i < 4; ++i) {
            drum.triangles.push_back({round[i], round[i + 1], over});
        }
    }
    MendOptions options = within(0.05);
    options.maxHoleMm = 30;
    const Mended mended = mend(drum, options);
    expectMended(mended);
    EXPECT_LT(mended.statistics.cells, 2000);  // the lid alone has 300,000
    EXPECT_GT(mended.statistics.cells, 0);
    EXPECT_NEAR(enclosedVolume(mended.mesh), 3 * std::numbers::pi * 100, 0.2);
}

/// A bowl with a wavy rim and a hole in its bottom, which has nothing of a cut by a plane: a wall
/// between the two would make a ring of it.
TEST(Mend, ClosesRimAndHoleOfABentSheetApart) {
    constexpr int kRound = 64, kRings = 12;
    TriangleMesh bowl;
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int n = 0; n < kRound; ++n) {
            const double angle = 2 * std::numbers::pi * n / kRound, radius = 4 + 3.0 * ring;
            const double wave = 2 * std::sin(6 * angle) * ring / kRings;
            bowl.points.push_back(
                {radius * std::cos(angle), radius * std::sin(angle), radius * radius / 20 + wave});
        }
    }
    for (int ring = 0; ring < kRings; ++ring) {
        for (int n = 0; n < kRound; ++n) {
            const VertexId a = ring * kRound + n, b = ring * kRound + (n + 1) % kRound;
            bowl.triangles.push_back({a, a + kRound, b + kRound});
            bowl.triangles.push_back({a, b + kRound, b});
        }
    }
    MendOptions options = within(0.5);
    options.maxHoleMm = 200;
    const Mended mended = mend(bowl, options);
    expectMended(mended);
    EXPECT_EQ(checkTopology(mended.mesh).genus(), 0);
}

TEST(Mend, DropsTrianglesThatNameNoPoint) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const TriangleMesh ball = bare(icosphere(3, {}, 40));
    TriangleMesh broken = ball;
    broken.triangles[7][1] = std::ssize(ball.points);
    broken.triangles[9][0] = -1;
    const Mended mended = mend(broken, within(0.5));
    expectMended(mended);
    EXPECT_EQ(mended.statistics.brokenTriangles, 2);
    EXPECT_EQ(mended.statistics.keptTriangles, std::ssize(ball.triangles) - 2);
    EXPECT_EQ(mended.mesh.triangles.size(), ball.triangles.size());

    broken = ball;
    broken.points[12] = {0, kNan, 0};  // of six triangles
    MendOptions options = within(0.5);
    options.maxHoleMm = 20;
    const Mended capped = mend(broken, options);
    expectMended(capped);
    EXPECT_EQ(capped.statistics.brokenTriangles, 6);
    try {
        mend(broken, within(0.5));
        FAIL() << "the hole is wider than 5 % of the diagonal";
    } catch (const MendRefusal& refusal) {
        EXPECT_EQ(refusal.statistics.brokenTriangles, 6);
    }

    broken = ball;
    broken.points.push_back({kNan, 0, 0});  // of none
    const Mended whole = mend(broken, within(0.5));
    EXPECT_EQ(whole.mesh, ball);
    EXPECT_FALSE(whole.statistics.wasSound);
    EXPECT_EQ(whole.statistics.brokenTriangles, 0);
    EXPECT_TRUE(isBroken(broken));
    EXPECT_FALSE(isBroken(ball));

    broken.points.assign(broken.points.size(), {kNan, 0, 0});
    EXPECT_THROW(mend(broken, {}), InvalidInput);
}

/// A slit three quarters round the ball, whose border crosses itself seen from anywhere.
TEST(Mend, ClosesABentSlitByTheCornersOfItsBorder) {
    TriangleMesh ball = bare(icosphere(3));
    std::erase_if(ball.triangles, [&](const Triangle& t) {
        const Vec3 middle = 1.0 / 3 * (ball.points[t[0]] + ball.points[t[1]] + ball.points[t[2]]);
        return std::abs(middle.z) < 0.1 && std::abs(std::atan2(middle.y, middle.x)) < 2.4;
    });
    MendOptions options = within(0.05);
    options.maxHoleMm = 3;
    const Mended mended = mend(ball, options);
    expectMended(mended);
    EXPECT_EQ(mended.statistics.cells, 0);
    EXPECT_EQ(mended.statistics.keptTriangles, std::ssize(ball.triangles));
    EXPECT_EQ(std::ssize(mended.mesh.triangles),
              std::ssize(ball.triangles) + mended.statistics.borderEdges - 2);
}

TEST(Mend, ClosesHolesThatShareACornerOneByOne) {
    const TriangleMesh ball = bare(icosphere(3));
    TriangleMesh holed = ball;
    const Triangle first = holed.triangles[0];
    const auto sharesOne = [&](const Triangle& t) {
        return std::count_if(t.begin(), t.end(), [&](VertexId v) {
                   return std::find(first.begin(), first.end(), v) != first.end();
               }) == 1;
    };
    holed.triangles.erase(std::find_if(holed.triangles.begin(), holed.triangles.end(), sharesOne));
    holed.triangles.erase(holed.triangles.begin());
    MendOptions options = within(0.05);
    options.maxHoleMm = 1;
    const Mended mended = mend(holed, options);
    expectMended(mended);
    EXPECT_EQ(mended.statistics.cells, 0);
    EXPECT_EQ(mended.statistics.borderEdges, 6);
    EXPECT_EQ(mended.mesh.triangles.size(), ball.triangles.size());
}

TEST(Mend, UnitesSpheresThatCross) {
    // the union of two unit balls whose centres are half a radius apart: two balls less a lens
    const TriangleMesh spheres = bare(crossingSpheres(4));
    const Mended mended = mend(spheres, within(0.02));
    expectMended(mended);
    const double d = 0.5, lens = std::numbers::pi * (4 + d) * (2 - d) * (2 - d) / 12;
    EXPECT_NEAR(enclosedVolume(mended.mesh), 8 * std::numbers::pi / 3 - lens, 0.03);
    EXPECT_EQ(nestingOf(mended.mesh), "()");
    // what lies in the other ball: two caps of height .75
    EXPECT_NEAR(areaOf(mended.statistics.inner), 2 * 2 * std::numbers::pi * 0.75, 0.3);
}

/// A ring of a hole round an island that hangs on two corners, whatever the order of triangles.
TEST(Mend, ClosesTheHolesBesideAnIslandApart) {
    const TriangleMesh ball = bare(icosphere(3));
    const Vec3 pole = normalized(ball.points[ball.triangles[0][0]]);
    TriangleMesh holed = ball;
    // rings round a corner: the triangles with one corner on the second ring and none on the first
    std::vector<int> ring(ball.points.size(), 9);
    ring[ball.triangles[0][0]] = 0;
    for (int n = 0; n < 3; ++n) {
        for (const Triangle& t : ball.triangles) {
            for (const VertexId v : t) {
                for (const VertexId w : t) {
                    if (ring[v] == n) ring[w] = std::min(ring[w], n + 1);
                }
            }
        }
    }
    const Vec3 along = normalized(cross(pole, Vec3{0.3, 0.5, 0.8}));
    std::erase_if(holed.triangles, [&](const Triangle& t) {
        const int least = std::min({ring[t[0]], ring[t[1]], ring[t[2]]});
        const Vec3 middle = 1.0 / 3 * (ball.points[t[0]] + ball.points[t[1]] + ball.points[t[2]]);
        return least == 1 && std::abs(dot(middle, along)) > 0.06;
    });
    MendOptions options = within(0.02);
    options.maxHoleMm = 3;
    std::mt19937 random(1);
    for (int n = 0; n < 4; ++n) {
        const Mended mended = mend(holed, options);
        expectMended(mended);
        EXPECT_EQ(mended.statistics.cells, 0);
        EXPECT_EQ(mended.statistics.keptTriangles, std::ssize(holed.triangles));
        EXPECT_NEAR(enclosedVolume(mended.mesh), enclosedVolume(ball), 0.02);
        std::shuffle(holed.triangles.begin(), holed.triangles.end(), random);
    }
}

/// The other ball closes it.
TEST(Mend, TakesAWideHoleWithinTheSolidForNone) {
    const TriangleMesh whole = bare(icosphere(4, {1.2, 0, 0}));
    TriangleMesh open = whole;
    std::erase_if(open.triangles, [&](const Triangle& t) { return open.points[t[0]].x < 0.5; });
    MendOptions options = within(0.02);
    options.maxHoleMm = 0.1;
    const Mended mended = mend(merged({bare(icosphere(4)), open}), options);
    expectMended(mended);
    EXPECT_TRUE(mended.statistics.filled.empty());
    const Mended united = mend(merged({bare(icosphere(4)), whole}), options);
    EXPECT_NEAR(enclosedVolume(mended.mesh), enclosedVolume(united.mesh), 1e-6);
}

TEST(Mend, TurnsWhatIsFlipped) {
    const TriangleMesh sphere = bare(icosphere(3));
    const Mended one = mend(withFlippedTriangle(sphere));
    EXPECT_EQ(one.statistics.flippedTriangles, 1);
    EXPECT_EQ(one.mesh.triangles.size(), sphere.triangles.size());
    expectMended(one);
    TriangleMesh inverted = sphere;
    flipOrientation(inverted);
    const Mended all = mend(inverted);
    expectMended(all);
    EXPECT_GT(enclosedVolume(all.mesh), 4);
}

TEST(Mend, DropsDoubledAndFlatTriangles) {
    const TriangleMesh sphere = bare(icosphere(3));
    for (const TriangleMesh& mesh : {withDuplicateTriangle(sphere), withZeroAreaTriangle(sphere),
                                     withRepeatedIndex(sphere), withUnusedVertex(sphere)}) {
        const Mended mended = mend(mesh);
        expectMended(mended);
        EXPECT_NEAR(enclosedVolume(mended.mesh), enclosedVolume(sphere), 1e-9);
        EXPECT_EQ(mended.statistics.cells, 0);
    }
}

TEST(Mend, JoinsASoup) {
    const TriangleMesh sphere = bare(icosphere(3));
    const Mended mended = mend(soupOf(sphere));
    expectMended(mended);
    EXPECT_EQ(mended.mesh.points.size(), sphere.points.size());
    EXPECT_EQ(mended.statistics.cells, 0);
    EXPECT_GT(mended.statistics.mergedPoints, 0);
}

TEST(Mend, JoinsASoupWithGaps) {
    const TriangleMesh sphere = bare(icosphere(3));
    TriangleMesh soup = soupOf(sphere);
    std::mt19937 random(1);
    const auto step = [&] { return static_cast<double>(random() % 3) - 1; };
    for (Vec3& p : soup.points) p += 1e-4 * Vec3{step(), step(), 0};
    const Mended mended = mend(soup, within(0.01));
    expectMended(mended);
    EXPECT_EQ(mended.mesh.points.size(), sphere.points.size());
    EXPECT_GT(mended.statistics.movedMm, 0);
    EXPECT_LE(
        hausdorffDistance(mended.mesh, soup).combined.upperMm,
        1.002 * std::max(mended.statistics.resultToInputMm, mended.statistics.inputToResultMm));
}

TEST(Mend, PartsSpheresThatTouch) {
    const Mended mended = mend(bare(twoSpheresTouchingAtAVertex()));
    expectMended(mended);
}

TEST(Mend, KeepsCavitiesAndDropsInnerShells) {
    const TriangleMesh outer = bare(icosphere(3, {}, 2)), inner = bare(icosphere(3));
    TriangleMesh cavity = inner;
    flipOrientation(cavity);
    const Mended hollow = mend(merged({outer, cavity}));
    EXPECT_TRUE(hollow.statistics.wasSound);
    const Mended solid = mend(merged({outer, inner}));
    expectMended(solid);
    EXPECT_EQ(nestingOf(solid.mesh), "()");
    EXPECT_NEAR(areaOf(solid.statistics.inner), surfaceArea(inner), 1e-9);
}

TEST(Mend, LeavesOutPiecesThatAreNotWanted) {
    TriangleMesh cavity = bare(icosphere(2, {0, 0, 0}, 4));
    for (Triangle& t : cavity.triangles) std::swap(t[1], t[2]);
    const TriangleMesh ball = bare(icosphere(3, {0, 0, 0}, 10)),
                       crumb = bare(icosphere(2, {20, 0, 0}, 2)),
                       holed = withHole(bare(icosphere(3, {0, 30, 0}, 5)));
    const TriangleMesh mesh = merged({ball, cavity, crumb, holed});
    const auto mended = [&](const ComponentSelection& pieces) {
        MendOptions options = within(0.2);
        options.pieces = pieces;
        Mended result = mend(mesh, options);
        expectMended(result);
        return result;
    };
    const std::size_t own = ball.triangles.size(), inner = cavity.triangles.size(),
                      small = crumb.triangles.size(), other = holed.triangles.size() + 1;
    const Mended all = mended({});
    EXPECT_EQ(all.mesh.triangles.size(), own + inner + small + other);
    EXPECT_EQ(all.statistics.filled.size(), 1U);
    EXPECT_TRUE(all.statistics.droppedPieces.empty());

    const Mended largest = mended({.largestOnly = true});
    EXPECT_EQ(largest.mesh.triangles.size(), own + inner);
    EXPECT_EQ(largest.statistics.keptTriangles, std::ssize(largest.mesh.triangles));
    ASSERT_EQ(largest.statistics.droppedPieces.size(), 2U);
    EXPECT_NEAR(largest.statistics.droppedPieces[1].middleMm.x, 20, 0.1);
    EXPECT_TRUE(largest.statistics.filled.empty());  // it is of what was dropped
    EXPECT_EQ(mended({.largestOnly = true, .fillCavities = true}).mesh.triangles.size(), own);
    EXPECT_EQ(mended({.minVolumeMm3 = 100}).mesh.triangles.size(), own + inner + other);

    MendOptions options;  // also of a sound mesh, which stays as it is otherwise
    options.pieces.largestOnly = true;
    const Mended sound = mend(merged({ball, crumb}), options);
    EXPECT_FALSE(sound.statistics.wasSound);
    EXPECT_EQ(sound.mesh.triangles.size(), own);
    EXPECT_TRUE(mend(ball, options).statistics.wasSound);
    options.pieces.minVolumeMm3 = 1e6;
    EXPECT_THROW(mend(ball, options), MendRefusal);
    options.leavesHolesOpen = true;
    EXPECT_THROW(mend(ball, options), InvalidInput);
}

TEST(Mend, UnitesSolidsThatShareAWall) {
    const TriangleMesh cubes = merged({cubeMesh(), cubeMesh({1, 0, 0}, {2, 1, 1})});
    const Mended mended = mend(cubes);
    expectMended(mended);
    EXPECT_EQ(mended.mesh.triangles.size(), 20u);  // two squares less
    EXPECT_EQ(mended.statistics.cells, 0);
    EXPECT_DOUBLE_EQ(enclosedVolume(mended.mesh), 2);
    EXPECT_NEAR(areaOf(mended.statistics.inner), 1, 0.02);  // the wall between
}

TEST(Mend, UnitesSolidsThatShareTheirWallsPoints) {
    TriangleMesh cubes = merged({cubeMesh(), cubeMesh({1, 0, 0}, {2, 1, 1})});
    for (Triangle& t : cubes.triangles) {
        for (VertexId& v : t) {
            v = std::find(cubes.points.begin(), cubes.points.end(), cubes.points[v]) -
                cubes.points.begin();
        }
    }
    const Mended mended = mend(withoutUnusedPoints(cubes));
    expectMended(mended);
    EXPECT_EQ(mended.mesh.triangles.size(), 20u);
    EXPECT_DOUBLE_EQ(enclosedVolume(mended.mesh), 2);
}

TEST(Mend, KeepsASurfaceOfWhichAPartComesTwice) {
    const TriangleMesh sphere = bare(icosphere(3));
    for (const bool isTurned : {false, true}) {
        TriangleMesh partly = sphere;
        for (std::size_t t = 0; t < sphere.triangles.size(); t += t < 600 ? 1 : 97) {
            auto [a, b, c] = sphere.triangles[t];
            if (isTurned || t % 3 == 0) std::swap(b, c);
            partly.triangles.push_back({a, b, c});
        }
        EXPECT_EQ(mend(partly).mesh.triangles, sphere.triangles);
    }
}

TEST(Mend, ThinsNewSurface) {
    // two faces of either box lie in one plane with the other's: 60,000 triangles by the lattice
    const TriangleMesh boxes =
        merged({cubeMesh({0, 0, 0}, {10, 10, 10}), cubeMesh({4, 0, 0}, {14, 10, 12})});
    const Mended mended = mend(boxes, within(0.2));
    expectMended(mended);
    expectBounds(boxes, mended);
    EXPECT_LT(mended.mesh.triangles.size(), 400u);
    EXPECT_NEAR(enclosedVolume(mended.mesh), 1600, 5);
}

/// A plate on a ring of `corners`, its faces fans of slivers.
TriangleMesh plateMesh(std::int64_t corners, const Vec3& middle, double radius, double height) {
    TriangleMesh plate;
    for (const double z : {0.0, height}) {
        for (std::int64_t n = 0; n < corners; ++n) {
            const double angle = 2 * std::numbers::pi * (static_cast<double>(n) + 0.3) /
                                 static_cast<double>(corners);
            plate.points.push_back(middle +
                                   Vec3{radius * std::cos(angle), radius * std::sin(angle), z});
        }
    }
    for (VertexId n = 0; n < corners; ++n) {
        const VertexId next = (n + 1) % corners, above = corners + n, aboveNext = corners + next;
        if (n > 0 && next > 0) {
            plate.triangles.push_back({0, next, n});
            plate.triangles.push_back({corners, above, aboveNext});
        }
        plate.triangles.push_back({n, next, aboveNext});
        plate.triangles.push_back({n, aboveNext, above});
    }
    return plate;
}

/// Faces that cross at so small an angle that single precision moves the crossing by millimetres.
TEST(Mend, CutsFacesThatCrossAtASmallAngle) {
    constexpr double kAngle = 8e-8;
    TriangleMesh plates =
        merged({plateMesh(100, {10, -5, 0}, 90, 5), plateMesh(97, {-20, 15, -3}, 80, 3)});
    for (std::size_t v = 0; v < plates.points.size(); ++v) {
        Vec3& p = plates.points[v];
        p.z += kAngle * (v < 200 ? p.x - p.y : 0.5 * p.y - p.x);
    }
    plates = merged({plateMesh(103, {0, 0, -5}, 100, 5), plates});
    for (Vec3& p : plates.points) {
        p.z -= 1.397;
        for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis]);
    }
    const Mended mended = mend(plates, within(3));
    expectMended(mended);
    EXPECT_EQ(mended.statistics.cells, 0);
    EXPECT_LT(mended.statistics.inputToResultMm, 1e-3);
}

/// What a bound dissolves is listed, not only what lies in new cells.
TEST(Mend, ListsAPlateThatIsTooThin) {
    TriangleMesh plate = cubeMesh({20, 0, 0}, {30, 10, 0.05});
    plate.triangles.pop_back();
    plate.points[plate.triangles[0][0]].z += 0.03;  // no plane closes it
    plate.triangles.push_back({0, 1, 7});           // crosses the plate
    const TriangleMesh scene = merged({cubeMesh({0, 0, 0}, {10, 10, 10}), plate});
    MendOptions options = within(0.2);
    options.maxHoleMm = 100;
    const Mended mended = mend(scene, options);
    expectMended(mended);
    expectBounds(scene, mended);
}

TEST(Mend, KeepsOneOfASolidGivenTwice) {
    for (const bool isTurned : {false, true}) {
        TriangleMesh again = cubeMesh();
        if (isTurned) flipOrientation(again);
        const Mended mended = mend(merged({cubeMesh(), again}));
        expectMended(mended);
        EXPECT_EQ(mended.statistics.duplicateTriangles, 12);
        EXPECT_DOUBLE_EQ(enclosedVolume(mended.mesh), 1);
    }
}

/// Two cubes that cross at corners: faces in planes, cut along the lattice.
TEST(Mend, UnitesCubesWithSharpEdges) {
    const Mended mended =
        mend(merged({cubeMesh(), cubeMesh({.5, .5, .5}, {1.5, 1.5, 1.5})}), within(0.01));
    expectMended(mended);
    EXPECT_NEAR(enclosedVolume(mended.mesh), 1.875, 1e-3);
    EXPECT_NEAR(areaOf(mended.statistics.inner), 1.5, 0.05);
}

TEST(Mend, RefusesWideHolesOrLeavesThemOpen) {
    TriangleMesh bowl = bare(icosphere(3));
    std::erase_if(bowl.triangles, [&](const Triangle& t) {
        return bowl.points[t[0]].z > 0.5 && bowl.points[t[1]].z > 0.5 && bowl.points[t[2]].z > 0.5;
    });
    EXPECT_THROW(mend(bowl, within(0.03)), InvalidInput);
    MendOptions options = within(0.03);
    options.maxHoleMm = 3;
    const Mended closed = mend(bowl, options);
    expectMended(closed);
    EXPECT_EQ(closed.statistics.filled.size(), 1u);
    options.maxHoleMm = 0.1;
    options.leavesHolesOpen = true;
    const Mended open = mend(bowl, options);
    EXPECT_EQ(open.statistics.leftOpen.size(), 1u);
    EXPECT_EQ(open.mesh.triangles, withoutUnusedPoints(bowl).triangles);  // the border stays
    const TopologyReport topology = checkTopology(open.mesh);
    EXPECT_TRUE(topology.isManifold() && topology.isOriented() && !topology.isClosed());
}

/// The width that a refusal names is enough as the next --max-hole.
TEST(Mend, NamesAWidthThatIsEnough) {
    for (const double scale : {1.0, 1.3, 1.71, 0.0123, 987.6}) {
        TriangleMesh bowl = bare(icosphere(3));
        std::erase_if(bowl.triangles, [&](const Triangle& t) { return bowl.points[t[0]].z > 0.7; });
        for (Vec3& p : bowl.points) p = scale * p;
        MendOptions options;
        try {
            mend(bowl, options);
            FAIL();
        } catch (const MendRefusal& refusal) {
            const std::string line = refusal.what();
            const std::size_t width = line.find(") is ") + 5;
            options.maxHoleMm = std::stod(line.substr(width));
        }
        EXPECT_EQ(mend(bowl, options).statistics.filled.size(), 1u) << scale;
    }
}

/// The lattice of the bound would have some hundred thousand cells.
TEST(Mend, RefusesWideRaggedHolesBeforeTheLongWork) {
    TriangleMesh bowl = bare(icosphere(5));
    std::erase_if(bowl.triangles, [&](const Triangle& t) { return bowl.points[t[0]].z > 0.2; });
    bowl.triangles.push_back({bowl.triangles[0][0], bowl.triangles[40][0], bowl.triangles[90][0]});
    try {
        mend(bowl, within(0.002));
        FAIL();
    } catch (const MendRefusal& refusal) {
        EXPECT_NE(std::string(refusal.what()).find("a hole near"), std::string::npos);
        EXPECT_GT(refusal.statistics.borderEdges, 0);
        EXPECT_EQ(refusal.statistics.cells, 0);
    }
}

/// Hills, which what closes their border flatly would cross.
TEST(Mend, RefusesAHillySheetBeforeTheLongWork) {
    TriangleMesh hills = bare(planeMesh(20, 1));
    for (Vec3& p : hills.points) p.z = 0.1 * std::sin(9 * p.x) * std::cos(7 * p.y);
    try {
        mend(hills, within(0.01));
        FAIL();
    } catch (const MendRefusal& refusal) {
        EXPECT_NE(std::string(refusal.what()).find("a hole near"), std::string::npos)
            << refusal.what();
        EXPECT_EQ(refusal.statistics.cells, 0);
    }
}

/// A Moebius band: of one side, open.
TEST(Mend, RefusesAMoebiusBandBeforeTheLongWork) {
    TriangleMesh band;
    constexpr int kSteps = 80;
    for (int n = 0; n < kSteps; ++n) {
        const double t = 2 * std::numbers::pi * n / kSteps;
        for (const double side : {-1.0, 1.0}) {
            const double r = 5 + side * std::cos(t / 2);
            band.points.push_back({r * std::cos(t), r * std::sin(t), side * std::sin(t / 2)});
        }
    }
    for (int n = 0; n < kSteps; ++n) {
        const VertexId a = 2 * n, b = a + 1, c = n + 1 < kSteps ? a + 2 : 1,
                       d = n + 1 < kSteps ? a + 3 : 0;
        band.triangles.push_back({a, c, b});
        band.triangles.push_back({b, c, d});
    }
    try {
        mend(band, within(0.003));
        FAIL();
    } catch (const MendRefusal& refusal) {
        EXPECT_GT(refusal.statistics.badEdges, 0);
        EXPECT_EQ(refusal.statistics.cells, 0);
    }
}

TEST(Mend, LeavesRaggedHolesOpenAsManifold) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        TriangleMesh sieve = bare(icosphere(4));
        std::mt19937 random(seed);
        std::erase_if(sieve.triangles, [&](const Triangle&) { return random() % 3 == 0; });
        MendOptions options = within(0.05);
        options.maxHoleMm = 0.05;
        options.leavesHolesOpen = true;
        const TopologyReport topology = checkTopology(mend(sieve, options).mesh);
        EXPECT_TRUE(topology.isManifold() && topology.isOriented()) << "seed " << seed;
    }
}

TEST(Mend, RefusesCoordinatesWithoutDigits) {
    EXPECT_THROW(mend(translated(withHole(bare(icosphere(2))), {1e15, 0, 0})), InvalidInput);
    TriangleMesh huge = withHole(bare(icosphere(2, {}, 1e110)));
    EXPECT_THROW(mend(huge), InvalidInput);
    TriangleMesh far = withUnusedVertex(withHole(bare(icosphere(3))));
    far.points.back() = {1e6, 0, 0};  // counts nowhere
    MendOptions options;
    options.maxHoleMm = 1;
    expectMended(mend(far, options));
}

TEST(Mend, LeavesASoundOpenSheetAsItIs) {
    MendOptions options = within(0.05);
    options.leavesHolesOpen = true;
    TriangleMesh half = bare(icosphere(3));  // a dome, and a plane that winds around nothing
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return half.points[t[0]].z < 0 || half.points[t[1]].z < 0 || half.points[t[2]].z < 0;
    });
    for (const TriangleMesh& sheet : {half, bare(planeMesh(10, 1))}) {
        const Mended mended = mend(sheet, options);
        EXPECT_EQ(mended.mesh, withoutUnusedPoints(sheet));
        EXPECT_EQ(mended.statistics.leftOpen.size(), 1U);
    }
}

TEST(Mend, DropsAnInnerShellBesideAnOpenSheet) {
    MendOptions options = within(0.2);
    options.leavesHolesOpen = true;
    TriangleMesh sheet = bare(planeMesh(10, 1));
    for (Vec3& p : sheet.points) p.x += 5;
    const Mended mended =
        mend(merged({bare(icosphere(2)), bare(icosphere(2, {}, 0.5)), std::move(sheet)}), options);
    EXPECT_FALSE(mended.statistics.wasSound);
    EXPECT_FALSE(mended.statistics.inner.empty());
}

TEST(Mend, LeavesASoundMeshByAnyBound) {
    EXPECT_TRUE(mend(bare(icosphere(3)), within(1000)).statistics.wasSound);
}

TEST(Mend, RefusesWhatEnclosesNothing) {
    const TriangleMesh triangle{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, {{0, 1, 2}}};
    for (const TriangleMesh& mesh : {planeMesh(4, 1), triangle, planeMesh(40, 1)}) {
        try {
            mend(mesh);
            ADD_FAILURE() << mesh.triangles.size();
        } catch (const MendRefusal& refusal) {
            EXPECT_NE(std::string(refusal.what()).find("enclose no volume"), std::string::npos);
        }
    }
    EXPECT_THROW(mend({}), InvalidInput);
    EXPECT_THROW(mend(cubeMesh(), within(0)), InvalidInput);
}

MendOptions asBalls(double maxErrorMm) {
    MendOptions options = within(maxErrorMm);
    options.removesHandles = true;
    return options;
}

/// Every piece is a ball; what is new lies near the input but for the two sides of each disc.
void expectBalls(const TriangleMesh& input, const Mended& mended, std::size_t cut,
                 std::size_t filled) {
    expectMended(mended);
    EXPECT_EQ(checkTopology(mended.mesh).genus(), 0);
    const MendStatistics& s = mended.statistics;
    EXPECT_EQ(s.cutHandles.size(), cut);
    EXPECT_EQ(s.filledHandles.size(), filled);
    EXPECT_EQ(static_cast<std::size_t>(s.handles), cut + filled);
    Mended listed = mended;
    for (const auto* discs : {&s.cutHandles, &s.filledHandles}) {
        for (MendedPlace disc : *discs) {
            disc.areaMm2 *= 2;
            listed.statistics.filled.push_back(disc);
        }
    }
    expectBounds(input, listed);
}

TEST(MendToBalls, LeavesBallsAsTheyAre) {
    const TriangleMesh mesh = merged({icosphere(3), icosphere(2, {5, 0, 0})});
    const Mended mended = mend(mesh, asBalls(0.01));
    EXPECT_TRUE(mended.statistics.wasSound);
    EXPECT_EQ(mended.mesh, mesh);
}

TEST(MendToBalls, CutsARingAcross) {
    const TriangleMesh ring = bare(torusMesh(60, 24, 3, 1));
    const Mended mended = mend(ring, asBalls(0.02));
    expectBalls(ring, mended, 1, 0);
    const double disc = 12 * std::sin(std::numbers::pi / 12);  // of 24 corners
    EXPECT_NEAR(mended.statistics.cutHandles[0].areaMm2, disc, 0.02);
    EXPECT_NEAR(norm(mended.statistics.cutHandles[0].middleMm), 3, 0.05);
    const double lost = enclosedVolume(ring) - enclosedVolume(mended.mesh);
    EXPECT_GT(lost, 0);
    EXPECT_LE(lost, 0.02 * disc);
    EXPECT_GT(mended.statistics.keptTriangles, std::ssize(ring.triangles) * 9 / 10);
    const ThreadLimitGuard one(1);
    EXPECT_EQ(mend(ring, asBalls(0.02)).mesh, mended.mesh);
}

TEST(MendToBalls, FillsANarrowTunnel) {
    const TriangleMesh ring = bare(torusMesh(60, 40, 3, 2.6));
    const Mended mended = mend(ring, asBalls(0.02));
    expectBalls(ring, mended, 0, 1);
    EXPECT_NEAR(mended.statistics.filledHandles[0].areaMm2, std::numbers::pi * 0.16, 0.01);
    EXPECT_LE(norm(mended.statistics.filledHandles[0].middleMm), 0.1);
    EXPECT_GT(enclosedVolume(mended.mesh), enclosedVolume(ring));
}

TEST(MendToBalls, CutsBothHolesOfADoubleRingThatCrossesItself) {
    const TriangleMesh rings = merged(
        {bare(torusMesh(40, 20, 3, 1)), translated(bare(torusMesh(40, 20, 3, 1)), {7, 0.1, 0})});
    const Mended mended = mend(rings, asBalls(0.05));
    expectBalls(rings, mended, 2, 0);
    EXPECT_EQ(nestingOf(mended.mesh), "()");
}

TEST(MendToBalls, CutsAThinHandleOfABall) {
    const TriangleMesh handled = merged(
        {bare(icosphere(4, {}, 3)), translated(bare(torusMesh(40, 12, 1, 0.1)), {3, 0.01, 0.02})});
    const Mended mended = mend(handled, asBalls(0.05));
    expectBalls(handled, mended, 1, 0);
    EXPECT_NEAR(mended.statistics.cutHandles[0].areaMm2, std::numbers::pi * 0.01, 0.003);
    EXPECT_GT(norm(mended.statistics.cutHandles[0].middleMm), 3);
}

/// A box drilled nine times, as bone is.
TEST(MendToBalls, FillsManyTunnelsAtOnce) {
    TriangleMesh sieve = cubeMesh({0, 0, 0}, {6, 6, 1});
    for (int n = 0; n < 9; ++n) {
        const double x = 1.02 + 2 * (n % 3), y = 1.01 + 2 * (n / 3);
        TriangleMesh drill = cubeMesh({x - 0.2, y - 0.2, -0.5}, {x + 0.2, y + 0.2, 1.5});
        flipOrientation(drill);
        sieve = merged({sieve, drill});
    }
    const Mended mended = mend(sieve, asBalls(0.05));
    EXPECT_EQ(checkTopology(mended.mesh).genus(), 0);
    expectMended(mended);
    EXPECT_EQ(mended.statistics.handles, 9);
    EXPECT_EQ(mended.statistics.filledHandles.size(), 9u);
}

TEST(MendToBalls, RefusesOpenSurfaces) {
    MendOptions options = asBalls(0.01);
    options.leavesHolesOpen = true;
    EXPECT_THROW(mend(icosphere(2), options), InvalidInput);
}

/// Holes, crossings, flips and doubles at random; the distances are proved again from outside.
TEST(Mend, MendsRandomDamage) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(seed);
        const TriangleMesh mesh = withRandomDamage(
            seed % 2 == 0 ? bare(icosphere(3)) : bare(torusMesh(40, 20, 2, 0.8)), seed);
        MendOptions options = within(0.03);
        options.maxHoleMm = 100;
        Mended mended;
        ASSERT_NO_THROW(mended = mend(mesh, options));
        expectMended(mended);
        expectBounds(mesh, mended);
        const ThreadLimitGuard one(1);
        EXPECT_EQ(mend(mesh, options).mesh, mended.mesh);
    }
}

}  // namespace
}  // namespace adaptiso::testing
