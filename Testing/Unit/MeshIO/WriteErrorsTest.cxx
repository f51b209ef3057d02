#include <gtest/gtest.h>

#include <limits>

#include "MeshIOTestSupport.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

using testing::exampleName;
using testing::icosphere;
using testing::messageOf;
using testing::temporaryFile;
using testing::tetrahedron;

TEST(WriteMesh, DiskFullIsAFileError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    for (const MeshFormat& format : meshFormats()) {
        const auto path = temporaryFile(exampleName(format));
        std::filesystem::create_symlink("/dev/full", path);
        const std::string message = messageOf<FileError>([&] {
            writeMesh(icosphere(1), path, {CoordinateFrame::Lps, std::nullopt, ""});
        });
        EXPECT_NE(message.find("No space left on device"), std::string::npos) << path << message;
        EXPECT_NE(message.find(path.string()), std::string::npos) << message;
    }
}

TEST(WriteMesh, AFolderThatIsNotThereIsAFileError) {
    const auto path = temporaryFile("none") / "a.stl";
    const std::string message = messageOf<FileError>([&] { writeMesh(tetrahedron(), path); });
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

TEST(WriteMesh, AFileInPlaceOfTheFolderIsAFileError) {
    const auto file = temporaryFile("folder.ply");
    writeMesh(tetrahedron(), file);
    for (const MeshFormat& format : meshFormats()) {
        const auto path = file / exampleName(format);
        const std::string message = messageOf<FileError>([&] {
            writeMesh(tetrahedron(), path, {CoordinateFrame::Lps, std::nullopt, ""});
        });
        EXPECT_NE(message.find("Not a directory"), std::string::npos) << message;
    }
}

TEST(WriteMesh, BadMeshesAreRefusedBeforeAFileIsMade) {
    TriangleMesh outside = tetrahedron(), negative = tetrahedron(), notFinite = tetrahedron(),
                 tooLarge = tetrahedron(), oddNormals = tetrahedron(), badNormal = tetrahedron();
    outside.triangles[3][1] = 4;
    negative.triangles[3][1] = -1;
    notFinite.points[2].y = std::numeric_limits<double>::quiet_NaN();
    tooLarge.points[2].y = 1e39;  // finite as double, infinite as float
    oddNormals.normals.resize(3);
    badNormal.normals.resize(4);
    badNormal.normals[1].x = std::numeric_limits<float>::infinity();
    const std::pair<TriangleMesh, const char*> cases[] = {{outside, "uses point 4, must be 0 to 3"},
                                                          {negative, "uses point -1"},
                                                          {notFinite, "coordinate 1 of point 2"},
                                                          {tooLarge, "coordinate 1 of point 2"},
                                                          {oddNormals, "3 normals for 4 points"},
                                                          {badNormal, "normal of point 1"},
                                                          {TriangleMesh{}, "no triangle"}};
    for (const auto& [mesh, words] : cases) {
        const auto path = temporaryFile("bad.ply");
        const std::string message =
            messageOf<InvalidInput>([&, &bad = mesh] { writeMesh(bad, path); });
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_FALSE(std::filesystem::exists(path));
    }
}

TEST(WriteMesh, PointArraysAreForFormatsThatHoldThemAndHaveOneValueAPoint) {
    MeshWriteOptions options;
    options.pointArrays = {{"Depth", std::vector<double>(4)}};
    for (const MeshFormat& format : meshFormats()) {
        const auto path = temporaryFile(exampleName(format));
        if (format.holdsPointArrays) {
            EXPECT_NO_THROW(writeMesh(tetrahedron(), path, options));
            continue;
        }
        EXPECT_THROW(writeMesh(tetrahedron(), path, options), InvalidInput) << format.name;
        EXPECT_FALSE(std::filesystem::exists(path)) << format.name;
    }
    options.pointArrays.push_back({"Shade", std::vector<Color>(3)});
    const std::string message =
        messageOf<InvalidInput>([&] { writeMesh(tetrahedron(), temporaryFile("a.vtp"), options); });
    EXPECT_NE(message.find("Shade"), std::string::npos) << message;
    EXPECT_NE(message.find("3 values for 4 points"), std::string::npos) << message;
}

TEST(WriteMesh, FramesOfAVolumeNeedTheVolume) {
    const auto path = temporaryFile("a.surf");
    EXPECT_THROW(writeMesh(tetrahedron(), path, {CoordinateFrame::TkRas, std::nullopt, ""}),
                 InvalidInput);
    EXPECT_THROW(
        writeMesh(tetrahedron(), path, {CoordinateFrame::TkRas, testing::shearedVolume(), ""}),
        InvalidInput);
    EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(WriteMesh, VolumeNamesThatHoldAFolderOrBreakTheFooterAreRefused) {
    for (const char* name :
         {"/data/jane/T1.mgz", "..\\T1.mgz", "a b.mgz", "a=b", "a\nb", "\xC3\xA4.mgz"}) {
        const auto path = temporaryFile("a.surf");
        EXPECT_THROW(writeMesh(tetrahedron(), path,
                               {CoordinateFrame::TkRas, testing::straightVolume(), name}),
                     InvalidInput)
            << name;
        EXPECT_FALSE(std::filesystem::exists(path)) << name;
    }
}

}  // namespace
}  // namespace adaptiso
