#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "Surfaces.h"
#include "adaptive/rounds/PatchGroups.h"

namespace adaptiso::testing {

/// Cubes of 12 cells that meet within the ball.
inline constexpr detail::PatchCut kCut{12, {5, 5, 5}};

/// Of a point, by hand: voxels are 1 mm.
inline Index3 cubeOf(const Vec3& p) {
    Index3 cube;
    for (int a = 0; a < 3; ++a) {
        cube[a] = static_cast<std::int64_t>(std::floor((p[a] - 5) / 12));
    }
    return cube;
}

/// A triangle by its corners.
using Key = std::array<double, 9>;

inline Key keyOf(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
}
inline Key keyOf(const detail::Patch& patch, std::uint32_t t) {
    const auto& [a, b, c] = patch.triangles[t];
    return keyOf(patch.points[a], patch.points[b], patch.points[c]);
}

/// A ball's full surface, and its patches.
struct PatchedBall {
    Scene scene = ballScene();
    detail::SimplifiedSurface surface = scene.fullSurface();
    detail::PatchGroups groups{surface, kCut, scene.frame};
    detail::PatchScratch scratch;

    Key key(std::uint32_t t) const {
        const auto& [a, b, c] = surface.triangles[t];
        return keyOf(surface.points[a], surface.points[b], surface.points[c]);
    }
    bool straddles(std::uint32_t t) const {
        const auto& [a, b, c] = surface.triangles[t];
        const Index3 cube = cubeOf(surface.points[a]);
        return cubeOf(surface.points[b]) != cube || cubeOf(surface.points[c]) != cube;
    }
};

}  // namespace adaptiso::testing
