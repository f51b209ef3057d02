// Sound files as other programs write them.
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <bit>
#include <cstring>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso {
namespace {

using testing::decoded;
using testing::icosphere;
using testing::messageOf;
using testing::tetrahedron;
using testing::written;

TEST(StlFile, TextIsRead) {
    const MeshFile file = decoded(
        "solid made by CoordinateFrame: RAS mm\n"
        "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1e0 0 0\n  vertex -0 +1 0\n "
        "endloop\nendfacet\n"
        "facet normal 0 0 1\n outer loop\n  vertex 0 1 0\n  vertex 1 0 0\n  vertex 1 1 0\n "
        "endloop\nendfacet\n"
        "endsolid\n",
        "a.stl");
    EXPECT_EQ(file.mesh.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    EXPECT_EQ(file.frame, CoordinateFrame::Ras);
}

TEST(StlFile, TextMayBeginWithABlankLineAndBeInCapitals) {
    const std::string text =
        "SOLID vertex of CoordinateFrame: LPS mm\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\n"
        "VERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nENDSOLID vertex\n";
    for (const std::string& bytes : {text, "\n  " + text}) {
        const MeshFile file = decoded(bytes, "a.stl");
        EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
        EXPECT_EQ(file.frame, CoordinateFrame::Lps);
    }
}

TEST(StlFile, TextCutOffBetweenFacetsIsRefused) {
    const std::string facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        "endfacet\n";
    EXPECT_EQ(decoded("solid a\n" + facet + "endsolid a\nsolid b\n" + facet + "endsolid b", "a.stl")
                  .mesh.triangles.size(),
              2u);
    const std::string message =
        messageOf<FileError>([&] { decoded("solid a\n" + facet, "a.stl"); });
    EXPECT_NE(message.find("endsolid"), std::string::npos) << message;
}

TEST(StlFile, BinaryWhoseHeaderBeginsWithSolidIsRead) {
    std::string bytes = written(tetrahedron(), "a.stl");
    bytes.replace(0, 5, "solid");
    EXPECT_EQ(decoded(bytes, "a.stl").mesh.triangles.size(), 4u);
}

TEST(ObjFile, NegativeAndTextureIndicesAreRead) {
    const MeshFile file =
        decoded("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvt 0 0\nusemtl x\nf -3/1 -2/1 -1/1\n", "a.obj");
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(file.frame, std::nullopt);
}

TEST(ObjFile, NormalsAreDroppedWhereAVertexHasTwo) {
    const std::string common = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 1 0 0\n";
    const MeshFile creased = decoded(common + "f 1//1 2//1 3//1\nf 1//2 3//1 4//1\n", "a.obj");
    EXPECT_TRUE(creased.mesh.normals.empty());
    const MeshFile smooth = decoded(common + "f 1//1 2//1 3//1\nf 1//1 3//1 4//2\n", "a.obj");
    ASSERT_EQ(smooth.mesh.normals.size(), 4u);
    EXPECT_EQ(smooth.mesh.normals[0], (Normal{0, 0, 1}));  // scaled to length 1
    EXPECT_EQ(smooth.mesh.normals[3], (Normal{1, 0, 0}));
}

TEST(OffFile, CountsOnTheFirstLineAndColoursAreRead) {
    const MeshFile file = decoded(
        "OFF 3 1 0\n0 0 0\n\n1 0 0 # CoordinateFrame: LPS mm\n0 1 0\n3 0 1 2 255 0 0\n", "a.off");
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(file.frame, CoordinateFrame::Lps);
}

TEST(PlyFile, TextWithOtherElementsAndPropertiesIsRead) {
    const MeshFile file = decoded(
        "ply\nformat ascii 1.0\ncomment CoordinateFrame: tkRAS mm\nelement tag 2\nproperty list "
        "uchar int ids\n"
        "element vertex 3\nproperty uchar red\nproperty float x\nproperty float y\nproperty float "
        "z\n"
        "element face 1\nproperty list uchar uint vertex_index\nproperty uchar flag\nend_header\n"
        "2 7 8\n0\n9 0 0 0\n9 1.5 0 0\n9 0 1 0\n3 0 1 2 1\n",
        "a.ply");
    EXPECT_EQ(file.mesh.points[1], (Vec3{1.5, 0, 0}));
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(file.frame, CoordinateFrame::TkRas);
}

TEST(PlyFile, BigEndianFloatsAreRead) {
    std::string bytes =
        "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar short vertex_indices\nend_header\n";
    const std::string zero(4, '\0'), one("\x3F\x80\0\0", 4);
    bytes += zero + zero + zero + one + zero + zero + zero + one + zero;
    bytes += std::string("\x03\0\0\0\x01\0\x02", 7);
    const MeshFile file = decoded(bytes, "a.ply");
    EXPECT_EQ(file.mesh.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

void put(const std::filesystem::path& file, const std::string& bytes) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
}

/// A .surf of the tetrahedron as FreeSurfer writes it, without this library's words.
std::string freeSurferBytes(const std::string& footer) {
    const std::string ours =
        written(tetrahedron(), "ours.surf", {CoordinateFrame::Lps, std::nullopt, ""});
    const std::size_t counts = ours.find("\n\n") + 2;
    return "\xFF\xFF\xFE"
           "created by someone on some day\n\n" +
           ours.substr(counts, 8 + 96) + footer;
}

const std::string kGeometry =
    "valid = 1  # volume info valid\nfilename = ../mri/orig.mgz\nvolume = 256 256 256\n"
    "voxelsize = 1.0000 1.0000 1.0000\nxras   = -1.0000 0.0000 0.0000\n"
    "yras   = 0.0000 0.0000 -1.0000\nzras   = 0.0000 1.0000 0.0000\ncras   = 1.5000 -2.0000 "
    "3.0000\n";

TEST(FreeSurferFile, FreeSurfersOwnFooterGivesTheVolume) {
    const std::string tags("\0\0\0\x02\0\0\0\0\0\0\0\x14", 12);
    const std::string commandLine(
        "\0\0\0\x03\0\0\0\0\0\0\0\x04"
        "mris",
        16);
    const MeshFile file = decoded(freeSurferBytes(tags + kGeometry + commandLine), "lh.pial");
    EXPECT_EQ(file.frame, CoordinateFrame::TkRas);
    ASSERT_TRUE(file.volume.has_value());
    // the middle voxel (128, 128, 128) is at c_ras
    EXPECT_EQ(file.volume->toPhysical({128, 128, 128}), (Vec3{-1.5, 2, 3}));
    EXPECT_EQ(file.volume->indexToPhysical.column[2], (Vec3{0, -1, 0}));
}

TEST(FreeSurferFile, UseRealRasMeansScannerRas) {
    const std::string tags("\0\0\0\x02\0\0\0\x01\0\0\0\x14", 12);
    const MeshFile file = decoded(freeSurferBytes(tags + kGeometry), "lh.pial");
    EXPECT_EQ(file.frame, CoordinateFrame::Ras);
}

TEST(FreeSurferFile, NoFooterOrAnInvalidOneGivesNoVolume) {
    const MeshFile bare = decoded(freeSurferBytes(""), "lh.pial");
    EXPECT_EQ(bare.frame, CoordinateFrame::TkRas);
    EXPECT_EQ(bare.volume, std::nullopt);
    std::string invalid = std::string("\0\0\0\x14", 4) + kGeometry;
    invalid.replace(invalid.find("valid = 1"), 9, "valid = 0");
    EXPECT_EQ(decoded(freeSurferBytes(invalid), "lh.pial").volume, std::nullopt);
}

TEST(GiftiFile, TextArraysAndColumnOrderAreRead) {
    const std::string head =
        "<?xml version=\"1.0\"?><GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">";
    const auto array = [](const char* intent, const char* type, const char* order,
                          const char* data) {
        return std::string("<DataArray Intent=\"") + intent + "\" DataType=\"" + type +
               "\" ArrayIndexingOrder=\"" + order +
               "\" Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" "
               "Encoding=\"ASCII\"><CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_SCANNER_"
               "ANAT"
               "</DataSpace></CoordinateSystemTransformMatrix><Data>" +
               data + "</Data></DataArray>";
    };
    const MeshFile file = decoded(head +
                                      array("NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32",
                                            "ColumnMajorOrder", "0 1 0  0 0 1  5 5 5") +
                                      array("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32",
                                            "RowMajorOrder", "0 1 2 1 2 0 2 0 1") +
                                      "</GIFTI>",
                                  "a.gii");
    EXPECT_EQ(file.mesh.points, (std::vector<Vec3>{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}}));
    EXPECT_EQ(file.mesh.triangles[1], (Triangle{1, 2, 0}));
    EXPECT_EQ(file.frame, CoordinateFrame::Ras);
}

/// A triangle in GIFTI: what is said of its points before their data.
std::string giftiWith(const std::string& metadata, const std::string& ofPoints) {
    const auto array = [](const std::string& head, const std::string& inside) {
        return "<DataArray " + head +
               " ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim1=\"3\" "
               "Encoding=\"ASCII\">" +
               inside + "</Data></DataArray>";
    };
    return "<?xml version=\"1.0\"?><GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\"><MetaData>" +
           metadata + "</MetaData>" +
           array("Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" Dim0=\"3\"",
                 ofPoints + "<Data>1 0 0 0 2 0 0 0 3") +
           array("Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" Dim0=\"1\"",
                 "<Data>0 1 2") +
           "</GIFTI>";
}

std::string entry(const std::string& name, const std::string& value) {
    return "<MD><Name><![CDATA[" + name + "]]></Name><Value><![CDATA[" + value + "]]></Value></MD>";
}

std::string space(const std::string& data, const std::string& transformed,
                  const std::string& matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1") {
    return "<CoordinateSystemTransformMatrix><DataSpace><![CDATA[NIFTI_XFORM_" + data +
           "]]></DataSpace><TransformedSpace><![CDATA[NIFTI_XFORM_" + transformed +
           "]]></TransformedSpace><MatrixData>" + matrix +
           "</MatrixData></CoordinateSystemTransformMatrix>";
}

/// c_ras (5, -12, 7.5) of a volume stored as FreeSurfer stores volumes.
const std::string kCentre =
    entry("VolGeomC_R", "5") + entry("VolGeomC_A", "-12") + entry("VolGeomC_S", "7.5");
const std::string kAxes =
    entry("VolGeomX_R", "-1") + entry("VolGeomX_A", "0") + entry("VolGeomX_S", "0") +
    entry("VolGeomY_R", "0") + entry("VolGeomY_A", "0") + entry("VolGeomY_S", "-1") +
    entry("VolGeomZ_R", "0") + entry("VolGeomZ_A", "1") + entry("VolGeomZ_S", "0");

std::string metadataOf(const std::string& entries) {
    return "<MetaData>" + entries + "</MetaData>";
}

/// The points in scanner RAS.
std::vector<Vec3> rasPoints(const MeshFile& file) {
    return toFrame(fromFrame(file.mesh, *file.frame, file.volume), CoordinateFrame::Ras).points;
}

void expectNear(const std::vector<Vec3>& found, const std::vector<Vec3>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_LE(norm(found[i] - expected[i]), 1e-9) << i;  // sums at 100 mm
    }
}

TEST(GiftiFile, FreeSurfersPointsAreInTkRasOfVolGeom) {
    const std::vector<Vec3> expected{{6, -12, 7.5}, {5, -10, 7.5}, {5, -12, 10.5}};
    const std::string toScanner = "1 0 0 5 0 1 0 -12 0 0 1 7.5 0 0 0 1";
    for (const std::string& said :
         {metadataOf(kAxes + kCentre) +
              space("UNKNOWN", "TALAIRACH", "2 0 0 9 0 1 0 0 0 0 1 0 0 0 0 1"),
          metadataOf(kCentre),
          metadataOf(kAxes + kCentre) + space("UNKNOWN", "SCANNER_ANAT", toScanner)}) {
        const MeshFile file = decoded(giftiWith("", said), "lh.pial.gii");
        EXPECT_EQ(file.frame, CoordinateFrame::TkRas);
        ASSERT_TRUE(file.volume);
        expectNear(rasPoints(file), expected);
    }
    EXPECT_EQ(rasPoints(decoded(giftiWith(kAxes + kCentre, ""), "a.gii")).size(), 3u);
}

TEST(GiftiFile, VolGeomsAxesTurnThePoints) {
    // axes along R, A, S: tkRAS (x, y, z) is -x along R, -z along A, y along S
    const std::string axes =
        entry("VolGeomX_R", "1") + entry("VolGeomX_A", "0") + entry("VolGeomX_S", "0") +
        entry("VolGeomY_R", "0") + entry("VolGeomY_A", "1") + entry("VolGeomY_S", "0") +
        entry("VolGeomZ_R", "0") + entry("VolGeomZ_A", "0") + entry("VolGeomZ_S", "1") +
        entry("VolGeomWidth", "100") + entry("VolGeomXsize", "0.7");
    const MeshFile file = decoded(giftiWith("", metadataOf(axes + kCentre)), "a.gii");
    ASSERT_TRUE(file.volume);
    expectNear(rasPoints(file), {{4, -12, 7.5}, {5, -12, 9.5}, {5, -15, 7.5}});
}

TEST(GiftiFile, ShearedVolGeomIsNoVolume) {
    const std::string sheared = metadataOf(kAxes + entry("VolGeomX_A", "0.2") + kCentre);
    for (const std::string& said : {sheared, sheared + space("UNKNOWN", "SCANNER_ANAT")}) {
        const MeshFile file = decoded(giftiWith("", said), "a.gii");
        EXPECT_EQ(file.frame, CoordinateFrame::TkRas);
        EXPECT_FALSE(file.volume);
    }
}

TEST(GiftiFile, ScannerSpaceOutdoesVolGeom) {
    const MeshFile file = decoded(
        giftiWith("", metadataOf(kAxes + kCentre) + space("SCANNER_ANAT", "UNKNOWN")), "a.gii");
    EXPECT_EQ(file.frame, CoordinateFrame::Ras);
    EXPECT_EQ(file.mesh.points[0], (Vec3{1, 0, 0}));
}

TEST(GiftiFile, PointsOfNiftisSpacesAreInRas) {
    for (const char* data : {"SCANNER_ANAT", "ALIGNED_ANAT", "TALAIRACH", "MNI_152"}) {
        EXPECT_EQ(decoded(giftiWith("", space(data, data)), "a.gii").frame, CoordinateFrame::Ras);
    }
    EXPECT_EQ(decoded(giftiWith("", space("UNKNOWN", "UNKNOWN")), "a.gii").frame, std::nullopt);
    EXPECT_EQ(decoded(giftiWith("", space("UNKNOWN", "TALAIRACH")), "a.gii").frame, std::nullopt);
    EXPECT_EQ(decoded(giftiWith("", ""), "a.gii").frame, std::nullopt);
}

TEST(GiftiFile, MatrixToScannerSpaceIsApplied) {
    const std::string matrix = "0 2 0 10\n1 0 0 20\n0 0 1 30\n0 0 0 1";  // mirrors, and stretches
    const MeshFile file = decoded(giftiWith("", space("UNKNOWN", "SCANNER_ANAT", matrix)), "a.gii");
    EXPECT_EQ(file.frame, CoordinateFrame::Ras);
    EXPECT_EQ(file.mesh.points, (std::vector<Vec3>{{10, 21, 30}, {14, 20, 30}, {10, 20, 33}}));
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 2, 1}}));
    const std::string flat = "0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
    EXPECT_THROW(decoded(giftiWith("", space("UNKNOWN", "SCANNER_ANAT", flat)), "a.gii"),
                 FileError);
}

TEST(GiftiFile, FrameIsUnknownWhereVolGeomMayNotHold) {
    const std::string volume = metadataOf(kAxes + kCentre);
    // Connectome Workbench moves points and keeps metadata
    const std::string workbench = entry("ProgramProvenance", "Workbench\nVersion: 1.5.0");
    EXPECT_EQ(decoded(giftiWith(workbench, volume), "a.gii").frame, std::nullopt);
    const std::string elsewhere = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
    EXPECT_EQ(
        decoded(giftiWith("", volume + space("UNKNOWN", "SCANNER_ANAT", elsewhere)), "a.gii").frame,
        std::nullopt);
    const MeshFile noCentre = decoded(giftiWith("", metadataOf(kAxes)), "a.gii");
    EXPECT_EQ(noCentre.frame, CoordinateFrame::TkRas);
    EXPECT_FALSE(noCentre.volume);
}

/// `bytes` with `mark` in place of ours, as long as it.
std::string withMark(std::string bytes, std::string mark) {
    const std::string own = "CoordinateFrame: RAS mm, SPACE=RAS";
    mark.resize(own.size(), ' ');
    return bytes.replace(bytes.find(own), own.size(), mark);
}

TEST(SlicerMark, IsReadWithAndWithoutOurs) {
    for (const std::string name : {"a.stl", "a.ply", "a.obj", "a.vtk"}) {
        const std::string bytes = written(tetrahedron(), name);
        EXPECT_EQ(decoded(bytes, name).frame, CoordinateFrame::Ras) << name;
        EXPECT_EQ(decoded(withMark(bytes, "3D Slicer output. SPACE=LPS"), name).frame,
                  CoordinateFrame::Lps)
            << name;
        EXPECT_EQ(decoded(withMark(bytes, "SPACE=RAS"), name).frame, CoordinateFrame::Ras) << name;
        EXPECT_EQ(decoded(withMark(bytes, "CoordinateFrame: LPS mm"), name).frame,
                  CoordinateFrame::Lps)
            << name;
    }
    EXPECT_EQ(decoded("solid 3D Slicer output. SPACE=LPS\nfacet normal 0 0 1\nouter loop\n"
                      "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n",
                      "a.stl")
                  .frame,
              CoordinateFrame::Lps);
}

TEST(SlicerMark, ThatContradictsOursIsRefusedUnlessTheFrameIsStated) {
    for (const std::string name : {"a.stl", "a.ply", "a.obj", "a.vtk"}) {
        for (const char* mark : {"CoordinateFrame: RAS mm, SPACE=LPS", "SPACE=RAS SPACE=LPS",
                                 "CoordinateFrame: tkRAS mmSPACE=RAS"}) {
            const std::string bytes = withMark(written(tetrahedron(), name), mark);
            const std::string message = messageOf<FileError>([&] { decoded(bytes, name); });
            EXPECT_NE(message.find("two coordinate frames"), std::string::npos) << message;
            EXPECT_NE(message.find("--input-coordinates"), std::string::npos) << message;
            const MeshReadOptions stated{.inputCoordinates = CoordinateFrame::Voxel};
            EXPECT_EQ(decodeMesh(bytes, findMeshFormat(name), name, stated).frame,
                      CoordinateFrame::Voxel);
        }
    }
}

TEST(EveryFormat, TakesTheFrameThatIsStated) {
    for (const MeshFormat& format : meshFormats()) {
        const std::string name = testing::exampleName(format);
        for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps}) {
            const std::string bytes = written(tetrahedron(), name, {frame, std::nullopt, ""});
            for (const CoordinateFrame stated :
                 {CoordinateFrame::Ras, CoordinateFrame::Lps, CoordinateFrame::TkRas}) {
                const MeshFile file = decodeMesh(bytes, format, name, {.inputCoordinates = stated});
                EXPECT_EQ(file.frame, stated) << name;
                EXPECT_EQ(file.mesh.points, decoded(bytes, name).mesh.points) << name;
            }
        }
    }
}

/// The tetrahedron with its numbers in `name`, as SPM writes.
std::string externalGifti(const std::string& name) {
    const auto array = [&](const char* intent, const char* type, const char* rows, int offset) {
        return std::string("<DataArray Intent=\"NIFTI_INTENT_") + intent +
               "\" DataType=\"NIFTI_TYPE_" + type +
               "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"" + rows +
               "\" Dim1=\"3\" Encoding=\"ExternalFileBinary\" Endian=\"LittleEndian\" "
               "ExternalFileName=\"" +
               name + "\" ExternalFileOffset=\"" + std::to_string(offset) +
               "\"><Data></Data></DataArray>";
    };
    return "<?xml version=\"1.0\"?><GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">" +
           array("POINTSET", "FLOAT32", "4", 0) + array("TRIANGLE", "INT32", "4", 48) + "</GIFTI>";
}

std::string externalBytes() {
    std::string bytes;
    const auto add = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    };
    for (const Vec3& p : tetrahedron().points) {
        for (int axis = 0; axis < 3; ++axis) add(static_cast<float>(p[axis]));
    }
    for (const Triangle& t : tetrahedron().triangles) {
        for (const VertexId v : t) add(static_cast<std::int32_t>(v));
    }
    return bytes;
}

TEST(GiftiFile, ExternalDataOfItsFolderAreRead) {
    const auto file = testing::temporaryFile("a.surf.gii");
    put(file.parent_path() / "a.dat", externalBytes());
    put(file, externalGifti("a.dat"));
    const TriangleMesh mesh = readMesh(file).mesh;
    EXPECT_EQ(mesh.points, tetrahedron().points);
    EXPECT_EQ(mesh.triangles, tetrahedron().triangles);

    put(file.parent_path() / "a.dat", externalBytes().substr(0, 90));
    EXPECT_THROW(readMesh(file), FileError);
}

TEST(GiftiFile, ExternalDataElsewhereAreNeverOpened) {
    const auto file = testing::temporaryFile("a.surf.gii");
    const auto folder = file.parent_path();
    put(folder / "in" / "a.dat", externalBytes());
    std::filesystem::remove(folder / "link.dat");
    std::filesystem::create_symlink("in/a.dat", folder / "link.dat");
    for (const std::string& name :
         {std::string("../a.dat"), (folder / "in" / "a.dat").string(), std::string("in/a.dat"),
          std::string("link.dat"), std::string(".."), std::string()}) {
        put(file, externalGifti(name));
        const std::string message = messageOf<FileError>([&] { readMesh(file); });
        EXPECT_NE(message.find("save it as GZipBase64Binary"), std::string::npos) << message;
    }
    const std::string message =
        messageOf<FileError>([&] { decoded(externalGifti("a.dat"), "a.gii"); });
    EXPECT_EQ(message,
              "a.gii: its points lie in another file, 'a.dat' (ExternalFileBinary); save it as "
              "GZipBase64Binary, all in one file");
}

TEST(GiftiFile, OfValuesAloneIsToldFromASurface) {
    const std::string message = messageOf<FileError>([] {
        decoded("<GIFTI Version=\"1.0\"><DataArray Intent=\"NIFTI_INTENT_SHAPE\"/></GIFTI>",
                "a.gii");
    });
    EXPECT_EQ(message,
              "a.gii: it holds values at points (NIFTI_INTENT_SHAPE), no surface; give the surface "
              "with its points and triangles (.surf.gii)");
}

TEST(GiftiFile, EntitiesAreRefused) {
    std::string bytes = written(tetrahedron(), "a.gii");
    const std::string type =
        "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">";
    const std::size_t at = bytes.find(type);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(
        at, type.size(),
        "<!DOCTYPE GIFTI [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b SYSTEM \"/etc/passwd\">]>");
    const std::string message = messageOf<FileError>([&] { decoded(bytes, "a.gii"); });
    EXPECT_NE(message.find("entities"), std::string::npos) << message;
}

/// Something of everything that VTK puts into files beside a surface.
vtkSmartPointer<vtkPolyData> decoratedPolyData(const TriangleMesh& mesh) {
    auto data = toVtkPolyData(mesh);
    const auto addArray = [&](vtkFieldData* to, const char* name, int components,
                              vtkIdType tuples) {
        vtkNew<vtkFloatArray> array;
        array->SetName(name);
        array->SetNumberOfComponents(components);
        array->SetNumberOfTuples(tuples);
        array->Fill(1.5);
        array->SetComponentName(0, "first");  // written as METADATA
        to->AddArray(array);
    };
    addArray(data->GetPointData(), "curvature", 1, data->GetNumberOfPoints());
    addArray(data->GetPointData(), "flow", 3, data->GetNumberOfPoints());
    addArray(data->GetCellData(), "quality", 2, data->GetNumberOfCells());
    data->GetPointData()->SetActiveScalars("curvature");
    data->GetPointData()->SetActiveVectors("flow");
    addArray(data->GetFieldData(), "numbers", 1, 5);
    vtkNew<vtkStringArray> strings;
    strings->SetName("words");
    strings->InsertNextValue("short");
    strings->InsertNextValue(std::string(1000, 'x'));  // a length of two bytes in legacy files
    data->GetFieldData()->AddArray(strings);
    return data;
}

TEST(VtkLegacyFile, EveryVariantThatVtkWritesIsRead) {
    const TriangleMesh sphere = icosphere(1);
    for (const int version : {vtkDataWriter::VTK_LEGACY_READER_VERSION_4_2,
                              vtkDataWriter::VTK_LEGACY_READER_VERSION_5_1}) {
        for (const bool isBinary : {false, true}) {
            vtkNew<vtkPolyDataWriter> writer;
            writer->SetInputData(decoratedPolyData(sphere));
            writer->SetFileVersion(version);
            isBinary ? writer->SetFileTypeToBinary() : writer->SetFileTypeToASCII();
            writer->WriteToOutputStringOn();
            ASSERT_EQ(writer->Write(), 1);
            const MeshFile file = decoded(writer->GetOutputStdString(), "a.vtk");
            EXPECT_EQ(file.mesh.triangles, sphere.triangles) << version << isBinary;
            EXPECT_EQ(file.mesh.normals.size(), sphere.normals.size()) << version << isBinary;
            ASSERT_EQ(file.mesh.points.size(), sphere.points.size());
            for (std::size_t i = 0; i < sphere.points.size(); ++i) {
                // VTK's text has six digits or more
                EXPECT_LE(norm(file.mesh.points[i] - sphere.points[i]), isBinary ? 0 : 1e-5);
            }
            EXPECT_EQ(file.frame, std::nullopt);
        }
    }
}

/// A surface with field data as VTK's programs have them.
vtkSmartPointer<vtkPolyData> withFields(
    const std::vector<std::pair<const char*, const char*>>& fields) {
    auto data = toVtkPolyData(tetrahedron());
    for (const auto& [name, text] : fields) {
        vtkNew<vtkStringArray> array;
        array->SetName(name);
        array->InsertNextValue(text);
        data->GetFieldData()->AddArray(array);
    }
    return data;
}

TEST(VtkXmlFile, FrameIsThatOfItsFields) {
    for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Appended}) {
        const auto bytes = [&](const std::vector<std::pair<const char*, const char*>>& fields) {
            vtkNew<vtkXMLPolyDataWriter> writer;
            writer->SetInputData(withFields(fields));
            writer->SetDataMode(mode);
            writer->WriteToOutputStringOn();
            writer->Write();
            return writer->GetOutputString();
        };
        const auto frameOf = [&](const auto& fields) {
            return decoded(bytes(fields), "a.vtp").frame;
        };
        using Fields = std::vector<std::pair<const char*, const char*>>;
        EXPECT_EQ(frameOf(Fields{{"SPACE", "LPS"}}), CoordinateFrame::Lps);
        EXPECT_EQ(frameOf(Fields{{"SPACE", "RAS"}}), CoordinateFrame::Ras);
        EXPECT_EQ(frameOf(Fields{{"SPACE", "outer"}}), std::nullopt);
        EXPECT_EQ(frameOf(Fields{{"SPACE", "LPS"}, {"CoordinateFrame", "LPS mm"}}),
                  CoordinateFrame::Lps);
        EXPECT_THROW(frameOf(Fields{{"SPACE", "LPS"}, {"CoordinateFrame", "RAS mm"}}), FileError);
    }
}

TEST(VtkLegacyFile, FrameIsThatOfItsHeaderElseOfItsFields) {
    for (const bool isBinary : {false, true}) {
        const auto frameOf = [&](const char* header, const char* field, const char* name) {
            vtkNew<vtkPolyDataWriter> writer;
            writer->SetInputData(withFields({{field, name}}));
            writer->SetHeader(header);
            isBinary ? writer->SetFileTypeToBinary() : writer->SetFileTypeToASCII();
            writer->WriteToOutputStringOn();
            writer->Write();
            return decoded(writer->GetOutputStdString(), "a.vtk").frame;
        };
        EXPECT_EQ(frameOf("vtk output", "CoordinateFrame", "LPS mm"), CoordinateFrame::Lps);
        EXPECT_EQ(frameOf("vtk output", "SPACE", "RAS"), CoordinateFrame::Ras);
        // 3D Slicer keeps the fields of a file that it has turned to LPS
        EXPECT_EQ(frameOf("3D Slicer output. SPACE=LPS", "CoordinateFrame", "RAS mm"),
                  CoordinateFrame::Lps);
    }
}

TEST(VtkXmlFile, EveryVariantThatVtkWritesIsRead) {
    const TriangleMesh sphere = icosphere(1);
    for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
        for (const bool isEncoded : {false, true}) {
            for (const bool isCompressed : {false, true}) {
                for (const bool isWide : {false, true}) {
                    for (const bool isBig : {false, true}) {
                        vtkNew<vtkXMLPolyDataWriter> writer;
                        writer->SetInputData(decoratedPolyData(sphere));
                        writer->SetDataMode(mode);
                        writer->SetEncodeAppendedData(isEncoded);
                        if (!isCompressed) writer->SetCompressorTypeToNone();
                        writer->SetBlockSize(1024);  // several blocks an array
                        isWide ? writer->SetHeaderTypeToUInt64() : writer->SetHeaderTypeToUInt32();
                        isBig ? writer->SetByteOrderToBigEndian()
                              : writer->SetByteOrderToLittleEndian();
                        writer->WriteToOutputStringOn();
                        ASSERT_EQ(writer->Write(), 1);
                        const MeshFile file = decoded(writer->GetOutputString(), "a.vtp");
                        const auto where = ::testing::Message()
                                           << mode << isEncoded << isCompressed << isWide << isBig;
                        EXPECT_EQ(file.mesh.triangles, sphere.triangles) << where;
                        EXPECT_EQ(file.mesh.normals.size(), sphere.normals.size()) << where;
                        ASSERT_EQ(file.mesh.points.size(), sphere.points.size()) << where;
                        for (std::size_t i = 0; i < sphere.points.size(); ++i) {
                            // VTK's text of a double is good to 1e-10 at least
                            EXPECT_LE(norm(file.mesh.points[i] - sphere.points[i]), 1e-10) << where;
                        }
                    }
                }
            }
        }
    }
}

TEST(VtkXmlFile, OtherCompressorsAreNamed) {
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(toVtkPolyData(tetrahedron()));
    writer->SetCompressorTypeToLZ4();
    writer->WriteToOutputStringOn();
    ASSERT_EQ(writer->Write(), 1);
    const std::string bytes = writer->GetOutputString();
    const std::string message = messageOf<FileError>([&] { decoded(bytes, "a.vtp"); });
    EXPECT_NE(message.find("vtkLZ4DataCompressor"), std::string::npos) << message;
}

}  // namespace
}  // namespace adaptiso
