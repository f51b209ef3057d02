#include <gtest/gtest.h>

#include <cmath>

#include "adaptiso/Core/Outliers.h"

namespace adaptiso {
namespace {

using Values = std::vector<std::optional<double>>;

/// The scores of all values but those at the median, by index.
std::vector<Outlier> scoresOf(const Values& values) {
    return findOutliers(values, {.limit = 0, .leastPercent = 0});
}

TEST(Outliers, HaveDistancesFromTheMedianInScaledMads) {
    // median 3, distances 2 1 0 1 97: their median is 1
    const Values values{1, 2, 3, 4, 100};
    const std::vector<Outlier> scores = scoresOf(values);
    ASSERT_EQ(scores.size(), 4U);
    EXPECT_EQ(scores[3].index, 4U);
    EXPECT_NEAR(scores[3].score, 97 / 1.4826, 1e-12);
    EXPECT_NEAR(scores[0].score, -2 / 1.4826, 1e-12);
    EXPECT_EQ(scores[0].percentText(), "-67%");
    const std::vector<Outlier> outliers = findOutliers(values);
    ASSERT_EQ(outliers.size(), 1U);
    EXPECT_EQ(outliers[0].index, 4U);
}

TEST(Outliers, StandWhereHalfOfTheValuesAreWrong) {
    const Values values{10, 11, 12, 13, 14, 1e6, 2e6, 3e6, 4e6};
    EXPECT_LT(std::abs(scoresOf(values)[1].score), 1.0);
}

TEST(Outliers, TakeTheMeanDistanceWhereMostAreEqual) {
    // distances 0 0 0 0 5: mean 1
    const std::vector<Outlier> scores = scoresOf({2, 2, 2, 2, 7});
    ASSERT_EQ(scores.size(), 1U);
    EXPECT_NEAR(scores[0].score, 5 / 1.253314, 1e-12);
}

TEST(Outliers, AreNoneOfFewOrEqualValuesAndOfNone) {
    EXPECT_TRUE(scoresOf({1, 2, 3, 400}).empty());
    EXPECT_TRUE(scoresOf({3, 3, 3, 3, 3, 3}).empty());
    for (const double none : {std::nan(""), HUGE_VAL}) {
        EXPECT_EQ(scoresOf({1, 2, 3, 4, 5, none}).size(), 4U);
    }
    EXPECT_EQ(scoresOf({1, 2, 3, 4, 5, std::nullopt}).size(), 4U);
    EXPECT_EQ(scoresOf({0, 0, 0, 0, 5}).at(0).percentText(), "+inf%");
}

}  // namespace
}  // namespace adaptiso
