#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "adaptiso-bids/Jobs.h"
#include "adaptiso-bids/QualityTable.h"
#include "adaptiso-bids/SideFiles.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::bids {
namespace {

TEST(BidsLabel, HasLettersAndDigitsAlone) {
    EXPECT_EQ(bidsLabel("411.5"), "411p5");
    EXPECT_EQ(bidsLabel("-300"), "m300");
    EXPECT_EQ(bidsLabel("1e-07"), "1em07");
    EXPECT_EQ(bidsLabel("1e+20"), "1e20");
    EXPECT_EQ(bidsLabel("auto"), "auto");
}

TEST(AgesIn, AreNumbersOfYears) {
    const std::string table =
        "participant_id\tage\tsex\nsub-01\t8\tF\n02\t0.5\tM\nsub-03\tn/a\nsub-04\t89+\n"
        "sub-05\t-1\nsub-06\t300\nsub-07\n\t9\n";
    const std::map<std::string, double> ages{{"sub-01", 8}, {"sub-02", 0.5}};
    EXPECT_EQ(agesIn(table, ""), ages);
    EXPECT_EQ(agesIn(table, R"({"age": {"Units": "years"}})"), ages);
    EXPECT_EQ(agesIn(table, R"({"sex": {}})"), ages);
    EXPECT_EQ(agesIn(table, R"({"age": {"Units": "yr"}})"), ages);
    EXPECT_DOUBLE_EQ(agesIn(table, R"({"age": {"Units": "Months"}})").at("sub-01"), 8.0 / 12);
    EXPECT_DOUBLE_EQ(agesIn(table, R"({"age": {"Units": "weeks"}})").at("sub-02"), 3.5 / 365.25);
    EXPECT_THROW(agesIn(table, R"({"age": {"Units": "parsec"}})"), FileError);
    EXPECT_TRUE(agesIn("participant_id\tsex\nsub-01\tF\n", "").empty());
}

TEST(QualityTable, HasARowOfCellsForEveryColumnThatTheDictionaryNames) {
    QualityRow row;
    row.participant = "sub-01";
    row.reason = "tab\there\nand line";
    row.name = "=1+1";
    row[Measure::AreaMm2] = 0.1;
    row[Measure::VolumeMm3] = -1.5;
    const std::string text = qualityTable({row});
    const std::string head = text.substr(0, text.find('\n'));
    const std::string line = text.substr(head.size() + 1);
    EXPECT_EQ(std::count(head.begin(), head.end(), '\t'),
              std::count(line.begin(), line.end(), '\t'));
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1);
    EXPECT_NE(line.find("\ttab here and line\t"), std::string::npos);
    EXPECT_NE(line.find("\t0.1\t"), std::string::npos);
    EXPECT_NE(line.find("\t'=1+1\t"), std::string::npos) << "no formula";
    EXPECT_NE(line.find("\t-1.5\t"), std::string::npos) << "a number";
    EXPECT_EQ(qualityDictionary({}).size(),
              static_cast<std::size_t>(std::count(head.begin(), head.end(), '\t')) + 1);
}

TEST(QualityTable, ComparesWhatIsAlike) {
    std::vector<QualityRow> rows;
    for (int n = 0; n < 12; ++n) {
        QualityRow row;
        row.product = "bem";
        row.part = n % 2 == 0 ? "inner_skull" : "outer_skin";
        row[Measure::VolumeMm3] = (n % 2 == 0 ? 1000 : 5000) + n;
        rows.push_back(row);
    }
    rows[0][Measure::VolumeMm3] = 5000;  // as large as the others' skin
    markOutliers(rows, {});
    EXPECT_EQ(rows[0].outliers.substr(0, 12), "volume_mm3:+");
    for (std::size_t n = 1; n < rows.size(); ++n) EXPECT_EQ(rows[n].outliers, "");
}

TEST(MarkOutliers, AsksForAnEffectAndTellsIt) {
    std::vector<QualityRow> rows(6);
    const double volumes[] = {1000, 1000.1, 999.9, 1000.1, 999.9, 1005};  // 0.5 %
    for (std::size_t n = 0; n < rows.size(); ++n) rows[n][Measure::VolumeMm3] = volumes[n];
    markOutliers(rows, {});
    EXPECT_EQ(rows[5].outliers, "");
    markOutliers(rows, {.limit = 3.5, .leastPercent = 0.4});
    // median 1000.05; distances 0.05 0.05 0.15 0.05 0.15 4.95: their median is 0.1
    EXPECT_EQ(rows[5].outliers, "volume_mm3:+33.4(+0.49%)");
    EXPECT_EQ(rows[0].outliers, "");
}

TEST(ProgramOptions, GiveValuesTheirCommas) {
    const ProgramInfo program{
        "adaptiso-x", {}, {}, {"iso", "largest", "crop", "vertices", "output"}};
    EXPECT_EQ(
        programOptions("--o", "iso=100,largest,crop=:,:,40:,vertices=1,2,3,iso=-3", program, {}),
        (std::vector<std::string>{"--iso=100", "--largest", "--crop=:,:,40:", "--vertices=1,2,3",
                                  "--iso=-3"}));
    EXPECT_TRUE(programOptions("--o", "", program, {}).empty());
    for (const char* const wrong : {"is0=1", "100", "--iso=3", "iso=", "output=x", ",iso=1"}) {
        EXPECT_THROW(programOptions("--o", wrong, program, {"output"}), UsageError) << wrong;
    }
}

}  // namespace
}  // namespace adaptiso::bids
