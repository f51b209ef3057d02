// Surfaces are recognised by content; what is no surface is named.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using testing::exampleName;
using testing::icosphere;
using testing::messageOf;
using testing::nameOfFormat;
using testing::temporaryFile;
using testing::tetrahedron;
using testing::written;
using namespace std::string_literals;

std::filesystem::path put(const std::string& name, const std::string& bytes) {
    const auto file = temporaryFile(name);
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
}

std::string gzipped(const std::string& bytes) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY),
              Z_OK);
    std::string packed(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

std::string refusalOf(const std::string& name, const std::string& bytes) {
    const auto file = put(name, bytes);
    std::string message = messageOf<FileError>([&] { readMesh(file); });
    const std::string prefix = file.string() + ": ";
    EXPECT_TRUE(message.starts_with(prefix)) << message;
    return message.substr(std::min(prefix.size(), message.size()));
}

class RecognizedFormat : public ::testing::TestWithParam<int> {
protected:
    const MeshFormat& format() const { return meshFormats()[GetParam()]; }
    std::string bytes() const {
        return written(icosphere(2, {5, 6, 7}, 80), exampleName(format()),
                       {CoordinateFrame::Lps, std::nullopt, ""});
    }
};

TEST_P(RecognizedFormat, IsReadByContentUnderAnyName) {
    for (const std::string name : {"lh.pial.T1", "sample_outer_skin_surface", "x.stl", "x.ply",
                                   "x.obj", "x.surf", "x.txt", "x.nii"}) {
        const MeshFile file = readMesh(put(name, bytes()));
        EXPECT_EQ(file.format, &format()) << name;
        EXPECT_EQ(file.mesh.triangles.size(), 320u) << name;
    }
}

TEST_P(RecognizedFormat, IsReadFromGzip) {
    for (const std::string& name : {exampleName(format()) + ".gz", "x"s, "x.ply"s}) {
        const MeshFile file = readMesh(put(name, gzipped(bytes())));
        EXPECT_EQ(file.format, &format()) << name;
        EXPECT_EQ(file.mesh.triangles.size(), 320u) << name;
    }
    const std::string packed = gzipped(bytes());
    EXPECT_NE(refusalOf("cut.gz", packed.substr(0, packed.size() / 2)).find("break off"),
              std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, RecognizedFormat,
                         ::testing::Range(0, static_cast<int>(meshFormats().size())), nameOfFormat);

TEST(Recognition, TakesTheExtensionWhereContentDoesNotTell) {
    EXPECT_EQ(readMesh(put("x.obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n")).format->name,
              "Wavefront OBJ");
    const std::string stl = written(tetrahedron(), "a.stl");
    EXPECT_NE(refusalOf("x.stl", stl.substr(0, 200)).find("cut off"), std::string::npos);
    EXPECT_NE(refusalOf("x.T1", "something").find("no surface format has the extension '.t1'"),
              std::string::npos);
}

TEST(Recognition, TellsImagesFromSurfaces) {
    std::string nifti1(352, '\0'), nifti2(544, '\0'), mgh(300, '\0'), dicom(200, '\0');
    nifti1.replace(0, 4, "\x5C\1\0\0"s).replace(344, 4, "n+1\0"s);
    nifti2.replace(0, 4, "\x1C\2\0\0"s).replace(4, 4, "n+2\0"s);
    mgh.replace(0, 8, "\0\0\0\1\0\0\0\4"s);
    dicom.replace(128, 4, "DICM");
    for (const std::string& bytes : {nifti1, nifti2, mgh, dicom, "NRRD0004\ntype: short\n"s,
                                     "ObjectType = Image\nNDims = 3\n"s}) {
        for (const std::string name : {"x.nii", "x.stl", "x"}) {
            EXPECT_EQ(refusalOf(name, bytes),
                      "this is an image, not a surface; adaptiso-mesh makes surfaces of images");
        }
        EXPECT_EQ(refusalOf("x.nii.gz", gzipped(bytes)),
                  "this is an image, not a surface; adaptiso-mesh makes surfaces of images");
    }
    nifti2.replace(504, 4, "\xB8\x0B\0\0"s);
    EXPECT_EQ(refusalOf("x.dscalar.nii", nifti2),
              "is CIFTI: values at points of surfaces, no volume and no surface; take volumes and "
              "values out of it with wb_command -cifti-separate");
}

TEST(Recognition, NamesSurfacesOfOtherFormats) {
    const std::pair<std::string, const char*> files[] = {
        {"P 0.3 0.3 0.4 10 1 3\n0 0 0\n1 0 0\n0 1 0\n", "a surface of MNI (BIC .obj"},
        {"\xFF\xFF\xFF\0\0\0\1\0\0\0\2\0\0\0\1\0\0\0\0"s, "values at points (curv), no surface"},
        {"#!ascii version of lh.pial\n3 1\n", "FreeSurfer's text (.asc)"},
        {"binarDCBA\7\0\0\0"s, "is a BrainVISA mesh"},
        {"$MeshFormat\n2.2 0 8\n", "is a gmsh mesh"},
        {"<?xml version=\"1.0\"?>\n<COLLADA>", "an XML scene of another format"},
        {"\xFF\xFEs\0o\0"s, "text in UTF-16"},
        {"version https://git-lfs.github.com/spec/v1\noid sha256:ab\nsize 7\n", "git lfs pull"},
        {"PK\3\4 and more", "is a zip archive"},
        {"<!DOCTYPE html><html>", "is a web page"},
        {std::string(3000, '\0'), "holds zeros alone"},
        {"", "is an empty file"},
    };
    for (const auto& [bytes, words] : files) {
        for (const std::string name : {"x.obj", "x.stl", "x.surf", "x"}) {
            const std::string message = refusalOf(name, bytes);
            EXPECT_NE(message.find(words), std::string::npos) << name << ": " << message;
            EXPECT_EQ(message.find("cut off"), std::string::npos) << message;
        }
    }
    std::filesystem::create_symlink("../.git/annex/objects/a/MD5E-s12--c.stl",
                                    temporaryFile("link.stl"));
    EXPECT_NE(messageOf<FileError>([] {
                  readMesh(temporaryFile("x").parent_path() / "link.stl");
              }).find("git annex get link.stl"),
              std::string::npos);
}

TEST(Recognition, NamesDatasetsOfVtkThatAreNoPolyData) {
    EXPECT_EQ(
        refusalOf("x.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\n"),
        "it is not a PolyData but 'UNSTRUCTURED_GRID'; save the surface as PolyData, e.g. with "
        "ParaView's Extract Surface");
    EXPECT_EQ(
        refusalOf("x.vtu", "<VTKFile type=\"UnstructuredGrid\">"),
        "it is not a PolyData but 'UnstructuredGrid'; save the surface as PolyData, e.g. with "
        "ParaView's Extract Surface");
}

// dialects

constexpr const char* kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";

MeshFile decodedAs(const std::string& name, const std::string& bytes) {
    return decodeMesh(bytes, name);
}

/// `text` with `to` in place of every `from`.
std::string replacedAll(std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
    return text;
}

const std::vector<Vec3> kCorners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}};
const std::vector<Triangle> kTwo{{0, 1, 2}, {0, 2, 3}};

void expectTwoTriangles(const std::string& name, const std::string& bytes) {
    const MeshFile file = decodedAs(name, bytes);
    EXPECT_EQ(file.mesh.points, kCorners) << bytes;
    EXPECT_EQ(file.mesh.triangles, kTwo) << bytes;
}

TEST(PlyDialects, RowsMayHoldMoreNumbersThanDeclaredOrBeBroken) {
    const std::string head = kPlyHead;
    for (const std::string body :
         {"0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n3 0 1 2\n3 0 2 3\n",
          "0 0 0 9 9\n1 0 0\n1 1 0 7\n0 1 0.5\n3 0 1 2 6 0 0 1 0 0 1\n3 0 2 3 255 255 255 255\n",
          "0 0 0\n\n1 0 0\n\n\n1 1 0\n0 1 0.5\n\n3 0 1 2\n3 0 2 3",
          "0 0\n0 1\n0 0\n1 1 0\n0 1 0.5 3 0 1 2 3 0 2 3",
          "0 0 0 1 0 0 1 1 0 0 1 0.5 3 0 1 2 3 0 2 3\n",
          "\t0\t0 0 \n 1 0 0\n1 1 0\n0 1 .5\n3 0 1 2\n3 0 2 3\n",
          "0 0 0\n1 0 0\n1 1 0\n0 1 5.0D-01\n3.0 0 1.0 2\n3 0 2 3.000e0\n"}) {
        expectTwoTriangles("x.ply", head + body);
        expectTwoTriangles("x.ply", replacedAll(head + body, "\n", "\r\n"));
        expectTwoTriangles("x.ply", replacedAll(head + body, "\n", "\r"));
    }
}

TEST(PlyDialects, BinaryDataMayFollowACarriageReturnAlone) {
    // the first byte of the data is a line feed: a coordinate of 10 * 2^-149 (denormal), little
    // endian
    std::string bytes = replacedAll(kPlyHead, "\n", "\r");
    bytes.replace(bytes.find("ascii"), 5, "binary_little_endian");
    const auto add = [&](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    };
    for (const Vec3& p : kCorners) {
        for (int axis = 0; axis < 3; ++axis) add(static_cast<float>(p[axis]));
    }
    bytes[bytes.size() - 48] = '\n';
    for (const Triangle& t : kTwo) {
        add(std::uint8_t{3});
        for (const VertexId v : t) add(static_cast<std::int32_t>(v));
    }
    const MeshFile file = decodedAs("x.ply", bytes);
    EXPECT_EQ(file.mesh.triangles, kTwo);
    EXPECT_EQ(file.mesh.points[3], kCorners[3]);
    EXPECT_GT(file.mesh.points[0].x, 0);
}

TEST(PlyDialects, SizedTypesOtherElementsAndFloatIndicesAreRead) {
    expectTwoTriangles("x.ply",
                       "ply\r\nformat ascii 1.0\ncomment a\nobj_info b\nelement camera 1\nproperty "
                       "int32 n\nelement "
                       "vertex 4\nproperty float32 x\nproperty float64 y\nproperty float "
                       "z\nproperty uint8 red\nelement "
                       "face 2\nproperty list uint8 float32 vertex_index\nproperty list uint16 "
                       "float32 uv\nelement edge "
                       "0\nproperty int vertex1\nend_header\n7\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0.5 "
                       "1\n3 0 1 2 2 0 0\n3 0 "
                       "2 3 0\n");
}

TEST(PlyDialects, CloudsOfPointsAreNamed) {
    const std::string cloud = refusalOf(
        "x.ply", replacedAll(kPlyHead, "face 2", "face 0") + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n");
    EXPECT_EQ(cloud, "it holds 4 points and no triangle; give a surface of triangles");
}

TEST(ObjDialects, AreRead) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvn 0 0 1\n";
    for (const std::string faces : {"f 1 2 3\nf 1 3 4\n", "f 1/1/ 2/1/ 3/1/\nf 1/1/ 3/1/ 4/1/\n",
                                    "f 1// 2// 3//\nf 1// 3// 4//\n", "f 1/ 2/ 3/\nf 1/ 3/ 4/\n",
                                    "f 1/1/1 2/1/1 3/1/1\nf 1//1 3//1 4//1\n",
                                    "f -4 -3 -2\nf -4 -2 -1\n", "f 1 2 \\\n3\nf \\\n1 \\\n 3 4\n",
                                    "  f\t1 2\t3 # a comment\n\n# f 9 9 9\ns off\nl 1 2\nf 1 3 4\n",
                                    "# c:\\temp\\\nf 1 2 3\nf 1 3 4"}) {
        expectTwoTriangles("x.obj", points + faces);
        expectTwoTriangles("x.obj", replacedAll(points + faces, "\n", "\r\n"));
        expectTwoTriangles("x.obj", replacedAll(points + faces, "\n", "\r"));
    }
    expectTwoTriangles(
        "x.obj",
        "\xEF\xBB\xBF# made by\nmtllib a.mtl\nv 0 0 0 1 0.5 0\nv 1 0 0 1 1 1\nv 1 1 0 1.0\n"
        "v 0 1.0d0 +5e-1\nf 1 2 3\nf 1 3 4\n");
    const MeshFile colored = decodeMesh("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n",
                                        "x.obj", {.keepsPointArrays = true});
    ASSERT_EQ(colored.pointArrays.size(), 1u);
}

TEST(StlDialects, AreRead) {
    const std::string facets =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
        "0\nendloop\nendfacet\n"
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 "
        "0.5\nendloop\nendfacet\n";
    const std::size_t half = facets.find("facet", 1 + facets.find("endfacet") + 4);
    for (const std::string& text :
         {"solid a\n" + facets + "endsolid a\n",
          "solid\n" + facets.substr(0, half) + "endsolid\n\nsolid b\n" + facets.substr(half) +
              "endsolid b",
          "solid a " + replacedAll(facets, "\n", " ") + "endsolid a\n",
          "solid a\n" + replacedAll(facets, "0.5", "5.D-1") + "endsolid\n",
          "SOLID A\n" + replacedAll(facets, "vertex", "  VERTEX\t") + "ENDSOLID\n"}) {
        expectTwoTriangles("x.stl", text);
        expectTwoTriangles("x", replacedAll(text, "\n", "\r\n"));
        expectTwoTriangles("x", replacedAll(text, "\n", "\r"));
    }
    EXPECT_EQ(
        refusalOf("x.stl", "solid a\n" + facets),
        "it ends without the word 'endsolid'; it may be cut off: get it again, or add that line "
        "at its end if it is whole");
}

TEST(OffDialects, WithNormalsOrTextureAreRead) {
    expectTwoTriangles("x.off",
                       "NOFF\n4 2\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 .5 0 0 1\n3 0 1 2\n"
                       "3 0 2 3 0.5 0.5 0.5\n");
    EXPECT_NE(refusalOf("x.off", "OFF BINARY\n\0\0\0\4"s).find("save it as plain OFF text"),
              std::string::npos);
}

TEST(TextNumbers, WithDecimalCommasAreNamed) {
    EXPECT_EQ(refusalOf("x.off", "OFF\n3 1 0\n0,5 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
              "a coordinate is '0,5', with a comma; save it with decimal points and blanks between "
              "numbers");
}

TEST(TextNumbers, ThatAreNotFiniteInVisualCAreKeptFaults) {
    const TriangleMesh mesh =
        decodeMesh("OFF\n3 1 0 # a\n-1.#IND 1.#INF -1.#INF #b\n1 0 0\n0 1 0\n3 0 1 2\n", "x.off",
                   {.keepsFaults = true})
            .mesh;
    EXPECT_TRUE(std::isnan(mesh.points[0].x));
    EXPECT_EQ(mesh.points[0].y, std::numeric_limits<double>::infinity());
    EXPECT_EQ(mesh.points[0].z, -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace adaptiso
