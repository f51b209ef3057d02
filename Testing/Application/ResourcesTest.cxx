#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/Progress.h"

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

TEST(StartableThreads, AreAllThatAreAskedForWhereNothingLimitsThem) {
    EXPECT_EQ(startableThreads(0), 0);
    EXPECT_EQ(startableThreads(3), 3);
}

/// "Death" in the name: googletest runs it first, while there is one thread.
TEST(StartableThreadsDeathTest, AreNoneAtTheLimitOfProcesses) {
    EXPECT_EXIT(
        {
            constexpr uid_t kNobody = 65534;
            const rlimit none = {};
            // root has no limit
            if (setrlimit(RLIMIT_NPROC, &none) != 0 || (getuid() == 0 && setuid(kNobody) != 0)) {
                _exit(2);
            }
            _exit(startableThreads(3) == 0 ? 0 : 1);
        },
        ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace adaptiso
