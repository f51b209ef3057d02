#include "SweptCentres.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace adaptiso::detail {
namespace {

/// Voxels that are kept clear around what is swept.
constexpr double kMargin = 1e-4;
/// Cosine below which a line of voxel centres counts as parallel to a plane.
constexpr double kParallel = 1e-12;

/// What lies on one side of a plane: dot(normal, p) >= least. Normals may have any length.
struct HalfSpace {
    Vec3 normal;
    double least;
};

struct Room {
    std::array<HalfSpace, 4> sides;
    int count = 0;
};

/// The tetrahedron, wider by the margin; of a flat one, a slab round it.
Room roomOf(const std::array<Vec3, 4>& p) {
    Room room;
    for (int i = 0; i < 4; ++i) {
        const Vec3 &a = p[(i + 1) % 4], &b = p[(i + 2) % 4], &c = p[(i + 3) % 4];
        Vec3 normal = areaVector2(a, b, c);
        const double margin = kMargin * norm(normal);
        double height = dot(normal, p[i] - a);
        if (height < 0) {
            normal = -normal;
            height = -height;
        }
        if (height < margin || margin == 0) {
            const double at = dot(normal, a);
            if (margin == 0) return {};
            room.sides[0] = {normal, at - 2 * margin};
            room.sides[1] = {-normal, -at - 2 * margin};
            room.count = 2;
            return room;
        }
        room.sides[room.count++] = {normal, dot(normal, a) - margin};
    }
    return room;
}

/// std::ceil and std::floor of what 64 bits hold, without a call.
double roundedUp(double x) {
    const auto whole = static_cast<double>(static_cast<std::int64_t>(x));
    return whole < x ? whole + 1 : whole;
}
double roundedDown(double x) {
    const auto whole = static_cast<double>(static_cast<std::int64_t>(x));
    return whole > x ? whole - 1 : whole;
}

}  // namespace

bool SweptCentres::isCentreIn(const std::array<Vec3, 4>& p) {
    std::array<double, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
        const double x = p[0][axis], y = p[1][axis], z = p[2][axis], w = p[3][axis];
        low[axis] = roundedUp(std::min(std::min(x, y), std::min(z, w)) - kMargin);
        high[axis] = roundedDown(std::max(std::max(x, y), std::max(z, w)) + kMargin);
        if (low[axis] > high[axis]) return false;
    }
    const Room room = roomOf(p);
    // lines of centres along the axis that the triangle faces most: few lie in a flat room
    const Vec3 facing = areaVector2(p[0], p[1], p[2]);
    int along = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (std::abs(facing[axis]) > std::abs(facing[along])) along = axis;
    }
    const int u = (along + 1) % 3, v = (along + 2) % 3;
    std::array<double, 4> perSlope{};  // 0: the line runs along the side
    for (int i = 0; i < room.count; ++i) {
        const Vec3& normal = room.sides[i].normal;
        const double slope = normal[along];
        if (slope * slope >= kParallel * kParallel * squaredNorm(normal)) perSlope[i] = 1 / slope;
    }
    Vec3 at;
    for (at[u] = low[u]; at[u] <= high[u]; ++at[u]) {
        for (at[v] = low[v]; at[v] <= high[v]; ++at[v]) {
            double first = low[along], last = high[along];
            for (int i = 0; i < room.count; ++i) {
                const auto& [normal, least] = room.sides[i];
                const double lack = least - dot(normal, at);
                if (perSlope[i] == 0) {
                    if (lack > 0) last = first - 1;
                } else if (perSlope[i] > 0) {
                    first = std::max(first, lack * perSlope[i]);
                } else {
                    last = std::min(last, lack * perSlope[i]);
                }
            }
            if (first <= last + 1 && roundedUp(first - 1e-9) <= last + 1e-9) return true;
        }
    }
    return false;
}

}  // namespace adaptiso::detail
