#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso {

/// Which vertices of a mesh have a fan of triangles all round that is clear of itself: seen along
/// one direction all of them are upright and go round the vertex once. No two triangles of such a
/// fan cross (see trianglesCross()). What is no such fan may be clear all the same.
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

}  // namespace adaptiso
