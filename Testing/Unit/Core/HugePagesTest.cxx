#include <gtest/gtest.h>

#include <numeric>

#include "adaptiso/Core/Memory.h"

namespace adaptiso {
namespace {

constexpr std::size_t kLarge = 3'000'000;  // numbers: several pages of 2 MB

TEST(HugePages, ReservingKeepsWhatIsThere) {
    std::vector<int> list{1, 2, 3};
    reserveInHugePages(list, kLarge);
    EXPECT_EQ(list, (std::vector{1, 2, 3}));
    EXPECT_GE(list.capacity(), kLarge);
    const int* const before = list.data();
    reserveInHugePages(list, 10);
    list.resize(kLarge);
    EXPECT_EQ(list.data(), before);
}

TEST(HugePages, AssigningFillsAndUsesTheMemoryThatIsThere) {
    std::vector<int> list;
    assignInHugePages(list, kLarge, 7);
    EXPECT_EQ(std::accumulate(list.begin(), list.end(), 0LL), 7LL * kLarge);
    const int* const before = list.data();
    assignInHugePages(list, kLarge - 5);
    EXPECT_EQ(list, std::vector<int>(kLarge - 5));
    EXPECT_EQ(list.data(), before);
}

TEST(HugePages, ShrinkingLeavesNoRoom) {
    std::vector<int> list(kLarge);
    std::iota(list.begin(), list.end(), 0);
    list.resize(kLarge / 2);
    shrinkInHugePages(list);
    EXPECT_EQ(list.capacity(), kLarge / 2);
    EXPECT_EQ(list.back(), static_cast<int>(kLarge / 2) - 1);
}

TEST(HugePages, NothingAndTooLittleMayBeAskedFor) {
    preferHugePages(nullptr, 0);
    char few[100];
    preferHugePages(few, sizeof few);
    std::vector<int> empty;
    assignInHugePages(empty, 0);
    shrinkInHugePages(empty);
    EXPECT_TRUE(empty.empty());
}

}  // namespace
}  // namespace adaptiso
