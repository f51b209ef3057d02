#include <gtest/gtest.h>

#include "SampledSquare.h"
#include "adaptive/collapse/ErrorTracker.h"

namespace adaptiso::testing {
namespace {

using detail::ErrorTracker;
using detail::Refusal;
using detail::SampleAssignment;
using detail::SheetClearance;

}  // namespace

TEST(ErrorTracker, MeasuresHowFarTheSamplesAre) {
    SampledSquare square;
    square.addSample(0.3);
    square.addSample(-0.4);
    const auto fit = ErrorTracker(square.patch, unitFrame()).measure(square.changed);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->sumOfSquares, 0.09 + 0.16, kSampleRounding);
    EXPECT_NEAR(fit->largestSquare, 0.16, kSampleRounding);
}

TEST(ErrorTracker, RefusesAVertexBeyondTheDistance) {
    SampledSquare square;
    ErrorTracker errors(square.patch, unitFrame());
    SampleAssignment result;
    square.shape({2.1, 2, 0.5});
    EXPECT_EQ(errors.assign(square.changed, 0.49, result), Refusal::VertexFar);
    EXPECT_EQ(errors.assign(square.changed, 0.51, result), Refusal::None);
}

TEST(ErrorTracker, RefusesASampleLeftBeyondTheDistance) {
    SampledSquare square;
    square.addSample(0.6);
    ErrorTracker errors(square.patch, unitFrame());
    SampleAssignment result;
    EXPECT_EQ(errors.assign(square.changed, 0.59, result), Refusal::SampleFar);
    EXPECT_EQ(errors.assign(square.changed, 0.61, result), Refusal::None);
    EXPECT_NEAR(result.largestSquare, 0.36, kSampleRounding);
}

TEST(ErrorTracker, AllowsASmallerDistanceInAWeb) {
    SampledSquare square;
    const std::size_t s = square.addSample(0.3);
    square.patch.samples[s].isInWeb = true;  // the square of the distance over 2^5
    ErrorTracker errors(square.patch, unitFrame());
    SampleAssignment result;
    EXPECT_EQ(errors.assign(square.changed, 1.69, result), Refusal::SampleFar);
    EXPECT_EQ(errors.assign(square.changed, 1.7, result), Refusal::None);
    EXPECT_FALSE(errors.measure(square.changed));  // no vertex is fitted there
}

TEST(ErrorTracker, KnowsWhereOtherSheetsAreNear) {
    SampledSquare square;
    const std::size_t s = square.addSample(0);
    for (const int clearance : {0, SheetClearance::kParts - 1, int{SheetClearance::kAlone}}) {
        square.patch.samples[s].clearance = static_cast<std::uint8_t>(clearance);
        const ErrorTracker errors(square.patch, unitFrame());
        SampleAssignment result;
        square.shape({2.4, 2.2, 0.02});
        EXPECT_EQ(errors.assign(square.changed, 1, result), Refusal::None);
        EXPECT_EQ(result.isCrowded, clearance == 0) << clearance;
        EXPECT_EQ(result.isInSingleSheet(), clearance == SheetClearance::kAlone) << clearance;
        square.shape({2.4, 2.2, 0.9});  // nearly as far as the other sheet
        EXPECT_EQ(errors.assign(square.changed, 1, result), Refusal::None);
        EXPECT_EQ(result.isCrowded, clearance != SheetClearance::kAlone) << clearance;
    }
}

TEST(ErrorTracker, IsInNoSingleSheetWithoutASample) {
    SampledSquare square;
    square.patch.samples.clear();
    square.patch.sampleTriangle.clear();
    SampleAssignment result;
    EXPECT_EQ(ErrorTracker(square.patch, unitFrame()).assign(square.changed, 0.1, result),
              Refusal::None);
    EXPECT_FALSE(result.isInSingleSheet());
}

}  // namespace adaptiso::testing
