#include <gtest/gtest.h>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {
namespace {

TEST(TriangleMesh, CubeHasItsAreaAndVolumeWhereverItIs) {
    const TriangleMesh cube = testing::cubeMesh({-1, -1, -1}, {1, 2, 3});
    EXPECT_DOUBLE_EQ(surfaceArea(cube), 2 * (2 * 3 + 3 * 4 + 2 * 4));
    EXPECT_DOUBLE_EQ(enclosedVolume(cube), 24);
    // Far from the origin the volume keeps its digits: whole numbers, so without rounding.
    EXPECT_EQ(enclosedVolume(testing::translated(cube, {1 << 20, 1 << 20, 1 << 20})), 24);
}

TEST(TriangleMesh, EmptyMeshHasNoAreaAndNoVolume) {
    EXPECT_EQ(surfaceArea({}), 0);
    EXPECT_EQ(enclosedVolume({}), 0);
}

TEST(TriangleMesh, FlippedMeshIsInsideOut) {
    TriangleMesh sphere = testing::icosphere(2);
    const double volume = enclosedVolume(sphere), area = surfaceArea(sphere);
    const Normal normal = sphere.normals[5];
    flipOrientation(sphere);
    EXPECT_DOUBLE_EQ(enclosedVolume(sphere), -volume);
    EXPECT_DOUBLE_EQ(surfaceArea(sphere), area);
    EXPECT_EQ(sphere.normals[5], (Normal{-normal.x, -normal.y, -normal.z}));
}

TEST(TriangleMesh, BoundingBoxHoldsEveryPoint) {
    const BoundingBox box = boundingBox(testing::cubeMesh({-1, -2, -3}, {4, 5, 6}));
    EXPECT_EQ(box.minimum, (Vec3{-1, -2, -3}));
    EXPECT_EQ(box.maximum, (Vec3{4, 5, 6}));
}

TEST(TriangleMesh, BoundingBoxOfNothingIsRefused) {
    EXPECT_THROW(boundingBox({}), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
