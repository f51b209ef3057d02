#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "AdaptivePromises.h"

namespace adaptiso::testing {
namespace {

/// Seeds of volumes up to a size: a test, so that --gtest_filter and GTEST_TOTAL_SHARDS can split
/// the run.
struct Seeds {
    std::uint64_t first, count;
    int maximumSize;
};

std::vector<Seeds> chunks(std::uint64_t first, std::uint64_t end, std::uint64_t count,
                          int maximumSize) {
    std::vector<Seeds> all;
    for (; first < end; first += count) all.push_back({first, count, maximumSize});
    return all;
}

// as AdaptivePromisesTest, over a hundred times as many volumes
class LongAdaptiveRun : public ::testing::TestWithParam<Seeds> {};

TEST_P(LongAdaptiveRun, PromisesHold) {
    const auto& [first, count, maximumSize] = GetParam();
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        const AdaptiveCase adaptive = adaptiveCase(seed, maximumSize);
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
    }
}

std::string nameOf(const ::testing::TestParamInfo<Seeds>& info) {
    return std::to_string(info.param.first);
}

INSTANTIATE_TEST_SUITE_P(SmallVolumes, LongAdaptiveRun,
                         ::testing::ValuesIn(chunks(1'000'000, 1'020'000, 500, 8)), nameOf);
INSTANTIATE_TEST_SUITE_P(LargerVolumes, LongAdaptiveRun,
                         ::testing::ValuesIn(chunks(2'000'000, 2'001'000, 20, 24)), nameOf);
// more than 32 cells a side: parts are simplified side by side and joined
INSTANTIATE_TEST_SUITE_P(ManyParts, LongAdaptiveRun,
                         ::testing::ValuesIn(chunks(3'000'000, 3'000'040, 4, 48)), nameOf);

}  // namespace
}  // namespace adaptiso::testing
