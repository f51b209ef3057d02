#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/Tetrahedra.h"

namespace adaptiso {
namespace {

using testing::icosphere;

constexpr const char* kNodes =
    "5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0 0 -1\n# by tetgen\n";
constexpr const char* kElements = "2 4 1\n0 0 1 2 3 2\n1 0 1 2 4 5\n# by tetgen\n";

TEST(Tetrahedra, OfTetgenAreReadAndTurnedOutward) {
    const TetrahedralMesh mesh = decodeTetgen(kNodes, kElements, "tetgen");
    ASSERT_EQ(mesh.tetrahedra.size(), 2u);
    EXPECT_EQ(mesh.tissues, (std::vector<std::int32_t>{2, 5}));
    for (const auto& t : mesh.tetrahedra) {
        const Vec3& a = mesh.points[t[0]];
        EXPECT_NEAR(dot(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a),
                    1, 1e-12);
    }
}

TEST(Tetrahedra, OfGmshAreRead) {
    const TetrahedralMesh mesh = decodeGmsh(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n3 0 0 0\n7 1 0 0\n8 0 1 0\n9 0 0 1\n"
        "$EndNodes\n$Elements\n3\n1 15 2 0 1 3\n2 2 2 0 1 3 7 8\n3 4 2 4 3 3 7 8 9\n$EndElements\n",
        "gmsh");
    ASSERT_EQ(mesh.tetrahedra.size(), 1u);
    EXPECT_EQ(mesh.tissues.front(), 4);
    EXPECT_EQ(mesh.tetrahedra.front(), (std::array<VertexId, 4>{0, 1, 2, 3}));
}

TEST(Tetrahedra, DamageIsToldInOneLine) {
    const auto refused = [](const std::string& nodes, const std::string& elements) {
        try {
            decodeTetgen(nodes, elements, "tetgen");
        } catch (const FileError& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with("tetgen: ")) << what;
            return;
        }
        ADD_FAILURE() << "was read";
    };
    refused("5 3 0 0\n0 0 0 0\n", kElements);
    refused(kNodes, "2 4 1\n0 0 1 2 3 2\n1 0 1 2 9 5\n");
    refused(kNodes, "2 4 0\n0 0 1 2 3\n1 0 1 2 4\n");
    refused("99999999999 3 0 0\n", kElements);
    EXPECT_THROW(decodeGmsh("$Nodes\n", "gmsh"), FileError);
}

TEST(Tetrahedra, AreMeasured) {
    // an equilateral element: dihedral angle acos(1/3), circumscribed radius sqrt(6)/4 of its edge
    TetrahedralMesh mesh;
    mesh.points = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    mesh.tetrahedra = {{0, 2, 1, 3}};
    mesh.tissues = {2};
    const std::vector<TriangleMesh> surfaces{icosphere(0, {}, 1)};
    const TetrahedraReport report = checkTetrahedra(mesh, surfaces);
    EXPECT_EQ(report.unlabelled, 0);
    EXPECT_EQ(report.flat, 0);
    EXPECT_NEAR(report.volumesMm3[0], 8.0 / 3, 1e-12);
    EXPECT_NEAR(report.leastDihedralDeg, 70.528779, 1e-5);
    EXPECT_NEAR(report.mostRadiusEdge, std::sqrt(6) / 4, 1e-12);
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.tissues = {9};
    EXPECT_EQ(checkTetrahedra(mesh, surfaces).flat, 1);
    EXPECT_EQ(checkTetrahedra(mesh, surfaces).unlabelled, 1);
}

TEST(Tetrahedra, MeshersAreGivenAllLayers) {
    std::vector<TriangleMesh> surfaces;
    for (const double radius : {60.0, 66.0, 72.0}) surfaces.push_back(icosphere(1, {}, radius));
    const std::string poly = tetgenInput(surfaces, 6);
    EXPECT_TRUE(poly.starts_with("126 3 0 0\n"));  // 42 points each
    EXPECT_NE(poly.find("\n240 1\n"), std::string::npos);
    // no holes, three regions: 2 brain, 4 skull, 5 scalp; 6^3 / (6 sqrt 2) mm3
    EXPECT_NE(poly.find("\n0\n3\n1 "), std::string::npos);
    EXPECT_NE(poly.find(" 4 25.455"), std::string::npos);
    const std::vector<std::string> files{"a.stl", "b.stl", "c.stl"};
    EXPECT_NE(gmshInput(files, 6).find("Volume(2) = {2, 1};\nPhysical Volume(4) = {2};"),
              std::string::npos);
}

}  // namespace
}  // namespace adaptiso
