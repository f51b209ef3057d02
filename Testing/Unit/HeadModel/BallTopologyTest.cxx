#include <gtest/gtest.h>

#include "BallTopology.h"
#include "HeadPhantoms.h"
#include "Support/Soundness.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::headmodel {
namespace {

using namespace adaptiso::testing;

constexpr Index3 kSize{40, 40, 40};

Mask maskOf(const Shape& shape) {
    return above(partInside(shape, centredGeometry(kSize)), 0.5);
}

FractionField fieldOf(const Mask& mask) {
    FractionField field{centredGeometry(kSize), std::vector<float>(mask.size())};
    for (std::size_t n = 0; n < mask.size(); ++n) field.part[n] = mask[n] != 0 ? 0.8f : 0.2f;
    return field;
}

/// Genus of the surface between the voxels; none when it is not one sound piece.
std::optional<std::int64_t> genusOf(const FractionField& field) {
    const TriangleMesh mesh = surfaceOf(field);
    expectSound(mesh);
    const TopologyReport report = checkTopology(mesh);
    return report.components.size() == 1 ? report.genus() : std::nullopt;
}

/// The voxels at these places of an otherwise empty grid.
Mask voxels(const std::vector<Index3>& places) {
    Mask mask(static_cast<std::size_t>(kSize[0] * kSize[1] * kSize[2]), 0);
    for (const Index3& at : places) mask[at[0] + kSize[0] * (at[1] + kSize[1] * at[2])] = 1;
    return mask;
}

TEST(MaskTopology, CountsHandlesAndCavities) {
    EXPECT_EQ(maskTopology(maskOf(sphere({}, 12)), kSize).eulerCharacteristic, 1);
    EXPECT_EQ(maskTopology(maskOf(torus({}, 11, 4)), kSize).eulerCharacteristic, 0);
    EXPECT_EQ(maskTopology(maskOf(shell({}, 6, 12)), kSize).eulerCharacteristic, 2);
    EXPECT_EQ(maskTopology(voxels({}), kSize).eulerCharacteristic, 0);
    EXPECT_EQ(maskTopology(voxels({{5, 5, 5}, {9, 9, 9}}), kSize).eulerCharacteristic, 2);
}

TEST(MaskTopology, FindsPlacesThatTouchByAnEdgeOrACornerOnly) {
    EXPECT_EQ(maskTopology(voxels({{5, 5, 5}, {6, 5, 5}}), kSize).criticalPlaces, 0);
    // the edge has two ends: two cubes of eight voxels see it
    EXPECT_EQ(maskTopology(voxels({{5, 5, 5}, {6, 6, 5}}), kSize).criticalPlaces, 2);
    EXPECT_EQ(maskTopology(voxels({{5, 5, 5}, {6, 6, 6}}), kSize).criticalPlaces, 1);
}

TEST(IsBall, IsTrueOfBallsAlone) {
    EXPECT_TRUE(isBall(maskOf(sphere({}, 12)), kSize));
    EXPECT_TRUE(isBall(maskOf(box({}, {9, 5, 3})), kSize));
    EXPECT_TRUE(isBall(voxels({{5, 5, 5}}), kSize));
    EXPECT_FALSE(isBall(maskOf(torus({}, 11, 4)), kSize));
    EXPECT_FALSE(isBall(maskOf(shell({}, 6, 12)), kSize));
    EXPECT_FALSE(isBall(voxels({{5, 5, 5}, {9, 9, 9}}), kSize));
    EXPECT_FALSE(isBall(voxels({{5, 5, 5}, {6, 6, 5}}), kSize));
    EXPECT_FALSE(isBall(voxels({}), kSize));
}

TEST(GrownBall, CutsAHandleByOneLayer) {
    const Mask ring = maskOf(torus({}, 11, 4));
    std::vector<float> depth = depthMm(ring, centredGeometry(kSize));
    const std::int64_t seed = std::max_element(depth.begin(), depth.end()) - depth.begin();
    Mask core(ring.size(), 0);
    core[seed] = 1;
    const Mask ball = grownBall(ring, depth, core, kSize);
    EXPECT_TRUE(isBall(ball, kSize));
    // the ring's section has 49 voxels; fronts that meet aslant leave a few more
    EXPECT_GE(voxelsIn(ring) - voxelsIn(ball), 30);
    EXPECT_LE(voxelsIn(ring) - voxelsIn(ball), 150);
    for (std::size_t n = 0; n < ring.size(); ++n) ASSERT_LE(ball[n], ring[n]);
}

TEST(CarvedBall, ClosesAHandleByAMembrane) {
    const Mask ring = maskOf(torus({}, 11, 4));
    const std::vector<float> depth = depthMm(ring, centredGeometry(kSize));
    const Mask ball = carvedBall(ring, depth, maskOf(sphere({}, 17)), kSize);
    EXPECT_TRUE(isBall(ball, kSize));
    // the hole has a radius of 7: 154 voxels of one layer, some more where it is not flat
    EXPECT_GE(voxelsIn(ball) - voxelsIn(ring), 100);
    EXPECT_LE(voxelsIn(ball) - voxelsIn(ring), 400);
    for (std::size_t n = 0; n < ring.size(); ++n) ASSERT_GE(ball[n], ring[n]);
}

TEST(MakeBall, LeavesABallAsItIs) {
    FractionField field = fieldOf(maskOf(sphere({}, 12)));
    const std::vector<float> before = field.part;
    EXPECT_EQ(makeBall(field.part, kSize), 0);
    EXPECT_EQ(field.part, before);
}

TEST(MakeBall, DropsStrayPiecesAndFillsCavities) {
    Mask mask = maskOf(shell({}, 5, 12));
    mask[3 + kSize[0] * (3 + kSize[1] * 3)] = 1;
    FractionField field = fieldOf(mask);
    EXPECT_EQ(makeBall(field.part, kSize), 0);
    EXPECT_EQ(above(field.part, 0.5), maskOf(sphere({}, 12)));
}

TEST(MakeBall, ClosesANarrowTunnelAndCutsAThinHandle) {
    // a tunnel of radius 2 through a ball is closed, by a membrane of 12 voxels or, since no voxel
    // of it is better than another here, a slanted one of a few layers; a cut takes the whole wall
    const Shape ball = sphere({}, 12);
    const ImageGeometry grid = centredGeometry(kSize);
    Mask mask = maskOf(ball);
    for (std::int64_t n = 0; n < std::ssize(mask); ++n) {
        const Vec3 p =
            grid.toPhysical({static_cast<double>(n % 40), static_cast<double>(n / 40 % 40), 0});
        if (std::hypot(p.x, p.y) < 2) mask[n] = 0;
    }
    FractionField tunnel = fieldOf(mask);
    EXPECT_EQ(genusOf(tunnel), 1);
    const std::int64_t closed = makeBall(tunnel.part, kSize);
    EXPECT_GT(closed, 0);
    EXPECT_LE(closed, 60);
    EXPECT_EQ(genusOf(tunnel), 0);

    // a thin wide ring on a ball is cut: 1 to 9 voxels against a membrane of hundreds
    Mask handled = maskOf(sphere({-8, 0, 0}, 8));
    const Mask ring = maskOf(torus({8, 0, 0}, 9, 1.2));
    for (std::size_t n = 0; n < ring.size(); ++n) handled[n] |= ring[n];
    FractionField handle = fieldOf(handled);
    const std::int64_t cut = makeBall(handle.part, kSize);
    EXPECT_GT(cut, 0);
    EXPECT_LE(cut, 30);
    EXPECT_EQ(genusOf(handle), 0);
}

TEST(MakeBall, MakesASphereOfAnyMess) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(seed);
        // noise smoothed a little: handles, cavities, islands and pinched places by the hundred
        std::vector<float> noise(40 * 40 * 40);
        std::uint64_t state = seed;
        for (float& value : noise) value = static_cast<float>(nextRandom(state) % 1000) / 1000;
        FractionField field{centredGeometry(kSize), noise};
        field.part = smoothed(field.part, field.grid, 0.4 + 0.1 * static_cast<double>(seed));
        const Mask room = maskOf(sphere({}, 17));
        for (std::size_t n = 0; n < room.size(); ++n) {
            if (room[n] == 0) field.part[n] = 0;
        }
        makeBall(field.part, kSize);
        EXPECT_TRUE(isBall(above(field.part, 0.5), kSize));
        EXPECT_EQ(genusOf(field), 0);
    }
}

TEST(MakeBall, MendsAPinchedPlaceWhereItIs) {
    // a voxel beside a flat side that touches it along an edge only
    Mask mask = maskOf(box({}, {10, 10, 10}));
    std::int64_t last = 0;
    for (std::int64_t n = 0; n < std::ssize(mask); ++n) last = mask[n] != 0 ? n : last;
    mask[last + 1 + kSize[0] * kSize[1] - 5 * kSize[0]] = 1;  // out by x and by z: over the edge
    ASSERT_EQ(maskTopology(mask, kSize).criticalPlaces > 0, true);
    FractionField field = fieldOf(mask);
    const std::int64_t changed = makeBall(field.part, kSize);
    EXPECT_LE(changed, 16);  // at most eight around each end of the edge
    EXPECT_TRUE(isBall(above(field.part, 0.5), kSize));
}

TEST(MakeBall, RefusesAnEmptySolid) {
    std::vector<float> nothing(40 * 40 * 40, 0);
    EXPECT_THROW(makeBall(nothing, kSize), InvalidInput);
}

}  // namespace
}  // namespace adaptiso::headmodel
