#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso {

/// Triangles of a fan that goesRoundOnce() judges, at most.
inline constexpr std::size_t kMostOfFan = 24;

/// The triangles all round a vertex are clear of themselves: seen along one direction all of them
/// are upright and go round the vertex once. No two triangles of such a fan cross (see
/// trianglesCross()). What is no such fan may be clear all the same.
/// \param spokes  from the vertex to the ring's, in their order round it; no more than kMostOfFan
bool goesRoundOnce(std::span<const Vec3> spokes);

/// Finds the vertices of a mesh with a fan of triangles all round that is clear of itself.
///
/// Cost: O(T), in parallel; 28 bytes a triangle while it is made, then one byte a vertex.
class ClearFans {
public:
    /// \param triangles  each the numbers of three points that are there
    template <class Triangles>
    ClearFans(std::span<const Vec3> points, const Triangles& triangles)
        : isClear_(points.size(), 0) {
        if (points.size() > kMost || triangles.size() > kMost / 3) return;  // none is clear
        prove(points, Sectors(points.size(), [&](const auto& give) {
                  for (const auto& [a, b, c] : triangles) {
                      give(static_cast<std::size_t>(a), sector(b, c));
                      give(static_cast<std::size_t>(b), sector(c, a));
                      give(static_cast<std::size_t>(c), sector(a, b));
                  }
              }));
    }

    bool isClear(std::size_t vertex) const { return isClear_[vertex] != 0; }

    /// Two triangles share a vertex with a clear fan: they do not cross.
    template <class Triangle>
    bool areClear(const Triangle& s, const Triangle& t) const {
        for (const auto v : s) {
            if ((v == t[0] || v == t[1] || v == t[2]) && isClear(static_cast<std::size_t>(v))) {
                return true;
            }
        }
        return false;
    }

private:
    static constexpr std::size_t kMost = 0xFFFFFFFF;  ///< that 32 bits can number
    using Sector = std::array<std::uint32_t, 2>;  ///< the other corners of a triangle, in its order
    using Sectors = Buckets<Sector, std::uint32_t>;

    template <class Id>
    static Sector sector(Id a, Id b) {
        return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)};
    }
    void prove(std::span<const Vec3> points, Sectors sectors);

    std::vector<std::uint8_t> isClear_;
};

/// Pairs of triangles that cross, a < b, each once, in an order that is always the same.
struct CrossingPairs {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    /// Triangles that lie near too many others to be tested with all (see findCrossingPairs()),
    /// ascending; empty: the pairs are all there are.
    std::vector<std::uint32_t> undecided;
    std::int64_t tests = 0;  ///< of pairs whose boxes overlap
};

/// Finds the pairs of triangles of a mesh that cross, as trianglesCross() has it. Near pairs come
/// from a tree of boxes. Most are proved clear by a fan (ClearFans) or a plane (Certificate.h); the
/// others are decided exactly. Where boxes overlap too often, a tree of groups that planes tell
/// apart (TriangleGroups) takes their place: a vertex of a million triangles costs no more than
/// others.
///
/// Where hundreds of triangles are near each one, and planes do not tell them apart, no more are
/// tested than a budget in proportion to T: 256 near ones, 8 that cross, and more where T is below
/// a few thousand. Such triangles are reported as undecided.
/// \param isTested  isTested(a, b): the pair is looked at; empty: all are
/// \pre the corners of triangles are finite
/// Cost: O(T log T), in parallel; 40 bytes a triangle, and those of ClearFans or TriangleGroups.
CrossingPairs findCrossingPairs(
    const TriangleView& mesh,
    const std::function<bool(std::uint32_t, std::uint32_t)>& isTested = {});

}  // namespace adaptiso
