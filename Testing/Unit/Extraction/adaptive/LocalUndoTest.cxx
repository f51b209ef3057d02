#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "Support/Meshes.h"
#include "Support/Soundness.h"
#include "Surfaces.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/AdaptiveMethod.h"
#include "adaptive/full/VolumeSurface.h"
#include "adaptive/mending/LocalUndo.h"
#include "adaptive/mending/SurfaceMender.h"
#include "adaptive/rounds/PatchRound.h"

namespace adaptiso::testing {
namespace {

using detail::SurfaceState;
using StateTriangle = SurfaceState::Triangle;

constexpr double kRadius = 10;

/// A sphere, and the same after two rounds that make it coarser.
struct CoarseSphere {
    CoarseSphere() : surface(surfaceOf(icosphere(5, {}, kRadius))) {
        surface.heirs.resize(surface.points.size());
        std::iota(surface.heirs.begin(), surface.heirs.end(), std::uint32_t{0});
        start = surface.state();
        detail::PatchLimits limits;
        limits.maxCost = 1e6;
        limits.maxDistanceMm = 0.1;
        for (const std::int64_t shift : {0, 16}) {
            detail::runPatchRound(surface, {32, {shift, shift, shift}}, unitFrame(), {limits});
        }
        coarse = surface;
        heirs = surface.heirs;
    }

    detail::LocalUndo undo() { return {{start.points, start.triangles}, surface}; }
    std::optional<detail::SurfaceChanges> undoAround(const Vec3& place, double reachMm) {
        return undo().around({}, {{place, place}}, reachMm);
    }

    detail::SimplifiedSurface surface;
    SurfaceState start;
    SurfaceState coarse;  ///< the surface after the rounds
    std::vector<std::uint32_t> heirs;
};

/// From its smallest corner.
StateTriangle turned(StateTriangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

using Place = std::array<double, 3>;

/// A triangle's corners, from the smallest on.
std::array<Place, 3> fromSmallest(const Corners& triangle) {
    std::array<Place, 3> corners;
    for (int c = 0; c < 3; ++c) corners[c] = {triangle[c].x, triangle[c].y, triangle[c].z};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners;
}

std::array<Place, 3> cornersOf(const SurfaceState& surface, std::size_t triangle) {
    const auto& [a, b, c] = surface.triangles[triangle];
    return fromSmallest({surface.points[a], surface.points[b], surface.points[c]});
}

std::set<std::array<Place, 3>> byCorners(const SurfaceState& surface) {
    std::set<std::array<Place, 3>> all;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) all.insert(cornersOf(surface, t));
    return all;
}

}  // namespace

/// A ball beside a speck of one voxel. The speck counts as inside out as long as the ball's surface
/// near it is not the full one.
class BallBesideSpeck final : public detail::FullSurface {
public:
    BallBesideSpeck()
        : FullSurface(unitFrame()),
          scene_({32, 32, 32},
                 [](const Vec3& p) {
                     const double ball = 9 - norm(p - Vec3{14, 14, 14});
                     return norm(p - kSpeck) < 0.5 ? 1 : ball;
                 }),
          full_(scene_.volume.view().geometry(), *scene_.sampler, scene_.bricks),
          finePoints_(pointsNear(scene_.fullSurface())) {}

    detail::SimplifiedSurface firstRound(const detail::PatchLimits& limits,
                                         detail::CollapseCosts* costs) const override {
        return full_.firstRound(limits, costs);
    }
    TriangleView fineOf(const detail::SimplifiedSurface& surface) const override {
        return full_.fineOf(surface);
    }
    TriangleMesh meshOf(const detail::SimplifiedSurface& surface) const override {
        return full_.meshOf(surface);
    }
    std::vector<std::int64_t> crossingTriangles(
        const detail::SimplifiedSurface& surface,
        const std::vector<std::uint8_t>& isFine) const override {
        return full_.crossingTriangles(surface, isFine);
    }
    std::vector<std::int64_t> insideOut(const detail::SimplifiedSurface& surface) const override {
        std::vector<std::int64_t> speck;
        if (pointsNear(surface) == finePoints_) return speck;
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            if (norm(surface.points[surface.triangles[t][0]] - kSpeck) < 1.1) {
                speck.push_back(static_cast<std::int64_t>(t));
            }
        }
        return speck;
    }
    double largestExtentMm() const override { return full_.largestExtentMm(); }

private:
    static constexpr Vec3 kSpeck{26, 14, 14};

    static std::size_t pointsNear(const SurfaceState& surface) {
        std::set<std::uint32_t> points;
        for (const auto& t : surface.triangles) {
            for (const std::uint32_t v : t) {
                if (norm(surface.points[v] - kSpeck) < 6) points.insert(v);
            }
        }
        return points.size();
    }

    Scene scene_;
    detail::VolumeSurface full_;
    std::size_t finePoints_;
};

TEST(LocalUndo, EndsWhereMoreVerticesWouldReturnThanMay) {
    CoarseSphere sphere, whole;
    const Vec3 place{0, 0, kRadius};
    const std::size_t before = whole.surface.points.size();
    ASSERT_TRUE(whole.undoAround(place, 2));
    const auto gain = static_cast<std::int64_t>(whole.surface.points.size() - before);
    ASSERT_GT(gain, 0);

    detail::LocalUndo undo = sphere.undo();
    EXPECT_FALSE(undo.around({}, {{place, place}}, 2, gain - 1));
    EXPECT_TRUE(undo.isTooMuch());
    EXPECT_EQ(sphere.surface.points.size(), before);  // nothing is changed
    detail::LocalUndo again = sphere.undo();
    EXPECT_TRUE(again.around({}, {{place, place}}, 2, gain));
    EXPECT_FALSE(again.isTooMuch());
}

TEST(LocalUndo, GoesFartherAroundPiecesThatStayInsideOut) {
    // the speck's own corners were merged with none: to take these apart changes nothing
    const BallBesideSpeck full;
    const detail::AdaptiveResult made = detail::simplifyWithin(full, {}, {});
    EXPECT_GT(made.work.verticesUndone, 50);
    EXPECT_EQ(made.work.runs, 1);
    EXPECT_TRUE(isSound(made.mesh));
}

// Merging the start's vertices into their heirs gives the surface.
TEST(LocalUndo, StandsOnHeirsThatMakeTheSurface) {
    const CoarseSphere sphere;
    ASSERT_LT(sphere.surface.triangles.size(), sphere.start.triangles.size() / 4);
    std::set<StateTriangle> merged, made;
    for (const StateTriangle& t : sphere.start.triangles) {
        const auto& heirs = sphere.surface.heirs;
        const StateTriangle now{heirs[t[0]], heirs[t[1]], heirs[t[2]]};
        if (now[0] != now[1] && now[1] != now[2] && now[2] != now[0]) merged.insert(turned(now));
    }
    for (const StateTriangle& t : sphere.surface.triangles) made.insert(turned(t));
    EXPECT_EQ(merged, made);
}

TEST(LocalUndo, BringsTheStartBackAroundAPlaceAndNowhereElse) {
    CoarseSphere sphere;
    const Vec3 place{0, 0, kRadius};
    constexpr double kReach = 1.5;
    ASSERT_TRUE(sphere.undoAround(place, kReach));
    expectSound(meshOf(sphere.surface));
    EXPECT_GT(sphere.surface.triangles.size(), sphere.coarse.triangles.size());
    const auto now = byCorners(sphere.surface);
    int near = 0;
    for (std::size_t t = 0; t < sphere.start.triangles.size(); ++t) {
        const auto& corners = sphere.start.triangles[t];
        const bool isNear = std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
            return norm(sphere.coarse.points[sphere.heirs[v]] - place) < kReach;
        });
        if (!isNear) continue;
        EXPECT_TRUE(now.contains(cornersOf(sphere.start, t)));
        ++near;
    }
    EXPECT_GT(near, 5);
    // a vertex comes apart in cubes as wide as the reach: the place's own and those beside it
    const auto isInReach = [&](std::uint32_t v) {
        const Vec3 way = sphere.coarse.points[v] - place;
        return std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}) < 2 * kReach;
    };
    for (std::size_t t = 0; t < sphere.coarse.triangles.size(); ++t) {
        const auto& corners = sphere.coarse.triangles[t];
        EXPECT_TRUE(std::any_of(corners.begin(), corners.end(), isInReach) ||
                    now.contains(cornersOf(sphere.coarse, t)));
    }
}

TEST(LocalUndo, TellsWhatItChanged) {
    const CoarseSphere sphere;
    const auto before = byCorners(sphere.coarse);
    std::size_t told = 0, gone = 0;
    for (const Vec3& way : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0},
                            Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
        CoarseSphere undone = sphere;
        const auto changes = undone.undoAround(kRadius * way, 1);
        ASSERT_TRUE(changes);
        const std::set<std::uint32_t> numbers(changes->triangles.begin(), changes->triangles.end());
        for (std::uint32_t t = 0; t < undone.surface.triangles.size(); ++t) {
            const bool isSame = t < sphere.coarse.triangles.size() &&
                                undone.surface.triangles[t] == sphere.coarse.triangles[t];
            EXPECT_TRUE(isSame || numbers.contains(t));
        }
        std::set<std::array<Place, 3>> toldBefore;
        for (const Corners& corners : changes->before) {
            toldBefore.insert(fromSmallest(corners));
        }
        EXPECT_TRUE(
            std::includes(before.begin(), before.end(), toldBefore.begin(), toldBefore.end()));
        const auto now = byCorners(undone.surface);
        for (const auto& corners : before) {
            if (now.contains(corners)) continue;
            EXPECT_TRUE(toldBefore.contains(corners));
            ++gone;
        }
        told += toldBefore.size();
    }
    // a triangle whose vertices that come apart were never merged goes and comes back
    EXPECT_LE(told, gone + gone / 4) << gone;
}

TEST(LocalUndo, LeavesSamplesWithTrianglesNearThem) {
    CoarseSphere sphere;
    ASSERT_TRUE(sphere.undoAround({kRadius, 0, 0}, 1));
    for (std::size_t s = 0; s < sphere.surface.samples.size(); ++s) {
        const auto& [a, b, c] = sphere.surface.triangles.at(sphere.surface.sampleTriangle[s]);
        const auto& points = sphere.surface.points;
        EXPECT_LT(detail::squaredDistanceToTriangle(sphere.surface.samples[s].point(),
                                                    {points[a], points[b], points[c]}),
                  0.3 * 0.3);
    }
}

// Where a vertex was pulled through the surface beside it what crosses comes apart, and what
// crosses that then.
TEST(LocalUndo, TakesBackWhatCrosses) {
    const CoarseSphere sphere;
    constexpr std::size_t kEvery = 11;
    constexpr int kTimes = 4;
    int crossed = 0, cleared = 0;
    for (std::size_t v = 0; v < sphere.surface.points.size(); v += kEvery) {
        CoarseSphere pulled = sphere;
        Vec3& p = pulled.surface.points[v];
        p = 0.99 * p + cross(normalized(p), {1, 2, 3});
        std::vector<std::int64_t> crossing = crossingTriangles(meshOf(pulled.surface));
        if (crossing.empty()) continue;
        ++crossed;
        for (int n = 0; n < kTimes && !crossing.empty(); ++n) {
            std::vector<detail::PlaceBeyond> places;  // farther than the reach from all vertices
            for (const std::int64_t t : crossing) {
                places.push_back({{}, {}, static_cast<SurfaceState::Number>(t)});
            }
            if (!pulled.undo().around({}, places, 1)) break;
            expectSound(meshOf(pulled.surface));
            crossing = crossingTriangles(meshOf(pulled.surface));
        }
        cleared += crossing.empty() ? 1 : 0;
    }
    EXPECT_GT(crossed, 5);
    EXPECT_GT(2 * cleared, crossed);
}

TEST(LocalUndo, HasNothingToDoWhereNothingWasMerged) {
    CoarseSphere sphere;
    static_cast<SurfaceState&>(sphere.surface) = sphere.start;
    std::iota(sphere.surface.heirs.begin(), sphere.surface.heirs.end(), std::uint32_t{0});
    EXPECT_FALSE(sphere.undoAround({0, 0, kRadius}, 1));
    EXPECT_FALSE(CoarseSphere().undoAround({0, 0, 0}, 1));  // no surface there
}

TEST(LocalUndo, BringsAllBackFromFarEnough) {
    CoarseSphere sphere;
    EXPECT_TRUE(sphere.undoAround({0, 0, kRadius}, 2 * kRadius));
    EXPECT_EQ(byCorners(sphere.surface), byCorners(sphere.start));
    EXPECT_FALSE(sphere.undoAround({0, 0, kRadius}, 2 * kRadius));
}

// What was mended goes with what it was mended in.
TEST(LocalUndo, TakesMendedTrianglesBackToo) {
    CoarseSphere sphere;
    const Vec3 place{0, 0, kRadius};
    detail::SurfaceMender mender(sphere.surface, unitFrame(), 0.5);
    std::vector<detail::PlaceBeyond> places;
    for (std::uint32_t t = 0; t < sphere.surface.triangles.size(); ++t) {
        const auto& [a, b, c] = sphere.surface.triangles[t];
        const auto& points = sphere.surface.points;
        const Vec3 middle = (1.0 / 3) * (points[a] + points[b] + points[c]);
        if (norm(middle - place) < 2) places.push_back({middle, 1.02 * middle, t, false});
    }
    ASSERT_GT(mender.mendDistances(places), 3U);
    const std::size_t mended = sphere.surface.points.size();
    ASSERT_GT(mended, sphere.coarse.points.size());
    ASSERT_TRUE(sphere.undo().around(mender.changedTriangles(), {{place, place}}, 1));
    const TriangleMesh mesh = meshOf(sphere.surface);
    expectSound(mesh);
    // all of it hung together, and every vertex is one of the rounds' again
    std::set<Place> known;
    for (const SurfaceState* state : {&sphere.start, &sphere.coarse}) {
        for (const Vec3& p : state->points) known.insert({p.x, p.y, p.z});
    }
    for (const Vec3& p : mesh.points) EXPECT_TRUE(known.contains({p.x, p.y, p.z}));
}

// Again and again, also where it did so before.
TEST(LocalUndo, LeavesASoundSurfaceWhereverItIsUsed) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> reach(0.3, 1.5);
    CoarseSphere sphere;
    int undone = 0;
    for (int n = 0; n < 60; ++n) {
        const Vec3 place = kRadius * normalized(randomPoint(random));
        undone += sphere.undoAround(place, reach(random)) ? 1 : 0;
        expectSound(meshOf(sphere.surface));
    }
    EXPECT_GT(undone, 20);
    EXPECT_LE(sphere.surface.triangles.size(), sphere.start.triangles.size());
}

}  // namespace adaptiso::testing
