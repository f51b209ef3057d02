#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "adaptiso/Core/ParseJson.h"

namespace adaptiso {
namespace {

using Json = nlohmann::json;

std::string nested(std::size_t depth, const std::string& begin = "[",
                   const std::string& end = "]") {
    std::string text;
    for (std::size_t n = 0; n < depth; ++n) text += begin;
    text += "1";
    for (std::size_t n = 0; n < depth; ++n) text += end;
    return text;
}

TEST(ParseJson, DeepNestingIsSeenWhateverItIsOf) {
    EXPECT_FALSE(isDeeplyNested(""));
    EXPECT_FALSE(isDeeplyNested(nested(100)));
    EXPECT_TRUE(isDeeplyNested(nested(101)));
    EXPECT_TRUE(isDeeplyNested(nested(400'000)));
    EXPECT_TRUE(isDeeplyNested(nested(101, R"({"a":)", "}")));
    EXPECT_TRUE(isDeeplyNested(nested(51, R"([{"a":)", "}]")));
    EXPECT_TRUE(isDeeplyNested(std::string(101, '[')));  // damaged as well
}

TEST(ParseJson, BracketsInTextsAndSiblingsDoNotNest) {
    EXPECT_FALSE(isDeeplyNested('"' + std::string(1000, '[') + '"'));
    EXPECT_FALSE(isDeeplyNested(R"(["\")" + std::string(1000, '[') + "\"]"));
    EXPECT_TRUE(isDeeplyNested(R"(["\\")" + std::string(1000, '[') + "]"));
    std::string siblings = "[";
    for (int n = 0; n < 1000; ++n) siblings += "[],{},";
    EXPECT_FALSE(isDeeplyNested(siblings + "[]]"));
}

bool isTaken(const std::string& text) {
    return !parseJson<Json>(text).is_discarded() &&
           !parseJson<nlohmann::ordered_json>(text).is_discarded();
}

TEST(ParseJson, DoesNotHandDeepNestingOn) {
    EXPECT_TRUE(isTaken(nested(100)));
    EXPECT_FALSE(isTaken(nested(101)));
}

TEST(ParseJson, GivesTheValuesOrDiscardsWhatIsNoJson) {
    const std::string text = R"({"a":[1,-2,3.5,true,null,"b",{}],"c":{"a":1}})";
    EXPECT_EQ(parseJson<Json>(text), Json::parse(text));
    for (const char* const bad : {"", "{", "[1,]", R"({"a":1}x)", "nul"}) {
        EXPECT_FALSE(isTaken(bad)) << bad;
    }
}

/// In time that grows with the length: squared, it would take hours.
TEST(ParseJson, TakesLongListsOfObjects) {
    std::string text = "[";
    for (int n = 0; n < 500'000; ++n) text += "{},";
    EXPECT_EQ(parseJson<Json>(text + "{}]").size(), 500'001U);
}

TEST(ParseJson, WholeNumbersAreNotConverted) {
    EXPECT_EQ(wholeNumber<std::int64_t>(Json::parse("-7")), -7);
    EXPECT_EQ(wholeNumber<std::uint64_t>(Json::parse("18446744073709551615")), UINT64_MAX);
    for (const char* const text : {"5e27", "1.0", "1e3", "99999999999999999999", "\"7\"", "null"}) {
        EXPECT_THROW(wholeNumber<std::int64_t>(Json::parse(text)), Json::exception) << text;
    }
}

TEST(ParseJson, RefusesAKeyTwiceInOneObject) {
    EXPECT_TRUE(isTaken(R"({"a":{"a":1,"b":2},"c":{"a":1},"b":3})"));
    EXPECT_FALSE(isTaken(R"({"a":{"b":1},"a":2})"));
    EXPECT_FALSE(isTaken(R"([{"a":{"b":1,"b":2}}])"));
}

}  // namespace
}  // namespace adaptiso
