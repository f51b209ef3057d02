#include <gtest/gtest.h>

#include <cstdint>

#include "adaptive/collapse/ChangedStar.h"
#include "adaptive/collapse/CrossingGuard.h"

namespace adaptiso::testing {
namespace {

using detail::ChangedStar;
using detail::CrossingGuard;
using detail::MetricFrame;
using detail::Patch;
using detail::PatchTopology;
using detail::Sample;

constexpr std::uint32_t kSide = 5;

std::uint32_t vertexAt(std::uint32_t x, std::uint32_t y) {
    return x + kSide * y;
}

/// A flat sheet of 5 x 5 vertices at z = 0, 1 mm apart, a sample at each, and over it at z = 0.5
/// one large triangle without any. A second sheet lies near all samples, by what they know.
Patch sheetUnderTriangle() {
    Patch patch;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        patch.points.push_back({static_cast<double>(i % kSide), static_cast<double>(i / kSide), 0});
    }
    for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
        for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
            const std::uint32_t a = vertexAt(x, y), b = vertexAt(x + 1, y), c = vertexAt(x, y + 1),
                                d = vertexAt(x + 1, y + 1);
            patch.triangles.push_back({a, b, d});
            patch.triangles.push_back({a, d, c});
        }
    }
    const auto first = static_cast<std::uint32_t>(patch.points.size());
    patch.points.insert(patch.points.end(), {{-20, -20, 0.5}, {30, -20, 0.5}, {0, 40, 0.5}});
    patch.triangles.push_back({first, first + 1, first + 2});
    patch.ownTriangles = static_cast<std::uint32_t>(patch.triangles.size());
    patch.quadrics.resize(patch.points.size());
    patch.states.assign(patch.points.size(), Patch::State::Open);
    for (std::uint32_t t = 0; t + 1 < patch.triangles.size(); ++t) {
        Sample& sample = patch.samples.emplace_back();
        sample.setPoint(patch.points[patch.triangles[t][0]]);
        sample.setNormal({0, 0, 1});
        sample.clearance = 0;
        patch.sampleTriangle.push_back(t);
    }
    return patch;
}

MetricFrame millimetres() {
    ImageGeometry geometry;
    geometry.size = {32, 32, 32};
    return MetricFrame(geometry);
}

}  // namespace

TEST(CrossingGuard, SeesTrianglesThatNoSampleIsAssignedTo) {
    Patch patch = sheetUnderTriangle();
    const MetricFrame frame = millimetres();
    const PatchTopology topology(patch);
    for (const bool looksEverywhere : {false, true}) {
        CrossingGuard guard(patch, topology, frame, looksEverywhere);
        ChangedStar changed;
        ASSERT_TRUE(topology.starOf(vertexAt(2, 2), changed.star));
        for (const double height : {0.3, 0.7}) {  // below the triangle, and through it
            changed.vertex = {2, 2, height};
            ASSERT_EQ(shapeStar(patch, {}, changed), detail::Refusal::None);
            EXPECT_EQ(guard.crossesNothing(changed), height < 0.5) << height;
        }
    }
}

TEST(CrossingGuard, SeesTrianglesWhereACommitPutThem) {
    Patch patch = sheetUnderTriangle();
    const MetricFrame frame = millimetres();
    const PatchTopology topology(patch);
    CrossingGuard guard(patch, topology, frame, false);
    ChangedStar changed;
    ASSERT_TRUE(topology.starOf(vertexAt(1, 1), changed.star));
    changed.vertex = {1, 1, 0.4};
    ASSERT_EQ(shapeStar(patch, {}, changed), detail::Refusal::None);
    ASSERT_TRUE(guard.crossesNothing(changed));
    // a tent of 3 mm beside it, over the place that the next star wants
    changed.vertex = {4.5, 1, 0.4};
    ASSERT_TRUE(topology.starOf(vertexAt(1, 1), changed.star));
    guard.commit(changed, false);
    patch.points[vertexAt(1, 1)] = changed.vertex;
    ChangedStar other;
    ASSERT_TRUE(topology.starOf(vertexAt(3, 1), other.star));
    other.vertex = {3, 1, 0.45};
    ASSERT_EQ(shapeStar(patch, {}, other), detail::Refusal::None);
    EXPECT_FALSE(guard.crossesNothing(other));
}

// A tetrahedron of its own above the sheet: a tent high enough crosses nothing, and leaves it
// below.
TEST(CrossingGuard, LetsNoStarSweepOverAPiece) {
    Patch patch = sheetUnderTriangle();
    patch.triangles.pop_back();  // the large one
    const auto first = static_cast<std::uint32_t>(patch.points.size());
    patch.points.insert(patch.points.end(),
                        {{1.95, 1.95, 0.2}, {2.05, 1.95, 0.2}, {2, 2.05, 0.2}, {2, 2, 0.3}});
    const auto own = static_cast<std::uint32_t>(patch.triangles.size());
    for (const auto& [a, b, c] : {std::array{0U, 2U, 1U}, {0U, 1U, 3U}, {1U, 2U, 3U}, {2U, 0U, 3U}})
        patch.triangles.push_back({first + a, first + b, first + c});
    patch.ownTriangles = own + 4;
    patch.quadrics.resize(patch.points.size());
    patch.states.resize(patch.points.size(), Patch::State::Open);
    const MetricFrame frame = millimetres();
    const PatchTopology topology(patch);
    for (const bool looksEverywhere : {false, true}) {
        CrossingGuard guard(patch, topology, frame, looksEverywhere);
        ChangedStar changed;
        ASSERT_TRUE(topology.starOf(vertexAt(2, 2), changed.star));
        for (const double height : {-2.0, 0.1, 0.25, 2.0}) {  // below, through and over the piece
            changed.vertex = {2, 2, height};
            ASSERT_EQ(shapeStar(patch, {}, changed), detail::Refusal::None);
            EXPECT_EQ(guard.crossesNothing(changed), height < 0.2) << height;
        }
        for (const std::uint32_t corner : {0U, 1U, 2U, 3U}) {  // the piece goes up, and is found
            ChangedStar moved;
            ASSERT_TRUE(topology.starOf(first + corner, moved.star));
            moved.vertex = patch.points[first + corner] + Vec3{0, 0, 1.5};
            guard.commit(moved, false);
            patch.points[first + corner] = moved.vertex;
        }
        for (const double height : {0.25, 1.0, 2.0}) {
            changed.vertex = {2, 2, height};
            ASSERT_EQ(shapeStar(patch, {}, changed), detail::Refusal::None);
            EXPECT_EQ(guard.crossesNothing(changed), height < 1.7) << height;
        }
        for (int corner = 0; corner < 4; ++corner) patch.points[first + corner].z -= 1.5;
    }
}

// A sheet whose last column is folded back over it: no sample knows of another sheet.
TEST(CrossingGuard, AsksForAProofBesideAFold) {
    Patch patch = sheetUnderTriangle();
    for (Sample& sample : patch.samples) sample.clearance = detail::SheetClearance::kAlone;
    const MetricFrame frame = millimetres();
    for (const bool isFolded : {false, true}) {
        for (std::uint32_t y = 0; isFolded && y < kSide; ++y) {
            patch.points[vertexAt(4, y)] = {2, static_cast<double>(y), 0.01};
        }
        const PatchTopology topology(patch);
        const CrossingGuard guard(patch, topology, frame, false);
        ChangedStar changed;
        ASSERT_TRUE(topology.starOf(vertexAt(2, 2), changed.star));
        changed.vertex = {2, 2, 0.02};
        ASSERT_EQ(shapeStar(patch, {}, changed), detail::Refusal::None);
        ASSERT_TRUE(changed.isGraph);
        EXPECT_EQ(guard.needsProof(changed, false), isFolded);
    }
}

}  // namespace adaptiso::testing
