#include <gtest/gtest.h>

#include <numeric>
#include <string>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {
namespace {

using testing::icosphere;

constexpr const char* kNodes =
    "5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0 0 -1\n# by tetgen\n";
constexpr const char* kElements = "2 4 1\n0 0 1 2 3 2\n1 0 1 2 4 5\n# by tetgen\n";

TEST(MesherFiles, OfTetgenAreReadAndTurnedOutward) {
    const TetrahedralMesh mesh = decodeTetgen(kNodes, kElements, "tetgen");
    ASSERT_EQ(mesh.tetrahedra.size(), 2u);
    EXPECT_EQ(mesh.labels, (std::vector<std::int32_t>{2, 5}));
    for (const auto& t : mesh.tetrahedra) {
        const Vec3& a = mesh.points[t[0]];
        EXPECT_NEAR(dot(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a),
                    1, 1e-12);
    }
}

TEST(MesherFiles, OfGmshAreRead) {
    const TetrahedralMesh mesh = decodeGmsh(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n3 0 0 0\n7 1 0 0\n8 0 1 0\n9 0 0 1\n"
        "$EndNodes\n$Elements\n3\n1 15 2 0 1 3\n2 2 2 0 1 3 7 8\n3 4 2 4 3 3 7 8 9\n$EndElements\n",
        "gmsh");
    ASSERT_EQ(mesh.tetrahedra.size(), 1u);
    EXPECT_EQ(mesh.labels.front(), 4);
    EXPECT_EQ(mesh.tetrahedra.front(), (std::array<VertexId, 4>{0, 1, 2, 3}));
}

void expectRefused(const std::string& nodes, const std::string& elements) {
    try {
        decodeTetgen(nodes, elements, "tetgen");
    } catch (const FileError& error) {
        const std::string what = error.what();
        EXPECT_TRUE(what.starts_with("tetgen: ")) << what;
        EXPECT_EQ(what.find('\v'), std::string::npos) << what;
        return;
    }
    ADD_FAILURE() << "was read";
}

TEST(MesherFiles, DamageIsToldInOneLine) {
    expectRefused("5 3 0 0\n0 0 0 0\n", kElements);
    expectRefused(kNodes, "2 4 1\n0 0 1 2 3 2\n1 0 1 2 9 5\n");
    expectRefused(kNodes, "2 4 0\n0 0 1 2 3\n1 0 1 2 4\n");
    expectRefused(kNodes, "1 4 1\n0 0 1 2 3 1e300\n");
    expectRefused(kNodes, "1 4 1\n0 0 1 2 3 nan\n");
    expectRefused(kNodes, "1 4 1\n0 -9223372036854775808 1 2 3 1\n");
    expectRefused("5 3 0 0\n0 1\v0 0 0\n", kElements);
    expectRefused("99999999999 3 0 0\n", kElements);
    EXPECT_THROW(decodeGmsh("$Nodes\n", "gmsh"), FileError);
    // a number of tags that would take minutes to skip
    EXPECT_THROW(decodeGmsh("$Nodes\n0\n$Elements\n1\n1 15 666666666 2\n", "gmsh"), FileError);
}

/// Two spheres, one in the other.
MesherInput shell() {
    MesherInput input;
    for (const double radius : {60.0, 66.0}) {
        const TriangleMesh sphere = icosphere(1, {}, radius);
        const VertexId first = std::ssize(input.points);
        input.points.insert(input.points.end(), sphere.points.begin(), sphere.points.end());
        for (const auto& [a, b, c] : sphere.triangles) {
            input.triangles.push_back({first + a, first + b, first + c});
            input.walls.push_back(radius > 60 ? 2 : 1);
        }
    }
    input.volumes = {{1, {1}, {0, 0, 0}}, {2, {2, 1}, {0, 0, 60.5}}};
    return input;
}

TEST(MesherFiles, TetgenIsGivenAllSpaces) {
    const std::string poly = tetgenInput(shell(), 6);
    EXPECT_TRUE(poly.starts_with("84 3 0 0\n"));  // 42 points each
    EXPECT_NE(poly.find("\n160 1\n"), std::string::npos);
    // no holes, two regions; 6^3 / (6 sqrt 2) mm3
    EXPECT_NE(poly.find("\n0\n2\n1 0 0 0 1 25.455"), std::string::npos);
    EXPECT_NE(poly.find("\n2 0 0 60.5 2 25.455"), std::string::npos);
}

TEST(MesherFiles, GmshIsGivenAllSpaces) {
    MesherInput input = shell();
    input.volumes.push_back({1, {2}, {}});
    const std::string script = gmshScript(input, "walls.msh", 6);
    EXPECT_NE(script.find("Merge \"walls.msh\";\n"), std::string::npos);
    EXPECT_NE(script.find("Surface Loop(2) = {2, 1};\nVolume(2) = {2};\n"), std::string::npos);
    EXPECT_NE(script.find("Physical Volume(1) = {1, 3};\nPhysical Volume(2) = {2};\n"),
              std::string::npos);
    EXPECT_NE(gmshWalls(input).find("\n160 2 2 2 2 "), std::string::npos);
}

TEST(MesherFiles, APointBesideLiesNextToItsWall) {
    const MesherInput input = shell();
    const TriangleMesh walls{input.points, {}, input.triangles};
    const AabbTree tree(walls);
    std::vector<std::int64_t> outer(80);
    std::iota(outer.begin(), outer.end(), 80);
    const double within = norm(pointBeside(walls, tree, outer, false));
    EXPECT_GT(within, 60);
    EXPECT_LT(within, 66);
    EXPECT_GT(norm(pointBeside(walls, tree, outer, true)), norm(walls.points[45]) * 0.9);
    const TriangleMesh flat{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {}, {{0, 1, 2}}};
    const AabbTree flatTree(flat);
    const std::vector<std::int64_t> only{0};
    EXPECT_THROW(pointBeside(flat, flatTree, only, true), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
