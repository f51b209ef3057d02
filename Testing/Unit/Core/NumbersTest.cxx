#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

TEST(ParseFiniteNumber, ReadsDecimalNumbers) {
    EXPECT_EQ(parseFiniteNumber("100"), 100);
    EXPECT_EQ(parseFiniteNumber("-0.5"), -0.5);
    EXPECT_EQ(parseFiniteNumber("+2.5e3"), 2500);
    EXPECT_EQ(parseFiniteNumber(".5"), 0.5);
}

TEST(ParseFiniteNumber, RefusesWhatIsNoFiniteNumber) {
    for (const char* text : {"", " 1", "1 ", "1x", "x", "nan", "inf", "-inf", "1e999", "0x10",
                             "1,5", "+-1", "++1", "--1", "+"}) {
        EXPECT_EQ(parseFiniteNumber(text), std::nullopt) << text;
    }
}

TEST(FormatNumber, IsShortAndReadsBack) {
    EXPECT_EQ(formatNumber(100), "100");
    EXPECT_EQ(formatNumber(100000), "100000");
    EXPECT_EQ(formatNumber(-200.25), "-200.25");
    EXPECT_EQ(formatNumber(0.1), "0.1");
    EXPECT_EQ(formatNumber(-0.0), "0");
    for (const double value :
         {1.0 / 3, 1e-300, -123456789.125, 1e22, std::numeric_limits<double>::max()}) {
        EXPECT_EQ(parseFiniteNumber(formatNumber(value)), value);
    }
}

TEST(FormatCount, GroupsThousands) {
    EXPECT_EQ(formatCount(0), "0");
    EXPECT_EQ(formatCount(999), "999");
    EXPECT_EQ(formatCount(1000), "1,000");
    EXPECT_EQ(formatCount(-123456), "-123,456");
    EXPECT_EQ(formatCount(1234567), "1,234,567");
}

}  // namespace
TEST(FormatRounded, GivesTheNearestWholeNumberInGroups) {
    EXPECT_EQ(formatRounded(1234567.5), "1,234,568");
    EXPECT_EQ(formatRounded(-0.4), "0");
}

TEST(FormatShort, HasSixDigitsAndWords) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(formatShort(1.0 / 3), "0.333333");
    EXPECT_EQ(formatShort(100000), "100000");
    EXPECT_EQ(formatShort(-0.0), "0");
    EXPECT_EQ(formatShort(std::numeric_limits<double>::max()), "1.79769e+308");
    EXPECT_EQ(formatShort(kInfinity), "infinity");
    EXPECT_EQ(formatShort(-kInfinity), "-infinity");
    EXPECT_EQ(formatShort(std::numeric_limits<double>::quiet_NaN()), "not a number");
}

TEST(FormatRounded, KeepsHugeNumbersShort) {
    EXPECT_EQ(formatRounded(1e30), "1e+30");
    EXPECT_EQ(formatRounded(std::numeric_limits<double>::infinity()), "infinity");
    EXPECT_EQ(formatFixed(1e300, 4), "1e+300");
}

TEST(FormatFixed, KeepsTheDigitsAskedFor) {
    EXPECT_EQ(formatFixed(0.1, 2), "0.10");
    EXPECT_EQ(formatFixed(-1234.5678, 3), "-1234.568");
    EXPECT_EQ(formatFixed(-0.04, 1), "0.0");
    EXPECT_EQ(formatFixed(-0.0, 0), "0");
    EXPECT_EQ(formatFixed(-0.06, 1), "-0.1");
}

TEST(FormatLength, KeepsThreeSignificantDigits) {
    EXPECT_EQ(formatLength(1.5, 4), "1.5000");
    EXPECT_EQ(formatLength(0.0123, 4), "0.0123");
    EXPECT_EQ(formatLength(0.00123456, 4), "0.00123");
    EXPECT_EQ(formatLength(0.00015, 4), "0.00015");
    EXPECT_EQ(formatLength(1.409e-5, 4), "1.41e-05");
    EXPECT_EQ(formatLength(-0.002, 1), "-0.002");
    EXPECT_EQ(formatLength(0.05, 3), "0.050");  // nothing is lost
    EXPECT_EQ(formatLength(3e-14, 3), "0.000");
    EXPECT_EQ(formatLength(0, 2), "0.00");
}

TEST(FormatBound, IsNeverLessThanTheBound) {
    EXPECT_EQ(formatBound(0.15), "0.1500");
    EXPECT_EQ(formatBound(0.07), "0.0700");
    EXPECT_EQ(formatBound(0.15000763), "0.15001");
    EXPECT_EQ(formatBound(0.00015), "0.00015");
    EXPECT_EQ(formatBound(0.000150001), "0.000151");
    EXPECT_EQ(formatBound(9.999e-5), "0.0001");
    EXPECT_EQ(formatBound(16.00001), "16.00001");
    EXPECT_EQ(formatBound(0), "0.0000");
    double value = 1e-9;
    for (int n = 0; n < 3000; ++n) {
        value *= 1.0123456789;
        for (const int digits : {2, 4}) {
            const double shown = *parseFiniteNumber(formatBound(value, digits));
            EXPECT_GE(shown, (1 - 1e-9) * value);
            EXPECT_LE(shown, std::max(value + std::pow(10, -digits), 1.01 * value));
        }
    }
}

TEST(FormatMeasure, KeepsThreeSignificantDigits) {
    EXPECT_EQ(formatMeasure(0.0028), "0.0028");
    EXPECT_EQ(formatMeasure(1.409e-5), "1.41e-05");
    EXPECT_EQ(formatMeasure(12.345), "12.3");
    EXPECT_EQ(formatMeasure(1234567.5), "1,234,568");
    EXPECT_EQ(formatMeasure(0), "0");
}

TEST(FormatApart, TellsDifferentNumbersApart) {
    using Texts = std::vector<std::string>;
    EXPECT_EQ(formatApart({1.0 / 3, 2}), (Texts{"0.333333", "2"}));
    EXPECT_EQ(formatApart({1000000.25, 1000000.5}), (Texts{"1000000.2", "1000000.5"}));
    EXPECT_EQ(formatApart({5, 5}), (Texts{"5", "5"}));
}

}  // namespace adaptiso
