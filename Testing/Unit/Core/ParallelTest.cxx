#include <gtest/gtest.h>

#include <atomic>
#include <utility>
#include <vector>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

TEST(Parallel, PiecesCoverAllOnce) {
    for (const std::int64_t count : {0, 1, 7, 100}) {
        std::vector<std::atomic<int>> calls(static_cast<std::size_t>(count));
        parallelForPieces(count, 8, [&](std::int64_t begin, std::int64_t end) {
            EXPECT_EQ(begin % 8, 0);
            EXPECT_TRUE(end == begin + 8 || end == count);
            for (std::int64_t n = begin; n < end; ++n) ++calls[n];
        });
        for (const auto& of : calls) EXPECT_EQ(of, 1);
    }
}

TEST(Parallel, LargestComeFirst) {
    const std::vector<std::int64_t> sizes{3, 0, 9, 3, 12, 1};
    const ThreadLimitGuard one(1);
    std::vector<std::int64_t> order;
    parallelLargestFirst(sizes, [&](std::int64_t n) { order.push_back(n); });
    EXPECT_EQ(order, (std::vector<std::int64_t>{4, 2, 0, 3, 5, 1}));
    parallelLargestFirst({}, [&](std::int64_t) { ADD_FAILURE(); });
}

TEST(Parallel, LargestFirstCallsEachOnce) {
    std::vector<std::int64_t> sizes;
    for (int n = 0; n < 1000; ++n) sizes.push_back(n * 7919 % 101);
    std::vector<std::atomic<int>> calls(sizes.size());
    parallelLargestFirst(sizes, [&](std::int64_t n) { ++calls[n]; });
    for (const auto& of : calls) EXPECT_EQ(of, 1);
}

}  // namespace
}  // namespace adaptiso
