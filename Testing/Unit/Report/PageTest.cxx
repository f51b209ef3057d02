#include <gtest/gtest.h>

#include <cstdlib>

#include "PageParts.h"
#include "Support/Meshes.h"
#include "adaptiso/Report/Page.h"

namespace adaptiso {
namespace {

Report example() {
    Report report;
    report.program = "adaptiso-check";
    report.version = "1.2.3";
    report.date = "2026-11-21 09:20 UTC";
    report.title = "Check of a.stl";
    report.verdict = ReportVerdict::Failed;
    report.headline = "1 check failed.";
    report.inputs = {{"Surface", "a.stl"}};
    report.checks = {{"a.stl", "closed", ReportOutcome::Failed, "a hole"},
                     {"a.stl", "genus 0", ReportOutcome::Passed, ""}};
    report.surfaces.push_back({"a.stl", testing::icosphere(2, {}, 10)});
    report.spots.push_back({"hole", {1, 2, 3}});
    return report;
}

bool holds(const std::string& page, const std::string& text) {
    return page.find(text) != std::string::npos;
}

TEST(Page, TellsTheVerdictInWords) {
    Report report = example();
    EXPECT_TRUE(holds(htmlPage(report, {}), "FAILED: Check of a.stl"));
    report.verdict = ReportVerdict::Passed;
    report.warnings = {"a part of the brain may be missing"};
    EXPECT_TRUE(holds(htmlPage(report, {}), "PASSED WITH WARNINGS: Check of a.stl"));
    EXPECT_TRUE(holds(htmlPage(report, {}), "verdict doubtful"));
    report.warnings.clear();
    EXPECT_TRUE(holds(htmlPage(report, {}), "PASSED: Check of a.stl"));
    report.verdict = ReportVerdict::Done;
    EXPECT_TRUE(holds(htmlPage(report, {}), "DONE: Check of a.stl"));
}

TEST(Page, HoldsWhatItWasGiven) {
    const std::string page = htmlPage(example(), {{"p.png", "A title", "An alt", "PNG", 3, 4}});
    for (const char* text :
         {"adaptiso-check 1.2.3", "2026-11-21 09:20 UTC", "1 check failed.", "a hole",
          "(-1.0, -2.0, 3.0)", "alt=\"An alt\"", "A title", "data:image/png;base64,UE5H"}) {
        EXPECT_TRUE(holds(page, text)) << text;
    }
}

TEST(Page, TellsWarningsBesideTheVerdict) {
    Report report = example();
    report.verdict = ReportVerdict::Passed;
    report.warnings = {"warning A7", "warning B7", "warning C7", "warning D7"};
    report.notes = {"a remark"};
    const std::string page = htmlPage(report, {});
    const std::size_t bannerEnd = page.find("</header>"), notes = page.find("id=\"notes\"");
    for (const char* shown : {"warning A7", "warning B7", "warning C7"}) {
        EXPECT_LT(page.find("<li><strong>Warning</strong>: " + std::string(shown)), bannerEnd);
        EXPECT_FALSE(holds(page.substr(notes), shown));
    }
    EXPECT_LT(page.find("<a href=\"#notes\">and 1 more</a>"), bannerEnd);
    EXPECT_TRUE(holds(page.substr(notes), "<li>Warning: warning D7</li>\n<li>a remark</li>"));
}

TEST(Page, ForbidsToLoadAnything) {
    EXPECT_TRUE(holds(htmlPage(example(), {}), "default-src 'none'"));
}

TEST(Page, TextsAreTextsWhateverTheyHold) {
    Report report = example();
    const std::string evil = "</script><script>alert('\"1\"')</script>{{TITLE}}&\x01\xff";
    report.title = report.headline = report.surfaces[0].name = evil;
    report.inputs = report.options = {{evil, evil}};
    report.checks[0].finding = report.spots[0].what = evil;
    report.tables = {{evil, {evil}, {{evil}}}};
    report.notes = report.warnings = {evil};
    const std::string page = htmlPage(report, {{"p.png", evil, evil, "", 1, 1}});
    EXPECT_FALSE(holds(page, "<script>alert"));
    EXPECT_FALSE(holds(page, "\"1\")"));
    EXPECT_TRUE(holds(page, "{{TITLE}}"));  // as it was given, not filled in
}

TEST(Page, RowsMayBeLongerThanTheHead) {
    Report report = example();
    report.tables = {{"A table", {"Name"}, {{"first", "second", "third"}}}};
    EXPECT_TRUE(holds(htmlPage(report, {}),
                      "first</th><td data-label=\"\">second</td><td data-label=\"\">third</td>"));
}

TEST(Page, EscapesWhatHtmlTakesForItself) {
    EXPECT_EQ(escaped("a<b>&\"c\"'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;");
    EXPECT_EQ(escaped("\xff"), "\uFFFD");
    EXPECT_EQ(escaped("Zürich µm"), "Zürich µm");
}

TEST(Page, SpotsMoveTheViewerWhereThereIsOne) {
    EXPECT_EQ(holds(htmlPage(example(), {}), "data-spot=\"0\""), hasViewer());
    EXPECT_EQ(holds(htmlPage(example(), {}), "id=\"surface-0\""), hasViewer());
    EXPECT_EQ(holds(htmlPage(example(), {}), "without the interactive viewer"), !hasViewer());
}

TEST(Page, NothingToSeeNeedsNoViewer) {
    Report report = example();
    report.surfaces.clear();
    EXPECT_FALSE(holds(htmlPage(report, {}), "data-spot"));
    EXPECT_FALSE(holds(htmlPage(report, {}), "id=\"viewer\""));
}

TEST(Page, ViewerGetsNoMoreThanItCanShow) {
    if (!hasViewer()) GTEST_SKIP() << "built without niivue";
    PageOptions options;
    options.maxTriangles = 100;
    EXPECT_TRUE(holds(htmlPage(example(), {}, options), "coarser than they are"));
    EXPECT_FALSE(holds(htmlPage(example(), {}), "coarser than they are"));
}

TEST(Notebook, HasAPictureAndWhereItCanAViewerThatReachesNothing) {
    const std::string html = notebookHtml(example(), {"p.png", "A title", "An alt", "PNG", 3, 4});
    EXPECT_TRUE(holds(html, "alt=\"An alt\""));
    EXPECT_TRUE(holds(html, "src=\"data:image/png;base64,UE5H\""));
    EXPECT_TRUE(holds(html, "<p>Check of a.stl</p>"));
    EXPECT_EQ(holds(html, "sandbox=\"allow-scripts\""), hasViewer());
    EXPECT_EQ(holds(html, "default-src &#39;none&#39;"), hasViewer());
    EXPECT_FALSE(holds(html, "<script"));  // all scripts are in the frame
}

TEST(Notebook, TextsAreTextsWhateverTheyHold) {
    Report report = example();
    const std::string evil = "</iframe></script><script>alert('1')</script>\"{{STYLE}}\xff";
    report.title = report.surfaces[0].name = evil;
    const std::string html = notebookHtml(report, {"p.png", evil, evil, "", 1, 1});
    EXPECT_FALSE(holds(html, "<script"));
    EXPECT_EQ(html.find("</iframe>"), html.rfind("</iframe>"));  // the frame's own end
    if (!hasViewer()) return;
    const std::size_t begin = html.find("srcdoc="), end = html.find("</iframe>");
    EXPECT_FALSE(holds(html.substr(begin, end - begin), "&lt;script&gt;alert"));
}

TEST(Notebook, SaysThatItShowsLess) {
    if (!hasViewer()) GTEST_SKIP() << "built without niivue";
    PageOptions options;
    options.maxTriangles = 100;
    EXPECT_TRUE(holds(notebookHtml(example(), {}, options), "coarser than they are"));
    EXPECT_FALSE(holds(notebookHtml(example(), {}), "coarser than they are"));
}

TEST(Page, RegionsAreAListToClickInTheirOwnColors) {
    if (!hasViewer()) GTEST_SKIP() << "built without niivue";
    Report report = example();
    EXPECT_TRUE(holds(htmlPage(report, {}), "\"areRegions\":false"));
    report.areRegions = true;
    report.surfaces.front().color = ReportColor{1, 2, 3};
    // two balls: the middle of their box lies in neither
    TriangleMesh second = testing::icosphere(2, {-30, 4, 5}, 10);
    TriangleMesh both = testing::icosphere(2, {30, 4, 5}, 9);
    const auto before = std::ssize(both.points);
    both.points.insert(both.points.end(), second.points.begin(), second.points.end());
    for (Triangle t : second.triangles) {
        for (VertexId& v : t) v += before;
        both.triangles.push_back(t);
    }
    report.surfaces.push_back({"both", both});
    const std::string page = htmlPage(report, {});
    EXPECT_TRUE(holds(page, "\"areRegions\":true"));
    EXPECT_TRUE(holds(page, "\"color\":[1,2,3],\"opacity\":1.0"));
    EXPECT_FALSE(holds(page, "\"opacity\":0.35"));
    // the middle of the larger, in RAS
    const std::size_t at = page.find("\"point\":[", page.find("\"name\":\"both\""));
    ASSERT_NE(at, std::string::npos);
    EXPECT_NEAR(std::stod(page.substr(at + 9)), 30, 0.5);
}

TEST(ReportDate, IsThatOfSourceDateEpoch) {
    setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
    EXPECT_EQ(reportDate(), "2023-11-14 22:13 UTC");
    setenv("SOURCE_DATE_EPOCH", "no number", 1);
    EXPECT_NE(reportDate(), "2023-11-14 22:13 UTC");
    unsetenv("SOURCE_DATE_EPOCH");
}

}  // namespace
}  // namespace adaptiso
