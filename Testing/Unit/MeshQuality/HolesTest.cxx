#include <gtest/gtest.h>

#include <limits>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

TEST(Holes, ClosedSurfaceHasNone) {
    EXPECT_TRUE(findHoles(testing::icosphere(2)).empty());
    EXPECT_TRUE(findHoles({}).empty());
}

TEST(Holes, MissingFaceOfACube) {
    TriangleMesh cube = testing::cubeMesh();
    // both triangles of the face z = 1
    std::erase_if(cube.triangles, [&](const Triangle& t) {
        return cube.points[t[0]].z == 1 && cube.points[t[1]].z == 1 && cube.points[t[2]].z == 1;
    });
    const std::vector<Hole> holes = findHoles(cube);
    ASSERT_EQ(holes.size(), 1u);
    EXPECT_EQ(holes[0].edges, 4);
    EXPECT_DOUBLE_EQ(holes[0].lengthMm, 4);
    EXPECT_LT(norm(holes[0].middleMm - Vec3{0.5, 0.5, 1}), 1e-15);
}

TEST(Holes, LargestComesFirst) {
    TriangleMesh sphere = testing::icosphere(3, {}, 10);
    const VertexId top = 0;
    VertexId far = 0;
    for (VertexId v = 0; v < std::ssize(sphere.points); ++v) {
        const double now = dot(sphere.points[v], sphere.points[top]);
        if (now < dot(sphere.points[far], sphere.points[top])) far = v;
    }
    // one triangle at one end, a fan at the other
    bool isTaken = false;
    std::erase_if(sphere.triangles, [&](const Triangle& t) {
        const auto has = [&](VertexId v) { return t[0] == v || t[1] == v || t[2] == v; };
        if (has(far)) return true;
        return has(top) && !std::exchange(isTaken, true);
    });
    const std::vector<Hole> holes = findHoles(sphere);
    ASSERT_EQ(holes.size(), 2u);
    EXPECT_GE(holes[0].edges, 5);
    EXPECT_EQ(holes[1].edges, 3);
    EXPECT_GT(holes[0].lengthMm, holes[1].lengthMm);
}

TEST(Holes, LeaveOutWhatIsNotFinite) {
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}};
    mesh.points[2].y = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Hole> holes = findHoles(mesh);
    ASSERT_EQ(holes.size(), 1u);
    EXPECT_EQ(holes[0].edges, 1);
    EXPECT_DOUBLE_EQ(holes[0].lengthMm, 1);
}

TEST(Holes, RefuseNumbersThatNameNoPoint) {
    EXPECT_THROW(findHoles({{{0, 0, 0}}, {}, {{0, 0, 7}}}), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
