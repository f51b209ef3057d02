#include <gtest/gtest.h>

#include <vector>

#include "Surfaces.h"
#include "adaptive/rounds/TightPlaces.h"

namespace adaptiso::testing {
namespace {

using detail::TightPlaces;

detail::Sample sampleAt(const Vec3& p) {
    detail::Sample sample;
    sample.setPoint(p);
    return sample;
}

}  // namespace

TEST(TightPlaces, GrowTighterWheneverTheyAreAdded) {
    TightPlaces places;
    int last = 0;
    for (int times = 1; times <= 3; ++times) {
        places.add({{10, 10, 10}});
        std::vector<detail::Sample> samples{sampleAt({11, 10, 9}), sampleAt({20, 10, 10})};
        places.apply(unitFrame(), samples);
        EXPECT_GT(samples[0].tightness, last);
        EXPECT_EQ(samples[1].tightness, 0);
        EXPECT_TRUE(samples[0].isAlone());
        last = samples[0].tightness;
    }
    places.add({{10, 10, 10}});  // and stay so
    detail::Sample sample = sampleAt({10, 10, 10});
    places.apply(unitFrame(), sample);
    EXPECT_EQ(sample.tightness, last);
}

TEST(TightPlaces, LoosenNoSample) {
    TightPlaces places;
    places.add({{10, 10, 10}});
    detail::Sample elsewhere = sampleAt({30, 30, 30}), there = sampleAt({10, 10, 10});
    elsewhere.tightness = there.tightness = 9;  // in a web
    places.apply(unitFrame(), elsewhere);
    places.apply(unitFrame(), there);
    EXPECT_EQ(elsewhere.tightness, 9);
    EXPECT_EQ(there.tightness, 9);
}

TEST(TightPlaces, AskForProofsWhereTrianglesCrossed) {
    TightPlaces places;
    places.addCrossings({{10, 10, 10}});
    std::vector<detail::Sample> samples{sampleAt({11, 10, 9}), sampleAt({20, 10, 10})};
    places.apply(unitFrame(), samples);
    EXPECT_EQ(samples[0].room, 0);
    EXPECT_TRUE(samples[1].isAlone());
}

// Places are sample indices, samples lie in millimetres.
TEST(TightPlaces, LieInTheLattice) {
    ImageGeometry geometry;
    geometry.indexToPhysical = Mat3::diagonal(0.5, 1, 4);
    const detail::MetricFrame frame(geometry);
    TightPlaces places;
    places.add({{10, 10, 10}});
    std::vector<detail::Sample> samples{sampleAt({5, 10, 40}), sampleAt({10, 10, 10})};
    places.apply(frame, samples);
    EXPECT_GT(samples[0].tightness, 0);
    EXPECT_EQ(samples[1].tightness, 0);
}

TEST(TightPlaces, FreezeWhatIsAroundThem) {
    TightPlaces places;
    EXPECT_FALSE(places.isFrozen({10, 10, 10}));
    places.freeze({{10, 10, 10}}, 0);
    EXPECT_TRUE(places.isFrozen({10, 10, 11.5}));
    EXPECT_FALSE(places.isFrozen({10, 10, 20}));
    places.freeze({{10, 10, 10}}, 3);  // 12 voxels around
    EXPECT_TRUE(places.isFrozen({10, 10, 20}));
    EXPECT_FALSE(places.isFrozen({10, 10, 40}));
}

TEST(TightPlaces, FreezeAtLeastTheirDistance) {
    std::mt19937 random(8);
    for (int level = 0; level < 4; ++level) {
        const double around = 1.5 * (1 << level);
        const Vec3 place = randomPoint(random, 50);
        TightPlaces places;
        places.freeze({place}, level);
        for (int n = 0; n < 200; ++n) {
            EXPECT_TRUE(places.isFrozen(place + randomPoint(random, around)));
            const Vec3 aside = normalized(randomPoint(random));
            EXPECT_FALSE(places.isFrozen(place + 4 * around * aside));  // 2 sqrt(3) cubes at most
        }
    }
}

}  // namespace adaptiso::testing
