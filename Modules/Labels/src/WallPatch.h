#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/SurfaceProof/Quadric.h"

namespace adaptiso::detail {

/// Where a vertex lies: in a wall, on a curve where walls meet, where curves end or meet.
enum class WallKind : std::uint8_t { Wall, Curve, Corner };

struct WallTriangle {
    std::array<std::uint32_t, 3> v;
    std::uint32_t wall;  ///< number of its two labels
    bool has(std::uint32_t vertex) const {
        return v[0] == vertex || v[1] == vertex || v[2] == vertex;
    }
};

/// Where a sample of the full walls is assigned to: a triangle of the walls as they are, and where
/// on it.
struct SampleHome {
    static constexpr std::uint8_t kOnWall = 3;

    std::uint32_t triangle = ~std::uint32_t{0};  ///< none at first
    float tightness = 0.8F;  ///< part of the limit that it may use: between samples it may be more
    std::uint8_t slot = kOnWall;  ///< or the edge, on a curve, by the corner that it starts from
};

/// A part of the walls that is simplified alone: what lies in a cube, and what reaches into it.
///
/// Vertices and triangles have numbers of their own here.
struct WallPatch {
    using Id = std::uint32_t;

    // the walls at full resolution
    std::vector<Vec3> fullPoints;
    std::vector<WallTriangle> fullTriangles;
    // the walls as they are; where there are none, the full ones are
    std::vector<Vec3> points;
    std::vector<WallKind> kinds;
    std::vector<Quadric> quadrics;
    std::vector<Id> origins;            ///< of each vertex, one of the full walls near it
    std::vector<std::uint8_t> isTried;  ///< of vertices: no edge there can collapse as they are
    std::vector<WallTriangle> triangles;
    std::vector<SampleHome> homes;  ///< of the full walls' vertices

    std::vector<std::uint8_t> isOwn;     ///< of vertices: in the cube
    std::vector<std::uint8_t> isFrozen;  ///< of vertices: do not move
    // the cube, in voxel indices
    Vec3 low, high;

    bool isFull() const { return points.empty(); }
};

}  // namespace adaptiso::detail
