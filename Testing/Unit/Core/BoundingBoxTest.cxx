#include <gtest/gtest.h>

#include "adaptiso/Core/BoundingBox.h"

namespace adaptiso {
namespace {

BoundingBox boxOf(std::initializer_list<Vec3> points) {
    auto box = BoundingBox::empty();
    for (const Vec3& p : points) box.add(p);
    return box;
}

TEST(BoundingBox, HoldsWhatWasAdded) {
    auto box = BoundingBox::empty();
    EXPECT_TRUE(box.isEmpty());
    box.add(Vec3{1, 5, 0});
    EXPECT_FALSE(box.isEmpty());
    EXPECT_EQ(box.minimum, box.maximum);
    box.add(boxOf({{2, 4, 3}, {0, 6, 1}}));
    EXPECT_EQ(box.minimum, (Vec3{0, 4, 0}));
    EXPECT_EQ(box.maximum, (Vec3{2, 6, 3}));
    EXPECT_EQ(box.size(), (Vec3{2, 2, 3}));
    EXPECT_EQ(box.middle(), (Vec3{1, 5, 1.5}));
    box.add(BoundingBox::empty());
    EXPECT_EQ(box.size(), (Vec3{2, 2, 3}));
    box.widen(2);
    EXPECT_EQ(box.minimum, (Vec3{-2, 2, -2}));
    EXPECT_EQ(box.maximum, (Vec3{4, 8, 5}));
}

TEST(BoundingBox, OverlapsWhatItTouches) {
    const BoundingBox box{{0, 4, 0}, {2, 6, 3}};
    EXPECT_FALSE(box.overlaps(BoundingBox::empty()));
    for (int a = 0; a < 3; ++a) {
        BoundingBox beside = box;
        beside.minimum[a] = box.maximum[a];
        beside.maximum[a] = box.maximum[a] + 1;
        EXPECT_TRUE(box.overlaps(beside));
        EXPECT_TRUE(beside.overlaps(box));
        beside.minimum[a] += 0.5;
        EXPECT_FALSE(box.overlaps(beside));
        EXPECT_FALSE(beside.overlaps(box));
        EXPECT_EQ(squaredDistance(box, beside), 0.25);
        EXPECT_EQ(squaredDistance(beside.minimum, box), 0.25);
    }
}

TEST(BoundingBox, ContainsItsFaces) {
    const BoundingBox box{{0, 4, 0}, {2, 6, 3}};
    EXPECT_TRUE(box.contains(box));
    EXPECT_TRUE(box.contains(box.maximum));
    for (int a = 0; a < 3; ++a) {
        BoundingBox larger = box;
        larger.maximum[a] += 0.5;
        EXPECT_FALSE(box.contains(larger));
        EXPECT_TRUE(larger.contains(box));
        EXPECT_FALSE(box.contains(larger.maximum));
    }
}

}  // namespace
}  // namespace adaptiso
