#include <gtest/gtest.h>

#include "Support/AnalyticVolumes.h"
#include "boxes/SimpleBoxes.h"

namespace adaptiso::detail {
namespace {

/// Whether a box is simple, straight from the definition: on no lign does the inside change twice.
template <int N>
bool isSimpleByDefinition(const BlockSamples<N>& samples, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int a = 0; a <= box.size; ++a) {
            for (int b = 0; b <= box.size; ++b) {
                int changes = 0;
                for (int step = 0; step < box.size; ++step) {
                    std::array<int, 3> p{box.x, box.y, box.z};
                    p[u] += a;
                    p[v] += b;
                    p[axis] += step;
                    std::array<int, 3> q = p;
                    ++q[axis];
                    changes += samples.inside(p) != samples.inside(q);
                }
                if (changes > 1) return false;
            }
        }
    }
    return true;
}

template <int N>
void expectDefinitionHolds() {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        // mostly one value, so that many boxes are simple
        std::uint64_t state = seed;
        ImageGeometry geometry;
        geometry.size = {N + 1, N + 1, N + 1};
        std::vector<std::uint8_t> samples(static_cast<std::size_t>(geometry.voxelCount()));
        const std::uint64_t rarity = 2 + seed;
        for (auto& s : samples) s = testing::nextRandom(state) % rarity == 0;
        const VolumeView volume(samples.data(), geometry);
        const auto sampler = LatticeSampler::make(volume, 0.5, Border::Closed);
        const BlockSamples<N> block(*sampler, {0, 0, 0});
        const VariationTrees<N> variation(block);
        for (int size = N; size >= 1; size /= 2) {
            for (int z = 0; z < N; z += size) {
                for (int y = 0; y < N; y += size) {
                    for (int x = 0; x < N; x += size) {
                        const Box box{x, y, z, size};
                        ASSERT_EQ(variation.isSimple(box), isSimpleByDefinition<N>(block, box))
                            << "seed " << seed << " at " << x << " " << y << " " << z << ", size "
                            << size;
                    }
                }
            }
        }
    }
}

}  // namespace

TEST(VariationTrees, AgreeWithTheDefinitionOfSimple) {
    expectDefinitionHolds<2>();
    expectDefinitionHolds<4>();
    expectDefinitionHolds<8>();
    expectDefinitionHolds<16>();
}

TEST(BoxTree, LeavesFillTheBlockOnce) {
    BoxTree<8> tree;
    tree.divide({0, 0, 0, 8});
    tree.divide({4, 0, 4, 4});
    tree.divide({6, 2, 4, 2});
    int cells = 0, leaves = 0;
    tree.forEachLeaf([&](const Box& box) {
        cells += box.size * box.size * box.size;
        ++leaves;
    });
    EXPECT_EQ(cells, 8 * 8 * 8);
    EXPECT_EQ(leaves, 7 + 7 + 8);
    EXPECT_TRUE(tree.isDivided({6, 2, 4, 2}));
    EXPECT_FALSE(tree.isDivided({4, 2, 4, 2}));
}

TEST(Bits, RanksAndCountsMembers) {
    Bits<73> bits;
    for (const int i : {0, 5, 63, 64, 72}) bits.set(i);
    EXPECT_EQ(bits.count(), 5);
    EXPECT_EQ(bits.rank(0), 0);
    EXPECT_EQ(bits.rank(63), 2);
    EXPECT_EQ(bits.rank(64), 3);
    EXPECT_EQ(bits.rank(72), 4);
    bits.reset(63);
    std::vector<int> members;
    bits.forEach([&](int i) { members.push_back(i); });
    EXPECT_EQ(members, (std::vector<int>{0, 5, 64, 72}));
}

}  // namespace adaptiso::detail
