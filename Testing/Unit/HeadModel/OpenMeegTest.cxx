#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ExportFreeSurfer.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using testing::icosphere;

class OpenMeegModelTest : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() /
                  ("adaptiso-openmeeg-" +
                   std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "-" +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                   std::to_string(getpid()));
        fs::create_directories(folder_);
        const std::vector<std::string> files{"a.tri", "b.tri", "c.tri"};
        for (int n = 0; n < 3; ++n) {
            writeOpenMeegSurface(icosphere(2, {1, 2, 3}, 80 + 6 * n), folder_ / files[n],
                                 CoordinateFrame::Ras, OpenMeegUnit::Millimetres);
        }
        geometry_ = openMeegGeometry(files);
        conductivities_ = openMeegConductivities(3, {0.33, 0.0041, 0.33});
    }
    void TearDown() override { fs::remove_all(folder_); }

    void put(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    OpenMeegModel read() const {
        put("m.geom", geometry_);
        put("m.cond", conductivities_);
        return readOpenMeegModel(folder_ / "m.geom", folder_ / "m.cond");
    }
    /// `text` with the first `from` as `to`; the test is wrong when there is none.
    static std::string changed(std::string text, const std::string& from, const std::string& to) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    }
    void expectRefused(const std::string& message) const {
        try {
            read();
            ADD_FAILURE() << "read, but should say: " << message;
        } catch (const FileError& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
        }
    }
    void geometryRefused(const std::string& from, const std::string& to,
                         const std::string& message) {
        const std::string good = geometry_;
        geometry_ = changed(geometry_, from, to);
        expectRefused(message);
        geometry_ = good;
    }
    void conductivitiesRefused(const std::string& from, const std::string& to,
                               const std::string& message) {
        const std::string good = conductivities_;
        conductivities_ = changed(conductivities_, from, to);
        expectRefused(message);
        conductivities_ = good;
    }

    fs::path folder_;
    std::string geometry_, conductivities_;
};

TEST_F(OpenMeegModelTest, IsAsTheFormatHasItToTheLetter) {
    EXPECT_EQ(geometry_,
              "# Domain Description 1.1\n\nInterfaces 3\n\nInterface Inner: \"a.tri\"\n"
              "Interface Outer: \"b.tri\"\nInterface Scalp: \"c.tri\"\n\nDomains 4\n\n"
              "Domain Brain: -Inner\nDomain Skull: +Inner -Outer\nDomain Skin: +Outer -Scalp\n"
              "Domain Air: +Scalp\n");
    EXPECT_EQ(conductivities_,
              "# Properties Description 1.0 (Conductivities)\n\nBrain 0.33\nSkull 0.0041\n"
              "Skin 0.33\nAir 0\n");
    EXPECT_EQ(openMeegGeometry(std::vector<std::string>{"a.tri"}),
              "# Domain Description 1.1\n\nInterfaces 1\n\nInterface Inner: \"a.tri\"\n\n"
              "Domains 2\n\nDomain Brain: -Inner\nDomain Air: +Inner\n");
}

TEST_F(OpenMeegModelTest, ComesBackAsWritten) {
    const OpenMeegModel model = read();
    ASSERT_EQ(model.interfaces.size(), 3u);
    EXPECT_EQ(model.interfaces[1].name, "Outer");
    EXPECT_EQ(model.interfaces[1].mesh.points.size(), 162u);
    // LPS (1, 2, 3) is RAS (-1, -2, 3); nine digits of 100 mm
    EXPECT_NEAR(norm(model.interfaces[1].mesh.points[0] - Vec3{-1, -2, 3}), 86, 1e-6);
    ASSERT_EQ(model.domains.size(), 4u);
    EXPECT_EQ(model.domains[1].name, "Skull");
    EXPECT_EQ(model.domains[1].inside, std::vector<std::size_t>{1});
    EXPECT_EQ(model.domains[1].outside, std::vector<std::size_t>{0});
    EXPECT_EQ(model.domains[1].conductivity, 0.0041);
    EXPECT_EQ(model.domains[3].conductivity, 0);
}

TEST_F(OpenMeegModelTest, MetresAreAThousandthInEveryFrame) {
    const TriangleMesh ball = icosphere(1, {10, 20, 30}, 80);
    writeOpenMeegSurface(ball, folder_ / "m.tri", CoordinateFrame::Lps, OpenMeegUnit::Metres);
    const TriangleMesh back = readMesh(folder_ / "m.tri").mesh;
    for (std::size_t n = 0; n < ball.points.size(); ++n) {
        EXPECT_LT(norm(back.points[n] - 0.001 * ball.points[n]), 1e-9);
    }
    EXPECT_GT(enclosedVolume(back), 0);
}

TEST_F(OpenMeegModelTest, EveryRuleOfTheGeometry) {
    geometryRefused("# Domain Description 1.1", "# Domain Description 1.0",
                    "line 1: must be \"# Domain Description 1.1\"");
    geometryRefused("# Domain Description 1.1", " # Domain Description 1.1", "line 1: must be");
    geometryRefused("Interfaces 3", "Interfaces three", "'three' must be a number from 1 to 100");
    geometryRefused("Interfaces 3", "Interfaces 0", "must be a number from 1 to 100");
    geometryRefused("Interfaces 3", "Surfaces 3", "line 3: must be 'Interfaces N'");
    geometryRefused("Interfaces 3", "Interfaces 4", "must begin with 'Interface Name:'");
    geometryRefused("Interfaces 3", "Interfaces 2", "must be 'Domains N'");
    geometryRefused("Interface Inner:", "Interface Inner :", "one name without spaces");
    geometryRefused("Interface Inner:", "Interface In.ner:", "'In.ner' is no name");
    geometryRefused("Interface Outer:", "Interface Inner:", "the name Inner is given twice");
    geometryRefused("\"a.tri\"", "a.tri", "file name in double quotes");
    geometryRefused("\"a.tri\"", "\"a a.tri\"", "file name in double quotes");
    geometryRefused("\"a.tri\"", "\"a.stl\"", "end in .tri");
    geometryRefused("\"a.tri\"", "\"/etc/a.tri\"", "must be relative");
    geometryRefused("\"a.tri\"", "\"../a.tri\"", "must be relative");
    geometryRefused("\"a.tri\"", "\"z.tri\"", "z.tri");
    geometryRefused("\"a.tri\"", "\"a\033.tri\"", "its file's name holds control characters");
    geometryRefused("Domains 4", "Domains 5", "the file ends where a domain should be");
    geometryRefused("Domains 4", "Domains 3", "there is more after the last domain");
    geometryRefused("Domain Skull:", "Domain Brain:", "the name Brain is given twice");
    geometryRefused("-Inner", "Inner", "'Inner' must be '-' (inside) or '+' (outside)");
    geometryRefused("-Inner", "-Unknown", "there is no interface 'Unknown'");
    geometryRefused("+Inner -Outer", "-Inner -Outer", "the interface Inner must be '-' of one");
    geometryRefused("+Inner -Outer", "-Outer", "the interface Inner must be '-' of one");
    geometryRefused("Domain Brain: -Inner\nDomain Skull: +Inner -Outer",
                    "Domain Brain: +Inner\nDomain Skull: -Inner -Outer",
                    "one domain, and one only, must be inside of nothing");
}

TEST_F(OpenMeegModelTest, EveryRuleOfTheConductivities) {
    conductivitiesRefused("# Properties Description 1.0 (Conductivities)", "# Conductivities",
                          "line 1: must be");
    conductivitiesRefused("Skull 0.0041", "Skull", "must be 'Name value'");
    conductivitiesRefused("Skull 0.0041", "Skull 0.0041 S/m", "must be 'Name value'");
    conductivitiesRefused("Skull 0.0041", "Bone 0.0041", "there is no domain 'Bone'");
    conductivitiesRefused("Skull 0.0041", "Brain 0.0041", "Brain is given twice");
    conductivitiesRefused("Skull 0.0041", "Skull 0", "must be a number above 0");
    conductivitiesRefused("Skull 0.0041", "Skull -1", "must be a number above 0");
    conductivitiesRefused("Skull 0.0041", "Skull nan", "must be a number above 0");
    conductivitiesRefused("Skull 0.0041", "Skull 1e", "must be a number above 0");
    conductivitiesRefused("Air 0", "Air 0.1", "of Air (the air) must be 0");
    conductivitiesRefused("Air 0\n", "", "the domain Air has none");
}

TEST_F(OpenMeegModelTest, ShowsWordsOfTheFilesWithoutControlCharacters) {
    geometryRefused("Interfaces 3", "Interfaces 3\r", "'3?' must be a number from 1 to 100");
    geometryRefused("Interface Inner:", "Interface In\033[31mner:", "'In?[31mner' is no name");
    geometryRefused("-Inner", "\033Inner", "'?Inner' must be '-' (inside) or '+' (outside)");
    geometryRefused("-Inner", "-\033Inner", "there is no interface '?Inner'");
    conductivitiesRefused("Skull 0.0041", "Sk\033ull 0.0041", "there is no domain 'Sk?ull'");
    geometryRefused("Interfaces 3", "Interfaces " + std::string(1000, '3'),
                    "'" + std::string(40, '3') + "...' must be");
}

TEST_F(OpenMeegModelTest, EveryRuleOfTheTriangles) {
    std::ifstream file(folder_ / "a.tri");
    std::stringstream text;
    text << file.rdbuf();
    const std::string good = text.str();
    put("a.tri", changed(good, "- 162", "- 163"));
    expectRefused("a.tri");
    put("a.tri", changed(good, "- 320 320 320", "- 320 320 319"));
    expectRefused("the three numbers of triangles differ");

    TriangleMesh inward = icosphere(2, {}, 80);
    flipOrientation(inward);
    writeOpenMeegSurface(inward, folder_ / "a.tri", CoordinateFrame::Ras,
                         OpenMeegUnit::Millimetres);
    expectRefused("its triangles are not counter-clockwise from outside");

    TriangleMesh wrongNormals = icosphere(2, {}, 80);
    wrongNormals.normals[7] = {1, 1, 1};
    writeOpenMeegSurface(wrongNormals, folder_ / "a.tri", CoordinateFrame::Ras,
                         OpenMeegUnit::Millimetres);
    expectRefused("the normal of vertex 7 is no unit vector that points outward");
}

TEST_F(OpenMeegModelTest, RefusesWhatIsNoFileOrTooLong) {
    put("m.geom", geometry_);
    EXPECT_THROW(readOpenMeegModel(folder_ / "m.geom", folder_ / "none.cond"), FileError);
    EXPECT_THROW(readOpenMeegModel(folder_, folder_ / "m.cond"), FileError);
    geometry_ += std::string(2 << 20, '\n');
    expectRefused("larger than any such file");
}

TEST(OpenMeegTexts, HaveFiveDomainsWithinTheAir) {
    const std::string geometry =
        openMeegGeometry(std::vector<std::string>{"a.tri", "b.tri", "c.tri", "d.tri", "e.tri"});
    EXPECT_NE(geometry.find("Interface WhiteMatter: \"a.tri\"\nInterface Cortex: \"b.tri\"\n"),
              std::string::npos);
    EXPECT_NE(geometry.find("Domain White: -WhiteMatter\nDomain Gray: +WhiteMatter -Cortex\n"
                            "Domain CSF: +Cortex -Inner\n"),
              std::string::npos);
    EXPECT_EQ(openMeegConductivities(5, standardConductivities(5)),
              "# Properties Description 1.0 (Conductivities)\n\nWhite 0.126\nGray 0.275\n"
              "CSF 1.654\nSkull 0.01\nSkin 0.465\nAir 0\n");
    EXPECT_EQ(standardConductivities(4).within(HeadSurface::Brain, 4), 0.3);
}

TEST(OpenMeegTexts, RefuseOtherNumbersOfSurfaces) {
    EXPECT_THROW(openMeegGeometry(std::vector<std::string>{"a.tri", "b.tri"}), InvalidInput);
    EXPECT_THROW(openMeegConductivities(2, {}), InvalidInput);
}

TEST(ConductivityModel, RefusesWhatIsNoConductivityInSiemensPerMetre) {
    EXPECT_NO_THROW(checkConductivities({}));
    for (const double value : {0.0, -1.0, 300.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(checkConductivities({.skull = value}), InvalidInput) << value;
    }
    EXPECT_EQ(ConductivityModel{}.within(HeadSurface::OuterSkull, 3), 0.006);
}

TEST(FreeSurferSurface, LeadsBackToTheScanner) {
    const fs::path path =
        fs::temp_directory_path() /
        ("adaptiso-" + std::to_string(getpid()) + "-" + freeSurferName(HeadSurface::OuterSkin));
    EXPECT_EQ(freeSurferName(HeadSurface::OuterSkin), "outer_skin.surf");
    const TriangleMesh ball = icosphere(2, {10, -20, 30}, 90);
    ImageGeometry image;
    image.size = {200, 180, 160};
    image.originMm = {-90, -70, -60};
    for (const bool hasVolume : {true, false}) {
        std::optional<ImageGeometry> volume;
        if (hasVolume) volume = frameVolume(CoordinateFrame::TkRas, image);
        writeFreeSurferSurface(ball, path, volume, "orig.mgz");
        const MeshFile file = readMesh(path);
        EXPECT_EQ(file.frame, hasVolume ? CoordinateFrame::TkRas : CoordinateFrame::Ras);
        const TriangleMesh back = fromFrame(file.mesh, *file.frame, file.volume);
        for (std::size_t n = 0; n < ball.points.size(); ++n) {
            ASSERT_LT(norm(back.points[n] - ball.points[n]), 2e-5);  // float at 120 mm
        }
        EXPECT_GT(enclosedVolume(file.mesh), 0);
    }
    fs::remove(path);
}

}  // namespace
}  // namespace adaptiso
