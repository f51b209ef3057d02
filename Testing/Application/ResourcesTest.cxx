#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "Common/Resources.h"

namespace adaptiso {
namespace {

TEST(StageTimer, AddsUpEachStageInTheOrderOfFirstUse) {
    StageTimer timer;
    const auto sleep = [] { std::this_thread::sleep_for(std::chrono::milliseconds(5)); };
    timer.time("read", sleep);
    EXPECT_EQ(timer.time("write", [] { return 42; }), 42);
    timer.time("read", sleep);
    ASSERT_EQ(timer.stages().size(), 2U);
    EXPECT_EQ(timer.stages()[0].first, "read");
    EXPECT_EQ(timer.stages()[1].first, "write");
    EXPECT_GE(timer.stages()[0].second, 0.010);  // a sleep is never shorter than asked for
    EXPECT_GE(timer.total(), timer.stages()[0].second + timer.stages()[1].second);
}

TEST(StageTimer, CountsAStageThatThrows) {
    StageTimer timer;
    EXPECT_THROW(timer.time("read", [] { throw 1; }), int);
    EXPECT_EQ(timer.stages().size(), 1U);
}

TEST(PeakMemory, GrowsWithWhatIsUsed) {
    const double before = peakMemoryMb();
    const std::vector<char> block(100'000'000, 'x');
    EXPECT_GE(peakMemoryMb(), block.back() == 'x' ? 100 : 0);
    EXPECT_GE(peakMemoryMb(), before);
}

}  // namespace
}  // namespace adaptiso
