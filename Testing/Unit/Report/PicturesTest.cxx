#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {
namespace {

/// Two spheres in an image of the inner one, and a spot.
struct Example {
    testing::AnalyticVolume image = testing::sampled<std::uint8_t>(
        testing::sphere({0, 0, 0}, 10), testing::centredGeometry({32, 32, 32}));
    Report report;

    Example() {
        report.surfaces.push_back({"inner", testing::icosphere(3, {}, 10)});
        report.surfaces.push_back({"outer", testing::icosphere(3, {}, 14)});
        report.volume = ReportVolume{"image.nii", image.volume.view()};
        report.spots.push_back({"here", {10, 0, 0}});
    }
};

std::set<std::string> namesOf(const std::vector<Picture>& pictures) {
    std::set<std::string> names;
    for (const Picture& picture : pictures) names.insert(picture.name);
    return names;
}

/// A big-endian number of a PNG's header.
int number(const std::string& png, std::size_t at) {
    int value = 0;
    for (std::size_t n = 0; n < 4; ++n) value = value << 8 | static_cast<std::uint8_t>(png[at + n]);
    return value;
}

TEST(Pictures, AreAllThere) {
    const Example example;
    const std::set<std::string> all{"contours-axial.png",    "contours-coronal.png",
                                    "contours-sagittal.png", "spots.png",
                                    "surface-1.png",         "surface-2.png"};
    EXPECT_EQ(namesOf(drawPictures(example.report)), all);
}

TEST(Pictures, RegionsAreDrawnTogether) {
    Example example;
    example.report.areRegions = true;
    const std::set<std::string> names = namesOf(drawPictures(example.report));
    EXPECT_TRUE(names.contains("regions.png"));
    EXPECT_TRUE(names.contains("contours-axial.png"));
    EXPECT_FALSE(names.contains("surface-1.png"));
}

TEST(Pictures, ArePngFilesWithAltTexts) {
    const Example example;
    for (const Picture& picture : drawPictures(example.report)) {
        EXPECT_EQ(picture.png.substr(0, 8), "\x89PNG\r\n\x1a\n") << picture.name;
        EXPECT_EQ(number(picture.png, 16), picture.width) << picture.name;
        EXPECT_EQ(number(picture.png, 20), picture.height) << picture.name;
        EXPECT_FALSE(picture.altText.empty()) << picture.name;
        EXPECT_FALSE(picture.title.empty()) << picture.name;
    }
}

TEST(Pictures, AreTheSameForAnyNumberOfThreads) {
    const Example example;
    const std::vector<Picture> many = drawPictures(example.report);
    const ThreadLimitGuard one(1);
    const std::vector<Picture> alone = drawPictures(example.report);
    ASSERT_EQ(many.size(), alone.size());
    for (std::size_t n = 0; n < many.size(); ++n) EXPECT_EQ(many[n].png, alone[n].png);
}

TEST(Pictures, MarksAreShownWithTheSurfaceBeforeThem) {
    Report report;
    report.surfaces.push_back({"skin", testing::cubeMesh()});
    const std::string plain = [&] {
        Report marked = report;
        marked.surfaces.push_back({"electrodes", {}});
        marked.surfaces.back().areMarks = true;
        for (const Picture& picture : drawPictures(marked)) {
            if (picture.name == "alignment.png") return picture.png;
        }
        return std::string();
    }();
    const BoundingBox box = boundingBox(report.surfaces[0].mesh);
    const Vec3 middle = 0.5 * (box.minimum + box.maximum), size = box.size();
    report.surfaces.push_back({"electrodes", pointMarks({box.maximum}, 0.05 * size.x)});
    report.surfaces.push_back({"sources", pointMarks({middle}, 0.05 * size.x)});
    EXPECT_EQ(std::ssize(report.surfaces[1].mesh.triangles), 8);
    for (const std::size_t marks : {1, 2}) report.surfaces[marks].areMarks = true;
    const std::vector<Picture> pictures = drawPictures(report);
    const std::set<std::string> names = namesOf(pictures);
    EXPECT_TRUE(names.contains("alignment.png"));
    EXPECT_TRUE(names.contains("surface-1.png"));
    EXPECT_FALSE(names.contains("surface-2.png"));
    for (const Picture& picture : pictures) {
        if (picture.name == "alignment.png") {
            EXPECT_NE(picture.png, plain);
        }
    }
    EXPECT_EQ(drawViews(report, {.width = 40, .height = 30}).size(), 1U);
}

TEST(Views, AreTheSameForAnyNumberOfThreads) {
    const Example example;
    const ViewOptions options{.azimuthDeg = 30, .elevationDeg = 20, .width = 900, .height = 900};
    const std::vector<Picture> many = drawViews(example.report, options);
    const ThreadLimitGuard one(1);
    const std::vector<Picture> alone = drawViews(example.report, options);
    ASSERT_EQ(namesOf(many), (std::set<std::string>{"view-1.png", "view-2.png"}));
    ASSERT_EQ(many.size(), alone.size());
    for (std::size_t n = 0; n < many.size(); ++n) EXPECT_EQ(many[n].png, alone[n].png);
}

TEST(Views, ShowRegionsTogetherAndBrokenSurfacesAsFarAsTheyGo) {
    Example example;
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    example.report.surfaces.push_back({"broken", {{{kNan, 0, 0}, {1, 0, 0}}, {}, {{0, 1, 7}}}});
    EXPECT_EQ(drawViews(example.report, {.width = 40, .height = 30}).size(), 3U);
    example.report.areRegions = true;
    const std::vector<Picture> together = drawViews(example.report, {.width = 40, .height = 30});
    ASSERT_EQ(namesOf(together), std::set<std::string>{"view-1.png"});
    EXPECT_EQ(number(together[0].png, 16), 40);
    EXPECT_EQ(number(together[0].png, 20), 30);
    EXPECT_TRUE(drawViews(Report{}, {}).empty());
}

TEST(Pictures, AnythingBrokenIsDrawnAsFarAsItGoes) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    Report report;
    TriangleMesh mesh = testing::cubeMesh();
    mesh.points[3] = {kNan, kNan, kNan};
    mesh.triangles.push_back({0, 1, 1234});
    mesh.triangles.push_back({2, 2, 2});
    report.surfaces.push_back({"broken", mesh});
    report.surfaces.push_back({"empty", {}});
    report.surfaces.push_back({"a point", {{{1, 1, 1}}, {}, {{0, 0, 0}}}});
    const std::set<std::string> names = namesOf(drawPictures(report));
    EXPECT_TRUE(names.contains("surface-1.png"));
    EXPECT_TRUE(names.contains("surface-3.png"));
}

TEST(Pictures, NothingToShowGivesNone) {
    EXPECT_TRUE(drawPictures(Report{}).empty());
}

TEST(Viridis, RunsFromVioletToYellow) {
    EXPECT_EQ(viridis(0), (ReportColor{68, 1, 84}));
    EXPECT_EQ(viridis(1), (ReportColor{253, 231, 37}));
    EXPECT_EQ(viridis(-1), viridis(0));
    EXPECT_EQ(viridis(2), viridis(1));
    EXPECT_EQ(viridis(std::numeric_limits<double>::quiet_NaN()), viridis(0));
}

}  // namespace
}  // namespace adaptiso
