#include <gtest/gtest.h>

#include <vector>

#include "adaptiso/Core/Memory.h"

namespace adaptiso {
namespace {

TEST(FreeMemory, GivesBackWhatAnEmptyListOfValuesKeeps) {
    std::vector<int> kept(1000), freed(1000);
    std::vector<double> also(1000);
    kept = {};
    EXPECT_GE(kept.capacity(), 1000U);
    freeMemory(freed, also);
    EXPECT_EQ(freed.capacity() + also.capacity(), 0U);
    EXPECT_TRUE(freed.empty() && also.empty());
}

}  // namespace
}  // namespace adaptiso
