#include <gtest/gtest.h>

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

}  // namespace adaptiso::testing
