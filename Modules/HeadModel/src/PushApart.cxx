#include "PushApart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kPushGrain = 256;
constexpr double kOvershoot = 1.02;  // moves aim at it; most of what is over may be lacking
constexpr double kLackMet = 0.018;   // of the gap
constexpr double kFade = 0.75;       // of a movement, from a vertex to its neighbours at least
constexpr int kFadeRings = 12;       // 0.75^12 = 3 %
constexpr double kNoMove = 0.01;     // of the gap: movements below are none

std::vector<std::vector<VertexId>> neighboursOf(const TriangleMesh& mesh) {
    std::vector<std::vector<VertexId>> neighbours(mesh.points.size());
    for (const Triangle& t : mesh.triangles) {  // closed: each edge runs once each way
        for (int side = 0; side < 3; ++side) neighbours[t[side]].push_back(t[(side + 1) % 3]);
    }
    return neighbours;
}

/// Unit normals of vertices, outward or inward.
std::vector<Vec3> normalsTowards(const TriangleMesh& mesh, bool isOutward) {
    std::vector<Vec3> normals(mesh.points.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 area2 = areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
        for (const VertexId v : t) normals[v] += area2;
    }
    for (Vec3& n : normals) n = isOutward ? normalized(n) : -normalized(n);
    return normals;
}

/// A surface prepared for searches of distance and side.
struct SearchedSurface {
    explicit SearchedSurface(const TriangleMesh& surface)
        : mesh(surface), tree(surface), inside(mesh, tree) {}
    SearchedSurface(const SearchedSurface&) = delete;  // `inside` refers to `tree`
    SearchedSurface(SearchedSurface&&) = delete;
    SearchedSurface& operator=(const SearchedSurface&) = delete;
    SearchedSurface& operator=(SearchedSurface&&) = delete;
    ~SearchedSurface() = default;

    const TriangleMesh& mesh;
    AabbTree tree;
    InsideTest inside;
};

/// How far a point lacks of lying on a side of a surface at a distance.
struct Lack {
    double mm = 0;   ///< <= 0: none
    Vec3 direction;  ///< unit vector: the shortest way there
    ClosestPoint nearest;
};

Lack lackOf(const Vec3& p, const SearchedSurface& surface, Side wanted, double gapMm) {
    Lack lack;
    lack.nearest = surface.tree.closestPoint(p);
    const double distance = std::sqrt(lack.nearest.squaredDistanceMm2);
    const Side side = surface.inside.sideOf(p);
    const bool isRight = side == wanted;
    lack.mm = isRight ? gapMm - distance : gapMm + distance;
    if (lack.mm <= 0) return lack;
    const Vec3 away = p - lack.nearest.pointMm;
    // Next to the surface the way there is lost in rounding: its normal says it.
    if (distance > 1e-6 * gapMm && side != Side::On) {
        lack.direction = isRight ? normalized(away) : -normalized(away);
    } else {
        const auto [a, b, c] = cornersOf(surface.mesh, lack.nearest.triangle);
        const Vec3 outward = normalized(areaVector2(a, b, c));
        lack.direction = wanted == Side::Outside ? outward : -outward;
    }
    return lack;
}

/// Way that each vertex of the moving surface still has to go, as far as is known.
class Needs {
public:
    explicit Needs(std::size_t vertices) : mm_(vertices), direction_(vertices) {}

    void add(VertexId v, double mm, const Vec3& direction) {
        if (!(mm > 0)) return;
        direction_[v] += mm * direction;
        mm_[v] = std::max(mm_[v], mm);
    }
    double largestMm() const { return *std::max_element(mm_.begin(), mm_.end()); }
    const std::vector<double>& mm() const { return mm_; }
    const std::vector<Vec3>& directions() const { return direction_; }

private:
    std::vector<double> mm_;
    std::vector<Vec3> direction_;
};

/// Adds needs of the moving surface's vertices: on the wrong side, or too near.
void addOwnVertices(const TriangleMesh& moving, const SearchedSurface& fixed,
                    const PushOptions& options, Needs& needs) {
    const Side wanted = options.isOutward ? Side::Outside : Side::Inside;
    std::vector<Lack> lacks(moving.points.size());
    parallelForPieces(std::ssize(lacks), kPushGrain, [&](std::int64_t begin, std::int64_t end) {
        for (VertexId v = begin; v < end; ++v) {
            lacks[v] = lackOf(moving.points[v], fixed, wanted, options.minGapMm);
        }
    });
    for (VertexId v = 0; v < std::ssize(lacks); ++v) {
        needs.add(v, lacks[v].mm, lacks[v].direction);
    }
}

/// Adds needs from the other surface's vertices: those that poke through a triangle move it.
void addOtherVertices(const SearchedSurface& moving, const TriangleMesh& fixed,
                      const PushOptions& options, Needs& needs) {
    const Side wanted = options.isOutward ? Side::Inside : Side::Outside;
    std::vector<Lack> lacks(fixed.points.size());
    parallelForPieces(std::ssize(lacks), kPushGrain, [&](std::int64_t begin, std::int64_t end) {
        for (VertexId v = begin; v < end; ++v) {
            lacks[v] = lackOf(fixed.points[v], moving, wanted, options.minGapMm);
        }
    });
    for (const Lack& lack : lacks) {
        if (lack.mm <= 0) continue;
        for (const VertexId v : moving.mesh.triangles[lack.nearest.triangle]) {
            needs.add(v, lack.mm, -lack.direction);
        }
    }
}

/// Adds needs from pairs of triangles too near between vertices. Pairs that meet part along the
/// moving triangle's normal.
void addTriangles(const SearchedSurface& moving, const SearchedSurface& fixed,
                  const PushOptions& options, Needs& needs) {
    struct Pair {
        std::int64_t triangle;
        double mm;
        Vec3 direction;
    };
    const double gap = options.minGapMm, sign = options.isOutward ? 1 : -1;
    const std::int64_t count = std::ssize(moving.mesh.triangles);
    std::vector<std::vector<Pair>> ofPiece((count + kPushGrain - 1) / kPushGrain);
    parallelForPieces(count, kPushGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            const std::array<Vec3, 3> own = cornersOf(moving.mesh, t);
            BoundingBox box = moving.tree.triangleBox(t);
            box.minimum += Vec3{-gap, -gap, -gap};
            box.maximum += Vec3{gap, gap, gap};
            fixed.tree.forEachOverlap(box, [&](std::int64_t other) {
                const NearestPoints near = triangleDistance(own, cornersOf(fixed.mesh, other));
                if (near.distanceMm >= gap) return;
                const Vec3 outward = sign * normalized(areaVector2(own[0], own[1], own[2]));
                Vec3 direction = normalized(near.pointA - near.pointB);
                // On the wrong side, the nearest points draw it further in.
                if (dot(direction, outward) <= 0) direction = outward;
                ofPiece[begin / kPushGrain].push_back({t, gap - near.distanceMm, direction});
            });
        }
    });
    for (const std::vector<Pair>& pairs : ofPiece) {
        for (const Pair& pair : pairs) {
            for (const VertexId v : moving.mesh.triangles[pair.triangle]) {
                needs.add(v, pair.mm, pair.direction);
            }
        }
    }
}

Needs findNeeds(const TriangleMesh& moving, const SearchedSurface& fixed,
                const PushOptions& options) {
    const SearchedSurface searched(moving);
    Needs needs(moving.points.size());
    addOwnVertices(moving, fixed, options, needs);
    addOtherVertices(searched, fixed.mesh, options, needs);
    addTriangles(searched, fixed, options, needs);
    return needs;
}

/// Movement that meets the needs and fades out around them.
/// \param towards  the surface's own unit normals, to the side that it is to move to
/// \param leastMm  movements below it that nothing needs are none
std::vector<Vec3> smoothMovement(const Needs& needs, const std::vector<Vec3>& towards,
                                 const std::vector<std::vector<VertexId>>& neighbours,
                                 double leastMm) {
    const std::vector<double>& needed = needs.mm();
    const std::int64_t count = std::ssize(needed);
    std::vector<double> mm = needed;
    std::vector<Vec3> direction(needed.size());
    for (VertexId v = 0; v < count; ++v)
        direction[v] = needed[v] * normalized(needs.directions()[v]);
    const std::vector<Vec3> own = direction;
    for (int ring = 0; ring < kFadeRings; ++ring) {
        std::vector<double> nextMm = mm;
        std::vector<Vec3> nextDirection = direction;
        for (VertexId v = 0; v < count; ++v) {
            double sum = 0;
            Vec3 sumDirection;
            for (const VertexId w : neighbours[v]) {
                sum += mm[w];
                sumDirection += direction[w];
            }
            const double share = kFade / static_cast<double>(neighbours[v].size());
            nextMm[v] = std::max(needed[v], share * sum);
            nextDirection[v] = own[v] + share * sumDirection;
        }
        mm = std::move(nextMm);
        direction = std::move(nextDirection);
    }
    std::vector<Vec3> movement(needed.size());
    for (VertexId v = 0; v < count; ++v) {
        Vec3 way = normalized(direction[v]);
        // Ways that cancel, or lead back in: the surface's own normal
        if (dot(way, towards[v]) < 0.2) way = normalized(way + 2 * towards[v]);
        if (needed[v] > 0 || mm[v] > leastMm) movement[v] = mm[v] * way;
    }
    return movement;
}

/// Smooths the whole movement so far around triangles that cross each other: the surface did not
/// cross itself when it started, so movements that differ little from vertex to vertex undo it.
void smoothWhereCrossing(const SelfIntersections& crossings, const TriangleMesh& mesh,
                         const std::vector<std::vector<VertexId>>& neighbours,
                         std::vector<Vec3>& moved) {
    std::vector<bool> isNear(moved.size());
    for (const TrianglePair& pair : crossings.pairs) {
        for (const std::int64_t t : pair) {
            for (const VertexId v : mesh.triangles[t]) {
                isNear[v] = true;
                for (const VertexId w : neighbours[v]) isNear[w] = true;
            }
        }
    }
    const std::vector<Vec3> before = moved;
    for (std::size_t v = 0; v < moved.size(); ++v) {
        if (!isNear[v]) continue;
        Vec3 sum = before[v];
        for (const VertexId w : neighbours[v]) sum += before[w];
        moved[v] = 1 / static_cast<double>(neighbours[v].size() + 1) * sum;
    }
}

std::string inMm(double value) {
    std::ostringstream text;
    text.precision(3);
    text << value << " mm";
    return text.str();
}

}  // namespace

std::optional<Finding> pushApart(TriangleMesh& surface, const TriangleMesh& fixed,
                                 const PushOptions& options) {
    constexpr int kMaxRounds = 100;
    const std::vector<Vec3> start = surface.points;
    const auto neighbours = neighboursOf(surface);
    const SearchedSurface other(fixed);
    PushOptions wanted = options;
    wanted.minGapMm *= kOvershoot;
    std::vector<Vec3> moved(start.size());
    VertexId neediest = 0;
    SelfIntersections crossings;
    for (int round = 0; round < kMaxRounds; ++round) {
        const Needs needs = findNeeds(surface, other, wanted);
        crossings = findSelfIntersections(surface);
        if (needs.largestMm() <= kLackMet * options.minGapMm && crossings.isClear()) {
            return std::nullopt;
        }
        smoothWhereCrossing(crossings, surface, neighbours, moved);
        const std::vector<Vec3> movement =
            smoothMovement(needs, normalsTowards(surface, options.isOutward), neighbours,
                           kNoMove * options.minGapMm);
        for (VertexId v = 0; v < std::ssize(moved); ++v) {
            moved[v] += movement[v];
            surface.points[v] = start[v] + moved[v];
            if (needs.mm()[v] > needs.mm()[neediest]) neediest = v;
            if (norm(moved[v]) <= options.maxMoveMm) continue;
            return Finding{"a vertex would have to move by " + inMm(norm(moved[v])) +
                               " or more to lie " + inMm(options.minGapMm) +
                               (options.isOutward ? " outside" : " inside") +
                               " the next surface; the limit is " + inMm(options.maxMoveMm),
                           start[v]};
        }
    }
    if (!crossings.pairs.empty()) {
        return Finding{"it crosses itself when moved " + inMm(options.minGapMm) +
                           " away from the next surface",
                       surface.points[surface.triangles[crossings.pairs[0][0]][0]]};
    }
    return Finding{"a distance of " + inMm(options.minGapMm) + " to the next surface can't be had",
                   start[neediest]};
}

}  // namespace adaptiso
