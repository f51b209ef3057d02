#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "adaptiso/Core/TextLines.h"

namespace adaptiso {
namespace {

using namespace std::string_literals;
using Lines = std::vector<std::string>;

Lines linesIn(const std::string& text, LineEnds ends = LineEnds::Any) {
    Lines lines;
    TextLines source(text, ends);
    while (const auto line = source.next()) lines.emplace_back(*line);
    EXPECT_EQ(source.number(), std::ssize(lines));
    EXPECT_EQ(source.position(), text.size());
    return lines;
}

TEST(TextLines, EndAsWritersEndThem) {
    const Lines expected{"a b", "", "c"};
    for (const LineEnds ends : {LineEnds::Any, LineEnds::OfFirst}) {
        for (const char* const text :
             {"a b\n\nc\n", "a b\n\nc", "a b\r\n\r\nc\r\n", "a b\r\rc\r", "a b\r\rc",
              "\xEF\xBB\xBF"
              "a b\n\nc"}) {
            EXPECT_EQ(linesIn(text, ends), expected) << ::testing::PrintToString(text);
        }
        EXPECT_EQ(linesIn("", ends), Lines());
        EXPECT_EQ(linesIn("\xEF\xBB\xBF", ends), Lines());
        EXPECT_EQ(linesIn("\n", ends), Lines{""});
    }
    EXPECT_EQ(linesIn("a\rb\r\nc\nd"), (Lines{"a", "b", "c", "d"}));
}

// What follows the empty line is binary: its first byte is no part of the line's end.
TEST(TextLines, OfAHeaderEndAsItsFirst) {
    const auto bytesBehind = [](const std::string& header, const std::string& data) {
        const std::string file = header + data;
        TextLines lines(file, LineEnds::OfFirst);
        while (const auto line = lines.next()) {
            if (line->empty()) break;
        }
        return file.substr(lines.position());
    };
    for (const std::string& data : {"\n1"s, "\r1"s, "\r\n1"s, "\0\r"s}) {
        EXPECT_EQ(bytesBehind("NRRD0004\ntype: short\n\n", data), data);
        EXPECT_EQ(bytesBehind("NRRD0004\r\ntype: short\r\n\r\n", data), data);
        EXPECT_EQ(bytesBehind("NRRD0004\rtype: short\r\r", data), data);
    }
    EXPECT_EQ(linesIn("a\nkey:=one\rtwo\n", LineEnds::OfFirst), (Lines{"a", "key:=one\rtwo"}));
    EXPECT_EQ(linesIn("a\r\r\nb\r\r\n", LineEnds::OfFirst), (Lines{"a", "b"}));
}

TEST(TextLines, NameOtherEncodings) {
    EXPECT_EQ(faultOfText("1 c\xF4t\xE9\n"), "");
    EXPECT_EQ(faultOfText("\xEF\xBB\xBF"
                          "1 a\n"),
              "");
    EXPECT_EQ(faultOfText(""), "");
    const std::string named = "is text in UTF-16; save it as UTF-8";
    EXPECT_EQ(faultOfText("\xFF\xFE"
                          "1\0 \0a\0"s),
              named);
    EXPECT_EQ(faultOfText("\xFE\xFF\0"
                          "1\0 \0a"s),
              named);
    EXPECT_EQ(faultOfText("1\0 \0a\0\n\0"s), named);
    EXPECT_EQ(faultOfText("\0"
                          "1\0 \0a"s),
              named);
    EXPECT_NE(faultOfText("1 a\0b\n"s).find("NUL"), std::string::npos);
}

}  // namespace
}  // namespace adaptiso
