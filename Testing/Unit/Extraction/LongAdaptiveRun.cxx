#include <gtest/gtest.h>

#include "AdaptivePromises.h"

namespace adaptiso::testing {

// as AdaptivePromisesTest, over a hundred times as many volumes
TEST(AdaptivePromises, HoldOnManySmallVolumes) {
    for (std::uint64_t seed = 1'000'000; seed < 1'020'000; ++seed) {
        const AdaptiveCase adaptive = adaptiveCase(seed, 8);
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
    }
}

TEST(AdaptivePromises, HoldOnManyLargerVolumes) {
    for (std::uint64_t seed = 2'000'000; seed < 2'001'000; ++seed) {
        const AdaptiveCase adaptive = adaptiveCase(seed, 24);
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
    }
}

// more than 32 cells a side: parts are simplified side by side and joined
TEST(AdaptivePromises, HoldAcrossManyPartsWorkedOnSideBySide) {
    for (std::uint64_t seed = 3'000'000; seed < 3'000'040; ++seed) {
        const AdaptiveCase adaptive = adaptiveCase(seed, 48);
        EXPECT_TRUE(keepsAdaptivePromises(adaptive)) << describe(seed, adaptive);
    }
}

}  // namespace adaptiso::testing
