#include <gtest/gtest.h>

#include "RandomVolumes.h"

namespace adaptiso::testing {

// the same properties as in SurfaceMethodsTest, over a hundred times as many volumes
namespace {

class ManyVolumes : public ::testing::TestWithParam<MethodChoice> {};

}  // namespace

TEST_P(ManyVolumes, KeepTheMethodsPromises) {
    for (std::uint64_t seed = 1'000'000; seed < 1'100'000; ++seed) {
        const HardVolume hard = hardVolume(seed, 14);
        const int blockSize = 2 << seed % 4;
        for (const Border border : {Border::Closed, Border::Open}) {
            ASSERT_TRUE(keepsItsPromises(hard, GetParam(), blockSize, border))
                << "seed " << seed << ", N = " << blockSize;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    , ManyVolumes,
    ::testing::Values(MethodChoice{Method::Boxes}, MethodChoice{Method::DiscretizedMarchingCubes},
                      MethodChoice{Method::DiscretizedMarchingCubes, true},
                      MethodChoice{Method::DiscretizedMarchingCubes, false, true},
                      MethodChoice{Method::DiscretizedMarchingCubes, true, true},
                      MethodChoice{Method::SkeletonClimbing}),
    ::testing::PrintToStringParamName());

}  // namespace adaptiso::testing
