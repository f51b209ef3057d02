#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

#include "BoundaryTestSupport.h"
#include "Support/Meshes.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

using namespace testing;

TEST(BoundariesFromSurfaces, MendHolesCrossingsTurnedTrianglesAndStrayPieces) {
    const HeadShapes head = smallHead();
    const TriangleMesh inner = withHole(icosphere(4, kCentre, 26));
    TriangleMesh outer = merged({icosphere(4, kCentre, 30), icosphere(2, {40, 40, 40}, 2)});
    TriangleMesh skin = withFlippedTriangle(icosphere(4, kCentre, 35));
    flipOrientation(inner.triangles.empty() ? outer : skin);
    const std::vector<TriangleMesh> surfaces{inner, outer, skin};
    const HeadBoundaries found = boundariesFromSurfaces(surfaces, quick());
    // the hole's chord, a triangle of 4 mm, lies 0.1 mm deep; the Gaussian takes 0.09
    EXPECT_LE(largestError(found, head), 0.35);

    // two balls that cross: their union
    const TriangleMesh crossing =
        merged({icosphere(4, {-8, 0, 0}, 26), icosphere(4, {8, 0, 0}, 26)});
    BoundaryOptions one = quick();
    one.innerSkullOnly = true;
    const HeadBoundaries united = boundariesFromSurfaces(std::span(&crossing, 1), one);
    const BoundingBox box = boundingBox(surfaceOf(united.solids[0]));
    EXPECT_NEAR(box.minimum.x, -34, 0.3);
    EXPECT_NEAR(box.maximum.x, 34, 0.3);
}

TEST(BoundariesFromSurfaces, FillATunnelThatTheClosingCloses) {
    // a hole of 4 mm through the whole ball, genus 1
    const ImageGeometry geometry = centredGeometry({60, 60, 60});
    const Shape tunnel = box({0, 0, 0}, {2, 2, 40});
    Shape drilled = sphere({}, 25);
    drilled.depthMm = [=](const Vec3& p) { return std::min(25 - norm(p), -tunnel.depthMm(p)); };
    const TriangleMesh surface = surfaceOf({geometry, partInside(drilled, geometry)});
    ASSERT_EQ(*checkTopology(surface).genus(), 1);
    BoundaryOptions options = quick();
    options.innerSkullOnly = true;
    const HeadBoundaries found = boundariesFromSurfaces(std::span(&surface, 1), options);
    EXPECT_LE(surfaceError(found.solids[0], sphere({}, 25)).largestMm, 1.0);  // a voxel
}

TEST(BoundariesFromSurfaces, RefuseOtherNumbersAndUnits) {
    const std::vector<TriangleMesh> metres(3, icosphere(2, {}, 0.08));
    expectRefused([&] { boundariesFromSurfaces(metres, quick()); }, "(metres?)");
    expectRefused([&] { boundariesFromSurfaces(std::span(metres).first(2), quick()); },
                  "there are 2 surfaces, must be 3");
}

}  // namespace
}  // namespace adaptiso
