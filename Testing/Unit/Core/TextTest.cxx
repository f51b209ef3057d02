#include <gtest/gtest.h>

#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::testing {

TEST(Base64, GivesTheExamplesOfItsStandard) {  // RFC 4648, section 10
    EXPECT_EQ(encodeBase64(""), "");
    EXPECT_EQ(encodeBase64("f"), "Zg==");
    EXPECT_EQ(encodeBase64("fo"), "Zm8=");
    EXPECT_EQ(encodeBase64("foo"), "Zm9v");
    EXPECT_EQ(encodeBase64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(encodeBase64("\xff\xfe\xfd"), "//79");
}

TEST(Text, IsTrimmedLoweredAndEscaped) {
    EXPECT_EQ(trimmed(" \t\r\n\v\fa b\n"), "a b");
    EXPECT_EQ(trimmed(" \n"), "");
    EXPECT_EQ(trimmed(""), "");
    EXPECT_EQ(lowerCase("AZaz[@ \xc4"), "azaz[@ \xc4");
    EXPECT_EQ(escapedMarkup("a<b>&\"'\n\x1f\xc3\xa4"), "a&lt;b&gt;&amp;&quot;'  \xc3\xa4");
}

TEST(Phrases, ListAndCount) {
    const std::vector<std::string> files{"a.nii", "b.nii"};
    EXPECT_EQ(joined(files), "a.nii, b.nii");
    EXPECT_EQ(joined(files, "; "), "a.nii; b.nii");
    EXPECT_EQ(joined(std::vector<std::string>{}), "");
    EXPECT_EQ(joined(std::vector{0.5, 2.0}, formatShort, " x "), "0.5 x 2");
    EXPECT_EQ(counted(1, "piece"), "1 piece");
    EXPECT_EQ(counted(12718, "cavity", "cavities"), "12,718 cavities");
}

TEST(Utf8, IsWhatItsStandardAllows) {  // RFC 3629, section 4
    for (const char* const text : {"", "a~", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
                                   "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
        EXPECT_TRUE(isUtf8(text)) << text;
        EXPECT_EQ(toUtf8(text), text);
    }
    for (const char* const text :
         {"\x80", "\xc1\xbf", "\xc3", "\xc3z", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xef\xbf",
          "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff"}) {
        EXPECT_FALSE(isUtf8(text)) << text;
        EXPECT_TRUE(isUtf8(toUtf8(text))) << text;
    }
    EXPECT_EQ(toUtf8("Gr\xf6\xdf"
                     "e"),
              "Größe");
}

TEST(Text, ControlsBecomeBlanks) {
    EXPECT_EQ(withoutControls("a\x1b]0;evil\x07.nii"), "a ]0;evil .nii");
    EXPECT_EQ(withoutControls("a\x7f\tb\n"), "a  b ");
    EXPECT_EQ(withoutControls("a\tb\n", "\n\t"), "a\tb\n");
    EXPECT_EQ(withoutControls("\u009b2J"), " 2J");  // CSI in UTF-8
    EXPECT_EQ(withoutControls("\x9b"
                              "2J"),
              " 2J");                                                 // and in Latin-1
    EXPECT_EQ(withoutControls("scan\u202eiin.gpj"), "scan iin.gpj");  // right-to-left override
    for (const char* one : {"\u2028", "\u2029", "\u202a", "\u202d", "\u2066", "\u2069", "\u0085",
                            "\u061c", "\u200e", "\u200f", "\ufeff", "\U000E0041"}) {
        EXPECT_EQ(withoutControls(one), " ");
    }
}

TEST(Text, WritingOfAllKindsStays) {
    for (const char* one : {"Hirn", "M\u00fcller", "\u8111.nii", "\U0001F9E0", "\u05de\u05d5\u05d7",
                            "\u200d", "\u2027\u202f\u2065\u206a", "M\xfcller"}) {
        EXPECT_EQ(withoutControls(one), one);
    }
    EXPECT_EQ(withoutControls("\xe2\x80"), "\xe2 ");  // cut off
}

TEST(Text, MarkupHasNoControlsEither) {
    EXPECT_EQ(escapedMarkup("<\u202e>\x1b"), "&lt; &gt; ");
}

}  // namespace adaptiso::testing
