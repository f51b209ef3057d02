#include <gtest/gtest.h>

#include <cmath>

#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {
namespace {

/// An equilateral element: dihedral angle acos(1/3), circumscribed radius sqrt(6)/4 of its edge.
TetrahedralMesh equilateral() {
    return {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 2, 1, 3}}, {2}};
}

TEST(Tetrahedra, AreMeasured) {
    TetrahedralMesh mesh = equilateral();
    const std::vector<TetrahedraRegion> regions{{2, "brain", 8.0 / 3, 0}};
    const TetrahedraReport report = checkTetrahedra(mesh, regions);
    EXPECT_EQ(report.unlabelled, 0);
    EXPECT_EQ(report.flat, 0);
    EXPECT_NEAR(report.volumesMm3[0], 8.0 / 3, 1e-12);
    EXPECT_NEAR(report.leastDihedralDeg, 70.528779, 1e-5);
    EXPECT_NEAR(report.mostRadiusEdge, std::sqrt(6) / 4, 1e-12);
    for (const TetrahedraCheck& check : judgeTetrahedra(report, regions)) {
        EXPECT_TRUE(check.isPassed) << check.name;
    }
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.labels = {9};
    EXPECT_EQ(checkTetrahedra(mesh, regions).flat, 1);
    EXPECT_EQ(checkTetrahedra(mesh, regions).unlabelled, 1);
}

TEST(Tetrahedra, EachFaultFailsItsCheck) {
    const auto failed = [](const TetrahedralMesh& mesh, const TetrahedraRegion& region) {
        const std::vector<TetrahedraRegion> regions{region};
        std::vector<std::string> names;
        for (const auto& check : judgeTetrahedra(checkTetrahedra(mesh, regions), regions)) {
            if (!check.isPassed) names.push_back(check.name);
        }
        return names;
    };
    using Names = std::vector<std::string>;
    TetrahedralMesh mesh = equilateral();
    EXPECT_EQ(failed(mesh, {2, "brain", 2.7, 0}), Names{"volume of brain as within its walls"});
    EXPECT_EQ(failed(mesh, {2, "brain", 2.7, 40}), Names{});  // 0.033 mm3 of 40 mm2 of walls
    mesh.labels = {3};
    EXPECT_EQ(failed(mesh, {2, "brain", 8.0 / 3, 0}),
              (Names{"each of a region", "volume of brain as within its walls"}));
    mesh = equilateral();
    mesh.points.push_back({0, 0, 0});
    mesh.tetrahedra.push_back({0, 1, 4, 4});
    mesh.labels.push_back(2);
    EXPECT_EQ(failed(mesh, {2, "brain", 8.0 / 3, 0}), Names{"none flat or inverted"});
}

TEST(Tetrahedra, OfNoRegionGoWithTheirPoints) {
    TetrahedralMesh mesh = equilateral();
    mesh.points.insert(mesh.points.begin(), {5, 5, 5});
    mesh.tetrahedra = {{1, 3, 2, 4}, {0, 1, 2, 3}};
    mesh.labels = {1, 2};
    const std::vector<TetrahedraRegion> regions{{17, "inside", 8.0 / 3, 0}};
    takeRegions(mesh, regions);
    EXPECT_EQ(mesh.points, equilateral().points);
    EXPECT_EQ(mesh.tetrahedra, equilateral().tetrahedra);
    EXPECT_EQ(mesh.labels, std::vector<std::int32_t>{17});
}

}  // namespace
}  // namespace adaptiso
