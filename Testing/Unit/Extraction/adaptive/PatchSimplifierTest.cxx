#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/collapse/PatchSimplifier.h"

namespace adaptiso::testing {
namespace {

using detail::Patch;
using detail::PatchLimits;
using detail::PatchSimplifier;

constexpr std::int64_t kAll = 1 << 20;

PatchLimits limits(double distanceMm) {
    PatchLimits limits;
    limits.maxCost = 1e3;
    limits.maxDistanceMm = distanceMm;
    return limits;
}

/// A sphere of radius 10 with a sample at each vertex.
Patch spherePatch() {
    Patch patch = patchOf(icosphere(3, {}, 10));
    addSamples(patch);
    for (std::size_t s = 0; s < patch.samples.size(); ++s) {
        patch.samples[s].setNormal(patch.points[s]);
    }
    return patch;
}

double squaredDistance(const Patch& patch, std::size_t s) {
    const auto& [a, b, c] = patch.triangles[patch.sampleTriangle[s]];
    return detail::squaredDistanceToTriangle(patch.samples[s].point(),
                                             {patch.points[a], patch.points[b], patch.points[c]});
}

}  // namespace

TEST(PatchSimplifier, LeavesLittleOfAFlatSheet) {
    Patch patch = patchOf(planeMesh(8, 8));
    addSamples(patch);
    PatchSimplifier(patch, unitFrame(), limits(0.1)).collapseEdges(kAll, nullptr);
    const TriangleMesh mesh = meshOf(patch);
    // the border's 32 vertices stay: with one more within, there are 32 triangles
    EXPECT_LE(mesh.triangles.size(), 50U);
    EXPECT_NEAR(surfaceArea(mesh), 64, 1e-9);
    for (const Vec3& p : mesh.points) EXPECT_NEAR(p.z, 0, 1e-9);
}

TEST(PatchSimplifier, KeepsSamplesWithinTheirDistance) {
    std::size_t last = 0;
    for (const double distance : {1.0, 0.3, 0.1}) {
        Patch patch = spherePatch();
        PatchSimplifier(patch, unitFrame(), limits(distance)).collapseEdges(kAll, nullptr);
        for (std::size_t s = 0; s < patch.samples.size(); ++s) {
            EXPECT_LE(std::sqrt(squaredDistance(patch, s)), distance + kSampleRounding);
        }
        const TriangleMesh mesh = meshOf(patch);
        expectSound(mesh);
        EXPECT_GT(mesh.triangles.size(), last) << distance;
        EXPECT_LT(mesh.triangles.size(), 1280U) << distance;
        last = mesh.triangles.size();
    }
}

TEST(PatchSimplifier, MakesAsManyCollapsesAsAsked) {
    Patch patch = spherePatch();
    std::vector<double> costs;
    PatchSimplifier(patch, unitFrame(), limits(1)).collapseEdges(100, &costs);
    EXPECT_EQ(costs.size(), 100U);
    EXPECT_EQ(meshOf(patch).triangles.size(), 1280U - 200U);
    EXPECT_LE(*std::max_element(costs.begin(), costs.end()), 1e3);
}

TEST(PatchSimplifier, MakesNoCollapseAboveItsCost) {
    Patch patch = spherePatch();
    std::vector<double> costs;
    PatchLimits cheap = limits(1);
    cheap.maxCost = 0.05;
    PatchSimplifier(patch, unitFrame(), cheap).collapseEdges(kAll, &costs);
    EXPECT_GT(costs.size(), 20U);
    for (const double cost : costs) EXPECT_LE(cost, 0.05);
}

TEST(PatchSimplifier, PutsNewVerticesIntoItsBox) {
    Patch patch = spherePatch();
    const std::vector<Vec3> before = patch.points;
    patch.lowIndex = {0, 0, 0};
    patch.highIndex = {8, 8, 8};
    PatchSimplifier(patch, unitFrame(), limits(0.5)).collapseEdges(kAll, nullptr);
    int changed = 0;
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
        if (patch.points[v] == before[v]) continue;
        ++changed;
        for (int a = 0; a < 3; ++a) {
            EXPECT_GE(patch.points[v][a], 0);
            EXPECT_LE(patch.points[v][a], 8);
        }
    }
    EXPECT_GT(changed, 3);
}

TEST(PatchSimplifier, TriesEdgesAgainThatLedOutOfAnotherBox) {
    Patch patch = patchOf(planeMesh(8, 8));
    addSamples(patch);
    const Vec3 low = patch.lowIndex;
    patch.lowIndex.z = 1e-6;  // all of the sheet lies in a wall
    PatchSimplifier(patch, unitFrame(), limits(0.1)).collapseEdges(kAll, nullptr);
    EXPECT_EQ(meshOf(patch).triangles.size(), 128U);
    patch.lowIndex = low;
    PatchLimits again = limits(0.1);
    again.triedCost = again.maxCost;
    PatchSimplifier(patch, unitFrame(), again).collapseEdges(kAll, nullptr);
    EXPECT_LE(meshOf(patch).triangles.size(), 50U);
}

TEST(PatchSimplifier, LeavesFinalVertices) {
    Patch patch = spherePatch();
    const std::vector<Vec3> before = patch.points;
    for (std::size_t v = 0; v < before.size(); ++v) {
        if (before[v].z > 0) patch.states[v] = Patch::State::Final;
    }
    const detail::MetricFrame frame = unitFrame();
    PatchSimplifier simplifier(patch, frame, limits(0.5));
    simplifier.collapseEdges(kAll, nullptr);
    simplifier.fitVertices();
    const TriangleMesh mesh = meshOf(patch);
    for (const Vec3& p : before) {
        if (p.z <= 0) continue;
        EXPECT_EQ(std::count(mesh.points.begin(), mesh.points.end(), p), 1);
    }
    EXPECT_LT(mesh.triangles.size(), 1000U);
}

TEST(PatchSimplifier, FitsVerticesToTheSamples) {
    Patch patch = spherePatch();
    const detail::MetricFrame frame = unitFrame();
    PatchSimplifier simplifier(patch, frame, limits(0.5));
    simplifier.collapseEdges(kAll, nullptr);
    const auto sumOfSquares = [&] {
        double sum = 0;
        for (std::size_t s = 0; s < patch.samples.size(); ++s) sum += squaredDistance(patch, s);
        return sum;
    };
    const double before = sumOfSquares();
    const std::size_t count = meshOf(patch).triangles.size();
    simplifier.fitVertices();
    EXPECT_LT(sumOfSquares(), 0.9 * before);
    EXPECT_EQ(meshOf(patch).triangles.size(), count);
    expectSound(meshOf(patch));
}

TEST(Sample, KeepsItsPlaceAndItsDirection) {
    std::mt19937 random(1);
    for (int n = 0; n < 100; ++n) {
        const Vec3 p = randomPoint(random, 500), normal = 7 * randomPoint(random);
        detail::Sample sample;
        sample.setPoint(p);
        sample.setNormal(normal);
        EXPECT_LE(norm(sample.point() - p), 1e-4);  // 24 bits of 500
        EXPECT_LE(norm(sample.normal() - normalized(normal)), 1e-4);
    }
}

TEST(TriedEdges, AreTriedAgainWhereSomethingHasChanged) {
    using State = Patch::State;
    std::vector<State> states(4, State::Open);
    states[3] = State::Final;
    detail::TriedEdges tried(states, 0.5);
    EXPECT_FALSE(tried.has(0, 1, 0.1));
    for (std::uint32_t v = 0; v < 4; ++v) tried.begin(v);
    EXPECT_TRUE(tried.has(0, 1, 0.5));
    EXPECT_FALSE(tried.has(0, 1, 0.6));  // dearer than what was tried
    EXPECT_FALSE(tried.has(0, 3, 0.1));
    tried.open(0);
    EXPECT_FALSE(tried.has(0, 1, 0.1));
    tried.passOn(1, 3);
    EXPECT_EQ(states, (std::vector{State::Open, State::Tried, State::Tried, State::Final}));
    tried.finish();
    EXPECT_EQ(states, (std::vector{State::Open, State::Open, State::Tried, State::Final}));
    detail::TriedEdges::openAll(states);
    EXPECT_EQ(states, (std::vector{State::Open, State::Open, State::Open, State::Final}));
}

}  // namespace adaptiso::testing
