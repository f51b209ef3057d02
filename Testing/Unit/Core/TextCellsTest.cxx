#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "adaptiso/Core/TextCells.h"

namespace adaptiso {
namespace {

using Cells = std::vector<std::string>;

TEST(TextCells, AreCutAtTheSeparatorThatTheFirstLineHas) {
    EXPECT_EQ(separatorOf("index\tname, long"), '\t');
    EXPECT_EQ(separatorOf("ROIid;ROIname, long"), ';');
    EXPECT_EQ(separatorOf("index,name"), ',');
    EXPECT_EQ(separatorOf("index name"), '\0');
    EXPECT_EQ(cellsOf("1\t a b \t", '\t'), (Cells{"1", "a b", ""}));
    EXPECT_EQ(cellsOf("1;\"a;\"\"b\"\"\";", ';'), (Cells{"1", "a;\"b\"", ""}));
    EXPECT_EQ(cellsOf("1\t\"a b\"\t5\" disc", '\t'), (Cells{"1", "a b", "5\" disc"}));
    EXPECT_EQ(cellsOf("1,\"a", ','), std::nullopt);
}

TEST(TextCells, NumbersAreReadAsProgramsWriteThem) {
    EXPECT_EQ(cellNumber(" -1.5 ", '\t'), -1.5);
    EXPECT_EQ(cellNumber("+1e3", '\t'), 1000);
    EXPECT_EQ(cellNumber("1.0D+02", '\t'), 100);
    EXPECT_EQ(cellNumber("12,5", '\t'), 12.5);
    EXPECT_EQ(cellNumber("-1,25e1", ';'), -12.5);
    EXPECT_EQ(cellNumber("12,5", ','), std::nullopt);
    EXPECT_EQ(cellNumber("1.234,5", '\t'), std::nullopt) << "thousands";
    EXPECT_EQ(cellNumber("1,234,567", '\t'), std::nullopt) << "thousands";
    EXPECT_EQ(cellNumber("1,234.5", '\t'), std::nullopt) << "thousands";
    EXPECT_EQ(cellNumber("12.5mm", '\t'), std::nullopt);
    EXPECT_EQ(cellNumber("one", '\t'), std::nullopt);
    EXPECT_EQ(cellNumber("-inf", '\t'), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(cellNumber("1.#INF", '\t'), std::numeric_limits<double>::infinity());
    for (const char* const cell : {"", " ", "n/a", "N/A", "NaN", "nan", "-nan", "NA", "null",
                                   "-1.#IND", "1.#QNAN", "#N/A"}) {
        EXPECT_TRUE(isMissing(cell)) << cell;
        const auto value = cellNumber(cell, '\t');
        ASSERT_TRUE(value) << cell;
        EXPECT_TRUE(std::isnan(*value)) << cell;
    }
    EXPECT_FALSE(isMissing("0"));
    EXPECT_FALSE(isMissing("Nasion"));
}

TEST(TextCells, AreNoFormulasWhenWrittenAndComeBack) {
    for (const auto& [text, cell] : std::vector<std::pair<std::string, std::string>>{
             {"=HYPERLINK(\"http://x/\"&A1,\"click\")", "'=HYPERLINK(\"http://x/\"&A1,\"click\")"},
             {"@SUM(A1)", "'@SUM(A1)"},
             {"+cmd|' /C calc'!A0", "'+cmd|' /C calc'!A0"},
             {"-left", "'-left"},
             {"\"=1+1\"", "'\"=1+1\""},
             {"'=1", "''=1"},
             {"\xEF\xBC\x9D"
              "1+1",
              "'\xEF\xBC\x9D"
              "1+1"},
             {"-1.5", "-1.5"},
             {"+2e3", "+2e3"},
             {"Femur_L", "Femur_L"},
             {"5'-end", "5'-end"},
             {"'quoted'", "'quoted'"},
             {"a=b", "a=b"}}) {
        EXPECT_EQ(writtenCell(text), cell);
        EXPECT_EQ(cellsOf("1\t" + writtenCell(text), '\t'), (Cells{"1", text})) << text;
    }
    EXPECT_EQ(writtenCell("\t=1+1"), "' =1+1") << "a control character before it hides nothing";
    EXPECT_EQ(writtenCell("a\r\n\x7f"
                          "b"),
              "a   b");
    EXPECT_EQ(writtenCell(""), "n/a");
}

}  // namespace
}  // namespace adaptiso
