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
