#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "Common/BatchSummary.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

class BatchSummaryTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(::testing::TempDir()) / ("BatchSummary-" + std::string(test->name()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        row_.name = "a";
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string page() const { return summaryPage({row_}, folder_ / "summary.html"); }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
    }

    fs::path folder_;
    SummaryRow row_;
};

TEST_F(BatchSummaryTest, LinksTheReport) {
    write("reports/a.html", "<img src=\"data:image/png;base64,AAAA\">");
    row_.report = folder_ / "reports/a.html";
    const std::string text = page();
    EXPECT_NE(text.find("<a href=\"reports/a.html\">report of a</a>"), std::string::npos);
    EXPECT_EQ(text.find("<img"), std::string::npos);  // 1,000 reports would be 300 MB
}

TEST_F(BatchSummaryTest, LinksAPictureOfItsFolderToTheReport) {
    write("a.html", "<img src=\"data:image/png;base64,AAAA\">");
    write("a pictures/surface-1.png", "png");
    row_.report = folder_ / "a.html";
    row_.pictures = folder_ / "a pictures";
    const std::string text = page();
    EXPECT_NE(text.find("<a href=\"a.html\"><img src=\"a%20pictures/surface-1.png\""),
              std::string::npos);
    EXPECT_EQ(text.find("AAAA"), std::string::npos);
}

TEST_F(BatchSummaryTest, HasNoPictureWhereTheReportHasNone) {
    write("a.html", "<p>no renderer");
    row_.report = folder_ / "a.html";
    EXPECT_EQ(page().find("<img"), std::string::npos);
}

TEST_F(BatchSummaryTest, HasNoColumnThatSaysNothing) {
    SummaryRow other = row_;
    row_.program = other.program = "adaptiso-mesh";
    row_.file = "a.nii.gz";
    other.name = "b";
    other.file = "b.nii.gz";
    std::string text = summaryPage({row_, other}, folder_ / "summary.html");
    for (const char* const column : {"program", "input", "picture"}) {
        EXPECT_EQ(text.find("<th>" + std::string(column)), std::string::npos) << column;
    }
    EXPECT_NE(text.find(", adaptiso-mesh</p>"), std::string::npos);
    write("p/surface-1.png", "png");
    row_.pictures = folder_ / "p";
    other.program = "adaptiso-check";
    other.file = "scan.nii";
    text = summaryPage({row_, other}, folder_ / "summary.html");
    for (const char* const column : {"program", "input", "picture"}) {
        EXPECT_NE(text.find("<th>" + std::string(column)), std::string::npos) << column;
    }
}

TEST_F(BatchSummaryTest, ForbidsItselfScriptsAndConnections) {
    const std::string text = page();
    const std::size_t policy = text.find("Content-Security-Policy");
    ASSERT_NE(policy, std::string::npos);
    EXPECT_LT(policy, text.find("<style>"));
    EXPECT_NE(text.find("default-src 'none'; img-src 'self' file:;"), std::string::npos);
    EXPECT_EQ(text.find("script-src"), std::string::npos);
}

TEST_F(BatchSummaryTest, SaysTheVerdictInWords) {
    row_.state = RunState::Failed;
    EXPECT_NE(page().find("1 of 1 failed"), std::string::npos);
    row_.state = RunState::Done;
    EXPECT_NE(page().find("All 1 done"), std::string::npos);
    row_.state = RunState::NotRun;
    SummaryRow gone = row_, half = row_;
    gone.state = RunState::Changed;
    half.state = RunState::NotFinished;
    const std::string text = summaryPage({row_, gone, half}, folder_ / "summary.html");
    EXPECT_NE(text.find("1 of 3 missing or changed, 1 not finished, 1 not run"), std::string::npos);
    EXPECT_EQ(text.find("class=\"ok\""), std::string::npos);
    EXPECT_EQ(summaryPage({}, folder_ / "summary.html").find("done"), std::string::npos);
}

}  // namespace
}  // namespace adaptiso
