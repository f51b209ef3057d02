// Known small files, byte by byte.
#include <gtest/gtest.h>

#include <cstring>

#include "MeshIOTestSupport.h"

namespace adaptiso {
namespace {

using testing::decoded;
using testing::icosphere;
using testing::mirroredVolume;
using testing::straightVolume;
using testing::tetrahedron;
using testing::written;

const MeshWriteOptions kLps{CoordinateFrame::Lps, std::nullopt, ""};

TEST(ObjFile, IsThisText) {
    TriangleMesh mesh = tetrahedron();
    EXPECT_EQ(written(mesh, "a.obj", kLps),
              "# adaptiso surface, CoordinateFrame: LPS mm, SPACE=LPS\n"
              "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n"
              "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    mesh.normals.assign(4, {0, 0, 1});
    EXPECT_EQ(written(mesh, "n.obj", kLps),
              "# adaptiso surface, CoordinateFrame: LPS mm, SPACE=LPS\n"
              "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\n"
              "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n"
              "f 1//1 3//3 2//2\nf 1//1 2//2 4//4\nf 1//1 4//4 3//3\nf 2//2 3//3 4//4\n");
}

TEST(OffFile, IsThisText) {
    EXPECT_EQ(written(tetrahedron(), "a.off", kLps),
              "OFF\n# adaptiso surface, CoordinateFrame: LPS mm\n4 4 0\n"
              "0 0 0\n1 0 0\n0 2 0\n0 0 3\n"
              "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
}

TEST(OpenMeegFile, IsThisText) {
    TriangleMesh mesh = tetrahedron();
    mesh.normals = {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    EXPECT_EQ(written(mesh, "a.tri", kLps),
              "- 4\n0 0 0 0 0 -1\n1 0 0 1 0 0\n0 2 0 0 1 0\n0 0 3 0 0 1\n"
              "- 4 4 4\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n");
}

TEST(TextFile, HasNineSignificantDigitsAndNoMinusZero) {
    TriangleMesh mesh = tetrahedron();
    mesh.points[1] = {100.0 / 3, -0.0, 1e-20};
    const std::string text = written(mesh, "a.off", kLps);
    EXPECT_NE(text.find("\n33.3333333 0 1e-20\n"), std::string::npos) << text;
}

TEST(StlFile, HasHeaderCountAndFiftyBytesATriangle) {
    const std::string bytes = written(tetrahedron(), "a.stl", kLps);
    ASSERT_EQ(bytes.size(), 84u + 50u * 4u);
    EXPECT_FALSE(bytes.starts_with("solid"));
    EXPECT_TRUE(bytes.starts_with("adaptiso surface, CoordinateFrame: LPS mm, SPACE=LPS "));
    EXPECT_EQ(bytes.substr(80, 4), std::string("\x04\0\0\0", 4));
    // triangle 0: points 0, 2, 1 in the plane z = 0, seen from below
    const float expected[12] = {0, 0, -1, 0, 0, 0, 0, 2, 0, 1, 0, 0};
    float found[12];
    std::memcpy(found, bytes.data() + 84, sizeof(found));
    for (int i = 0; i < 12; ++i) EXPECT_EQ(found[i], expected[i]) << i;
    EXPECT_EQ(bytes.substr(84 + 48, 2), std::string(2, '\0'));
}

TEST(PlyFile, HasDoublesFloatNormalsAndInt32Triangles) {
    TriangleMesh mesh = tetrahedron();
    const std::string header =
        "ply\nformat binary_little_endian 1.0\n"
        "comment adaptiso surface, CoordinateFrame: LPS mm, SPACE=LPS\n"
        "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n";
    const std::string faces =
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    const std::string bytes = written(mesh, "a.ply", kLps);
    ASSERT_EQ(bytes.size(), header.size() + faces.size() + 4 * 24 + 4 * 13);
    EXPECT_TRUE(bytes.starts_with(header + faces));
    EXPECT_EQ(bytes.substr(bytes.size() - 13),
              std::string("\x03\x01\0\0\0\x02\0\0\0\x03\0\0\0", 13));

    mesh.normals.assign(4, {0, 0, 1});
    EXPECT_EQ(
        written(mesh, "n.ply", kLps).size(),
        header.size() + 3 * std::strlen("property float nx\n") + faces.size() + 4 * 36 + 4 * 13);
}

/// Footer of the file, from tag 2 on.
std::string footerOf(const std::string& bytes) {
    const std::size_t begin = bytes.find("\n\n") + 2 + 8 + 4 * 12 + 4 * 12;
    return bytes.substr(begin);
}

TEST(FreeSurferFile, HasMagicCommentCountsBigEndianNumbersAndFooter) {
    const std::string bytes =
        written(tetrahedron(), "a.surf", {CoordinateFrame::TkRas, straightVolume(), "T1.mgz"});
    const std::string head =
        "\xFF\xFF\xFE"
        "adaptiso surface, CoordinateFrame: tkRAS mm\n\n";
    ASSERT_TRUE(bytes.starts_with(head + std::string("\0\0\0\x04\0\0\0\x04", 8)));
    // point 0, LPS (0, 0, 0), is voxel (5, 10, 15): tkRAS (0, 0, 0); point 1 is voxel (6, 10, 15)
    const std::string minusOne("\xBF\x80\0\0", 4);  // -1.0f
    EXPECT_EQ(bytes.substr(head.size() + 8, 24),
              std::string(12, '\0') + minusOne + std::string(8, '\0'));
    // tkRAS of this volume is mirrored: triangle 0, (0, 2, 1), is turned round
    EXPECT_EQ(bytes.substr(head.size() + 8 + 48, 12),
              std::string("\0\0\0\0\0\0\0\x01\0\0\0\x02", 12));
    EXPECT_EQ(footerOf(bytes), std::string("\0\0\0\x02\0\0\0\0\0\0\0\x14", 12) +
                                   "valid = 1  # volume info valid\n"
                                   "filename = T1.mgz\n"
                                   "volume = 10 20 30\n"
                                   "voxelsize = 1 2 3\n"
                                   "xras   = -1 0 0\n"
                                   "yras   = 0 -1 0\n"
                                   "zras   = 0 0 1\n"
                                   "cras   = 0 0 0\n");
}

TEST(FreeSurferFile, RasAndLpsFootersMakeTkRasTheFrameItself) {
    const std::string common = std::string("\0\0\0\x02\0\0\0\0\0\0\0\x14", 12) +
                               "valid = 1  # volume info valid\nfilename = unknown\n"
                               "volume = 256 256 256\nvoxelsize = 1 1 1\n";
    EXPECT_EQ(footerOf(written(tetrahedron(), "r.surf",
                               {CoordinateFrame::Ras, straightVolume(), "T1.mgz"})),
              common + "xras   = -1 0 0\nyras   = 0 0 -1\nzras   = 0 1 0\ncras   = 0 0 0\n");
    EXPECT_EQ(footerOf(written(tetrahedron(), "l.surf", {CoordinateFrame::Lps, std::nullopt, ""})),
              common + "xras   = 1 0 0\nyras   = 0 0 -1\nzras   = 0 -1 0\ncras   = 0 0 0\n");
}

TEST(GiftiFile, SaysItsFrameTwiceAndHoldsTwoArrays) {
    const std::string ras = written(icosphere(1), "a.gii", {});
    EXPECT_NE(ras.find("NumberOfDataArrays=\"2\""), std::string::npos);
    EXPECT_NE(ras.find("<DataSpace><![CDATA[NIFTI_XFORM_SCANNER_ANAT]]>"), std::string::npos);
    EXPECT_NE(ras.find("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"), std::string::npos);
    EXPECT_NE(ras.find("<Value><![CDATA[RAS mm]]></Value>"), std::string::npos);

    const std::string voxels =
        written(icosphere(1), "v.gii", {CoordinateFrame::Voxel, straightVolume(), ""});
    EXPECT_NE(voxels.find("<DataSpace><![CDATA[NIFTI_XFORM_UNKNOWN]]>"), std::string::npos);
    // voxel -> RAS of 1 x 2 x 3 mm voxels along L, P, S from (-5, -20, -45) LPS
    EXPECT_NE(voxels.find("-1 0 0 5\n0 -2 0 20\n0 0 3 -45\n0 0 0 1\n"), std::string::npos)
        << voxels;
}

TEST(VtkFiles, SayFrameAndVersion) {
    const std::string xml = written(icosphere(1), "a.vtp", {});
    EXPECT_NE(xml.find("Name=\"CoordinateFrame\""), std::string::npos);
    EXPECT_NE(xml.find("Name=\"AdaptisoSurfaceVersion\""), std::string::npos);
    EXPECT_NE(xml.find("vtkZLibDataCompressor"), std::string::npos);
    const std::string legacy = written(icosphere(1), "a.vtk", {});
    EXPECT_TRUE(
        legacy.starts_with("# vtk DataFile Version 4.2\n"
                           "adaptiso surface, CoordinateFrame: RAS mm, SPACE=RAS\nBINARY\n"));
}

TEST(GiftiFile, TkRasSaysItsVolumeAsFreeSurferDoes) {
    const std::string text =
        written(tetrahedron(), "t.gii", {CoordinateFrame::TkRas, straightVolume(), "T1.mgz"});
    const std::pair<const char*, const char*> expected[] = {
        {"Fname", "T1.mgz"}, {"Width", "10"}, {"Height", "20"}, {"Depth", "30"}, {"Xsize", "1"},
        {"Ysize", "2"},      {"Zsize", "3"},  {"X_R", "-1"},    {"X_A", "0"},    {"X_S", "0"},
        {"Y_R", "0"},        {"Y_A", "-1"},   {"Y_S", "0"},     {"Z_R", "0"},    {"Z_A", "0"},
        {"Z_S", "1"},        {"C_R", "0"},    {"C_A", "0"},     {"C_S", "0"}};
    for (const auto& [key, value] : expected) {
        const std::string entry = std::string("<MD><Name><![CDATA[VolGeom") + key +
                                  "]]></Name><Value><![CDATA[" + value + "]]></Value></MD>";
        EXPECT_NE(text.find(entry), std::string::npos) << entry;
    }
    for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Voxel}) {
        const std::string other = written(tetrahedron(), "r.gii", {frame, straightVolume(), ""});
        EXPECT_EQ(other.find("VolGeom"), std::string::npos) << toString(frame);
    }
}

/// 3D Slicer takes a surface without its mark for LPS, and one with it for what it says.
TEST(SlicerMark, IsThereForRasAndLpsAlone) {
    for (const std::string name : {"a.stl", "a.ply", "a.obj", "a.vtk", "a.vtp"}) {
        for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps,
                                            CoordinateFrame::TkRas, CoordinateFrame::Voxel}) {
            MeshWriteOptions options{frame, straightVolume(), ""};
            const std::string mark =
                name == "a.vtp" ? "Name=\"SPACE\"" : "SPACE=" + std::string(slicerName(frame));
            const bool isKnown = !slicerName(frame).empty();
            const std::string bytes = written(tetrahedron(), name, options);
            EXPECT_EQ(bytes.find(mark) != std::string::npos, isKnown) << name << toString(frame);
            EXPECT_EQ(bytes.find("SPACE") != std::string::npos, isKnown) << name << toString(frame);
            options.saysFrame = false;
            EXPECT_EQ(written(tetrahedron(), name, options).find("SPACE"), std::string::npos);
        }
    }
    EXPECT_EQ(slicerMarker(CoordinateFrame::Ras), "SPACE=RAS");
    EXPECT_EQ(slicerMarker(CoordinateFrame::Lps), "SPACE=LPS");
}

TEST(VtkFiles, HoldValuesAtPoints) {
    const std::size_t count = icosphere(1).points.size();
    MeshWriteOptions options;
    options.pointArrays = {{"Depth", std::vector<double>(count, 0.5)},
                           {"Shade", std::vector<Color>(count, Color{1, 2, 3})}};
    const std::string xml = written(icosphere(1), "a.vtp", options);
    EXPECT_NE(xml.find("Scalars=\"Depth\""), std::string::npos);
    EXPECT_NE(xml.find("type=\"UInt8\" Name=\"Shade\" NumberOfComponents=\"3\""),
              std::string::npos);
    // beside the mesh: what is read is what was written without them
    const MeshFormat format = findMeshFormat("a.vtp");
    EXPECT_EQ(decodeMesh(xml, format, "a").mesh,
              decodeMesh(written(icosphere(1), "b.vtp", {}), format, "b").mesh);
}

TEST(EveryFile, NamesNoUserHostFolderOrDate) {
    for (const MeshFormat& format : meshFormats()) {
        const std::string name = testing::exampleName(format);
        const std::string bytes =
            written(icosphere(1), name, {CoordinateFrame::Lps, std::nullopt, ""});
        for (const char* word : {"/tmp", "/home", "/root", "root", "user", "created", "202"}) {
            if (format.holdsNormals && std::string_view(word) == "202")
                continue;  // digits of numbers
            EXPECT_EQ(bytes.find(word), std::string::npos) << name << " holds " << word;
        }
    }
}

}  // namespace
}  // namespace adaptiso
