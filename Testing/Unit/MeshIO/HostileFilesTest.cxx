// Files cut off, damaged at random, or made to do harm.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <random>

#include "MeshIOTestSupport.h"
#include "Support/OperatorNew.h"
#include "adaptiso/Core/Errors.h"

namespace {

std::atomic<std::size_t> largestRequest{0};

}  // namespace

// tests see what a hostile file asks for
void* adaptiso::testing::memoryForNew(std::size_t byteCount) noexcept {
    std::size_t largest = largestRequest;
    while (byteCount > largest && !largestRequest.compare_exchange_weak(largest, byteCount)) {
    }
    return std::malloc(byteCount);
}

namespace adaptiso {
namespace {

using testing::decoded;
using testing::exampleName;
using testing::icosphere;
using testing::messageOf;
using testing::nameOfFormat;
using testing::replaced;
using testing::tetrahedron;
using testing::written;

/// Decodes bytes that may be bad: a FileError that names the file, or a mesh whose every index is
/// in range and every number finite. \return whether it was a mesh
bool decodesSafely(const std::string& bytes, const std::string& name) {
    try {
        const MeshFile file = decoded(bytes, name);
        const auto points = static_cast<VertexId>(file.mesh.points.size());
        EXPECT_FALSE(file.mesh.triangles.empty());
        EXPECT_TRUE(file.mesh.normals.empty() ||
                    file.mesh.normals.size() == file.mesh.points.size());
        for (const Triangle& t : file.mesh.triangles) {
            for (const VertexId vertex : t) EXPECT_TRUE(vertex >= 0 && vertex < points);
        }
        for (const Vec3& p : file.mesh.points) {
            EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
        }
        for (const Normal& n : file.mesh.normals) EXPECT_LE(norm(toVec3(n)), 1 + 1e-5);
        return true;
    } catch (const FileError& error) {
        const std::string message = error.what();
        EXPECT_TRUE(message.starts_with(name + ": ")) << message;
        EXPECT_NE(message.find("; "), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return false;
    }
}

class HostileFile : public ::testing::TestWithParam<int> {
protected:
    const MeshFormat& format() const { return meshFormats()[GetParam()]; }
    std::string name() const { return exampleName(format()); }
    std::string soundBytes() const {
        return written(icosphere(1, {5, 6, 7}, 80), name(),
                       {CoordinateFrame::Lps, std::nullopt, ""});
    }
};

TEST_P(HostileFile, CutOffAnywhereIsAnErrorOrAMesh) {
    const std::string bytes = soundBytes();
    ASSERT_TRUE(decodesSafely(bytes, name()));
    for (std::size_t length = 0; length < bytes.size(); length += 7) {
        decodesSafely(bytes.substr(0, length), name());
    }
    // a list of faces without a count (OBJ) can't be seen to end early; the others can
    if (format().name != "Wavefront OBJ") {
        EXPECT_FALSE(decodesSafely(bytes.substr(0, bytes.size() / 2), name()));
        EXPECT_FALSE(decodesSafely(bytes.substr(0, bytes.size() / 5), name()));
    }
}

TEST_P(HostileFile, WithFlippedBitsIsAnErrorOrAMesh) {
    const std::string sound = soundBytes();
    std::mt19937 random(20240611u + static_cast<unsigned>(GetParam()));
    for (int round = 0; round < 4000; ++round) {
        std::string bytes = sound;
        const int flips = 1 + static_cast<int>(random() % 4);
        // half of them in the first bytes, where counts stand
        const std::size_t range =
            round % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 800);
        for (int flip = 0; flip < flips; ++flip) {
            bytes[random() % range] ^= static_cast<char>(1u << (random() % 8));
        }
        decodesSafely(bytes, name());
    }
}

TEST_P(HostileFile, WithChangedDigitsIsAnErrorOrAMesh) {
    // numbers in text stay numbers: counts, offsets and indices turn wrong, not unreadable
    const std::string sound = soundBytes();
    std::vector<std::size_t> digits;
    for (std::size_t i = 0; i < sound.size(); ++i) {
        if (sound[i] >= '0' && sound[i] <= '9') digits.push_back(i);
    }
    ASSERT_FALSE(digits.empty());
    std::mt19937 random(77u + static_cast<unsigned>(GetParam()));
    for (int round = 0; round < 2000; ++round) {
        std::string bytes = sound;
        const std::size_t at =
            digits[random() %
                   std::min<std::size_t>(digits.size(), round % 2 == 0 ? 120 : digits.size())];
        const std::string number =
            round % 3 == 0 ? "99999999999" : std::string(1, static_cast<char>('0' + random() % 10));
        bytes.replace(at, 1, number);
        decodesSafely(bytes, name());
    }
}

TEST_P(HostileFile, OfRandomBytesIsAnError) {
    std::mt19937 random(4711u + static_cast<unsigned>(GetParam()));
    const std::string sound = soundBytes();
    for (int round = 0; round < 300; ++round) {
        std::string bytes = sound.substr(0, random() % 200);
        const std::size_t more = random() % 500;
        for (std::size_t i = 0; i < more; ++i) bytes += static_cast<char>(random());
        decodesSafely(bytes, name());
    }
    EXPECT_FALSE(decodesSafely("", name()));
    EXPECT_FALSE(decodesSafely(std::string(300, '\0'), name()));
    EXPECT_FALSE(decodesSafely(std::string(300, '\xFF'), name()));
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, HostileFile,
                         ::testing::Range(0, static_cast<int>(meshFormats().size())), nameOfFormat);

TEST(HostileCounts, AllocateNothingOfTheirSize) {
    const std::string xml = written(tetrahedron(), "a.vtp"),
                      gifti = written(tetrahedron(), "a.gii"),
                      legacy = written(tetrahedron(), "a.vtk"),
                      ply = written(tetrahedron(), "a.ply"),
                      surf = written(tetrahedron(), "a.surf");
    std::string stl = written(tetrahedron(), "a.stl");
    stl.replace(80, 4, "\xFF\xFF\xFF\x7F");
    const std::size_t counts = surf.find("\n\n") + 2;
    const std::string plyEmpty =
        "ply\nformat ascii 1.0\nelement nothing 9000000000000000000\nend_header\n";
    const std::string vtkHead = "# vtk DataFile Version 5.1\n\nASCII\nDATASET POLYDATA\n";
    const std::pair<const char*, std::string> files[] = {
        {"points.vtp",
         replaced(xml, "NumberOfPoints=\"4\"", "NumberOfPoints=\"9000000000000000000\"")},
        {"points2.vtp", replaced(xml, "NumberOfPoints=\"4\"", "NumberOfPoints=\"900000000\"")},
        {"polys.vtp",
         replaced(xml, "NumberOfPolys=\"4\"", "NumberOfPolys=\"3074457345618258603\"")},
        {"negative.vtp", replaced(xml, "NumberOfPolys=\"4\"", "NumberOfPolys=\"-4\"")},
        {"points.gii", replaced(gifti, "Dim0=\"4\"", "Dim0=\"3074457345618258603\"")},
        {"points2.gii", replaced(gifti, "Dim0=\"4\"", "Dim0=\"4000000000\"")},
        {"points.vtk", replaced(legacy, "POINTS 4", "POINTS 3074457345618258603")},
        {"polys.vtk", replaced(legacy, "POLYGONS 4 16", "POLYGONS 4 4000000000000")},
        {"field.vtk", vtkHead + "FIELD FieldData 1\na 4000000000 4000000000 double\n"},
        {"strings.vtk", vtkHead + "FIELD FieldData 1\na 1 9000000000000000000 string\n"},
        {"arrays.vtk", vtkHead + "FIELD FieldData 9000000000000000000\n"},
        {"scalars.vtk",
         vtkHead + "POINT_DATA 9000000000000000000\nSCALARS a float 4\nLOOKUP_TABLE default\n"},
        {"vertex.ply", replaced(ply, "element vertex 4", "element vertex 9000000000000000000")},
        {"face.ply", replaced(ply, "element face 4", "element face 4000000000")},
        {"nothing.ply", plyEmpty},
        {"count.stl", stl},
        {"points.surf", surf.substr(0, counts) + "\x7F\xFF\xFF\xFF" + surf.substr(counts + 4)},
        {"negative.surf", surf.substr(0, counts) + "\xFF\xFF\xFF\xFF" + surf.substr(counts + 4)},
        {"triangles.surf",
         surf.substr(0, counts + 4) + "\x7F\xFF\xFF\xFF" + surf.substr(counts + 8)},
        {"points.off", "OFF\n4000000000000 1 0\n0 0 0\n"},
        {"faces.off", "OFF\n1 4000000000000 0\n0 0 0\n"},
        {"points.tri", "- 4000000000000\n0 0 0 0 0 1\n"},
        {"triangles.tri", "- 1\n0 0 0 0 0 1\n- 4000000000000 4000000000000 4000000000000\n0 0 0\n"},
    };
    for (const auto& [name, bytes] : files) {
        largestRequest = 0;
        EXPECT_FALSE(decodesSafely(bytes, name)) << name;
        EXPECT_GT(largestRequest, std::size_t{0}) << "requests go unseen";
        // the readers' own pieces (1 MB) and XML parser, never what the file claims
        EXPECT_LE(largestRequest, std::size_t{4} << 20) << name;
    }
}

TEST(HostileCounts, CompressedDataIsNotUnpackedBeyondWhatIsDue) {
    // 32 MB of zeros in 32 kB: what comes out is measured against the number of points
    TriangleMesh mesh = tetrahedron();
    mesh.points.resize(2'000'000, {0, 0, 0});
    const std::string bytes = written(mesh, "a.gii");
    largestRequest = 0;
    EXPECT_FALSE(decodesSafely(replaced(bytes, "Dim0=\"2000000\"", "Dim0=\"4\""), "a.gii"));
    EXPECT_LE(largestRequest, std::size_t{4} << 20);
}

TEST(HostileCounts, BlocksOfAVtpFileAreNotUnpackedBeyondWhatIsDue) {
    // 48 MB of zeros packed into 50 kB, in blocks that are each within zlib's best ratio
    TriangleMesh mesh = tetrahedron();
    mesh.points.resize(2'000'000, {0, 0, 0});
    const std::string bytes = written(mesh, "a.vtp");
    largestRequest = 0;
    const std::string message = messageOf<FileError>([&] {
        decoded(replaced(bytes, "NumberOfPoints=\"2000000\"", "NumberOfPoints=\"4\""), "a.vtp");
    });
    EXPECT_NE(message.find("unpack to more than 96 bytes"), std::string::npos) << message;
    EXPECT_LE(largestRequest, std::size_t{4} << 20);
}

TEST(HostileIndices, OutsideTheMeshAreNamed) {
    EXPECT_NE(messageOf<FileError>([] {
                  decoded("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off");
              }).find("uses point 3, must be 0 to 2"),
              std::string::npos);
    EXPECT_THROW(decoded("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "a.off"), FileError);
    EXPECT_THROW(decoded("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "a.obj"), FileError);
    EXPECT_THROW(decoded("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "a.obj"), FileError);
    EXPECT_THROW(decoded("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//2 2//1 3//1\n", "a.obj"),
                 FileError);
    EXPECT_THROW(
        decoded("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 9223372036854775807//1 2//1 3//1\n",
                "a.obj"),
        FileError);
}

TEST(HostileIndices, PolygonOffsetsThatRunBackwardsAreAnError) {
    // found by fuzzing: the difference of two such offsets overflowed
    const std::string sound =
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"2\">"
        "<Points><DataArray format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points><Polys>"
        "<DataArray Name=\"connectivity\" format=\"ascii\">0 1 2 2 1 0</DataArray>"
        "<DataArray Name=\"offsets\" format=\"ascii\">3 6</DataArray></Polys></Piece>"
        "</PolyData></VTKFile>";
    EXPECT_EQ(decoded(sound, "a.vtp").mesh.triangles.size(), 2u);
    EXPECT_FALSE(decodesSafely(replaced(sound, ">3 6<", ">3 -9223372036854775808<"), "a.vtp"));
    EXPECT_FALSE(decodesSafely(replaced(sound, ">3 6<", ">3 0<"), "a.vtp"));
    // a polygon that names a corner twice in a row, and a line
    EXPECT_EQ(decoded(replaced(sound, ">3 6<", ">4 6<"), "a.vtp").mesh.triangles.size(), 1u);
}

TEST(HostileNumbers, ThatAreNotFiniteAreRefused) {
    for (const char* number : {"nan", "inf", "-inf", "1e999", "0x10", "1,5", ""}) {
        const std::string bytes =
            std::string("OFF\n3 1 0\n0 0 ") + number + "\n1 0 0\n0 1 0\n3 0 1 2\n";
        EXPECT_THROW(decoded(bytes, "a.off"), FileError) << number;
    }
}

TEST(KeptFaults, ComeThroughAsTheyAre) {
    const auto kept = [](const std::string& bytes, const std::string& name) {
        return decodeMesh(bytes, findMeshFormat(name), name, {.keepsFaults = true}).mesh;
    };
    const TriangleMesh mesh =
        kept("OFF\n4 3 0\n0 0 nan\n1 0 -inf\n0 1 0\n7 7 7\n3 0 1 2\n3 0 0 1\n3 0 9 -1\n", "a.off");
    EXPECT_TRUE(std::isnan(mesh.points[0].z));
    EXPECT_TRUE(std::isinf(mesh.points[1].z));
    EXPECT_EQ(mesh.points.size(), 4u);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 0, 1}, {0, 9, -1}}));

    const std::string text =
        "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex inf 0 0\nvertex 0 nan 0\n"
        "endloop\nendfacet\nendsolid\n";
    EXPECT_TRUE(std::isinf(kept(text, "a.stl").points[1].x));
    EXPECT_THROW(decoded(text, "a.stl"), FileError);

    EXPECT_TRUE(
        kept("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 1\nf 1//1 2//1 3//1\n", "a.obj").normals.empty());
    // what is no mesh at all is refused just the same
    EXPECT_THROW(kept("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "a.off"), FileError);
    EXPECT_THROW(kept("OFF\n0 1 0\n3 0 1 2\n", "a.off"), FileError);
    EXPECT_THROW(kept("OFF\n3 1 0\n0 0 0\n", "a.off"), FileError);
}

TEST(HostileCounts, DecompressionBombsAreNotUnpacked) {
    // 25 million points take 300 MB (float) and 600 MB (double); 2 MB of what is packed could just
    // hold them
    const std::string packed(3 << 20, 'A');
    const std::string gifti = written(tetrahedron(), "a.gii"),
                      xml = written(tetrahedron(), "a.vtp");
    const std::string counts = replaced(gifti, "Dim0=\"4\"", "Dim0=\"25000000\"");
    const std::pair<const char*, std::string> files[] = {
        {"a.gii", replaced(counts, "<Data>", "<Data>" + packed)},
        {"a.vtp", replaced(replaced(xml, "NumberOfPoints=\"4\"", "NumberOfPoints=\"25000000\""),
                           "</AppendedData>", packed + "</AppendedData>")},
    };
    for (const auto& [name, bytes] : files) {
        largestRequest = 0;
        const std::string message =
            messageOf<FileError>([&bytes = bytes, name = name] { decoded(bytes, name); });
        EXPECT_NE(message.find("decompression bomb"), std::string::npos) << message;
        EXPECT_LE(largestRequest, std::size_t{8} << 20) << name;
    }
}

TEST(PlyFile, NamesOfElementsAreShownWithoutControlCharacters) {
    const std::string ply = written(tetrahedron(), "a.ply");
    const std::string message = messageOf<FileError>([&] {
        decoded(replaced(ply, "element vertex 4", "element ver\033[31mtex 4000000000"), "a.ply");
    });
    EXPECT_NE(message.find("'ver?[31mtex'"), std::string::npos) << message;
}

TEST(ReadMesh, OpensRegularFilesOnly) {
    EXPECT_NE(messageOf<FileError>([] { readMesh("/nowhere/a.stl"); }).find("no such file"),
              std::string::npos);
    const auto folder = testing::temporaryFile("folder.stl");
    std::filesystem::create_directories(folder);
    EXPECT_NE(messageOf<FileError>([&] { readMesh(folder); }).find("this is a folder"),
              std::string::npos);
    const auto device = testing::temporaryFile("zero.stl");
    std::filesystem::create_symlink("/dev/zero", device);
    EXPECT_NE(messageOf<FileError>([&] { readMesh(device); }).find("regular file"),
              std::string::npos);
}

}  // namespace
}  // namespace adaptiso
