#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

namespace adaptiso::testing {
namespace {

template <class T>
Volume row(std::vector<T> samples) {
    const auto count = static_cast<std::int64_t>(samples.size());
    return Volume::fromSamples(std::move(samples), {{count, 1, 1}, {}, {}});
}

constexpr std::array<double, 6> kPercents{100, 0, 50, 25, 99, 1};

template <class T>
class PercentilesOf : public ::testing::Test {};
using PixelTypes =
    ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                     std::int32_t, std::uint64_t, std::int64_t, float, double>;
TYPED_TEST_SUITE(PercentilesOf, PixelTypes);

TYPED_TEST(PercentilesOf, AreTheNearestRanksOfTheSortedSamples) {
    using T = TypeParam;
    std::uint64_t random = 11;
    std::vector<T> samples;
    for (int n = 0; n < 700'001; ++n) {  // several pieces of parallel work
        const std::uint64_t bits = nextRandom(random);
        if constexpr (std::is_floating_point_v<T>) {
            // both signs, many magnitudes
            samples.push_back(static_cast<T>(std::ldexp(static_cast<double>(bits >> 40) - 0x1p23,
                                                        static_cast<int>(bits % 40) - 60)));
        } else {
            samples.push_back(static_cast<T>(bits >> 5));
        }
    }
    const Volume volume = row(samples);
    const std::vector<double> found = percentiles(volume, kPercents);
    std::sort(samples.begin(), samples.end());
    ASSERT_EQ(found.size(), kPercents.size());
    for (std::size_t n = 0; n < found.size(); ++n) {
        const double rank = std::max(1.0, std::ceil(kPercents[n] / 100 * 700'001));
        EXPECT_EQ(found[n], static_cast<double>(samples[static_cast<std::size_t>(rank) - 1]))
            << kPercents[n];
    }
    for (const int threads : {1, 5}) {
        const ThreadLimitGuard limit(threads);
        EXPECT_EQ(percentiles(volume, kPercents), found);
    }
}

TYPED_TEST(PercentilesOf, ReachTheEndsOfTheType) {
    using Limits = std::numeric_limits<TypeParam>;
    const std::array<double, 2> ends{0, 100};
    const auto found = percentiles(row<TypeParam>({1, Limits::max(), Limits::lowest()}), ends);
    EXPECT_EQ(found[0], static_cast<double>(Limits::lowest()));
    EXPECT_EQ(found[1], static_cast<double>(Limits::max()));
}

TEST(Percentiles, CountFromTheFirstSample) {
    std::vector<std::uint8_t> samples(1000, 5);
    samples[7] = 1;
    samples[8] = 9;
    const std::array<double, 4> percents{0.1, 0.11, 99.9, 99.91};
    EXPECT_EQ(percentiles(row(samples), percents), (std::vector<double>{1, 5, 5, 9}));
}

TEST(Percentiles, LeaveNanAndInfinityAside) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> samples{nan, 3, -infinity, -2, infinity, 7, -nan};
    const std::array<double, 3> percents{0, 50, 100};
    EXPECT_EQ(percentiles(row(samples), percents), (std::vector<double>{-2, 3, 7}));
    EXPECT_EQ(countFinite(row(samples)), 3);
    EXPECT_TRUE(percentiles(row<double>({nan, infinity}), percents).empty());
}

TEST(Percentiles, RefuseWhatIsNoPercentage) {
    for (const double percent : {-0.1, 100.1, std::numeric_limits<double>::quiet_NaN()}) {
        const std::array<double, 1> percents{percent};
        EXPECT_THROW(percentiles(row<float>({1, 2}), percents), InvalidInput);
    }
}

TEST(SampleHistogram, CountsEverySampleOnce) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const SampleHistogram histogram =
        sampleHistogram(row<float>({-1, 0, 0.5, 1, 1.5, 4, 4.5, nan, infinity}), 0, 4, 4);
    EXPECT_EQ(histogram.counts, (std::vector<std::int64_t>{2, 2, 0, 1}));  // the last holds 4 too
    EXPECT_EQ(histogram.below, 1);
    EXPECT_EQ(histogram.above, 1);
    EXPECT_EQ(histogram.edge(0), 0);
    EXPECT_EQ(histogram.edge(3), 3);
    EXPECT_EQ(histogram.edge(4), 4);
}

TEST(SampleHistogram, IsTheSameWhateverTheThreadCount) {
    const Volume noise = randomVolume<std::int16_t>({100, 100, 90}, 1000, 3);
    const auto counts = [&](int threads) {
        const ThreadLimitGuard limit(threads);
        return sampleHistogram(noise, 100, 900, 37).counts;
    };
    EXPECT_EQ(counts(1), counts(4));
}

TEST(SampleHistogram, RefusesRangesThatAreNone) {
    const Volume volume = row<float>({1, 2});
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW(sampleHistogram(volume, 1, 1, 4), InvalidInput);
    EXPECT_THROW(sampleHistogram(volume, 0, infinity, 4), InvalidInput);
    EXPECT_THROW(sampleHistogram(volume, 0, 1, 0), InvalidInput);
}

}  // namespace
}  // namespace adaptiso::testing
