#include "DoubledTriangles.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>

#include "adaptiso/Core/Buckets.h"

namespace adaptiso::detail {

/// Number of the first point at the place of each.
std::vector<VertexId> firstAtPlace(const std::vector<Vec3>& points) {
    std::vector<VertexId> order(points.size()), place(points.size());
    std::iota(order.begin(), order.end(), VertexId{0});
    std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
        const Vec3 &p = points[a], &q = points[b];
        return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    });
    for (std::size_t n = 0; n < order.size(); ++n) {
        const bool isSame = n > 0 && points[order[n]] == points[order[n - 1]];
        place[order[n]] = isSame ? place[order[n - 1]] : order[n];
    }
    return place;
}

namespace {

/// Triangles at one place.
struct Doubled {
    Triangle places;                   ///< ascending
    std::vector<std::size_t> numbers;  ///< ascending
    std::vector<int> facings;  ///< 1 or -1: whether an even number of swaps makes them ascend
    int facing = 0;            ///< their sum
};

std::vector<Doubled> collectDoubled(const std::vector<Vec3>& points,
                                    const std::vector<Triangle>& triangles) {
    const std::vector<VertexId> place = firstAtPlace(points);
    struct Placed {
        Triangle places;
        std::size_t number;
        int facing;
        bool operator<(const Placed& o) const {
            return places != o.places ? places < o.places : number < o.number;
        }
    };
    std::vector<Placed> all;
    all.reserve(triangles.size());
    for (std::size_t n = 0; n < triangles.size(); ++n) {
        Triangle t;
        for (int i = 0; i < 3; ++i) t[i] = place[triangles[n][i]];
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        const int facing = t[1] < t[2] ? 1 : -1;
        if (facing < 0) std::swap(t[1], t[2]);
        all.push_back({t, n, facing});
    }
    std::sort(all.begin(), all.end());
    std::vector<Doubled> sets;
    for (const Placed& placed : all) {
        if (sets.empty() || sets.back().places != placed.places)
            sets.emplace_back().places = placed.places;
        Doubled& set = sets.back();
        set.numbers.push_back(placed.number);
        set.facings.push_back(placed.facing);
        set.facing += placed.facing;
    }
    return sets;
}

/// Finds the walls of solids that touch. A set with as many triangles facing either way is a wall,
/// or a surface given twice. Connected sets are walls if an even number of other sets meets at most
/// of the edges where they end: two solids go on from there.
std::vector<std::uint8_t> findWalls(const std::vector<Doubled>& sets) {
    struct EdgeOfSet {
        VertexId a, b;
        std::size_t set;
        bool operator<(const EdgeOfSet& o) const {
            return std::tie(a, b, set) < std::tie(o.a, o.b, o.set);
        }
    };
    std::vector<EdgeOfSet> edges;
    edges.reserve(3 * sets.size());
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const auto& [a, b, c] = sets[n].places;
        edges.insert(edges.end(), {{a, b, n}, {b, c, n}, {a, c, n}});
    }
    std::sort(edges.begin(), edges.end());
    DisjointSets regions(std::ssize(sets));
    std::vector<std::int64_t> votes(sets.size());
    struct Vote {
        std::size_t set;
        int isEven;
    };
    std::vector<Vote> cast;
    for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
        std::size_t others = 0;
        std::optional<std::size_t> first;
        for (end = begin;
             end < edges.size() && edges[end].a == edges[begin].a && edges[end].b == edges[begin].b;
             ++end) {
            const Doubled& set = sets[edges[end].set];
            if (set.facing != 0) {
                ++others;
            } else if (first) {
                regions.join(static_cast<std::int64_t>(*first),
                             static_cast<std::int64_t>(edges[end].set));
            } else {
                first = edges[end].set;
            }
        }
        if (first && others > 0) cast.push_back({*first, others % 2 == 0 ? 1 : -1});
    }
    for (const auto& [set, isEven] : cast) {
        votes[regions.find(static_cast<std::int64_t>(set))] += isEven;
    }
    std::vector<std::uint8_t> isWall(sets.size());
    for (std::size_t n = 0; n < sets.size(); ++n) {
        isWall[n] = sets[n].facing == 0 && votes[regions.find(static_cast<std::int64_t>(n))] > 0;
    }
    return isWall;
}

/// Whether the connected part of each triangle is closed, and is open once the dropped triangles
/// are gone. A part is closed if as many triangles run one way along each edge as the other.
std::vector<std::uint8_t> findOpened(std::size_t pointCount, const std::vector<Triangle>& triangles,
                                     const std::vector<std::uint8_t>& isDropped) {
    DisjointSets parts(static_cast<std::int64_t>(pointCount));
    struct HalfEdge {
        VertexId a, b;
        int way;
        std::uint8_t isDropped;
    };
    std::vector<HalfEdge> halves;
    halves.reserve(3 * triangles.size());
    for (std::size_t n = 0; n < triangles.size(); ++n) {
        const Triangle& t = triangles[n];
        for (std::size_t i = 0; i < 3; ++i) {
            const VertexId a = t[i], b = t[(i + 1) % 3];
            parts.join(a, b);
            halves.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1, isDropped[n]});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& one, const HalfEdge& other) {
        return std::tie(one.a, one.b) < std::tie(other.a, other.b);
    });
    std::vector<std::uint8_t> isOpen(pointCount), isOpened(pointCount);  // of parts
    for (std::size_t begin = 0, end; begin < halves.size(); begin = end) {
        int all = 0, kept = 0;
        for (end = begin; end < halves.size() && halves[end].a == halves[begin].a &&
                          halves[end].b == halves[begin].b;
             ++end) {
            all += halves[end].way;
            if (halves[end].isDropped == 0) kept += halves[end].way;
        }
        const std::int64_t part = parts.find(halves[begin].a);
        if (all != 0) isOpen[part] = 1;
        if (kept != 0) isOpened[part] = 1;
    }
    std::vector<std::uint8_t> found;
    for (const Triangle& t : triangles) {
        const std::int64_t part = parts.find(t[0]);
        found.push_back(isOpened[part] != 0 && isOpen[part] == 0);
    }
    return found;
}

}  // namespace

DoubledTriangles findDoubled(const std::vector<Vec3>& points,
                             const std::vector<Triangle>& triangles) {
    const std::vector<Doubled> sets = collectDoubled(points, triangles);
    const std::vector<std::uint8_t> isWall = findWalls(sets);
    DoubledTriangles found{std::vector<std::uint8_t>(triangles.size()), {}};
    std::vector<std::size_t> copies;
    for (std::size_t n = 0; n < sets.size(); ++n) {
        const Doubled& set = sets[n];
        std::size_t keeps = 0;
        while (set.facing * set.facings[keeps] < 0) ++keeps;
        for (std::size_t k = 0; k < set.numbers.size(); ++k) {
            if (k == keeps && isWall[n] == 0) continue;
            found.isDropped[set.numbers[k]] = 1;
            if (isWall[n] == 0) copies.push_back(set.numbers[k]);
        }
        if (isWall[n] != 0) found.walls.push_back(set.numbers[0]);
    }
    if (copies.empty()) return found;
    const std::vector<std::uint8_t> isOpened =
        findOpened(points.size(), triangles, found.isDropped);
    for (const std::size_t n : copies) {
        if (isOpened[n] != 0) found.isDropped[n] = 0;
    }
    return found;
}

}  // namespace adaptiso::detail
