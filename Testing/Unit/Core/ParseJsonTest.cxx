#include <gtest/gtest.h>

#include <string>

#include "adaptiso/Core/ParseJson.h"

namespace adaptiso {
namespace {

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

struct FakeJson {
    enum class value_t { discarded };
    explicit FakeJson(value_t) : isDiscarded(true) {}
    FakeJson() = default;
    static FakeJson parse(std::string_view, std::nullptr_t, bool) { return {}; }
    bool isDiscarded = false;
};

TEST(ParseJson, DoesNotHandDeepNestingOn) {
    EXPECT_FALSE(parseJson<FakeJson>(nested(100)).isDiscarded);
    EXPECT_TRUE(parseJson<FakeJson>(nested(101)).isDiscarded);
}

}  // namespace
}  // namespace adaptiso
