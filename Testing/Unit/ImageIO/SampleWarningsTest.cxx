#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "Fixtures.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

template <class T>
std::vector<Warning> warningsOf(std::int16_t datatype, std::vector<T> samples) {
    NiftiFile file;
    file.sformCode = 1;
    file.sform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    file.datatype = datatype;
    file.bitpix = 8 * sizeof(T);
    samples.resize(24);
    file.data = samplesOf(samples);
    const TempFolder folder;
    return readVolume(writeFile(folder / "x.nii", file.bytes())).warnings;
}

TEST(SampleWarnings, CountVoxelsThatAreNotFinite) {
    EXPECT_TRUE(warningsOf<float>(16, {1, 2, 3}).empty());
    const auto found = warningsOf<float>(
        16, {1, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NE(found[0].text.find("2 of its voxels hold no finite number"), std::string::npos);
    EXPECT_EQ(warningsOf<double>(64, {-std::numeric_limits<double>::infinity()}).size(), 1U);
}

TEST(SampleWarnings, CountIntegersThatNoDoubleHolds) {
    constexpr std::int64_t kExact = std::int64_t{1} << 53;
    EXPECT_TRUE(warningsOf<std::int64_t>(1024, {kExact, -kExact}).empty());
    const auto found = warningsOf<std::int64_t>(1024, {kExact + 1, -kExact - 1, 5});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NE(found[0].text.find("2 of its voxels hold integers beyond 2^53"), std::string::npos);
    EXPECT_EQ(warningsOf<std::uint64_t>(1280, {~std::uint64_t{0}}).size(), 1U);
}

}  // namespace
}  // namespace adaptiso::testing
