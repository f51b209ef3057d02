#include "SweptCentres.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace adaptiso::detail {
namespace {

/// Voxels that are kept clear around what is swept.
constexpr double kMargin = 1e-4;

/// What lies on one side of a plane: dot(normal, p) >= least.
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
        Vec3 normal = normalized(areaVector2(a, b, c));
        double height = dot(normal, p[i] - a);
        if (height < 0) {
            normal = -normal;
            height = -height;
        }
        if (height < kMargin) {
            const double at = dot(normal, a);
            if (normal == Vec3{}) return {};
            room.sides[0] = {normal, at - 2 * kMargin};
            room.sides[1] = {-normal, -at - 2 * kMargin};
            room.count = 2;
            return room;
        }
        room.sides[room.count++] = {normal, dot(normal, a) - kMargin};
    }
    return room;
}

}  // namespace

bool SweptCentres::isCentreIn(const std::array<Vec3, 3>& triangle, const Vec3& point) const {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 3; ++i) p[i] = toIndex(triangle[i]);
    p[3] = toIndex(point);
    std::array<double, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::ceil(std::min({p[0][axis], p[1][axis], p[2][axis], p[3][axis]}) - kMargin);
        high[axis] =
            std::floor(std::max({p[0][axis], p[1][axis], p[2][axis], p[3][axis]}) + kMargin);
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
    Vec3 at;
    for (at[u] = low[u]; at[u] <= high[u]; ++at[u]) {
        for (at[v] = low[v]; at[v] <= high[v]; ++at[v]) {
            at[along] = 0;
            double first = low[along], last = high[along];
            for (int i = 0; i < room.count; ++i) {
                const auto& [normal, least] = room.sides[i];
                const double slope = normal[along], lack = least - dot(normal, at);
                if (std::abs(slope) < 1e-12) {
                    if (lack > 0) last = first - 1;
                } else if (slope > 0) {
                    first = std::max(first, lack / slope);
                } else {
                    last = std::min(last, lack / slope);
                }
            }
            if (std::ceil(first - 1e-9) <= last + 1e-9) return true;
        }
    }
    return false;
}

}  // namespace adaptiso::detail
