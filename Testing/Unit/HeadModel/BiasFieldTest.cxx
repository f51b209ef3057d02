#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "BiasField.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::headmodel {
namespace {

constexpr std::int64_t kSide = 60;
constexpr double kAir = -10;

/// Two kinds of tissue in cubes of 12 mm, in voxels of 2 mm, with a field over them.
struct Tissue {
    ImageGeometry grid = testing::centredGeometry({kSide, kSide, kSide}, {2, 2, 2});
    std::vector<float> truth, values;
    Mask mask;

    explicit Tissue(double slope, double bend) {
        for (std::int64_t n = 0; n < grid.voxelCount(); ++n) {
            const std::int64_t i = n % kSide, j = n / kSide % kSide, k = n / (kSide * kSide);
            const double x = 2.0 * static_cast<double>(i) / (kSide - 1) - 1,
                         z = 2.0 * static_cast<double>(k) / (kSide - 1) - 1;
            truth.push_back((i / 6 + j / 6 + k / 6) % 2 == 0 ? 100 : 70);
            values.push_back(static_cast<float>(
                kAir + truth.back() * std::exp(slope * (x + 0.5 * z) + bend * x * x)));
            mask.push_back(1);
        }
    }

    /// By how much, in part, one kind of tissue differs from place to place.
    double spread() const {
        double least = 1e9, most = 0;
        for (std::size_t n = 0; n < values.size(); ++n) {
            const double level = (values[n] - kAir) / truth[n];
            least = std::min(least, level);
            most = std::max(most, level);
        }
        return most / least - 1;
    }
};

TEST(BiasField, IsFoundAndTakenOutOfTwoKindsOfTissue) {
    for (const double bend : {0.0, 0.2, -0.2}) {
        Tissue tissue(0.3, bend);
        ASSERT_GT(tissue.spread(), 1.0);
        const BiasField field = BiasField::estimated(tissue.values, kAir, tissue.mask, tissue.grid);
        EXPECT_GT(field.most() / field.least(), 1.9);
        field.removeFrom(tissue.values, kAir, tissue.grid.size);
        // steps of half a per cent in nine directions; the outermost corners are kept at the rim's
        EXPECT_LT(tissue.spread(), 0.12) << bend;
    }
}

TEST(BiasField, OfEvenTissueIsNone) {
    Tissue tissue(0, 0);
    const std::vector<float> before = tissue.values;
    const BiasField field = BiasField::estimated(tissue.values, kAir, tissue.mask, tissue.grid);
    EXPECT_NEAR(field.least(), 1, 0.01);
    EXPECT_NEAR(field.most(), 1, 0.01);
    field.removeFrom(tissue.values, kAir, tissue.grid.size);
    for (std::size_t n = 0; n < before.size(); ++n) {
        ASSERT_NEAR(tissue.values[n], before[n], 1) << n;
    }
}

TEST(BiasField, OfTooLittleTissueIsNone) {
    Tissue tissue(0.3, 0);
    const std::vector<float> before = tissue.values;
    for (std::size_t n = 0; n < tissue.mask.size(); ++n) tissue.mask[n] = n % kSide < 2 ? 1 : 0;
    const BiasField field = BiasField::estimated(tissue.values, kAir, tissue.mask, tissue.grid);
    field.removeFrom(tissue.values, kAir, tissue.grid.size);
    EXPECT_EQ(tissue.values, before);
    EXPECT_EQ(field.least(), 1);
}

}  // namespace
}  // namespace adaptiso::headmodel
