#include <gtest/gtest.h>

#include "Support/Meshes.h"
#include "adaptiso/HeadModel/Tetrahedra.h"

namespace adaptiso {
namespace {

using testing::icosphere;

TEST(HeadTetrahedra, MeshersAreGivenAPointOfEachLayer) {
    const std::vector<double> radii{60, 66, 72};
    std::vector<TriangleMesh> surfaces;
    for (const double radius : radii) surfaces.push_back(icosphere(2, {}, radius));
    const MesherInput input = headMesherInput(surfaces);
    EXPECT_EQ(input.points.size(), 3 * surfaces[0].points.size());
    ASSERT_EQ(input.volumes.size(), 3u);
    for (std::size_t n = 0; n < 3; ++n) {
        const MesherVolume& volume = input.volumes[n];
        EXPECT_EQ(volume.region, static_cast<int>(n + 1));
        EXPECT_EQ(volume.walls.size(), n == 0 ? 1u : 2u);
        EXPECT_LT(norm(volume.insideMm), radii[n]);
        EXPECT_GT(norm(volume.insideMm), n > 0 ? radii[n - 1] : 0);
    }
}

TEST(HeadTetrahedra, RegionsAreTissuesBetweenSurfaces) {
    std::vector<TriangleMesh> surfaces;
    for (const double radius : {60.0, 66.0, 72.0}) surfaces.push_back(icosphere(2, {}, radius));
    const std::vector<TetrahedraRegion> regions = headRegions(surfaces);
    ASSERT_EQ(regions.size(), 3u);
    EXPECT_EQ(regions[0].label, 2);
    EXPECT_EQ(regions[1].label, 4);
    EXPECT_EQ(regions[1].name, "skull");
    EXPECT_EQ(regions[2].label, 5);
    EXPECT_NEAR(regions[2].mm3, enclosedVolume(surfaces[2]) - enclosedVolume(surfaces[1]), 1e-6);
}

TEST(HeadTetrahedra, ATissuesPlaceIsItsNumberLessTheFirstOnes) {
    for (const std::size_t count : {1u, 3u, 4u, 5u}) {
        const std::vector<TetrahedraRegion> tissues = allTissues(count);
        ASSERT_EQ(tissues.size(), count == 5 ? 5u : 4u);
        for (std::size_t n = 0; n < tissues.size(); ++n) {
            EXPECT_EQ(tissues[n].label, static_cast<int>(n + 6 - tissues.size()));
        }
    }
    EXPECT_EQ(tissueConductivities({0.33, 0.01, 0.43, 1.79}, 4),
              (std::vector<double>{0.33, 1.79, 0.01, 0.43}));
}

}  // namespace
}  // namespace adaptiso
