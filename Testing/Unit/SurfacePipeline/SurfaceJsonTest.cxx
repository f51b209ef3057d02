#include <gtest/gtest.h>

#include "Support/Pages.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso {
namespace {

TEST(Figures, OfNestedKeysAreObjects) {
    struct Owner {
        int a = 1;
    };
    const Figures<Owner> rows{
        {"one", "", [](const Owner& of) { return Json(of.a); }, "One", Shown::Count},
        {"in.two", "", [](const Owner&) { return Json(2.5); }, "Two", Shown::Plain},
        {"in.deep.none", "none", [](const Owner&) { return Json(); }, "None", Shown::Bound},
        {"text", "", [](const Owner&) { return Json("word"); }}};
    EXPECT_EQ(figuresJson(rows, Owner{}).dump(),
              R"({"one":1,"in":{"two":2.5,"deep":{"none":null}},"text":"word"})");
    EXPECT_EQ(figureColumns({"File"}, rows),
              (std::vector<std::string>{"File", "One", "Two", "None"}));
    EXPECT_EQ(figureCells({"a"}, rows, Owner{1234}),
              (std::vector<std::string>{"a", "1,234", "2.5", "–"}));
    EXPECT_EQ(figureLines(Figures<Owner>{rows[2]}, "."), "| `.in.deep.none` | none |\n");
}

TEST(SurfaceFigures, OfOtherMethodsHaveNoWork) {
    const SurfaceRecord record{};
    const Json json = figuresJson(surfaceFigures(), {record, Method::MarchingCubes, 4});
    EXPECT_EQ(json["adaptive"].dump(),
              R"({"runs":null,"placesMended":null,"verticesUndone":null,"trianglesKept":null})");
    EXPECT_EQ(json["blocks"]["size"], 4);
    EXPECT_EQ(json["isovalueChosenBy"], "user");
    EXPECT_TRUE(json["errorBoundMm"].is_null());
}

TEST(SurfaceFigures, StandInTheTableOfTheirPage) {
    std::string lines = figureLines(surfaceFigures(), ".");
    const std::string before = "| `.triangles`";
    lines.insert(lines.find(before), figureLines(workFigures(), ".adaptive."));
    testing::expectOnPage(MESH_PAGE, "| `.isovalue` |", "| `.output.file`", lines);
}

}  // namespace
}  // namespace adaptiso
