// FIFF's surfaces: what is written comes back, and damage is told in one line.
#include <gtest/gtest.h>

#include <algorithm>

#include "MeshIOTestSupport.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

using testing::bytesOf;
using testing::cubeMesh;
using testing::icosphere;
using testing::temporaryFile;

TriangleMesh shell(double radius) {
    TriangleMesh mesh = icosphere(1, {0.01, -0.02, 0.03}, radius);
    mesh.normals = areaWeightedNormals(mesh);
    return mesh;
}

std::string fiffBytes(const FiffSurface& surface) {
    const auto path = temporaryFile("a.fif");
    writeFiffSurfaces({&surface, 1}, path);
    return bytesOf(path);
}

template <class Read>
std::string refusalOf(const Read& read) {
    try {
        read();
    } catch (const FileError& error) {
        const std::string what = error.what();
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        return what;
    }
    ADD_FAILURE() << "was read";
    return {};
}

TEST(FiffSurfaces, ComeBackWithNumberAndConductivity) {
    const std::vector<FiffSurface> surfaces{{4, 0.33, shell(0.09)}, {1, 1.79, shell(0.08)}};
    const auto path = temporaryFile("bem.fif");
    writeFiffSurfaces(surfaces, path);
    const std::vector<FiffSurface> read = readFiffSurfaces(path);
    ASSERT_EQ(read.size(), 2u);
    for (std::size_t n = 0; n < 2; ++n) {
        EXPECT_EQ(read[n].id, surfaces[n].id);
        EXPECT_FLOAT_EQ(static_cast<float>(read[n].conductivity),
                        static_cast<float>(surfaces[n].conductivity));
        EXPECT_EQ(read[n].mesh.triangles, surfaces[n].mesh.triangles);
        ASSERT_EQ(read[n].mesh.points.size(), surfaces[n].mesh.points.size());
        for (std::size_t v = 0; v < read[n].mesh.points.size(); ++v) {
            // float's rounding of a tenth of a metre
            EXPECT_LE(norm(read[n].mesh.points[v] - surfaces[n].mesh.points[v]), 2e-8);
        }
    }
}

TEST(FiffSurfaces, AreReadAsSurfacesByName) {
    const std::vector<FiffSurface> surfaces{
        {4, 0.3, shell(0.09)}, {3, 0.006, shell(0.085)}, {1, 0.3, shell(0.08)}};
    const auto path = temporaryFile("model-bem.fif");
    writeFiffSurfaces(surfaces, path);
    const auto paths = surfacePaths(path);
    ASSERT_EQ(paths.size(), 3u);
    EXPECT_TRUE(paths[0].string().ends_with(".fif:inner_skull"));
    EXPECT_TRUE(paths[2].string().ends_with(".fif:outer_skin"));
    for (std::size_t n = 0; n < 3; ++n) {
        const MeshFile file = readMesh(paths[n]);
        EXPECT_EQ(file.frame, CoordinateFrame::TkRas);
        EXPECT_EQ(file.format->name, "FIFF (MNE)");
        EXPECT_EQ(file.mesh.triangles, surfaces[2 - n].mesh.triangles);
        // metres in float, read in mm
        EXPECT_LE(norm(file.mesh.points[5] - 1000.0 * surfaces[2 - n].mesh.points[5]), 2e-5);
    }
    EXPECT_NE(refusalOf([&] { readMesh(path); }).find("outer_skin"), std::string::npos);
    EXPECT_NE(refusalOf([&] { readMesh(path.string() + ":brain"); }).find("outer_skin"),
              std::string::npos);
    const std::vector<FiffSurface> twice{{4, 0.3, shell(0.09)}, {4, 0.3, shell(0.08)}};
    writeFiffSurfaces(twice, path);
    ASSERT_EQ(surfacePaths(path).size(), 2u);
    EXPECT_TRUE(surfacePaths(path)[1].string().ends_with(".fif:outer_skin-2"));
    EXPECT_LE(
        norm(readMesh(surfacePaths(path)[1]).mesh.points[5] - 1000.0 * twice[1].mesh.points[5]),
        2e-5);
    writeFiffSurfaces(std::span(surfaces).first(1), path);
    EXPECT_EQ(surfacePaths(path).size(), 1u);
    EXPECT_EQ(readMesh(path).mesh.points.size(), surfaces[0].mesh.points.size());
}

TEST(FreeSurferTri, IsReadWithAndWithoutNumbersAndNormals) {
    const std::string numbered =
        "4\n1 0 0 0\n2 9.5 0 0\n3 0 9 0\n4 0 0 9\n4\n1 1 3 2\n2 1 2 4\n3 1 4 3\n4 2 3 4\n";
    const std::string bare =
        "4\n0 0 0 1 0 0\n9.5 0 0 1 0 0\n0 9 0 1 0 0\n0 0 9 1 0 0\n4\n1 3 2\n1 2 4\n1 4 3\n2 3 4\n";
    for (const std::string& text : {numbered, bare}) {
        const MeshFile file = decodeMesh(text, "head.tri");
        ASSERT_EQ(file.mesh.points.size(), 4u);
        EXPECT_EQ(file.mesh.points[1].x, 9.5);
        EXPECT_EQ(file.mesh.triangles[3], (Triangle{1, 2, 3}));
        EXPECT_FALSE(file.frame);
    }
    const auto refused = [&](const std::string& text) {
        return refusalOf([&] { decodeMesh(text, "head.tri"); });
    };
    EXPECT_NE(refused("99999999999\n1 2 3\n").find("head.tri: "), std::string::npos);
    for (std::size_t cut = 0; cut + 2 < numbered.size(); ++cut) {
        EXPECT_NE(refused(numbered.substr(0, cut)).find("head.tri: "), std::string::npos) << cut;
    }
    for (const char* corner : {"1.9", "-0.5", "0"}) {
        EXPECT_NE(refused("3\n0 0 0\n1 0 0\n0 1 0\n1\n" + std::string(corner) + " 2 3\n")
                      .find("names no point"),
                  std::string::npos)
            << corner;
    }
    EXPECT_NE(refused("3\n0 0 0\n1 0 0\n0 1 0\n1\n1 2 7\n").find("point 6"), std::string::npos);
}

TEST(FiffSurfaces, HoldNeitherDateNorMachine) {
    const FiffSurface surface{4, 1, shell(0.09)};
    const std::string bytes = fiffBytes(surface);
    // FILE_ID's version is followed by machine and time: 16 bytes of 0
    EXPECT_EQ(bytes.substr(20, 16), std::string(16, '\0'));
}

TEST(FiffSurfaces, RefuseEveryCut) {
    const FiffSurface surface{4, 1, cubeMesh()};
    const std::string bytes = fiffBytes(surface);
    std::size_t refused = 0, complete = 0;
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
        try {
            // behind the last surface nothing is missed
            complete += decodeFiffSurfaces(std::string_view(bytes).substr(0, cut), "a.fif").size();
        } catch (const FileError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with("a.fif: ")) << error.what();
            ++refused;
        }
    }
    EXPECT_EQ(refused + complete, bytes.size());
    EXPECT_LE(complete, 60u);
}

TEST(FiffSurfaces, RefuseOtherFramesAndVerticesThatAreNotThere) {
    FiffSurface surface{4, 1, cubeMesh()};
    std::string bytes = fiffBytes(surface);
    const std::string frame("\0\0\x0D\xB2\0\0\0\3\0\0\0\4\0\0\0\0\0\0\0\5", 20);  // 3506: 5
    const std::size_t at = bytes.find(frame);
    ASSERT_NE(at, std::string::npos);
    bytes[at + 19] = 4;
    EXPECT_NE(refusalOf([&] { decodeFiffSurfaces(bytes, "a.fif"); }).find("MRI coordinates"),
              std::string::npos);
    surface.mesh.triangles[3][1] = 8;
    EXPECT_NE(
        refusalOf([&] { decodeFiffSurfaces(fiffBytes(surface), "b.fif"); }).find("point 9 of 8"),
        std::string::npos);
    EXPECT_NE(refusalOf([&] { decodeFiffSurfaces("not a FIFF file at all", "c"); }).find("FIFF"),
              std::string::npos);
    EXPECT_THROW(writeFiffSurfaces({}, temporaryFile("d.fif")), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
