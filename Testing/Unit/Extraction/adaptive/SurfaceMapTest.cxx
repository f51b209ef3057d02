#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "Support/Meshes.h"
#include "Surfaces.h"
#include "adaptiso/SurfaceProof/SurfaceMap.h"

namespace adaptiso::testing {
namespace {

using Map = detail::SurfaceMap<VertexId>;
using Walkable = detail::WalkableSurface<VertexId>;

TriangleMesh ballMesh(double radiusMm, int subdivisions) {
    return icosphere(subdivisions, {}, radiusMm);
}

/// Everything that a map of one mesh to another has.
struct Mapped {
    Mapped(const TriangleMesh& fine, const TriangleMesh& coarse, double distanceMm)
        : from(fine), to(coarse), cover(coarse.triangles.size()) {
        source.assign(from.points, from.triangles);
        onto.assign(to.points, to.triangles);
        Map map(onto, 0.25 * distanceMm * distanceMm);
        for (const Vec3& p : from.points) vertices.push_back(map.vertexAt(p, nearest(p)));
        for (VertexId t = 0; t < std::ssize(from.triangles); ++t) {
            isMapped.push_back(mapOne(map, t, distanceMm * distanceMm) ? 1 : 0);
        }
        const auto passes = [&](VertexId t) { cover.addBorder(static_cast<std::uint64_t>(t)); };
        for (VertexId h = 0; h < 3 * std::ssize(from.triangles); ++h) {
            const VertexId twin = source.twin(h);
            if (isMapped[h / 3] == 0 || (twin != Walkable::kNone && isMapped[twin / 3] != 0)) {
                continue;
            }
            const Map::Vertex &a = vertices[from.triangles[h / 3][h % 3]],
                              &b = vertices[from.triangles[h / 3][(h + 1) % 3]];
            passes(a.imageTriangle);
            if (a.imageTriangle != b.imageTriangle) map.forEachAlong(wayOf(map, h), passes);
        }
    }

    std::int64_t mapped() const { return std::count(isMapped.begin(), isMapped.end(), 1); }
    std::vector<VertexId> covered() const {
        std::vector<VertexId> result;
        for (VertexId t = 0; t < std::ssize(to.triangles); ++t) {
            if (cover.covers(static_cast<std::uint64_t>(t))) result.push_back(t);
        }
        return result;
    }

    TriangleMesh from, to;
    Walkable source, onto;
    detail::SharedCover cover;
    std::vector<Map::Vertex> vertices;
    std::vector<std::uint8_t> isMapped;

private:
    VertexId nearest(const Vec3& p) const {
        VertexId best = 0;
        for (VertexId t = 0; t < std::ssize(to.triangles); ++t) {
            if (detail::squaredDistanceToTriangle(p, onto.cornersOf(t)) <
                detail::squaredDistanceToTriangle(p, onto.cornersOf(best))) {
                best = t;
            }
        }
        return best;
    }
    /// Of the edge of a half-edge, always in the same direction.
    Map::Way wayOf(Map& map, VertexId halfEdge) const {
        const VertexId h = std::min(halfEdge, source.twin(halfEdge));
        return map.wayAlong(vertices[from.triangles[h / 3][h % 3]],
                            vertices[from.triangles[h / 3][(h + 1) % 3]]);
    }
    bool mapOne(Map& map, VertexId t, double squaredDistance) {
        std::array<const Map::Vertex*, 3> corners{};
        std::array<Map::Way, 3> ways;
        std::array<Map::Side, 3> sides{};
        for (int i = 0; i < 3; ++i) corners[i] = &vertices[from.triangles[t][i]];
        for (int i = 0; i < 3; ++i) {
            const VertexId h = 3 * t + i;
            sides[i] = {nullptr, h < source.twin(h)};
            if (corners[i]->imageTriangle == corners[(i + 1) % 3]->imageTriangle) continue;
            ways[i] = wayOf(map, h);
            sides[i].way = &ways[i];
        }
        if (!map.map(corners, sides, squaredDistance)) return false;
        for (const Map::Part& part : map.parts()) {
            cover.add(static_cast<std::uint64_t>(part.triangle),
                      detail::shareOf(part.area2, onto.cornersOf(part.triangle)));
        }
        return true;
    }
};

Vec3 pointOn(const TriangleMesh& mesh, VertexId t, std::mt19937& random) {
    std::uniform_real_distribution<double> part(0, 1);
    double u = part(random), v = part(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto& [a, b, c] = mesh.triangles[t];
    return (1 - u - v) * mesh.points[a] + u * mesh.points[b] + v * mesh.points[c];
}

/// What the map says holds at points of both surfaces, by a look at all triangles.
void expectSound(const Mapped& mapped, double distanceMm) {
    std::mt19937 random(7);
    const double most = distanceMm * (1 + 1e-9);
    for (VertexId t = 0; t < std::ssize(mapped.from.triangles); ++t) {
        if (mapped.isMapped[t] == 0) continue;
        ASSERT_LE(distanceTo(mapped.to, pointOn(mapped.from, t, random)), most) << t;
    }
    for (const VertexId t : mapped.covered()) {
        for (int n = 0; n < 8; ++n) {
            ASSERT_LE(distanceTo(mapped.from, pointOn(mapped.to, t, random)), most) << t;
        }
    }
}

}  // namespace

TEST(NearestOnSegments, FindsNoPairThatIsFartherThanThoseTried) {
    std::mt19937 random(3);
    for (int n = 0; n < 500; ++n) {
        const Vec3 p = randomPoint(random), q = randomPoint(random), r = randomPoint(random),
                   s = n % 10 == 0 ? r : randomPoint(random);
        const detail::SegmentPair pair = detail::nearestOnSegments(p, q, r, s);
        for (int i = 0; i <= 20; ++i) {
            for (int k = 0; k <= 20; ++k) {
                const Vec3 on = p + i / 20.0 * (q - p), other = r + k / 20.0 * (s - r);
                ASSERT_LE(pair.squaredDistance(), squaredNorm(on - other) + 1e-12) << n;
            }
        }
    }
}

TEST(SurfaceMap, CoversACoarseBallByAFineOne) {
    const TriangleMesh fine = ballMesh(10, 4), coarse = ballMesh(10, 2);
    // the chord of a triangle of the coarse one lies 0.25 below the ball
    const Mapped mapped(fine, coarse, 0.4);
    EXPECT_EQ(mapped.mapped(), std::ssize(fine.triangles));
    EXPECT_EQ(mapped.covered().size(), coarse.triangles.size());
    expectSound(mapped, 0.4);
}

TEST(SurfaceMap, MapsNothingFartherThanTheDistance) {
    const TriangleMesh fine = ballMesh(10.5, 3), coarse = ballMesh(10, 3);
    const Mapped near(fine, coarse, 0.51);
    EXPECT_EQ(near.covered().size(), coarse.triangles.size());
    const Mapped far(fine, coarse, 0.49);
    EXPECT_EQ(far.mapped(), 0);
    EXPECT_TRUE(far.covered().empty());
}

// What is missing of the fine surface is no image of it; all else still is.
TEST(SurfaceMap, CoversNothingAtAHole) {
    TriangleMesh fine = ballMesh(10, 3);
    const TriangleMesh coarse = fine;
    const std::array<VertexId, 3> gone = fine.triangles.front();
    fine.triangles.erase(fine.triangles.begin());
    const Mapped mapped(fine, coarse, 0.1);
    EXPECT_FALSE(mapped.cover.covers(0));
    for (VertexId t = 1; t < std::ssize(coarse.triangles); ++t) {
        const auto& v = coarse.triangles[t];
        const bool isBeside = std::any_of(v.begin(), v.end(), [&](VertexId corner) {
            return std::find(gone.begin(), gone.end(), corner) != gone.end();
        });
        EXPECT_TRUE(isBeside || mapped.cover.covers(t)) << t;
    }
}

// Two sheets over one half of a triangle have its area, but not its points.
TEST(SurfaceMap, DoesNotTakeTwoSheetsForAWhole) {
    TriangleMesh coarse, half;
    coarse.points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    half.points = {{0, 0, 0.1}, {2, 2, 0.1}, {0, 4, 0.1}};
    coarse.triangles = half.triangles = {{0, 1, 2}};
    const Mapped mapped(merged({half, translated(half, {0, 0, 0.1})}), coarse, 0.3);
    EXPECT_EQ(mapped.mapped(), 2);
    EXPECT_FALSE(mapped.cover.covers(0));
}

// A spike that nothing of the fine surface lies near, although each of its vertices does.
TEST(SurfaceMap, DoesNotCoverASpike) {
    const TriangleMesh fine = ballMesh(10, 3);
    TriangleMesh coarse = ballMesh(10, 1);
    coarse.points[0] = 1.5 * coarse.points[0];
    const Mapped mapped(fine, coarse, 1.2);
    expectSound(mapped, 1.2);
    EXPECT_FALSE(mapped.covered().empty());
    for (VertexId t = 0; t < std::ssize(coarse.triangles); ++t) {
        const auto& v = coarse.triangles[t];
        if (std::find(v.begin(), v.end(), 0) != v.end()) {
            EXPECT_FALSE(mapped.cover.covers(t));
        }
    }
}

// Vertices of both balls are moved by chance, up to folds: whatever is said is so.
TEST(SurfaceMap, SaysNothingWrongOfRandomSurfaces) {
    std::mt19937 random(11);
    std::int64_t mapped = 0, covered = 0, all = 0, allCoarse = 0;
    for (int n = 0; n < 24; ++n) {
        TriangleMesh fine = ballMesh(4, 2 + n % 2), coarse = ballMesh(4, 1 + n % 3);
        const double noise = 0.05 * (1 + n % 8);
        for (Vec3& p : fine.points) p = p + randomPoint(random, noise);
        for (Vec3& p : coarse.points) p = p + randomPoint(random, 2 * noise);
        const double distanceMm = 0.2 + 0.1 * (n % 5);
        const Mapped one(fine, coarse, distanceMm);
        expectSound(one, distanceMm);
        mapped += one.mapped();
        covered += std::ssize(one.covered());
        all += std::ssize(fine.triangles);
        allCoarse += std::ssize(coarse.triangles);
    }
    EXPECT_GT(mapped, all / 4);
    EXPECT_LT(mapped, all);
    EXPECT_GT(covered, allCoarse / 10);
    EXPECT_LT(covered, allCoarse);
}

}  // namespace adaptiso::testing
