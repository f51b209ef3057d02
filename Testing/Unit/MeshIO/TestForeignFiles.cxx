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

TEST(Polygons, AreRefusedWithAWayOut) {
    const std::string quad = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    const std::string plyHead =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const std::pair<const char*, std::string> files[] = {
        {"a.off", "OFF\n4 1 0\n" + quad + "4 0 1 2 3\n"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"},
        {"a.ply", plyHead + quad + "4 0 1 2 3\n"},
        {"a.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n" + quad +
                      "POLYGONS 1 5\n4 0 1 2 3\n"},
    };
    for (const auto& [name, bytes] : files) {
        const std::string message = messageOf<FileError>([&] { decoded(bytes, name); });
        EXPECT_EQ(
            message,
            std::string(name) +
                ": it has a polygon of 4 corners; only triangles are read: triangulate it first");
    }
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

TEST(FreeSurferFile, QuadrangleFilesAreNamedAsSuch) {
    const std::string message = messageOf<FileError>([] {
        decoded(
            "\xFF\xFF\xFF"
            "abc",
            "lh.pial");
    });
    EXPECT_NE(message.find("mris_convert"), std::string::npos) << message;
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

TEST(GiftiFile, ExternalFilesAreNeverOpened) {
    std::string bytes = written(tetrahedron(), "a.gii");
    const std::string packed = "GZipBase64Binary";
    bytes.replace(bytes.find(packed), packed.size(), "ExternalFileBinary");
    const std::string message = messageOf<FileError>([&] { decoded(bytes, "a.gii"); });
    EXPECT_NE(message.find("ExternalFileBinary"), std::string::npos) << message;
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
