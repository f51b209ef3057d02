#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Common/BatchSummary.h"
#include "Common/Sha256.h"
#include "adaptiso/Core/Text.h"

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

    std::string page() const { return pageOf({row_}); }
    std::string pageOf(std::vector<SummaryRow> rows) const {
        Summary summary{std::move(rows)};
        summary.program = "adaptiso-mesh 1.2.3";
        summary.command = "adaptiso-mesh INPUT... --output-dir out";
        return summaryPage(summary, folder_ / "summary.html");
    }
    /// `count` runs of alike volumes, and one of `other` mm3.
    static std::vector<SummaryRow> runs(int count, double other) {
        std::vector<SummaryRow> rows;
        for (int n = 0; n <= count; ++n) {
            SummaryRow row{"adaptiso-mesh", "run" + std::to_string(n)};
            row.file = row.name + ".nii";
            row.state = RunState::Done;
            row.volumesMm3 = {{"", n == count ? other : 1000 + n}};
            rows.push_back(row);
        }
        return rows;
    }
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
    EXPECT_NE(text.find("<th scope=\"row\"><a href=\"reports/a.html\">a</a></th>"),
              std::string::npos);
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
    std::string text = pageOf({row_, other});
    for (const char* const column : {"Program", "Input", "Picture", "Files", "Volume, mm³"}) {
        EXPECT_EQ(text.find(column + std::string("</th>")), std::string::npos) << column;
    }
    EXPECT_NE(text.find("<h1>2 runs of adaptiso-mesh</h1>"), std::string::npos);
    write("p/surface-1.png", "png");
    row_.pictures = folder_ / "p";
    other.program = "adaptiso-check";
    other.file = "scan.nii";
    text = pageOf({row_, other});
    for (const char* const column : {"Program", "Input", "Picture"}) {
        EXPECT_NE(text.find(column + std::string("</th>")), std::string::npos) << column;
    }
}

TEST_F(BatchSummaryTest, RunsItsOwnScriptAloneAndLoadsPicturesAlone) {
    const std::string text = page();
    const std::size_t policy = text.find("Content-Security-Policy");
    ASSERT_NE(policy, std::string::npos);
    EXPECT_LT(policy, text.find("<style>"));
    const std::string begin = "<script>";
    const std::size_t script = text.find(begin) + begin.size();
    const std::string hex =
        sha256Of(std::string_view(text).substr(script, text.find("</script>") - script));
    std::string sum;
    for (std::size_t n = 0; n < hex.size(); n += 2) {
        sum += static_cast<char>(std::stoi(hex.substr(n, 2), nullptr, 16));
    }
    EXPECT_NE(text.find("default-src 'none'; img-src 'self' file:; script-src 'sha256-" +
                            encodeBase64(sum) + "'; ",
                        policy),
              std::string::npos);
    EXPECT_EQ(text.find("connect-src"), std::string::npos);
    EXPECT_EQ(text.find("<script>"), text.rfind("<script>"));
}

TEST_F(BatchSummaryTest, HoldsWhatMadeItAndWhatMakesItAgain) {
    const std::string text = page();
    EXPECT_NE(text.find("<dd>adaptiso-mesh 1.2.3</dd>"), std::string::npos);
    EXPECT_NE(text.find("<dd>adaptiso-mesh INPUT... --output-dir out</dd>"), std::string::npos);
}

TEST_F(BatchSummaryTest, EscapesTextsAndIsTheSameForTheSameRows) {
    row_.name = row_.says = row_.reason = "<b onclick=x>\"&'";
    row_.warnings = {{"<i>", "<i>"}};
    row_.volumesMm3 = {{"<u>", 5}};
    std::vector<SummaryRow> rows(7, row_);
    rows.back().volumesMm3 = {{"<u>", 500}};
    const std::string text = pageOf(rows);
    EXPECT_EQ(text, pageOf(rows));
    for (const char* const tag : {"<b ", "<i>", "<u>"}) {
        EXPECT_EQ(text.find(tag), std::string::npos) << tag;
    }
}

TEST_F(BatchSummaryTest, CountsEachRunOnceForItsReason) {
    std::vector<SummaryRow> rows = runs(6, 1000);
    rows[0].state = rows[2].state = rows[5].state = RunState::Failed;
    rows[0].reason = rows[5].reason = "closed";
    rows[2].reason = "truncated";
    rows[1].warnings = rows[2].warnings = {{"guessed-unit"}, {"guessed-unit"}};
    rows[1].warnings.push_back({"not-finite"});
    const std::vector<SummaryReason> reasons = reasonsOf(rows);
    ASSERT_EQ(reasons.size(), 4U);
    EXPECT_EQ(reasons[0].reason, "closed");
    EXPECT_EQ(reasons[0].names, (std::vector<std::string>{"run0.nii", "run5.nii"}));
    EXPECT_EQ(reasons[1].reason, "truncated");
    EXPECT_EQ(reasons[2].reason, "guessed-unit");
    std::size_t failed = 0;
    for (const SummaryReason& reason : reasons)
        failed += reason.isWarning ? 0 : reason.names.size();
    EXPECT_EQ(failed, 3U);
}

TEST_F(BatchSummaryTest, DrawsChartsOfFiveRunsAndMore) {
    EXPECT_EQ(pageOf(runs(3, 1900)).find("<svg"), std::string::npos);
    EXPECT_NE(pageOf(runs(6, NAN)).find("</strong>, 6 runs, median"), std::string::npos);
    const std::string text = pageOf(runs(6, 1900));
    EXPECT_NE(text.find("Outliers: <a href=\"#run-7\">run6</a> (+89%)"), std::string::npos);
    EXPECT_NE(text.find("more than 3.5 robust standard deviations"), std::string::npos);
    EXPECT_EQ(text.find("<circle class=\"apart\""), text.rfind("<circle class=\"apart\""));
    EXPECT_EQ(pageOf(runs(6, 1003)).find("Outliers:"), std::string::npos);
    // six lie between 1000 and 1005: an axis to 1900 would show them as one dot
    EXPECT_NE(text.find(">≥ 1,015 mm³</text>"), std::string::npos);
    EXPECT_NE(text.find("Dots at an end with ≤ or ≥"), std::string::npos);
    EXPECT_EQ(pageOf(runs(6, 1003)).find("≥"), std::string::npos);
}

TEST_F(BatchSummaryTest, DrawsNoChartOfWhatNoAxisHolds) {
    std::vector<SummaryRow> rows = runs(6, 1e308);
    rows[0].volumesMm3.front().second = -1e308;  // their difference is no number
    EXPECT_EQ(pageOf(rows).find("<svg"), std::string::npos);
    for (SummaryRow& row : rows) row.volumesMm3.front().second = 0;
    rows[0].volumesMm3.front().second = 5;  // part of a median that is 0
    const std::string text = pageOf(rows);
    EXPECT_NE(text.find("(+inf%)"), std::string::npos);
    EXPECT_EQ(text.find("not a number"), std::string::npos);
    for (SummaryRow& row : rows) row.volumesMm3.front().second = 7;
    EXPECT_EQ(pageOf(rows).find("<svg"), std::string::npos);
}

TEST_F(BatchSummaryTest, SortsByNumbersAndStates) {
    std::vector<SummaryRow> rows = runs(1, 123456.75);
    rows[0].state = RunState::Unusual;
    rows[1].seconds = 12.345;
    const std::string text = pageOf(rows);
    for (const char* const key : {"data-key=\"5\">▲", "data-key=\"7\">✔",
                                  "data-key=\"123456.75\">123,457<", "data-key=\"12.345\">12.3<"}) {
        EXPECT_NE(text.find(key), std::string::npos) << key;
    }
}

TEST_F(BatchSummaryTest, RanksByWhatMustBeLookedAtFirst) {
    const std::vector<Warning> one{{"not-finite", "5 samples are <NaN>"}}, two(2, one.front());
    std::vector<RunRecord> records(5, RunRecord{"adaptiso-mesh", "1"});
    for (RunRecord& record : records) record.hasEnded = true;
    records[0].name = "passed";
    records[1].name = "warned";
    records[1].warnings = one;
    records[2].name = "warned twice";
    records[2].warnings = two;
    records[3].name = "check";
    records[3].exitCode = 1;
    records[4].name = "failed";
    records[4].exitCode = 3;
    std::vector<SummaryRow> rows;
    for (const RunRecord& record : records) rows.push_back(recordRow(record));
    sortByNeed(rows);
    std::string order;
    for (const SummaryRow& row : rows) order += row.name + "; ";
    EXPECT_EQ(order, "failed; check; warned twice; warned; passed; ");
    EXPECT_EQ(verdictOf(rows), "1 of 5 failed, 1 with a failed check, 2 with warnings");
    EXPECT_NE(pageOf(rows).find("▲ 2 warnings: 5 samples are &lt;NaN&gt;</td>"), std::string::npos);
}

TEST_F(BatchSummaryTest, SaysTheVerdictInWords) {
    row_.state = RunState::Failed;
    EXPECT_NE(page().find("1 of 1 failed"), std::string::npos);
    EXPECT_NE(page().find("<title>FAILED: "), std::string::npos);
    row_.state = RunState::Done;
    EXPECT_NE(page().find("All 1 done"), std::string::npos);
    EXPECT_NE(page().find("<title>PASSED: "), std::string::npos);
    row_.warnings = {{"not-finite"}};
    EXPECT_NE(page().find("<title>PASSED WITH WARNINGS: "), std::string::npos);
    row_.state = RunState::NotFinished;
    EXPECT_NE(page().find("<title>NOT FINISHED: "), std::string::npos);
    row_.state = RunState::NotRun;
    SummaryRow gone = row_, half = row_;
    gone.state = RunState::Changed;
    half.state = RunState::NotFinished;
    const std::string text = pageOf({row_, gone, half});
    EXPECT_NE(text.find("1 of 3 missing or changed, 1 not finished, 1 not run"), std::string::npos);
    EXPECT_EQ(text.find("✔"), std::string::npos);
    EXPECT_EQ(pageOf({}).find("All"), std::string::npos);
}

}  // namespace
}  // namespace adaptiso
