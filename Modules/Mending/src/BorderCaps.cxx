#include "BorderCaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "PlanarFiller.h"
#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/PolygonTriangulation.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso::detail {
namespace {

constexpr std::size_t kMostOfRing = 4096;
constexpr double kSlackOfRagged = 3;  ///< of a ring's mean edge

/// Edges, by their ends ascending.
std::uint64_t endsKey(VertexId a, VertexId b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
           static_cast<std::uint64_t>(std::max(a, b));
}

/// Three places in a ring.
using Places = std::array<std::size_t, 3>;

/// The triangulation of a ring of the least area in space [Barequet1995], of triangles with an area
/// and edges that are not in the mesh. Empty if no such triangulation exists.
/// \param isTaken   whether an edge between two points is the mesh's
/// \param isBarred  whether a triangle is not to be taken, by places in the ring, ascending
template <class IsTaken, class IsBarred>
std::vector<Places> leastArea(const std::vector<Vec3>& points, const std::vector<VertexId>& ring,
                              const IsTaken& isTaken, const IsBarred& isBarred) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const std::size_t size = ring.size();
    std::vector<double> least(size * size);  // of the part from i to j, i < j
    std::vector<std::size_t> apex(size * size);
    for (std::size_t length = 2; length < size; ++length) {
        for (std::size_t i = 0; i + length < size; ++i) {
            const std::size_t j = i + length;
            double& best = least[i * size + j];
            best = kNone;
            const bool isSide = length + 1 == size;  // of the ring itself
            if (!isSide && isTaken(ring[i], ring[j])) continue;
            for (std::size_t k = i + 1; k < j; ++k) {
                const double parts = least[i * size + k] + least[k * size + j];
                if (!(parts < best) || isBarred(i, k, j)) continue;
                const Corners c{points[ring[i]], points[ring[k]], points[ring[j]]};
                const double area = 0.5 * norm(areaVector2(c[0], c[1], c[2]));
                const double longest = std::max(
                    {squaredNorm(c[1] - c[0]), squaredNorm(c[2] - c[1]), squaredNorm(c[0] - c[2])});
                constexpr double kFlat = 1e-6;  // of the longest side
                if (area <= kFlat * longest || parts + area >= best) continue;
                best = parts + area;
                apex[i * size + j] = k;
            }
        }
    }
    if (!(least[size - 1] < kNone)) return {};
    std::vector<Places> triangles;
    std::vector<std::array<std::size_t, 2>> left{{0, size - 1}};
    while (!left.empty()) {
        const auto [i, j] = left.back();
        left.pop_back();
        if (j < i + 2) continue;
        const std::size_t k = apex[i * size + j];
        triangles.push_back({i, k, j});
        left.push_back({i, k});
        left.push_back({k, j});
    }
    return triangles;
}

/// The plane across a ring's mean normal: the ring runs counter-clockwise in it.
struct RingPlane {
    Vec3 origin, normal, u, v;  ///< of length 1; the normal 0 where the ring has none
    double area2 = 0;

    RingPlane(const std::vector<Vec3>& points, const std::vector<VertexId>& ring)
        : origin(points[ring[0]]) {
        for (std::size_t n = 0; n < ring.size(); ++n) {
            normal += cross(points[ring[n]] - origin, points[ring[(n + 1) % ring.size()]] - origin);
        }
        area2 = norm(normal);
        normal = normalized(normal);
        Vec3 along;
        along[std::abs(normal.x) < 0.6 ? 0 : 1] = 1;
        u = normalized(cross(along, normal));
        v = cross(normal, u);
    }

    Point2 operator()(const Vec3& p) const { return {dot(u, p - origin), dot(v, p - origin)}; }

    /// All points of a ring lie in it, but for `farthestMm`.
    template <class Ring>
    bool contains(const std::vector<Vec3>& points, const Ring& ring, double farthestMm) const {
        return std::ranges::all_of(ring, [&](VertexId p) {
            return std::abs(dot(normal, points[p] - origin)) <= farthestMm;
        });
    }

    double roundingMm() const {
        constexpr double kRounding = 1e-5;  // of the own ring's width
        return kRounding * std::sqrt(area2);
    }
};

/// A ring seen along its mean normal, counter-clockwise. Empty where it has none.
std::vector<Point2> seenFlat(const std::vector<Vec3>& points, const std::vector<VertexId>& ring) {
    const RingPlane plane(points, ring);
    if (plane.normal == Vec3{}) return {};
    std::vector<Point2> flat;
    flat.reserve(ring.size());
    for (const VertexId p : ring) flat.push_back(plane(points[p]));
    return flat;
}

using EdgeSet = std::unordered_set<std::uint64_t>;  ///< by endsKey()

/// Turns edges within a plane cap that the mesh has already. \return false where one is left
bool turnTaken(const std::vector<Vec3>& points, const Vec3& normal, const EdgeSet& taken,
               std::vector<Triangle>& triangles) {
    constexpr int kMostRounds = 8;
    for (int round = 0; round < kMostRounds; ++round) {
        bool isLeft = false;
        std::unordered_map<std::uint64_t, std::size_t> first;
        std::vector<std::uint8_t> isChanged(triangles.size());
        for (std::size_t n = 0; n < triangles.size(); ++n) {
            for (std::size_t i = 0; i < 3 && isChanged[n] == 0; ++i) {
                const VertexId a = triangles[n][i], b = triangles[n][(i + 1) % 3],
                               c = triangles[n][(i + 2) % 3];
                const auto [before, isFirst] = first.try_emplace(endsKey(a, b), n);
                if (isFirst || !taken.contains(endsKey(a, b))) continue;
                isLeft = true;
                Triangle& other = triangles[before->second];
                if (isChanged[before->second] != 0) continue;
                VertexId d = other[0];
                for (const VertexId v : other) {
                    if (v != a && v != b) d = v;
                }
                const Triangle one{a, d, c}, two{d, b, c};
                const auto isUp = [&](const Triangle& t) {
                    constexpr double kFlat = 1e-9;
                    const Corners corners{points[t[0]], points[t[1]], points[t[2]]};
                    return dot(normal, areaVector2(corners[0], corners[1], corners[2])) >
                           kFlat * squaredNorm(boxOf(corners).size());
                };
                if (taken.contains(endsKey(c, d)) || !isUp(one) || !isUp(two)) continue;
                triangles[n] = one;
                other = two;
                isChanged[n] = isChanged[before->second] = 1;
            }
        }
        if (!isLeft) return true;
    }
    return false;
}

/// The mean length of a ring's edges.
double meanEdgeMm(const std::vector<Vec3>& points, const std::vector<VertexId>& ring) {
    double lengthMm = 0;
    for (std::size_t n = 0; n < ring.size(); ++n) {
        lengthMm += norm(points[ring[(n + 1) % ring.size()]] - points[ring[n]]);
    }
    return lengthMm / static_cast<double>(ring.size());
}

/// Edges of the mesh, and those of a cap that is being made.
struct TakenEdges {
    const EdgeSet& ofMesh;
    EdgeSet own{};

    bool contains(VertexId a, VertexId b) const {
        return ofMesh.contains(endsKey(a, b)) || own.contains(endsKey(a, b));
    }
};

/// Closes rings by the least area of triangles that cross no other.
class ClearCaps {
public:
    explicit ClearCaps(const TriangleMesh& mesh) : mesh_(mesh), tree_(mesh) {}

    static constexpr std::size_t kMost = 256;  ///< of a ring; time grows with the third power

    /// Empty where some rounds lead to none, or those of all rings take too long.
    std::vector<Triangle> close(const std::vector<VertexId>& ring, const EdgeSet& taken) {
        return ring.size() > kMost ? std::vector<Triangle>()
                                   : closeBut(0, ring, {taken}, stepsLeft_);
    }

    /// Closes rings of about one plane, the first round the others: a cut from which whole
    /// triangles were taken. Dents of the rims are filled first.
    ///
    /// \param normal  outward, of the plane
    /// \return  empty as close()
    std::vector<Triangle> closeRims(std::vector<std::vector<VertexId>> rims, const Vec3& normal,
                                    const EdgeSet& ofMesh) {
        constexpr std::size_t kMostOfRims = 512;
        constexpr double kMostLeft = 0.25;
        const auto sizeOfAll = [&] {
            std::size_t size = 2 * (rims.size() - 1);
            for (const auto& rim : rims) size += rim.size();
            return size;
        };
        if (sizeOfAll() > 4 * kMostOfRims) return {};
        const std::size_t before = closed_.size();
        TakenEdges taken{ofMesh};
        std::vector<Triangle> triangles, rest;
        for (auto& rim : rims) fillDents(rim, normal, taken, triangles);
        if (sizeOfAll() <= kMostOfRims) {
            const std::vector<VertexId> ring = bridged(rims, taken);
            rest = closeBut(kMostLeft, ring, taken, raggedStepsLeft_);
        }
        if (rest.empty()) {
            closed_.resize(before);
            return {};
        }
        triangles.insert(triangles.end(), rest.begin(), rest.end());
        return triangles;
    }

private:
    /// \param mostLeft  the part of the triangles that may cross something, and are left out
    /// \return  empty where some rounds lead to no more, or those of all rings take too long
    std::vector<Triangle> closeBut(double mostLeft, const std::vector<VertexId>& ring,
                                   const TakenEdges& taken, std::int64_t& stepsLeft) {
        constexpr int kMostRounds = 32;
        const std::size_t size = ring.size();
        if (size < 3) return {};
        std::vector<Triangle> best;
        std::vector<bool> isBarred(size * size * size);  // by places in the ring, ascending
        const auto numberOf = [&](std::size_t i, std::size_t k, std::size_t j) {
            return (i * size + k) * size + j;
        };
        for (int round = 0; round < kMostRounds; ++round) {
            stepsLeft -= static_cast<std::int64_t>(size * size * size / 6);
            if (stepsLeft < 0) break;
            const std::vector<Places> places = leastArea(
                mesh_.points, ring, [&](VertexId a, VertexId b) { return taken.contains(a, b); },
                [&](std::size_t i, std::size_t k, std::size_t j) {
                    return isBarred[numberOf(i, k, j)];
                });
            std::unordered_map<std::uint64_t, int> uses;  // of edges: a ring may pass a point twice
            std::vector<Triangle> triangles;
            for (const auto& [i, k, j] : places) {
                const Triangle t{ring[i], ring[k], ring[j]};
                bool isDoubled = false;
                for (std::size_t n = 0; n < 3; ++n) {
                    isDoubled = ++uses[endsKey(t[n], t[(n + 1) % 3])] > 2 || isDoubled;
                }
                if (isDoubled || crosses(t)) {
                    isBarred[numberOf(i, k, j)] = true;
                } else {
                    triangles.push_back(t);
                }
            }
            if (places.empty()) break;
            if (triangles.size() > best.size()) best = triangles;
            if (triangles.size() == places.size()) break;
        }
        if (static_cast<double>(best.size()) < (1 - mostLeft) * static_cast<double>(size - 2)) {
            return {};
        }
        keep(best);
        return best;
    }

    void keep(const std::vector<Triangle>& triangles) {
        for (const Triangle& t : triangles) {
            closed_.push_back({mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]});
        }
    }

    /// Cuts corners off a rim that lie below the line between those beside them.
    void fillDents(std::vector<VertexId>& rim, const Vec3& normal, TakenEdges& taken,
                   std::vector<Triangle>& triangles) {
        constexpr double kFarthest = 3, kDepth = 0.05;  // of the mean edge
        const double edgeMm = meanEdgeMm(mesh_.points, rim);
        const auto isDent = [&](const Triangle& t) {
            const Vec3 &a = mesh_.points[t[0]], &b = mesh_.points[t[1]], &c = mesh_.points[t[2]];
            const double lengthMm = norm(c - a);
            if (!(lengthMm > 0) || lengthMm > kFarthest * edgeMm) return false;
            const double along = std::clamp(dot(b - a, c - a) / (lengthMm * lengthMm), 0.0, 1.0);
            return dot(normal, a + along * (c - a) - b) > kDepth * edgeMm &&
                   !taken.contains(t[0], t[2]) && !isDegenerate(mesh_, t) && !crosses(t);
        };
        for (bool isFilled = true; isFilled && rim.size() > 3;) {
            isFilled = false;
            for (std::size_t n = 0; n < rim.size() && rim.size() > 3; ++n) {
                const std::size_t next = (n + 1) % rim.size();
                const Triangle t{rim[n], rim[next], rim[(n + 2) % rim.size()]};
                if (!isDent(t)) continue;
                triangles.push_back(t);
                keep({t});
                taken.own.insert(endsKey(t[0], t[2]));
                rim.erase(rim.begin() + static_cast<std::ptrdiff_t>(next));
                isFilled = true;
            }
        }
    }

    /// Joins rims to one ring: at each step the rim nearest to it, by an edge there and back. Empty
    /// if every such edge is taken.
    ///
    /// \param taken  gets these edges
    std::vector<VertexId> bridged(const std::vector<std::vector<VertexId>>& rims,
                                  TakenEdges& taken) const {
        std::vector<VertexId> ring = rims.front();
        std::vector<std::uint8_t> isJoined(rims.size());
        for (std::size_t joined = 1; joined < rims.size(); ++joined) {
            double least = std::numeric_limits<double>::infinity();
            std::size_t rim = 0, from = 0, to = 0;
            for (std::size_t r = 1; r < rims.size(); ++r) {
                if (isJoined[r] != 0) continue;
                for (std::size_t i = 0; i < ring.size(); ++i) {
                    for (std::size_t k = 0; k < rims[r].size(); ++k) {
                        const double squared =
                            squaredNorm(mesh_.points[ring[i]] - mesh_.points[rims[r][k]]);
                        if (squared >= least || ring[i] == rims[r][k] ||
                            taken.contains(ring[i], rims[r][k])) {
                            continue;
                        }
                        least = squared;
                        rim = r;
                        from = i;
                        to = k;
                    }
                }
            }
            if (rim == 0) return {};
            isJoined[rim] = 1;
            const std::vector<VertexId>& other = rims[rim];
            taken.own.insert(endsKey(ring[from], other[to]));
            std::vector<VertexId> way(other.begin() + static_cast<std::ptrdiff_t>(to), other.end());
            way.insert(way.end(), other.begin(),
                       other.begin() + static_cast<std::ptrdiff_t>(to) + 1);
            way.push_back(ring[from]);
            ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(from) + 1, way.begin(),
                        way.end());
        }
        return ring;
    }

    bool crosses(const Triangle& t) const {
        const Corners own{mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]};
        BoundingBox box = boxOf(own);
        const bool isCap = std::any_of(closed_.begin(), closed_.end(), [&](const Corners& cap) {
            return box.overlaps(boxOf(cap)) && trianglesCross(own, cap);
        });
        if (isCap) return true;
        bool isFound = false;
        tree_.forEachOverlap(box, [&](std::int64_t other) {
            if (!trianglesCross(own, cornersOf(mesh_, other))) return;
            isFound = true;
            box = BoundingBox::empty();  // ends the search
        });
        return isFound;
    }

    const TriangleMesh& mesh_;
    AabbTree tree_;  ///< of the triangles that were there first
    std::vector<Corners> closed_;
    std::int64_t stepsLeft_ = 500'000'000, raggedStepsLeft_ = 1'000'000'000;  ///< of all rounds
};

/// In the plane that fits best. Empty where the ring crosses itself in it, or an edge is the
/// mesh's.
std::vector<Triangle> flatCap(const TriangleMesh& mesh, const std::vector<VertexId>& ring,
                              const EdgeSet& taken) {
    std::vector<Triangle> triangles;
    for (const auto& [a, b, c] : triangulatePolygon(seenFlat(mesh.points, ring))) {
        triangles.push_back({ring[a], ring[b], ring[c]});
    }
    std::size_t sides = 0;  // of the ring, which the mesh has
    for (const auto& [a, b, c] : triangles) {
        for (const std::uint64_t key : {endsKey(a, b), endsKey(b, c), endsKey(c, a)}) {
            if (taken.contains(key)) ++sides;
        }
    }
    if (sides > ring.size()) return {};
    const auto haveArea = [&] {
        return std::none_of(triangles.begin(), triangles.end(),
                            [&](const Triangle& t) { return isDegenerate(mesh, t); });
    };
    if (haveArea()) return triangles;
    Vec3 normal;
    for (const auto& [a, b, c] : triangles) {
        normal += areaVector2(mesh.points[a], mesh.points[b], mesh.points[c]);
    }
    flipSlivers(mesh.points, normalized(normal), triangles);
    if (!haveArea()) triangles.clear();
    return triangles;
}

/// Rings in one plane, the one round the others first: a cut through a solid with cavities.
class RingGroups {
public:
    /// \param slack  how far points may lie off the plane, in mean edges of a ring; 0: by rounding
    RingGroups(const TriangleMesh& mesh, const std::vector<std::vector<VertexId>>& rings,
               double slack)
        : mesh_(mesh), points_(mesh.points), rings_(rings) {
        const std::vector<Vec3>& points = points_;
        for (const auto& ring : rings) {
            planes_.emplace_back(points, ring);
            boxes_.push_back({points[ring[0]], points[ring[0]]});
            for (const VertexId v : ring) boxes_.back().add(points[v]);
        }
        for (std::size_t n = 0; n < rings.size(); ++n) {
            slackMm_.push_back(
                std::max(planes_[n].roundingMm(), slack * meanEdgeMm(points, rings[n])));
            isFlat_.push_back(planes_[n].contains(points, rings[n], slackMm_[n]));
        }
    }

    /// A group of rims of one sheet that nowhere leads away from their plane: a side, such as a
    /// lampshade's, between two openings, and no cut.
    /// \param pieces  of the mesh's points \param ofPiece  the points of each
    bool isSide(const std::vector<std::size_t>& group, const ComponentLabels& pieces,
                const Buckets<VertexId>& ofPiece) const {
        const std::size_t outer = group.front();
        const std::int64_t piece = pieces.ofVertex[rings_[outer][0]];
        const bool isShared = std::any_of(group.begin() + 1, group.end(), [&](std::size_t inner) {
            return pieces.ofVertex[rings_[inner][0]] == piece;
        });
        if (!isShared) return false;
        const auto of = ofPiece.of(static_cast<std::size_t>(piece));
        return planes_[outer].contains(points_, of, 2 * slackMm_[outer]);
    }

    const RingPlane& planeOf(std::size_t ring) const { return planes_[ring]; }
    bool isFlat(std::size_t ring) const { return isFlat_[ring]; }

    /// The groups of two rings or more, by their numbers. What lies in a cavity's ring is another
    /// solid, with a group of its own.
    std::vector<std::vector<std::size_t>> groups() const {
        constexpr std::size_t kMostRings = 2000;  // all pairs are looked at
        if (rings_.size() > kMostRings) return {};
        std::vector<std::optional<std::size_t>> parents(rings_.size());
        for (std::size_t inner = 0; inner < rings_.size(); ++inner) {
            std::optional<std::size_t>& least = parents[inner];
            for (std::size_t outer = 0; isFlat_[inner] && outer < rings_.size(); ++outer) {
                if (!isFlat_[outer]) continue;
                if (least && planes_[outer].area2 >= planes_[*least].area2) continue;
                if (isWithin(inner, outer)) least = outer;
            }
        }
        const auto isCavity = [&](std::size_t ring) {
            bool isOdd = false;
            for (auto at = parents[ring]; at; at = parents[*at]) isOdd = !isOdd;
            return isOdd;
        };
        std::vector<std::vector<std::size_t>> groups;
        for (std::size_t outer = 0; outer < rings_.size(); ++outer) {
            if (isCavity(outer)) continue;
            std::vector<std::size_t> group{outer};
            for (std::size_t inner = 0; inner < rings_.size(); ++inner) {
                if (parents[inner] == outer) group.push_back(inner);
            }
            const bool areOpposite =
                std::all_of(group.begin() + 1, group.end(), [&](std::size_t inner) {
                    return dot(planes_[inner].normal, planes_[outer].normal) < 0;
                });
            if (group.size() > 1 && areOpposite) groups.push_back(std::move(group));
        }
        return groups;
    }

    /// Triangles between the first and the others. Empty where the rings bound no plane region, or
    /// an edge within it is the mesh's.
    std::vector<Triangle> between(const std::vector<std::size_t>& group,
                                  const EdgeSet& taken) const {
        const RingPlane& plane = planes_[group.front()];
        std::vector<Vec3> flat;  // as the first is seen
        std::vector<VertexId> numbers;
        std::unordered_map<VertexId, VertexId> placeOf;  // rings may meet
        std::vector<std::vector<VertexId>> loops;
        for (const std::size_t n : group) {
            loops.emplace_back();
            for (const VertexId v : rings_[n]) {
                const auto [place, isNew] = placeOf.try_emplace(v, std::ssize(flat));
                loops.back().push_back(place->second);
                if (!isNew) continue;
                const Point2 seen = plane(points_[v]);
                flat.push_back({seen[0], seen[1], 0});
                numbers.push_back(v);
            }
        }
        BoundingBox box{flat.front(), flat.front()};
        for (const Vec3& p : flat) box.add(p);
        const Vec3 &low = box.minimum, &high = box.maximum;
        PlanarFiller filler;
        const auto filled = filler.fill(flat, {low, {high.x, low.y, 0}, {low.x, high.y, 0}}, loops);
        if (!filled || filled->size() != 1) return {};
        std::vector<Triangle> triangles = filled->front().triangles;
        for (Triangle& t : triangles) {
            for (VertexId& v : t) v = numbers[static_cast<std::size_t>(v)];
        }
        const bool isSound = turnTaken(points_, plane.normal, taken, triangles) &&
                             std::ranges::none_of(triangles, [&](const Triangle& t) {
                                 return isDegenerate(mesh_, t);
                             });
        if (!isSound) triangles.clear();
        return triangles;
    }

private:
    bool overlaps(std::size_t outer, std::size_t inner) const {
        BoundingBox box = boxes_[outer];
        box.widen(slackMm_[outer]);
        return box.overlaps(boxes_[inner]);
    }

    /// The inner one lies in the plane of the outer one, and begins in it. \pre both are flat
    bool isWithin(std::size_t inner, std::size_t outer) const {
        constexpr double kParallel = 0.9;
        const RingPlane &own = planes_[inner], &plane = planes_[outer];
        if (own.area2 >= plane.area2 || std::abs(dot(own.normal, plane.normal)) < kParallel ||
            !overlaps(outer, inner) || !plane.contains(points_, rings_[inner], slackMm_[outer])) {
            return false;
        }
        // of an edge: a corner may be the outer one's
        const Point2 at = plane(0.5 * (points_[rings_[inner][0]] + points_[rings_[inner][1]]));
        const std::vector<VertexId>& ring = rings_[outer];
        bool isIn = false;
        Point2 before = plane(points_[ring.back()]);
        for (const VertexId v : ring) {
            const Point2 next = plane(points_[v]);
            const double along = (at[1] - before[1]) / (next[1] - before[1]);
            if ((before[1] > at[1]) != (next[1] > at[1]) &&
                at[0] < before[0] + along * (next[0] - before[0])) {
                isIn = !isIn;
            }
            before = next;
        }
        return isIn;
    }

    const TriangleMesh& mesh_;
    const std::vector<Vec3>& points_;
    const std::vector<std::vector<VertexId>>& rings_;
    std::vector<RingPlane> planes_;
    std::vector<BoundingBox> boxes_;
    std::vector<double> slackMm_;
    std::vector<bool> isFlat_;
};

/// Which way a border goes on where it meets itself.
class BorderTurns {
public:
    BorderTurns(const MendInput& input, const Buckets<VertexId>& next)
        : points_(input.mesh.points) {
        for (const Triangle& t : input.mesh.triangles) {
            for (const VertexId v : t) {
                if (next.of(v).size() < 2) continue;
                normals_[v] += areaVector2(points_[t[0]], points_[t[1]], points_[t[2]]);
            }
        }
    }

    /// The way with the narrowest hole between it and where the border came from, seen along the
    /// mean normal of the triangles there.
    std::size_t narrowest(VertexId from, VertexId at, const std::vector<VertexId>& ways) const {
        if (ways.size() < 2) return 0;
        const Vec3 normal = normalized(normals_.at(at)), back = points_[from] - points_[at];
        std::size_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t n = 0; n < ways.size(); ++n) {
            const Vec3 on = points_[ways[n]] - points_[at];
            const Vec3 u = on - dot(on, normal) * normal, v = back - dot(back, normal) * normal;
            double turn = std::atan2(dot(normal, cross(u, v)), dot(u, v));
            if (turn <= 0) turn += 2 * std::numbers::pi;
            if (turn < least) {
                least = turn;
                best = n;
            }
        }
        return best;
    }

private:
    const std::vector<Vec3>& points_;
    std::unordered_map<VertexId, Vec3> normals_;  ///< where a border meets itself
};

/// Marks more triangles of caps in which one is dropped. A cap that goes in parts loses the
/// triangles around it, or all of them if these are more than half. Any other cap loses all.
void widenWithinCaps(const MendInput& input, std::vector<std::uint8_t>& isDropped) {
    constexpr int kRounds = 2;  // over edges
    const std::int64_t first = input.firstCap();
    for (int round = 0; round < kRounds; ++round) {
        std::unordered_map<std::uint64_t, std::uint32_t> rims;  // edges, by their cap
        const auto forEachEdge = [&](std::size_t n, const auto& see) {
            const Triangle& t = input.mesh.triangles[first + static_cast<std::int64_t>(n)];
            for (std::size_t i = 0; i < 3; ++i) see(endsKey(t[i], t[(i + 1) % 3]));
        };
        for (std::size_t n = 0; n < isDropped.size(); ++n) {
            if (isDropped[n] == 0) continue;
            forEachEdge(n, [&](std::uint64_t key) { rims.emplace(key, input.capOf[n]); });
        }
        for (std::size_t n = 0; n < isDropped.size(); ++n) {
            forEachEdge(n, [&](std::uint64_t key) {
                const auto rim = rims.find(key);
                if (rim != rims.end() && rim->second == input.capOf[n]) isDropped[n] = 1;
            });
        }
    }
    std::vector<std::array<std::size_t, 2>> counts(input.capGoesInParts.size());  // kept, dropped
    for (std::size_t n = 0; n < isDropped.size(); ++n) ++counts[input.capOf[n]][isDropped[n]];
    for (std::size_t n = 0; n < isDropped.size(); ++n) {
        const auto& [kept, dropped] = counts[input.capOf[n]];
        if (dropped > (input.capGoesInParts[input.capOf[n]] != 0 ? kept : 0)) isDropped[n] = 1;
    }
}

}  // namespace

std::vector<std::vector<VertexId>> borderRings(const MendInput& input) {
    std::vector<std::uint8_t> uses(input.edges.size());
    for (const auto& edges : input.edgeOf) {
        for (const std::uint32_t e : edges)
            uses[e] = static_cast<std::uint8_t>(std::min(uses[e] + 1, 3));
    }
    if (std::find(uses.begin(), uses.end(), 1) == uses.end()) return {};
    const Buckets<VertexId> next(input.mesh.points.size(), [&](const auto& give) {
        for (std::size_t t = 0; t < input.edgeOf.size(); ++t) {
            const Triangle& corners = input.mesh.triangles[t];
            for (std::size_t i = 0; i < 3; ++i) {
                if (uses[input.edgeOf[t][i]] == 1) give(corners[(i + 1) % 3], corners[i]);
            }
        }
    });
    const BorderTurns turns(input, next);
    std::vector<std::vector<VertexId>> rings;
    std::vector<std::vector<VertexId>> left(input.mesh.points.size());
    for (VertexId v = 0; v < std::ssize(left); ++v)
        left[v].assign(next.of(v).begin(), next.of(v).end());
    std::vector<std::int64_t> placeOnPath(input.mesh.points.size(), -1);
    for (VertexId first = 0; first < std::ssize(left); ++first) {
        std::vector<VertexId> path{first};
        placeOnPath[first] = 0;
        while (!path.empty()) {
            std::vector<VertexId>& ways = left[path.back()];
            if (ways.empty()) {  // it ends at an edge of several triangles
                placeOnPath[path.back()] = -1;
                path.pop_back();
                continue;
            }
            const std::size_t way =
                path.size() < 2 ? 0 : turns.narrowest(path[path.size() - 2], path.back(), ways);
            const VertexId v = ways[way];
            ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(way));
            const std::int64_t place = placeOnPath[v];
            if (place < 0) {
                placeOnPath[v] = std::ssize(path);
                path.push_back(v);
                continue;
            }
            rings.emplace_back(path.begin() + place, path.end());
            for (auto p = path.begin() + place + 1; p != path.end(); ++p) placeOnPath[*p] = -1;
            path.resize(place + 1);
        }
    }
    return rings;
}

bool addCaps(MendInput& input, CapKind kind) {
    const bool isByArea = kind == CapKind::LeastArea;
    TriangleMesh& mesh = input.mesh;
    const auto rings = borderRings(input);
    if (rings.empty()) return false;
    std::vector<std::uint8_t> isOnRing(mesh.points.size());
    for (const auto& ring : rings) {
        for (const VertexId v : ring) isOnRing[v] = 1;
    }
    EdgeSet taken;
    for (const MendInput::Edge& edge : input.edges) {
        if (isOnRing[edge.a] != 0 && isOnRing[edge.b] != 0) taken.insert(endsKey(edge.a, edge.b));
    }
    std::optional<ClearCaps> clear;
    const std::size_t before = input.capGoesInParts.size();
    const auto add = [&](const std::vector<Triangle>& triangles, bool isPlane) {
        for (const auto& [a, b, c] : triangles) {
            taken.insert({endsKey(a, b), endsKey(b, c), endsKey(c, a)});
        }
        mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
        input.capOf.insert(input.capOf.end(), triangles.size(),
                           static_cast<std::uint32_t>(input.capGoesInParts.size()));
        input.capGoesInParts.push_back(isPlane ? 1 : 0);
    };
    // 0: open, 1: closed, 2: of a ragged cut, which no flat cap closes
    std::vector<std::uint8_t> isClosed(rings.size());
    const auto addGroup = [&](const std::vector<std::size_t>& group,
                              const std::vector<Triangle>& triangles, bool isPlane) {
        if (triangles.empty()) return;
        for (const std::size_t n : group) isClosed[n] = 1;
        add(triangles, isPlane);
    };
    if (kind != CapKind::FlatAlone) {
        const RingGroups nested(mesh, rings, 0), ragged(mesh, rings, kSlackOfRagged);
        for (const auto& group : nested.groups()) {
            if (!isByArea) addGroup(group, nested.between(group, taken), true);
        }
        const auto raggedGroups = ragged.groups();
        ComponentLabels pieces;
        Buckets<VertexId> ofPiece;
        if (!raggedGroups.empty()) {
            pieces = labelComponents(mesh);
            ofPiece.assign(static_cast<std::size_t>(pieces.count), [&](const auto& give) {
                for (VertexId v = 0; v < std::ssize(pieces.ofVertex); ++v) {
                    give(static_cast<std::size_t>(pieces.ofVertex[v]), v);
                }
            });
        }
        for (const auto& group : raggedGroups) {
            const bool areOpen =
                std::ranges::all_of(group, [&](std::size_t n) { return isClosed[n] == 0; });
            const bool areFlat =
                std::ranges::all_of(group, [&](std::size_t n) { return nested.isFlat(n); });
            if (!areOpen || areFlat || ragged.isSide(group, pieces, ofPiece)) continue;
            for (const std::size_t n : group) isClosed[n] = 2;
            if (!isByArea) continue;
            std::vector<std::vector<VertexId>> rims;
            for (const std::size_t n : group) rims.push_back(rings[n]);
            if (!clear) clear.emplace(mesh);
            addGroup(group,
                     clear->closeRims(std::move(rims), ragged.planeOf(group[0]).normal, taken),
                     true);
        }
    }
    for (std::size_t n = 0; n < rings.size(); ++n) {
        const std::vector<VertexId>& ring = rings[n];
        const bool isLeft = isClosed[n] == 0 || (isByArea && isClosed[n] == 2);
        if (!isLeft || ring.size() < 3 || ring.size() > kMostOfRing) continue;
        const RingPlane plane(mesh.points, ring);
        std::vector<Triangle> triangles;
        bool isRagged = false;
        if (!isByArea) {
            triangles = flatCap(mesh, ring, taken);
        } else {
            if (!clear) clear.emplace(mesh);
            constexpr std::size_t kFewest = 32;  // or the lattice makes little of it
            triangles = clear->close(ring, taken);
            isRagged = triangles.empty() && ring.size() >= kFewest;
            if (isRagged) triangles = clear->closeRims({ring}, plane.normal, taken);
        }
        if (triangles.empty()) continue;
        const bool isPlane = !isByArea && plane.contains(mesh.points, ring, plane.roundingMm());
        add(triangles, isPlane || isRagged);
    }
    return input.capGoesInParts.size() != before;
}

bool dropCrossingCaps(MendInput& input) {
    const std::int64_t first = input.firstCap();
    std::vector<std::uint8_t> isDropped(input.capOf.size());  // of triangles
    const auto isCap = [&](std::uint32_t t) { return t >= first; };
    const auto judge = [&](std::uint32_t t) {
        if (isCap(t)) isDropped[t - first] = 1;
    };
    for (const auto& [a, b] : input.crossingPairs) {
        judge(a);
        judge(b);
    }
    for (const std::uint32_t t : input.undecided) judge(t);
    if (std::find(isDropped.begin(), isDropped.end(), 1) == isDropped.end()) return false;
    widenWithinCaps(input, isDropped);
    // caps come last, so that no other triangle gets another number; none that crosses stays
    std::erase_if(input.crossingPairs,
                  [&](const auto& pair) { return isCap(pair[0]) || isCap(pair[1]); });
    std::erase_if(input.undecided, isCap);
    std::size_t next = 0;
    for (std::size_t n = 0; n < input.capOf.size(); ++n) {
        if (isDropped[n] != 0) continue;
        input.mesh.triangles[first + next] = input.mesh.triangles[first + n];
        input.capOf[next++] = input.capOf[n];
    }
    input.mesh.triangles.resize(first + next);
    input.capOf.resize(next);
    return true;
}

}  // namespace adaptiso::detail
