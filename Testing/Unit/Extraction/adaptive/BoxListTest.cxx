#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "Surfaces.h"
#include "adaptive/proof/BoxList.h"

namespace adaptiso::testing {
namespace {

using detail::BoxList;

BoundingBox randomBox(std::mt19937& random, double size) {
    const Vec3 p = randomPoint(random, 10);
    BoundingBox box{p, p};
    box.add(p + randomPoint(random, size));
    return box;
}

std::set<std::size_t> overlapsOf(const BoxList& list, const BoundingBox& box) {
    std::set<std::size_t> found;
    list.forEachOverlap(box, [&](std::size_t i) { EXPECT_TRUE(found.insert(i).second); });
    return found;
}

}  // namespace

TEST(BoxList, FindsAllThatOverlapAndNoOthersButByRounding) {
    std::mt19937 random(1);
    std::vector<BoundingBox> boxes;
    BoxList list;
    EXPECT_TRUE(list.isEmpty());
    for (int n = 0; n < 1000; ++n) {  // no multiple of what is looked at at once
        boxes.push_back(randomBox(random, 2));
        list.add(boxes.back());
    }
    EXPECT_FALSE(list.isEmpty());
    for (int n = 0; n < 200; ++n) {
        const BoundingBox box = randomBox(random, 4);
        BoundingBox wider = box;
        wider.widen(1e-4);
        const auto found = overlapsOf(list, box);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (boxes[i].overlaps(box)) {
                EXPECT_TRUE(found.contains(i)) << n;
            }
            if (!boxes[i].overlaps(wider)) {
                EXPECT_FALSE(found.contains(i)) << n;
            }
        }
    }
    list.clear();
    EXPECT_TRUE(list.isEmpty());
    EXPECT_TRUE(overlapsOf(list, {{-10, -10, -10}, {10, 10, 10}}).empty());
}

TEST(BoxList, FindsThoseThatOnlyTouch) {
    BoxList list;
    list.add({{0, 0, 0}, {1.0 / 3, 1.0 / 3, 1.0 / 3}});
    EXPECT_EQ(overlapsOf(list, {{1.0 / 3, 0, 0}, {1, 1, 1}}).size(), 1U);
    EXPECT_EQ(overlapsOf(list, {{-1, -1, -1}, {0, 0, 0}}).size(), 1U);
}

}  // namespace adaptiso::testing
