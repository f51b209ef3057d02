#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "SampledSquare.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/collapse/ErrorTracker.h"

namespace adaptiso::testing {
namespace {

using detail::ChangedStar;
using detail::ErrorTracker;
using detail::Patch;
using detail::PatchTopology;
using detail::Refusal;
using detail::SampleAssignment;

double squaredDistance(const Patch& patch, std::size_t s, std::uint32_t triangle) {
    const auto& [a, b, c] = patch.triangles[triangle];
    return detail::squaredDistanceToTriangle(patch.samples[s].point(),
                                             {patch.points[a], patch.points[b], patch.points[c]});
}

/// Every sample is in the list of the triangle that it is assigned to, and in no other.
void expectListed(const Patch& patch, const ErrorTracker& errors) {
    std::vector<int> listed(patch.samples.size(), 0);
    for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) {
        for (auto s = errors.first(t); s != ErrorTracker::kNone; s = errors.next(s)) {
            EXPECT_EQ(patch.sampleTriangle[s], t);
            EXPECT_NE(patch.triangles[t][0], Patch::kGone);
            ++listed[s];
        }
    }
    EXPECT_EQ(std::count(listed.begin(), listed.end(), 1), std::ssize(listed));
}

}  // namespace

// Hills whose vertices move by chance: each sample goes to a triangle of the new star, at the
// distance that was told, and that is mostly the nearest one.
TEST(ErrorTracker, HandsSamplesToNearTriangles) {
    std::mt19937 random(2);
    int moved = 0, nearest = 0;
    for (int n = 0; n < 200; ++n) {
        SampledSquare square;
        Patch& patch = square.patch;
        for (Vec3& p : patch.points) p.z = 0.3 * randomPoint(random).z;
        for (int i = 0; i < 5; ++i) square.addSample(randomPoint(random).z);
        ErrorTracker errors(patch, unitFrame());
        square.changed.vertex = patch.points[SampledSquare::kMiddle] + randomPoint(random, 0.3);
        SampleAssignment result;
        if (shapeStar(patch, {}, square.changed) != Refusal::None ||
            errors.assign(square.changed, 2, result) != Refusal::None) {
            continue;
        }
        std::vector<std::size_t> samples;
        const auto& star = square.changed.star;
        for (int i = 0; i < star.count; ++i) {
            for (auto s = errors.first(star.triangle[i]); s != ErrorTracker::kNone;
                 s = errors.next(s)) {
                samples.push_back(s);
            }
        }
        errors.commit(square.changed, result);
        patch.points[SampledSquare::kMiddle] = square.changed.vertex;
        expectListed(patch, errors);
        double sum = 0, largest = 0;
        for (const std::size_t s : samples) {
            const double squared = squaredDistance(patch, s, patch.sampleTriangle[s]);
            double least = std::numeric_limits<double>::max();
            for (int i = 0; i < star.count; ++i) {
                least = std::min(least, squaredDistance(patch, s, star.triangle[i]));
            }
            sum += squared;
            largest = std::max(largest, squared);
            ++moved;
            nearest += squared <= least + kSampleRounding ? 1 : 0;
        }
        ASSERT_NEAR(result.sumOfSquares, sum, kSampleRounding) << n;
        ASSERT_NEAR(result.largestSquare, largest, kSampleRounding) << n;
    }
    EXPECT_GT(moved, 1000);
    EXPECT_GT(nearest, moved * 3 / 4);
}

TEST(ErrorTracker, HandsOnTheSamplesOfTrianglesThatGo) {
    SampledSquare square;
    Patch& patch = square.patch;
    PatchTopology topology(patch);
    ErrorTracker errors(patch, unitFrame());
    for (std::uint32_t h = 0; h < 3 * patch.ownTriangles; ++h) {
        if (patch.triangles[h / 3][0] == Patch::kGone) continue;
        if (!topology.isMovable(topology.from(h)) || !topology.isMovable(topology.to(h))) continue;
        ChangedStar changed;
        if (!topology.starOfEdge(h, changed.star)) continue;
        changed.vertex = 0.5 * (patch.points[topology.from(h)] + patch.points[topology.to(h)]);
        SampleAssignment result;
        if (shapeStar(patch, {}, changed) != Refusal::None ||
            errors.assign(changed, 0.1, result) != Refusal::None)
            continue;
        const std::uint32_t kept = topology.from(h);
        topology.collapse(h, changed.star);
        errors.commit(changed, result);
        patch.points[kept] = changed.vertex;
    }
    EXPECT_LT(meshOf(patch).triangles.size(), 24U);
    expectListed(patch, errors);
    for (std::size_t s = 0; s < patch.samples.size(); ++s) {
        EXPECT_NEAR(squaredDistance(patch, s, patch.sampleTriangle[s]), 0, kSampleRounding) << s;
    }
}

}  // namespace adaptiso::testing
