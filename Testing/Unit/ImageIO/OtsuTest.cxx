#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

namespace adaptiso {
namespace {

template <class T>
double otsuOf(std::vector<T> samples) {
    const auto count = static_cast<std::int64_t>(samples.size());
    return otsuThreshold(Volume::fromSamples(std::move(samples), {{count, 1, 1}, {}, {}}));
}

TEST(Otsu, LiesHalfwayBetweenTwoValues) {
    EXPECT_EQ(otsuOf<std::uint8_t>({0, 0, 0, 100}), 50);
    EXPECT_EQ(otsuOf<std::int16_t>({-1000, -1000, 40, 40}), -480);
    EXPECT_EQ(otsuOf<float>({0, 0, 1, 1}), 0.5);
    EXPECT_DOUBLE_EQ(otsuOf<double>({1e-9, 3e-9, 3e-9}), 2e-9);
    EXPECT_EQ(otsuOf<std::uint16_t>({3, 4}), 3.5);
    EXPECT_EQ(otsuOf<std::int64_t>({-1'000'000'000'000, 1'000'000'000'000}), 0);
}

TEST(Otsu, MaximisesTheVarianceBetweenClasses) {
    // 10 x 0, 10 x 1, 10 x 8, 10 x 9: means of {0, 1} and {8, 9} are 0.5 and 8.5, between-class
    // variance 1/4 * 8^2 = 16; splitting off 0 or 9 alone gives 3/16 * 6^2 = 6.75
    std::vector<std::uint8_t> samples;
    for (const int value : {0, 1, 8, 9}) samples.insert(samples.end(), 10, std::uint8_t(value));
    EXPECT_EQ(otsuOf(samples), 4.5);
}

TEST(Otsu, FollowsTheClassesNotTheirSizes) {
    // a rare bright mode around 200 over a broad dark one around 20
    std::vector<std::uint8_t> samples;
    for (int i = 0; i < 900; ++i) samples.push_back(static_cast<std::uint8_t>(10 + i % 21));
    for (int i = 0; i < 100; ++i) samples.push_back(static_cast<std::uint8_t>(190 + i % 21));
    EXPECT_EQ(otsuOf(samples), 110);  // halfway between 30 and 190
}

TEST(Otsu, IsTheSameForIntegersAndFloats) {
    std::vector<std::uint8_t> bytes;
    std::vector<float> floats;
    for (int i = 0; i < 1000; ++i) {
        const int value = i % 3 ? (i * 7) % 50 : 120 + (i * 11) % 60;
        bytes.push_back(static_cast<std::uint8_t>(value));
        floats.push_back(static_cast<float>(value));
    }
    EXPECT_EQ(otsuOf(bytes), otsuOf(floats));
}

TEST(Otsu, LeavesNanAndInfinityAside) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(otsuOf<float>({nan, 0, infinity, 10, -infinity, 0, 10}), 5);
}

TEST(Otsu, RefusesVolumesWithNothingToSeparate) {
    EXPECT_THROW(otsuOf<std::uint8_t>({7, 7, 7}), InvalidInput);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(otsuOf<float>({nan, nan}), InvalidInput);
    EXPECT_THROW(otsuOf<float>({nan, 2, 2}), InvalidInput);
    const double largest = std::numeric_limits<double>::max();
    EXPECT_THROW(otsuOf<double>({-largest, largest}), InvalidInput);
}

/// The choice of `count` thresholds; none when there is no such choice.
template <class T>
std::vector<double> thresholdsOf(const std::vector<T>& samples, int count) {
    const auto size = static_cast<std::int64_t>(samples.size());
    const auto lists = otsuThresholds(Volume::fromSamples(samples, {{size, 1, 1}, {}, {}}), count);
    for (std::size_t n = 0; n < lists.size(); ++n) EXPECT_EQ(lists[n].size(), n + 1);
    return static_cast<int>(lists.size()) < count ? std::vector<double>() : lists.back();
}

/// 100 samples around each of the centres, 20 values wide.
template <class T>
std::vector<T> modes(const std::vector<int>& centres) {
    std::vector<T> samples;
    for (const int centre : centres) {
        for (int n = 0; n < 100; ++n) samples.push_back(static_cast<T>(centre - 10 + n % 21));
    }
    return samples;
}

TEST(OtsuThresholds, LieHalfwayBetweenTheModes) {
    EXPECT_EQ(thresholdsOf(modes<std::uint8_t>({20, 120, 220}), 2), (std::vector<double>{70, 170}));
    EXPECT_EQ(thresholdsOf(modes<std::int16_t>({-1000, 0, 60, 1000}), 3),
              (std::vector<double>{-500, 30, 530}));
    EXPECT_EQ(thresholdsOf(modes<float>({-1000, 0, 60, 1000}), 3),
              (std::vector<double>{-500, 30, 530}));
}

TEST(OtsuThresholds, OneIsThatOfAuto) {
    const auto samples = modes<std::int16_t>({-1000, 40, 300});
    EXPECT_EQ(thresholdsOf(samples, 1), std::vector<double>{otsuOf(samples)});
}

TEST(OtsuThresholds, AreNotSpoiltByAFewOutliers) {
    auto samples = modes<std::int16_t>({0, 60, 200});
    for (int n = 0; n < 40; ++n)
        samples.insert(samples.end(), samples.begin(), samples.begin() + 300);
    samples.push_back(32767);  // one bin of 256 would be 128 wide
    EXPECT_EQ(thresholdsOf(samples, 2), (std::vector<double>{30, 130}));
}

TEST(OtsuThresholds, AreNoneWhereClassesAreTooFew) {
    EXPECT_TRUE(thresholdsOf<std::uint8_t>({0, 0, 5, 5}, 2).empty());
    EXPECT_TRUE(thresholdsOf<float>({0, 0, 5, 5, 9}, 3).empty());
    EXPECT_EQ(thresholdsOf<float>({0, 0, 5, 5, 9}, 2), (std::vector<double>{2.5, 7}));
    // a mask of less than a thousandth: both percentiles are 0
    std::vector<float> mask(5000, 0);
    mask[1] = 1;
    EXPECT_EQ(thresholdsOf(mask, 1), std::vector<double>{0.5});
    EXPECT_TRUE(thresholdsOf(mask, 2).empty());
    EXPECT_THROW(thresholdsOf<float>({1, 1}, 2), InvalidInput);
    EXPECT_THROW(thresholdsOf<float>({1, 2}, 0), InvalidInput);
    EXPECT_THROW(thresholdsOf<float>({1, 2}, 4), InvalidInput);
}

}  // namespace
}  // namespace adaptiso
