// What a file counts, held against what it holds.
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cstring>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/PointData.h"

namespace adaptiso {
namespace {

using testing::decoded;
using testing::exampleName;
using testing::icosphere;
using testing::messageOf;
using testing::replaced;
using testing::written;

constexpr std::size_t kTriangles = 320;  // of the ball

TriangleMesh ball() {
    return icosphere(2, {1, 2, 3}, 40);
}

std::vector<std::string> codesOf(const MeshFile& file) {
    std::vector<std::string> codes;
    for (const Warning& warning : file.warnings) codes.push_back(warning.code);
    return codes;
}

using Codes = std::vector<std::string>;

std::string fault(const std::string& bytes, const std::string& name) {
    return messageOf<FileError>([&] { decoded(bytes, name); });
}

void expectMore(const std::string& bytes, const std::string& name, const std::string& what) {
    const std::string message = fault(bytes, name);
    EXPECT_NE(message.find(what), std::string::npos) << name << ": " << message;
    EXPECT_NE(message.find("are two files joined?"), std::string::npos) << message;
}

class CountOf : public ::testing::TestWithParam<int> {
protected:
    const MeshFormat& format() const { return meshFormats()[GetParam()]; }
    std::string name() const { return exampleName(format()); }
    std::string ballBytes() const { return written(ball(), name()); }
    bool countsRecords() const { return format().name != "Wavefront OBJ"; }
};

TEST_P(CountOf, JoinedFilesAreRefused) {
    if (!countsRecords()) GTEST_SKIP() << "OBJ counts nothing";
    expectMore(ballBytes() + ballBytes(), name(), "another surface");
    // a small one behind a large one, and the other way round
    const std::string small = written(testing::tetrahedron(), name());
    expectMore(ballBytes() + small, name(), "another surface");
    expectMore(small + ballBytes(), name(), "another surface");
}

TEST_P(CountOf, OfAWholeFileGivesNoWarning) {
    EXPECT_EQ(codesOf(decoded(ballBytes(), name())), Codes{});
}

TEST_P(CountOf, ZerosBehindTheEndAreAWarning) {
    if (!countsRecords()) GTEST_SKIP() << "OBJ counts nothing";
    const MeshFile file = decoded(ballBytes() + std::string(100, '\0'), name());
    EXPECT_EQ(file.mesh.triangles.size(), kTriangles);
    EXPECT_EQ(codesOf(file), Codes{"trailing-bytes"});
}

TEST_P(CountOf, AFewBytesBehindTheEndAreAWarning) {
    if (!countsRecords()) GTEST_SKIP() << "OBJ counts nothing";
    const MeshFile file = decoded(ballBytes() + "#end", name());
    EXPECT_EQ(file.mesh.triangles.size(), kTriangles);
    const bool isComment = format().name == "OFF";
    EXPECT_EQ(codesOf(file), isComment ? Codes{} : Codes{"trailing-bytes"});
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, CountOf,
                         ::testing::Range(0, static_cast<int>(meshFormats().size())),
                         [](const auto& parameter) {
                             std::string name(meshFormats()[parameter.param].extensions.front());
                             return name.substr(1);
                         });

TEST(Counts, FewerThanAreThereAreRefused) {
    std::string stl = written(ball(), "a.stl");
    const std::uint32_t half = 160;
    std::memcpy(stl.data() + 80, &half, sizeof half);
    expectMore(stl, "a.stl", "it holds 160 more behind the 160 triangles that it counts");
    expectMore(replaced(written(ball(), "a.ply"), "face 320", "face 319"), "a.ply",
               "1 more behind the 319 faces");
    expectMore(replaced(written(ball(), "a.off"), "162 320 0", "162 315 0"), "a.off",
               "5 more behind the 315 faces");
    expectMore(replaced(written(ball(), "a.tri"), "- 320 320 320", "- 319 319 319"), "a.tri",
               "1 more behind the 319 triangles");
    TriangleMesh bare = ball();
    bare.normals.clear();
    const std::string counts = "POLYGONS 320 1280", fewer = "POLYGONS 310 1240";
    expectMore(replaced(written(bare, "a.vtk"), counts, fewer), "a.vtk",
               "10 more behind the 310 polygons");
    // with normals behind the polygons they are no whole records
    EXPECT_NE(fault(replaced(written(ball(), "a.vtk"), counts, fewer), "a.vtk").find("no section"),
              std::string::npos);
}

TEST(Counts, AHeaderOfStlBehindTheTrianglesIsAnotherFile) {
    const std::string stl = written(ball(), "a.stl");
    const std::string header = stl.substr(0, 80) + std::string(4, '\0');
    expectMore(stl + header, "a.stl", "another surface");
    expectMore(stl + header + stl.substr(84, 100), "a.stl", "another surface");  // its count unset
}

TEST(Counts, FewerTrianglesOfFreeSurferAreRefused) {
    const std::string bytes = written(ball(), "a.pial");
    // the number of triangles stands behind that of the points, in front of these
    const std::size_t at = bytes.find("\n\n") + 2 + sizeof(std::int32_t);
    const std::size_t end = at + 4 + 162 * 12 + 320 * 12;
    for (const int fewer : {1, 20, 60}) {
        std::string file = bytes;
        file[at + 3] = static_cast<char>(file[at + 3] - fewer);
        const std::string more = std::to_string(fewer) + " more behind the ";
        expectMore(file, "a.pial", more);
        expectMore(file.substr(0, end), "a.pial", more);  // without its footer
    }
}

TEST(Counts, OfTextAreHeldAgainstTheRest) {
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
        "0\n0 1 0\n3 0 1 2\n";
    EXPECT_EQ(codesOf(decoded(ply + "\n \n", "a.ply")), Codes{});
    expectMore(ply + "3 0 2 1\n", "a.ply", "1 more behind the 1 faces");
    const std::string vtk =
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 "
        "0\nPOLYGONS 1 4\n3 0 1 2\n";
    EXPECT_EQ(codesOf(decoded(vtk, "a.vtk")), Codes{});
    expectMore(vtk + "3 0 2 1\n", "a.vtk", "1 more behind the 1 polygons");
    EXPECT_EQ(codesOf(decoded(
                  vtk + "POINT_DATA 3\nTENSORS t float\n" +
                      [] {
                          std::string numbers;
                          for (int n = 0; n < 27; ++n) numbers += "1 ";
                          return numbers;
                      }(),
                  "a.vtk")),
              Codes{});
    EXPECT_EQ(codesOf(decoded(vtk + "SOMETHING new\n1 2 3\n", "a.vtk")), Codes{"trailing-bytes"});
    const std::string tri = "3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1\n1 1 2 3\n";  // FreeSurfer's
    EXPECT_EQ(codesOf(decoded(tri, "a.tri")), Codes{});
    expectMore(tri + "2 1 3 2\n", "a.tri", "1 more behind the 1 triangles");
    // the numbers of cells contradict each other
    EXPECT_NE(fault(replaced(vtk, "POLYGONS 1 4", "POLYGONS 2 4"), "a.vtk")
                  .find("it counts 2 polygons, and its list has 1"),
              std::string::npos);
}

TEST(Counts, UnsetByAStreamWriterAreSetToWhatIsThere) {
    for (const std::uint32_t count : {0U, 0xFFFFFFFFU}) {
        std::string stl = written(ball(), "a.stl");
        std::memcpy(stl.data() + 80, &count, sizeof count);
        const MeshFile file = decoded(stl, "a.stl");
        EXPECT_EQ(file.mesh.triangles.size(), kTriangles);
        EXPECT_EQ(file.mesh.points.size(), ball().points.size());
        EXPECT_EQ(codesOf(file), Codes{"count-unset"});
        // a part of a record behind them
        EXPECT_EQ(codesOf(decoded(stl + "abc", "a.stl")), (Codes{"count-unset", "trailing-bytes"}));
    }
    for (const std::string count : {"0", "-1", "4294967295"}) {
        const std::string ply = replaced(written(ball(), "a.ply"), "face 320", "face " + count);
        EXPECT_EQ(decoded(ply, "a.ply").mesh.triangles.size(), kTriangles) << count;
        const std::string off =
            replaced(written(ball(), "a.off"), "162 320 0", "162 " + count + " 0");
        EXPECT_EQ(decoded(off, "a.off").mesh.triangles.size(), kTriangles) << count;
    }
}

TEST(Counts, JoinedObjFilesAreKnownByTheirNumbers) {
    const std::string large = written(ball(), "a.obj"),
                      small = written(testing::tetrahedron(), "a.obj");
    for (const std::string& joined :
         {large + large, small + large, large + small, small + small + large}) {
        EXPECT_NE(fault(joined, "a.obj").find("are two files joined?"), std::string::npos);
    }
    // one file of two bodies, numbered on or back
    const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(decoded(body + "f 1 2 3\n" + body + "f 4 5 6\n", "a.obj").mesh.triangles.size(), 2U);
    EXPECT_EQ(decoded(body + "f -3 -2 -1\n" + body + "f -3 -2 -1\n", "a.obj").mesh.triangles.size(),
              2U);
    EXPECT_EQ(decoded(body + "f 1 2 3\nv 1 1 0\nf 2 4 3\n", "a.obj").mesh.triangles.size(), 2U);
}

TEST(Counts, ObjMayEndWithLandmarks) {
    const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(decoded(body + "f 1 2 3\nv 5 5 5\n", "a.obj").mesh.points.size(), 4U);
    EXPECT_EQ(decoded(body + "f 1 2 3\n" + body + body, "a.obj").mesh.triangles.size(), 1U);
}

TEST(Counts, JoinedObjFilesOfSeveralBodiesAreRefused) {
    const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const std::string one = body + "f 1 2 3\n";
    const std::string several = one + body + "f 4 5 6\n" + body + "f 7 8 9\n";
    EXPECT_EQ(decoded(several, "a.obj").mesh.triangles.size(), 3U);
    for (const std::string& joined : {one + several, several + one, several + several}) {
        EXPECT_NE(fault(joined, "a.obj").find("are two files joined?"), std::string::npos);
    }
}

TEST(Counts, OfGiftiArraysAreHeldAgainstThem) {
    const std::string gifti = written(ball(), "a.gii");
    const std::string count = "NumberOfDataArrays=\"2\"";
    for (const char* const other : {"1", "3"}) {
        const std::string bytes =
            replaced(gifti, count, "NumberOfDataArrays=\"" + std::string(other) + "\"");
        EXPECT_NE(fault(bytes, "a.gii").find("NumberOfDataArrays is " + std::string(other)),
                  std::string::npos);
    }
    EXPECT_EQ(codesOf(decoded(replaced(gifti, count, ""), "a.gii")), Codes{});
    EXPECT_EQ(codesOf(decoded(replaced(gifti, count, "NumberOfDataArrays=\"0\""), "a.gii")),
              Codes{"count-unset"});
}

TEST(Counts, OfVtkAreThoseOfItsPoints) {
    const std::string points = "POINTS 3 float\n0 0 0 1 0 0 0 1 0\n",
                      polygon = "POLYGONS 1 4\n3 0 1 2\n";
    const std::string head = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n";
    const std::string vtk = head + points + polygon;
    const std::string field = "POINT_DATA 3\nFIELD f 1\n";
    EXPECT_EQ(codesOf(decoded(vtk + field + "a 1 3 float\n1 2 3\n", "a.vtk")), Codes{});
    EXPECT_NE(fault(vtk + field + "a 1 2 float\n1 2\n", "a.vtk").find("values for 2 points"),
              std::string::npos);
    EXPECT_NE(fault(vtk + "POINT_DATA 2\nSCALARS s float\nLOOKUP_TABLE default\n1 2\n", "a.vtk")
                  .find("values for 2 points, and 3 points"),
              std::string::npos);
    EXPECT_NE(fault(vtk + points, "a.vtk").find("two sections POINTS"), std::string::npos);
    EXPECT_NE(fault(vtk + polygon, "a.vtk").find("two sections POLYGONS"), std::string::npos);
}

TEST(Counts, OfVtkCellDataAreThoseOfItsCells) {
    const std::string head =
                          "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 "
                          "float\n0 0 0 1 0 0 0 1 0\n",
                      polygon = "POLYGONS 1 4\n3 0 1 2\n",
                      others = "VERTICES 2 4\n1 0 1 1\nLINES 1 3\n2 0 1\n";
    const auto scalars = [](int count) {
        std::string text = "SCALARS s float\nLOOKUP_TABLE default\n";
        for (int n = 0; n < count; ++n) text += "1 ";
        return "CELL_DATA " + std::to_string(count) + "\n" + text + "\n";
    };
    const auto field = [](int count, int tuples) {
        std::string text = "CELL_DATA " + std::to_string(count) + "\nFIELD f 1\na 1 " +
                           std::to_string(tuples) + " float\n";
        for (int n = 0; n < tuples; ++n) text += "1 ";
        return text + "\n";
    };
    const std::string one = head + polygon, four = head + others + polygon;
    for (const std::string& good :
         {one + scalars(1), one + field(1, 1), one + "POINT_DATA 3\n" + scalars(1)}) {
        EXPECT_EQ(codesOf(decoded(good, "a.vtk")), Codes{});
    }
    for (const std::string& good : {four + scalars(4), four + field(4, 4)}) {
        const MeshFile file = decoded(good, "a.vtk");
        EXPECT_EQ(codesOf(file), Codes{"lines-left-out"});
        EXPECT_EQ(file.warnings[0].text,
                  "3 lines or points beside the polygons of the surface were left out");
    }
    const auto refused = [](const std::string& vtk, std::string_view words) {
        EXPECT_NE(fault(vtk, "a.vtk").find(words), std::string::npos) << fault(vtk, "a.vtk");
    };
    refused(one + scalars(2), "values for 2 cells, and 1 cells");
    refused(one + field(2, 2), "values for 2 cells, and 1 cells");
    refused(one + field(1, 2), "values for 2 cells, and 1 cells");
    refused(four + scalars(1), "values for 1 cells, and 4 cells");
    refused(four + scalars(5), "values for 5 cells, and 4 cells");
}

/// A triangle, a line and arrays in text.
std::string vtpWith(const std::string& pointValues, const std::string& cellValues) {
    const auto array = [](const std::string& attributes, const std::string& values) {
        return "<DataArray format=\"ascii\" " + attributes + ">" + values + "</DataArray>";
    };
    const std::string real = "type=\"Float32\" ", whole = "type=\"Int64\" ";
    return "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfLines=\"1\" "
           "NumberOfPolys=\"1\"><PointData>" +
           array(real + "Name=\"p\"", pointValues) + "</PointData><CellData>" +
           array(real + "Name=\"c\" NumberOfComponents=\"2\"", cellValues) + "</CellData><Points>" +
           array(real + "NumberOfComponents=\"3\"", "0 0 0 1 0 0 0 1 0") + "</Points><Lines>" +
           array(whole + "Name=\"connectivity\"", "0 1") + array(whole + "Name=\"offsets\"", "2") +
           "</Lines><Polys>" + array(whole + "Name=\"connectivity\"", "0 1 2") +
           array(whole + "Name=\"offsets\"", "3") + "</Polys></Piece></PolyData></VTKFile>";
}

TEST(Counts, OfPlyEachElementAndPropertyIsThereOnce) {
    const std::string
        vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
        face = "element face 1\n", corners = "property list uchar int vertex_indices\n",
        points = "0 0 0\n1 0 0\n0 1 0\n", triangle = "3 0 1 2\n";
    const auto ply = [&](const std::string& header, const std::string& rows) {
        return "ply\nformat ascii 1.0\n" + header + "end_header\n" + rows;
    };
    const std::string good = vertices + face + corners;
    EXPECT_EQ(codesOf(decoded(ply(good, points + triangle), "a.ply")), Codes{});
    const auto refused = [&](const std::string& header, const std::string& rows,
                             std::string_view words) {
        const std::string bytes = ply(header, rows);
        EXPECT_NE(fault(bytes, "a.ply").find(words), std::string::npos) << fault(bytes, "a.ply");
    };
    refused(good + face + corners, points + triangle + triangle, "the element 'face' twice");
    refused(vertices + good, points + points + triangle, "the element 'vertex' twice");
    refused(good + corners, points + "3 0 1 2 3 0 2 1\n", "the property 'vertex_indices' twice");
    refused(vertices + "property float x\n" + face + corners,
            "0 0 0 9\n1 0 0 9\n0 1 0 9\n" + triangle, "the property 'x' twice");
    refused("format binary_little_endian 1.0\n" + good, points + triangle,
            "twice how it is encoded");
}

TEST(Counts, OfVtpArraysAreThoseOfItsPointsAndCells) {
    EXPECT_EQ(codesOf(decoded(vtpWith("1 2 3", "1 2 3 4"), "a.vtp")), Codes{"lines-left-out"});
    for (const char* const other : {"1 2", "1 2 3 4 5", ""}) {
        EXPECT_NE(fault(vtpWith(other, "1 2 3 4"), "a.vtp").find("values, must hold 3"),
                  std::string::npos);
        EXPECT_NE(fault(vtpWith("1 2 3", other), "a.vtp").find("values, must hold 4"),
                  std::string::npos);
    }
    // packed, where the array is at another's place
    const TriangleMesh mesh = ball();
    MeshWriteOptions options;
    options.pointArrays = {{"p", std::vector<double>(mesh.points.size())}};
    options.cellArrays = {{"c", std::vector<std::int32_t>(mesh.triangles.size())}};
    const std::string vtp = written(mesh, "a.vtp", options);
    EXPECT_EQ(codesOf(decoded(vtp, "a.vtp")), Codes{});
    const std::string begin = "Name=\"c\" format=\"appended\" offset=\"";
    const std::size_t at = vtp.find(begin) + begin.size();
    const std::string offset = vtp.substr(at, vtp.find('"', at) - at);
    EXPECT_NE(
        fault(replaced(vtp, begin + offset, begin + "0"), "a.vtp").find("its array 'c' holds"),
        std::string::npos);
}

TEST(Counts, ArraysThatAreNotCarriedAreNamed) {
    const auto leftOut = [](const std::string& bytes, const char* name) {
        return decodeMesh(bytes, findMeshFormat(name), name, {.keepsPointArrays = true})
            .arraysLeftOut;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(leftOut(vtpWith("1 2 3", "1 2 3 4"), "a.vtp"), Names{"c"});
    EXPECT_EQ(decoded(vtpWith("1 2 3", "1 2 3 4"), "a.vtp").arraysLeftOut, Names{});
    const std::string vtk =
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 "
        "0\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS p float\nLOOKUP_TABLE default\n1 2 3\n"
        "CELL_DATA 1\nSCALARS c float\nLOOKUP_TABLE default\n1\nFIELD f 2\nd 2 1 int\n1 2\n"
        "e 1 1 string\nname\n";
    EXPECT_EQ(leftOut(vtk, "a.vtk"), (Names{"c", "d", "e"}));
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float p\nelement face 1\nproperty list uchar int vertex_indices\n"
        "property uchar red\nproperty list uchar float texcoord\nend_header\n0 0 0 1\n1 0 0 2\n"
        "0 1 0 3\n3 0 1 2 255 2 0 0\n";
    EXPECT_EQ(leftOut(ply, "a.ply"), (Names{"red", "texcoord"}));
    std::string gifti = written(testing::tetrahedron(), "a.gii");
    gifti = replaced(gifti, "NumberOfDataArrays=\"2\"", "NumberOfDataArrays=\"3\"");
    gifti = replaced(gifti, "</GIFTI>",
                     "<DataArray Intent=\"NIFTI_INTENT_SHAPE\" DataType=\"NIFTI_TYPE_FLOAT32\" "
                     "Dimensionality=\"1\" Dim0=\"4\" Encoding=\"ASCII\"><Data>1 2 3 4</Data>"
                     "</DataArray></GIFTI>");
    EXPECT_EQ(leftOut(gifti, "a.gii"), Names{"NIFTI_INTENT_SHAPE"});
}

TEST(Counts, OfComponentsOfVtpPlacesAreThree) {
    const std::string vtp = written(ball(), "a.vtp");
    for (const std::string name : {"Points", "Normals"}) {
        const std::string before = "Name=\"" + name + "\" NumberOfComponents=\"";
        ASSERT_NE(vtp.find(before + "3\""), std::string::npos);
        for (const char* const other : {"1", "2", "4"}) {
            const std::string bytes = replaced(vtp, before + "3\"", before + other + "\"");
            EXPECT_NE(fault(bytes, "a.vtp").find("components (NumberOfComponents), must have 3"),
                      std::string::npos);
        }
    }
}

TEST(Counts, ACommentBehindVtpIsNothing) {
    const std::string vtp = written(ball(), "a.vtp");
    EXPECT_EQ(codesOf(decoded(vtp + "<!-- end -->\n<!-- > -->\n", "a.vtp")), Codes{});
}

TEST(Counts, SeveralStlFilesBehindOneAreRefused) {
    const std::string small = written(testing::tetrahedron(), "a.stl");
    expectMore(written(ball(), "b.stl") + small + small, "a.stl", "another surface");
}

TEST(Counts, MoreThanAreThereAreRefused) {
    std::string stl = written(ball(), "a.stl");
    const std::uint32_t more = 321;
    std::memcpy(stl.data() + 80, &more, sizeof more);
    EXPECT_NE(fault(stl, "a.stl").find("321 triangles, but only 16000 bytes"), std::string::npos);
}

TEST(Counts, SolidsOfOneTextAreAllRead) {
    const auto solid = [](const std::string& name, double z) {
        const std::string height = std::to_string(z);
        return "solid " + name + "\nfacet normal 0 0 1\nouter loop\nvertex 0 0 " + height +
               "\nvertex 1 0 " + height + "\nvertex 0 1 " + height +
               "\nendloop\nendfacet\nendsolid " + name + "\n";
    };
    const MeshFile file = decoded(solid("a", 0) + "\n" + solid("b", 1), "a.stl");
    EXPECT_EQ(file.mesh.triangles.size(), 2U);
    EXPECT_EQ(file.mesh.points.size(), 6U);
    EXPECT_EQ(file.solids, (std::vector<std::int64_t>{0, 1}));
    // Solids without triangles are left out. Triangles before the first solid count as a solid.
    const std::string empty = "solid x\nendsolid x\n";
    EXPECT_TRUE(decoded(solid("a", 0) + empty + empty, "a.stl").solids.empty());
    EXPECT_EQ(decoded(empty + solid("a", 0) + empty + solid("b", 1), "a.stl").solids,
              (std::vector<std::int64_t>{0, 1}));
    EXPECT_EQ(
        decoded("solidA" + solid("", 0).substr(6) + solid("b", 1) + solid("c", 2), "a.stl").solids,
        (std::vector<std::int64_t>{0, 1, 2}));
    EXPECT_EQ(codesOf(file), Codes{"several-solids"});
    EXPECT_EQ(codesOf(decoded(solid("a", 0), "a.stl")), Codes{});
    std::string solids;
    for (int n = 0; n < 20; ++n) solids += solid("a", n);
    expectMore(solids + written(ball(), "b.stl"), "a.stl", "another surface");
}

TEST(Counts, AttributesOfStlAreNamedOrPassedOver) {
    const std::string stl = written(ball(), "a.stl");
    std::string colored = stl;
    for (std::size_t n = 0; n < 320; ++n) {
        const std::uint16_t red = 0xFC00;  // SolidView: bit 15 and red
        std::memcpy(colored.data() + 84 + 50 * n + 48, &red, sizeof red);
    }
    const MeshFile file = decoded(colored, "a.stl");
    EXPECT_EQ(file.mesh.triangles, decoded(stl, "a.stl").mesh.triangles);
    EXPECT_EQ(codesOf(file), Codes{"attributes-left-out"});
    // as the format defines it: so many bytes behind the triangle
    std::string longer = stl.substr(0, 84);
    for (std::size_t n = 0; n < 320; ++n) {
        const std::uint16_t bytes = n % 2 == 0 ? 7 : 0;
        std::string record = stl.substr(84 + 50 * n, 50);
        std::memcpy(record.data() + 48, &bytes, sizeof bytes);
        longer += record + std::string(bytes, 'x');
    }
    const MeshFile followed = decoded(longer, "a.stl");
    EXPECT_EQ(followed.mesh.points, decoded(stl, "a.stl").mesh.points);
    EXPECT_EQ(codesOf(followed), Codes{"attributes-left-out"});
}

TEST(Counts, OfValuesAtPointsAreHeldAgainstTheRest) {
    const std::vector<float> numbers{1, 2, 3, 4};
    const std::vector<std::int32_t> labels{1, 2, 3, 4};
    const auto bytes = [](const PointData& data, const char* name) {
        const auto file = testing::temporaryFile(name);
        writePointData(data, 4, file);
        return testing::bytesOf(file);
    };
    const auto codes = [](const std::string& content, PointDataFormat format) {
        std::vector<std::string> found;
        for (const Warning& warning : decodePointData(content, format, "x").warnings) {
            found.push_back(warning.code);
        }
        return found;
    };
    const std::vector<std::pair<PointData, const char*>> files{
        {{PointDataFormat::FreeSurferCurv, 4, {{{}, numbers, 1, {}}}, {}, {}, {}}, "lh.curv"},
        {{PointDataFormat::FreeSurferAnnot, 4, {{{}, labels, 1, {}}}, {}, {}, {}}, "lh.annot"},
        {{PointDataFormat::FreeSurferMgh, 4, {{{}, numbers, 1, {}}}, {}, {}, {}}, "lh.mgh"},
        {{PointDataFormat::Gifti, 4, {{{}, numbers, 1, {}}}, {}, {}, {}}, "lh.gii"}};
    for (const auto& [data, name] : files) {
        const std::string content = bytes(data, name);
        EXPECT_EQ(codes(content, data.format), Codes{}) << name;
        EXPECT_EQ(codes(content + std::string(9, '\0'), data.format), Codes{"trailing-bytes"})
            << name;
        const std::string more = content + std::string(8, '\1') + content;
        EXPECT_THROW(decodePointData(more, data.format, name), FileError) << name;
    }
}

/// A packed block of zeros, named by many arrays.
std::string manyArrays(int arrays, std::size_t points) {
    std::string zeros(points * sizeof(double), '\0');
    std::string packed(compressBound(zeros.size()), '\0');
    uLongf length = packed.size();
    compress2(reinterpret_cast<Bytef*>(packed.data()), &length,
              reinterpret_cast<const Bytef*>(zeros.data()), zeros.size(), 9);
    packed.resize(length);
    std::string block;
    for (const std::uint64_t word : {std::uint64_t{1}, std::uint64_t{zeros.size()},
                                     std::uint64_t{0}, std::uint64_t{packed.size()}}) {
        appendLittleEndian(word, block);
    }
    std::string text =
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
        "compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"" +
        std::to_string(points) + "\" NumberOfPolys=\"1\"><PointData>";
    for (int n = 0; n < arrays; ++n) {
        text += "<DataArray type=\"Float64\" Name=\"a\" format=\"appended\" offset=\"0\"/>";
    }
    text +=
        "</PointData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
        "format=\"ascii\">";
    for (std::size_t n = 0; n < points; ++n) text += "0 1 2 ";
    return text +
           "</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" "
           "format=\"ascii\">0 1 2</DataArray><DataArray type=\"Int64\" Name=\"offsets\" "
           "format=\"ascii\">3</DataArray></Polys></Piece></PolyData><AppendedData "
           "encoding=\"raw\">_" +
           block + packed + "</AppendedData></VTKFile>";
}

TEST(Counts, ArraysThatNameOneBlockAreCountedTogether) {
    const auto read = [](int arrays) {
        const std::string bytes = manyArrays(arrays, 2000);
        return decodeMesh(bytes, findMeshFormat("a.vtp"), "a.vtp", {.keepsPointArrays = true});
    };
    EXPECT_EQ(read(100).pointArrays.size(), 100U);
    const std::string message = messageOf<FileError>([&] { read(5000); });
    EXPECT_NE(message.find("decompression bomb"), std::string::npos) << message;
}

TEST(Counts, EqualNamesTakeNoLongerThanOthers) {
    // by ever more '_' they take some 10^11 steps
    constexpr int kArrays = 5000;
    MeshWriteOptions options;
    for (int n = 0; n < kArrays; ++n) {
        options.pointArrays.push_back({"x", std::vector<double>(4)});
    }
    const std::string bytes = written(testing::tetrahedron(), "a.ply", options);
    EXPECT_NE(bytes.find("double x_\n"), std::string::npos);
    EXPECT_NE(bytes.find("double x_1\n"), std::string::npos);
    EXPECT_EQ(decodeMesh(bytes, findMeshFormat("a.ply"), "a.ply", {.keepsPointArrays = true})
                  .pointArrays.size(),
              std::size_t{kArrays});
}

}  // namespace
}  // namespace adaptiso
