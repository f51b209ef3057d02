#include <gtest/gtest.h>

#include "RandomVolumes.h"

namespace adaptiso::testing {

// the same properties as in BoxesMethodTest, over a hundred times as many volumes
TEST(BoxesMethod, KeepsItsPromisesOnManyRandomVolumes) {
    for (std::uint64_t seed = 1'000'000; seed < 1'100'000; ++seed) {
        const HardVolume hard = hardVolume(seed, 14);
        const int blockSize = 2 << seed % 4;
        for (const Border border : {Border::Closed, Border::Open}) {
            ASSERT_TRUE(keepsItsPromises(hard, blockSize, border))
                << "seed " << seed << ", N = " << blockSize;
        }
    }
}

}  // namespace adaptiso::testing
