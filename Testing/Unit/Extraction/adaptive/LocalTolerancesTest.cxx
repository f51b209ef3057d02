#include <gtest/gtest.h>

#include <vector>

#include "Surfaces.h"
#include "adaptive/rounds/LocalTolerances.h"

namespace adaptiso::testing {
namespace {

using detail::LocalTolerances;

detail::Sample sampleAt(const Vec3& p) {
    detail::Sample sample;
    sample.setPoint(p);
    return sample;
}

}  // namespace

TEST(LocalTolerances, ShrinkWheneverPlacesAreAdded) {
    LocalTolerances places;
    int last = 0;
    for (int times = 1; times <= 3; ++times) {
        places.add({{10, 10, 10}});
        std::vector<detail::Sample> samples{sampleAt({11, 10, 9}), sampleAt({20, 10, 10})};
        places.apply(unitFrame(), samples);
        EXPECT_GT(samples[0].halvings, last);
        EXPECT_EQ(samples[1].halvings, 0);
        EXPECT_TRUE(samples[0].isAlone());
        last = samples[0].halvings;
    }
    places.add({{10, 10, 10}});  // and stay so
    detail::Sample sample = sampleAt({10, 10, 10});
    places.apply(unitFrame(), sample);
    EXPECT_EQ(sample.halvings, last);
}

TEST(LocalTolerances, LoosenNoSample) {
    LocalTolerances places;
    places.add({{10, 10, 10}});
    detail::Sample elsewhere = sampleAt({30, 30, 30}), there = sampleAt({10, 10, 10});
    elsewhere.halvings = there.halvings = 9;  // in a web
    places.apply(unitFrame(), elsewhere);
    places.apply(unitFrame(), there);
    EXPECT_EQ(elsewhere.halvings, 9);
    EXPECT_EQ(there.halvings, 9);
}

TEST(LocalTolerances, AskForProofsWhereTrianglesCrossed) {
    LocalTolerances places;
    places.addCrossings({{10, 10, 10}});
    std::vector<detail::Sample> samples{sampleAt({11, 10, 9}), sampleAt({20, 10, 10})};
    places.apply(unitFrame(), samples);
    EXPECT_EQ(samples[0].clearance, 0);
    EXPECT_TRUE(samples[1].isAlone());
}

// Places are sample indices, samples lie in millimetres.
TEST(LocalTolerances, LieInTheLattice) {
    ImageGeometry geometry;
    geometry.indexToPhysical = Mat3::diagonal(0.5, 1, 4);
    const detail::MetricFrame frame(geometry);
    LocalTolerances places;
    places.add({{10, 10, 10}});
    std::vector<detail::Sample> samples{sampleAt({5, 10, 40}), sampleAt({10, 10, 10})};
    places.apply(frame, samples);
    EXPECT_GT(samples[0].halvings, 0);
    EXPECT_EQ(samples[1].halvings, 0);
}

TEST(LocalTolerances, FreezeWhatIsAroundThem) {
    LocalTolerances places;
    EXPECT_FALSE(places.isFrozen({10, 10, 10}));
    places.freeze({{10, 10, 10}}, 0);
    EXPECT_TRUE(places.isFrozen({10, 10, 11.5}));
    EXPECT_FALSE(places.isFrozen({10, 10, 20}));
    places.freeze({{10, 10, 10}}, 3);  // 12 voxels around
    EXPECT_TRUE(places.isFrozen({10, 10, 20}));
    EXPECT_FALSE(places.isFrozen({10, 10, 40}));
}

TEST(LocalTolerances, FreezeAtLeastTheirDistance) {
    std::mt19937 random(8);
    for (int level = 0; level < 4; ++level) {
        const double around = 1.5 * (1 << level);
        const Vec3 place = randomPoint(random, 50);
        LocalTolerances places;
        places.freeze({place}, level);
        for (int n = 0; n < 200; ++n) {
            EXPECT_TRUE(places.isFrozen(place + randomPoint(random, around)));
            const Vec3 aside = normalized(randomPoint(random));
            EXPECT_FALSE(places.isFrozen(place + 4 * around * aside));  // 2 sqrt(3) cubes at most
        }
    }
}

}  // namespace adaptiso::testing
