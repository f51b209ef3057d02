#include <gtest/gtest.h>

#include "Common/UsageWords.h"

namespace adaptiso {
namespace {

const std::vector<std::string> kNames{"iso",    "info",   "index",     "method",
                                      "border", "search", "triangles", "min-volume"};

TEST(NearestWord, FindsSlipsOfTheKeyboard) {
    EXPECT_EQ(nearestWord("isso", kNames), "iso");
    EXPECT_EQ(nearestWord("ios", kNames), "iso");  // a swap is one slip
    EXPECT_EQ(nearestWord("tirangels", kNames), "triangles");
    EXPECT_EQ(nearestWord("minvolume", kNames), "min-volume");
    EXPECT_EQ(nearestWord("boder", kNames), "border");
}

TEST(NearestWord, FindsWhatBeginsAlike) {
    EXPECT_EQ(nearestWord("isovalue", kNames), "iso");
    EXPECT_EQ(nearestWord("tri", kNames), "triangles");
}

TEST(NearestWord, GuessesNothingFromAfar) {
    for (const char* typed : {"", "x", "mi", "frobnicate", "colour", "xyz"}) {
        EXPECT_EQ(nearestWord(typed, kNames), std::nullopt) << typed;
    }
}

TEST(Shown, QuotesBlanksAndCutsWhatIsLong) {
    EXPECT_EQ(shown("1.5"), "1.5");
    EXPECT_EQ(shown(""), "''");
    EXPECT_EQ(shown("a b"), "'a b'");
    EXPECT_EQ(shown(std::string(61, '9')), std::string(60, '9') + "...");
    EXPECT_EQ(shown(std::string(59, 'a') + "\xc3\xa4\xc3\xa4"), std::string(59, 'a') + "...");
}

}  // namespace
}  // namespace adaptiso
