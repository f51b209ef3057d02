#include <gtest/gtest.h>

#include <bit>
#include <memory>
#include <ostream>
#include <vector>

#include "Support/AnalyticVolumes.h"
#include "boxes/AscBoxes.h"

namespace adaptiso::detail {

std::ostream& operator<<(std::ostream& out, const Padi& p) {
    return out << int{p.sizeX} << " x " << int{p.sizeY} << " at " << int{p.x} << ", " << int{p.y};
}
std::ostream& operator<<(std::ostream& out, const AscBox& b) {
    return out << int{b.size[0]} << " x " << int{b.size[1]} << " x " << int{b.size[2]} << " at "
               << int{b.low[0]} << ", " << int{b.low[1]} << ", " << int{b.low[2]};
}

namespace {

/// A block of (N+1)^3 samples, by isInside(x, y, z), climbed.
template <int N>
class ClimbedBlock {
public:
    template <class F>
    explicit ClimbedBlock(const F& isInside, const std::array<int, 3>& cells = {N, N, N})
        : samples_(N + 1, isInside), climber_(samples_.block, cells) {}

    std::vector<Padi> padi(int slab) const {
        std::vector<Padi> found;
        climber_.findPadi(slab, found);
        return found;
    }
    std::vector<AscBox> boxes() const {
        std::vector<AscBox> found;
        climber_.findBoxes(found);
        return found;
    }
    bool inside(const std::array<int, 3>& p) const { return samples_.block.inside(p); }

private:
    struct Samples {
        template <class F>
        Samples(int side, const F& isInside)
            : values(valuesOf(side, isInside)),
              sampler(LatticeSampler::make(VolumeView(values.data(), geometryOf(side)), 0.5,
                                           Border::Closed)),
              block(*sampler, {0, 0, 0}) {}

        template <class F>
        static std::vector<std::uint8_t> valuesOf(int side, const F& isInside) {
            std::vector<std::uint8_t> values;
            for (int z = 0; z < side; ++z) {
                for (int y = 0; y < side; ++y) {
                    for (int x = 0; x < side; ++x) values.push_back(isInside(x, y, z) ? 1 : 0);
                }
            }
            return values;
        }
        static ImageGeometry geometryOf(int side) {
            ImageGeometry geometry;
            geometry.size = {side, side, side};
            return geometry;
        }

        std::vector<std::uint8_t> values;
        std::unique_ptr<LatticeSampler> sampler;
        BlockSamples<N> block;
    };

    Samples samples_;
    SkeletonClimber<N> climber_;
};

using Boxes = std::vector<AscBox>;
using Padis = std::vector<Padi>;

template <int N>
bool isSimpleByDefinition(const ClimbedBlock<N>& block, const AscBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int a = 0; a <= box.size[u]; ++a) {
            for (int b = 0; b <= box.size[v]; ++b) {
                int changes = 0;
                for (int step = 0; step < box.size[axis]; ++step) {
                    std::array<int, 3> p{box.low[0], box.low[1], box.low[2]};
                    p[u] += a;
                    p[v] += b;
                    p[axis] += step;
                    std::array<int, 3> q = p;
                    ++q[axis];
                    changes += block.inside(p) != block.inside(q);
                }
                if (changes > 1) return false;
            }
        }
    }
    return true;
}

template <int N>
void expectSimpleBoxesFillTheBlock() {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        // mostly one value, so that boxes grow; cells cut off at an open border
        std::uint64_t state = seed;
        std::array<int, 3> cells;
        for (int& c : cells) c = static_cast<int>(testing::nextRandom(state) % (N + 1));
        if (seed % 2 == 0) cells = {N, N, N};
        const std::uint64_t rarity = 2 + 3 * seed;
        const ClimbedBlock<N> block(
            [&](int, int, int) { return testing::nextRandom(state) % rarity == 0; }, cells);
        std::vector<int> covered(std::size_t{N} * N * N, 0);
        for (const AscBox& box : block.boxes()) {
            EXPECT_TRUE(isSimpleByDefinition(block, box)) << "seed " << seed << ": " << box;
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_TRUE(std::has_single_bit(box.size[axis])) << box;
                EXPECT_EQ(box.low[axis] % box.size[axis], 0) << box;
            }
            for (int z = 0; z < box.size[2]; ++z) {
                for (int y = 0; y < box.size[1]; ++y) {
                    for (int x = 0; x < box.size[0]; ++x) {
                        ++covered.at(box.low[0] + x + N * (box.low[1] + y + N * (box.low[2] + z)));
                    }
                }
            }
        }
        for (int z = 0; z < N; ++z) {
            for (int y = 0; y < N; ++y) {
                for (int x = 0; x < N; ++x) {
                    const bool inVolume = x < cells[0] && y < cells[1] && z < cells[2];
                    ASSERT_EQ(covered[x + N * (y + N * z)], inVolume ? 1 : 0)
                        << "seed " << seed << " at " << x << " " << y << " " << z;
                }
            }
        }
    }
}

}  // namespace

TEST(SkeletonClimber, FillsTheBlockOnceWithSimpleBoxes) {
    expectSimpleBoxesFillTheBlock<2>();
    expectSimpleBoxesFillTheBlock<4>();
    expectSimpleBoxesFillTheBlock<8>();
    expectSimpleBoxesFillTheBlock<16>();
}

TEST(SkeletonClimber, TakesABlockWholeWhereAPlanePasses) {
    const Boxes whole{{{0, 0, 0}, {4, 4, 4}}};
    EXPECT_EQ(ClimbedBlock<4>([](int x, int, int) { return x < 3; }).boxes(), whole);
    EXPECT_EQ(ClimbedBlock<4>([](int, int y, int) { return y > 0; }).boxes(), whole);
    EXPECT_EQ(ClimbedBlock<4>([](int, int, int z) { return z < 1; }).boxes(), whole);
    EXPECT_EQ(ClimbedBlock<4>([](int x, int y, int z) { return x + 2 * y - z < 3; }).boxes(),
              whole);
}

TEST(SkeletonClimber, CutsAtTheDikeThatASheetVariesTwiceOn) {
    const Boxes acrossX{{{0, 0, 0}, {2, 4, 4}}, {{2, 0, 0}, {2, 4, 4}}};
    EXPECT_EQ(ClimbedBlock<4>([](int x, int, int) { return x == 2; }).boxes(), acrossX);
    const Boxes acrossY{{{0, 0, 0}, {4, 2, 4}}, {{0, 2, 0}, {4, 2, 4}}};
    EXPECT_EQ(ClimbedBlock<4>([](int, int y, int) { return y == 2; }).boxes(), acrossY);
}

TEST(SkeletonClimber, GrowsToAnyLengthAlongZ) {
    // in at slab 0, out again at slab 1: the second box takes the other three
    const Boxes boxes{{{0, 0, 0}, {4, 4, 1}}, {{0, 0, 1}, {4, 4, 3}}};
    EXPECT_EQ(ClimbedBlock<4>([](int, int, int z) { return z == 1; }).boxes(), boxes);
}

TEST(SkeletonClimber, ClimbsRoundARod) {
    // Strips 0 and 1 hold the rod's lign: their largest dikes are 0..1, 1..2 and 2..4. Across them
    // the first two meet a lign along y that varies twice, the third does not. Strips 2 and 3 are
    // free: the whole lign, two strips long.
    const ClimbedBlock<4> block([](int x, int y, int) { return x == 1 && y == 1; });
    const Padis padi{{0, 2, 4, 2}, {2, 0, 2, 2}, {0, 0, 1, 1},
                     {0, 1, 1, 1}, {1, 0, 1, 1}, {1, 1, 1, 1}};
    for (int slab = 0; slab < 4; ++slab) EXPECT_EQ(block.padi(slab), padi) << "slab " << slab;
    const Boxes boxes = block.boxes();
    ASSERT_EQ(boxes.size(), padi.size());
    for (const AscBox& box : boxes) EXPECT_EQ(box.size[2], 4) << box;
}

TEST(SkeletonClimber, CutsABallThroughItsMiddle) {
    // radius 1 about sample (2, 2, 2): farm 2 holds five samples of it, farms 1 and 3 one each
    const ClimbedBlock<4> block([](int x, int y, int z) {
        return (x - 2) * (x - 2) + (y - 2) * (y - 2) + (z - 2) * (z - 2) <= 1;
    });
    // slab 0: ligns 0 and 4 are free, so strips 0 and 3 are whole; the others meet one sample
    const Padis outer{{0, 0, 4, 1}, {0, 3, 4, 1}, {0, 1, 2, 1},
                      {0, 2, 2, 1}, {2, 1, 2, 1}, {2, 2, 2, 1}};
    const Padis inner{{0, 0, 2, 2}, {0, 2, 2, 2}, {2, 0, 2, 2}, {2, 2, 2, 2}};
    EXPECT_EQ(block.padi(0), outer);
    EXPECT_EQ(block.padi(1), inner);
    EXPECT_EQ(block.padi(2), inner);
    EXPECT_EQ(block.padi(3), outer);
    // slabs 1 and 2 have equal padi, but lign (1, 2) along z goes in and out between them
    EXPECT_EQ(block.boxes().size(), 6u + 4u + 4u + 6u);
}

TEST(SkeletonClimber, ReachesNotOverTheLastSampleOfAnOpenVolume) {
    const ClimbedBlock<4> block([](int, int, int) { return false; }, {3, 4, 2});
    const Boxes boxes{{{0, 0, 0}, {2, 4, 2}}, {{2, 0, 0}, {1, 4, 2}}};
    EXPECT_EQ(block.boxes(), boxes);
}

}  // namespace adaptiso::detail
