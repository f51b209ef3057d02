#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Components.h"

namespace adaptiso {
namespace {

/// Appends `part`, inside out when it is to be a cavity.
void append(TriangleMesh& mesh, TriangleMesh part, bool isCavity = false) {
    if (isCavity) flipOrientation(part);
    const VertexId base = std::ssize(mesh.points);
    mesh.points.insert(mesh.points.end(), part.points.begin(), part.points.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    for (const Triangle& t : part.triangles) {
        mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
}

/// An axis-aligned cube of 8 vertices and 12 triangles, outward: volume (2 h)^3, area 24 h^2.
TriangleMesh cube(const Vec3& centre, double h) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 direction{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0,
                             corner & 4 ? 1.0 : -1.0};
        mesh.points.push_back(centre + h * direction);
        mesh.normals.push_back(toNormal(direction));
    }
    constexpr std::array<std::array<VertexId, 4>, 6> kFaces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& f : kFaces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

/// A sphere: an octahedron, each triangle cut in four `levels` times.
TriangleMesh sphere(const Vec3& centre, double radius, int levels = 3) {
    std::vector<Vec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<Triangle> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<VertexId, VertexId>, VertexId> middles;
        const auto middle = [&](VertexId a, VertexId b) {
            const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), std::ssize(points));
            if (isNew) points.push_back(normalized(points[a] + points[b]));
            return at->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : triangles) {
            const VertexId ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        triangles = std::move(finer);
    }
    TriangleMesh mesh;
    for (const Vec3& p : points) {
        mesh.points.push_back(centre + radius * p);
        mesh.normals.push_back(toNormal(p));
    }
    mesh.triangles = std::move(triangles);
    return mesh;
}

/// Like an onion: a ball of radius 10 with a hollow of radius 8, in it a ball of radius 6 with a
/// hollow of radius 3, in that a ball of radius 1; beside it all a lone ball of radius 4.
struct Onion {
    Vec3 centre{0.5, -0.25, 100};
    TriangleMesh wall10 = sphere(centre, 10), hollow8 = sphere(centre, 8);
    TriangleMesh wall6 = sphere(centre, 6), hollow3 = sphere(centre, 3);
    TriangleMesh wall1 = sphere(centre, 1), lone4 = sphere({20, 3, 101}, 4);

    TriangleMesh mesh() const {
        TriangleMesh all;
        append(all, wall1);
        append(all, hollow8, true);
        append(all, lone4);
        append(all, wall10);
        append(all, hollow3, true);
        append(all, wall6);
        return all;
    }
};

TEST(LabelComponents, NumbersByFirstVertexAndCountsUnusedVertices) {
    TriangleMesh mesh = cube({0, 0, 0}, 1);
    append(mesh, cube({5, 0, 0}, 1));
    mesh.points.push_back({9, 9, 9});
    const ComponentLabels labels = labelComponents(mesh);
    EXPECT_EQ(labels.count, 3);
    EXPECT_EQ(labels.ofVertex.front(), 0);
    EXPECT_EQ(labels.ofVertex[8], 1);
    EXPECT_EQ(labels.ofVertex.back(), 2);
}

TEST(SelectComponents, KeepsTheMeshAsItIsWhenNothingIsAsked) {
    const TriangleMesh mesh = Onion().mesh();
    EXPECT_EQ(selectComponents(mesh, {}), mesh);
}

TEST(SelectComponents, FillingCavitiesDropsWhatLiesInsideThemToo) {
    const Onion onion;
    TriangleMesh expected = onion.lone4;
    append(expected, onion.wall10);
    EXPECT_EQ(selectComponents(onion.mesh(), {.fillCavities = true}), expected);
}

TEST(SelectComponents, LargestCountsMaterialNotWhatTheWallEncloses) {
    // shell 10..8: 4/3 pi (1000 - 512) = 488 units; shell 6..3: 216 - 27 = 189; lone ball: 64
    const Onion onion;
    TriangleMesh expected;
    append(expected, onion.hollow8, true);
    append(expected, onion.wall10);
    EXPECT_EQ(selectComponents(onion.mesh(), {.largestOnly = true}), expected);

    // a thin shell, 10..9.9 (30 units), around the ball of radius 6 (216): the ball is larger
    TriangleMesh thin = onion.wall10;
    append(thin, sphere(onion.centre, 9.9), true);
    append(thin, onion.wall6);
    EXPECT_EQ(selectComponents(thin, {.largestOnly = true}), onion.wall6);
}

TEST(SelectComponents, FillsBeforeItLooksForTheLargest) {
    const Onion onion;
    TriangleMesh thin = onion.wall10;
    append(thin, sphere(onion.centre, 9.9), true);
    append(thin, onion.wall6);
    EXPECT_EQ(selectComponents(thin, {.largestOnly = true, .fillCavities = true}), onion.wall10);
}

TEST(SelectComponents, MinVolumeDropsSmallPiecesAndFillsSmallCavities) {
    const Onion onion;
    // between the ball of radius 3 (113 mm3, and the ball of radius 1) and that of radius 4
    TriangleMesh expected;
    append(expected, onion.hollow8, true);
    append(expected, onion.lone4);
    append(expected, onion.wall10);
    append(expected, onion.wall6);
    EXPECT_EQ(selectComponents(onion.mesh(), {.minVolumeMm3 = 150}), expected);
}

TEST(SelectComponents, MinVolumeKeepsALargePieceInsideADroppedShell) {
    // a cube of side 2 (8 mm3) in a shell of sides 2.2 and 2.4 (3.176 mm3 of material)
    TriangleMesh mesh = cube({0, 0, 0}, 1.2);
    append(mesh, cube({0, 0, 0}, 1.1), true);
    append(mesh, cube({0, 0, 0}, 1));
    EXPECT_EQ(selectComponents(mesh, {.minVolumeMm3 = 5}), cube({0, 0, 0}, 1));
}

TEST(SelectComponents, MinVolumeBoundIsKept) {
    const TriangleMesh mesh = cube({0, 0, 0}, 1);  // 8 mm3, exact in doubles
    EXPECT_EQ(selectComponents(mesh, {.minVolumeMm3 = 8}), mesh);
    EXPECT_TRUE(selectComponents(mesh, {.minVolumeMm3 = 8.001}).triangles.empty());
}

TEST(SelectComponents, ReadsNestingWhereRaysMeetEdgesAndVertices) {
    // concentric axis-aligned cubes: rays through the middles of faces, along their diagonals and
    // along their sides; the sphere's points lie on the axes
    TriangleMesh mesh;
    append(mesh, cube({0, 0, 0}, 8));
    append(mesh, cube({0, 0, 0}, 4), true);
    append(mesh, sphere({0, 0, 0}, 3, 0));
    append(mesh, cube({0, 0, 12}, 1));  // above, not inside
    TriangleMesh expected = cube({0, 0, 0}, 8);
    append(expected, cube({0, 0, 12}, 1));
    EXPECT_EQ(selectComponents(mesh, {.fillCavities = true}), expected);
}

TEST(SelectComponents, APieceInTheBoundingBoxOfAnotherIsNotInsideIt) {
    // an L of three cubes' worth: its box holds the small cube, its material does not
    TriangleMesh ell;
    ell.points = {{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 2, 0}, {2, 4, 0}, {0, 4, 0},
                  {0, 0, 2}, {4, 0, 2}, {4, 2, 2}, {2, 2, 2}, {2, 4, 2}, {0, 4, 2}};
    ell.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3},  {0, 5, 4},
                     {6, 7, 8}, {6, 8, 9}, {6, 9, 10}, {6, 10, 11}};
    for (VertexId a = 0; a < 6; ++a) {
        const VertexId b = (a + 1) % 6;
        ell.triangles.push_back({a, b, b + 6});
        ell.triangles.push_back({a, b + 6, a + 6});
    }
    ASSERT_DOUBLE_EQ(enclosedVolume(ell), 24);
    flipOrientation(ell);  // as a cavity it would take the small cube with it
    const Vec3 beside{3, 3, 1};
    TriangleMesh mesh;
    for (TriangleMesh part : {ell, cube(beside, 0.5)}) {
        part.normals.clear();
        append(mesh, part);
    }
    TriangleMesh wall = cube({2, 2, 1}, 5);
    wall.normals.clear();
    append(mesh, wall);
    const TriangleMesh filled = selectComponents(mesh, {.fillCavities = true});
    EXPECT_EQ(filled.triangles.size(), 24U);  // both cubes
    EXPECT_DOUBLE_EQ(enclosedVolume(filled), 1000 + 1);
}

TEST(SelectComponents, FindsEveryIslandOfAManyHoledBlock) {
    // 5 x 5 x 5 cavities of side 1 in a cube of side 20, each with an island of side 0.5
    TriangleMesh mesh = cube({10, 10, 10}, 10);
    for (int n = 0; n < 125; ++n) {
        const Vec3 centre{2.0 + 4 * (n % 5), 2.0 + 4 * (n / 5 % 5), 2.0 + 4 * (n / 25)};
        append(mesh, cube(centre, 0.5), true);
        append(mesh, cube(centre, 0.25));
    }
    EXPECT_EQ(selectComponents(mesh, {.fillCavities = true}), cube({10, 10, 10}, 10));
    const TriangleMesh largest = selectComponents(mesh, {.largestOnly = true});
    EXPECT_EQ(largest.triangles.size(), 12U * 126);
    EXPECT_DOUBLE_EQ(enclosedVolume(largest), 8000 - 125);
}

TEST(SelectComponents, LargestOfEqualsIsTheFirst) {
    TriangleMesh mesh = cube({0, 0, 0}, 1);
    append(mesh, cube({8, 0, 0}, 1));
    EXPECT_EQ(selectComponents(mesh, {.largestOnly = true}), cube({0, 0, 0}, 1));
}

TEST(SelectComponents, AnOpenSurfaceIsJudgedByItsArea) {
    TriangleMesh lidless = cube({0, 0, 0}, 2);
    lidless.triangles.resize(10);            // two triangles, one face, less: 5 * 16 mm2
    TriangleMesh mesh = cube({9, 0, 0}, 1);  // 24 mm2
    append(mesh, lidless);
    EXPECT_EQ(selectComponents(mesh, {.largestOnly = true}), lidless);
}

TEST(SelectComponents, RefusesVolumesOfAnOpenSurface) {
    TriangleMesh mesh = cube({0, 0, 0}, 1);
    mesh.triangles.pop_back();
    EXPECT_THROW(selectComponents(mesh, {.fillCavities = true}), InvalidInput);
    EXPECT_THROW(selectComponents(mesh, {.minVolumeMm3 = 1}), InvalidInput);
}

TEST(SelectComponents, RefusesABoundThatIsNoVolume) {
    const TriangleMesh mesh = cube({0, 0, 0}, 1);
    for (const double bound : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(selectComponents(mesh, {.minVolumeMm3 = bound}), InvalidInput) << bound;
    }
}

TEST(SelectComponents, DropsUnusedVerticesAndKeepsNormalsWithTheirPoints) {
    TriangleMesh mesh;
    append(mesh, cube({0, 0, 0}, 1));
    append(mesh, sphere({9, 0, 0}, 3));
    const TriangleMesh kept = selectComponents(mesh, {.largestOnly = true});
    EXPECT_EQ(kept, sphere({9, 0, 0}, 3));
}

}  // namespace
}  // namespace adaptiso
