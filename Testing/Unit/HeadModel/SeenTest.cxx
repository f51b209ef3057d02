#include <gtest/gtest.h>

#include "Support/Meshes.h"
#include "adaptiso/HeadModel/Seen.h"

namespace adaptiso {
namespace {

using testing::icosphere;

TEST(Seen, IsTheShareOfTheAreaNearPlaces) {
    const TriangleMesh sphere = icosphere(5, {1, 2, 3}, 90);
    std::vector<Vec3> upper;
    for (const Vec3& p : sphere.points) {
        if (p.z > 3) upper.push_back(p);
    }
    const SeenSurface all = seenOf(sphere, sphere.points), half = seenOf(sphere, upper),
                      none = seenOf(sphere, {});
    EXPECT_NEAR(all.share, 1, 1e-12);
    // places begin within an edge of 3 mm above the equator, and 3 mm beyond them are near: 3 / 180
    EXPECT_NEAR(half.share, 0.5, 3.0 / 180 + 0.001);
    EXPECT_DOUBLE_EQ(none.share, 0);
    for (const double mm : none.distanceMm) EXPECT_DOUBLE_EQ(mm, kFarFromSeenMm);
    for (std::size_t v = 0; v < sphere.points.size(); ++v) {
        if (sphere.points[v].z > 3) {
            EXPECT_DOUBLE_EQ(half.distanceMm[v], 0);
        }
    }
}

}  // namespace
}  // namespace adaptiso
