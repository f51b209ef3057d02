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

struct FakeJson {
    enum class value_t { discarded };
    explicit FakeJson(value_t) : isDiscarded(true) {}
    FakeJson() = default;
    enum class Event { object_start, key, object_end };
    /// As nlohmann's, of objects and texts alone.
    template <class Look>
    static FakeJson parse(std::string_view text, const Look& look, bool) {
        for (const char c : text) {
            FakeJson key;
            key.text = c;
            if (c == '{') look(0, Event::object_start, key);
            if (c == '}') look(0, Event::object_end, key);
            if (c >= 'a' && c <= 'z') look(0, Event::key, key);
        }
        return {};
    }
    template <class>
    std::string get() const {
        return text;
    }
    std::string text;
    bool isDiscarded = false;
};

TEST(ParseJson, DoesNotHandDeepNestingOn) {
    EXPECT_FALSE(parseJson<FakeJson>(nested(100)).isDiscarded);
    EXPECT_TRUE(parseJson<FakeJson>(nested(101)).isDiscarded);
}

TEST(ParseJson, WholeNumbersAreNotConverted) {
    EXPECT_EQ(wholeNumber<std::int64_t>(Json::parse("-7")), -7);
    EXPECT_EQ(wholeNumber<std::uint64_t>(Json::parse("18446744073709551615")), UINT64_MAX);
    for (const char* const text : {"5e27", "1.0", "1e3", "99999999999999999999", "\"7\"", "null"}) {
        EXPECT_THROW(wholeNumber<std::int64_t>(Json::parse(text)), Json::exception) << text;
    }
}

TEST(ParseJson, RefusesAKeyTwiceInOneObject) {
    EXPECT_FALSE(parseJson<FakeJson>("{a {a b} {a} b}").isDiscarded);
    EXPECT_TRUE(parseJson<FakeJson>("{a {b} a}").isDiscarded);
    EXPECT_TRUE(parseJson<FakeJson>("{a {b b}}").isDiscarded);
}

}  // namespace
}  // namespace adaptiso
