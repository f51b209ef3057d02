#include "Lattice.h"

#include <algorithm>

namespace adaptiso::detail {

bool mayTouch(const std::array<Vec3, 3>& triangle, const BoundingBox& box) {
    const Vec3 middle = box.middle(), half = 0.5 * box.size();
    const std::array<Vec3, 3> p{triangle[0] - middle, triangle[1] - middle, triangle[2] - middle};
    double size = std::max({half.x, half.y, half.z});
    for (const Vec3& corner : p) {
        size = std::max({size, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
    }
    const auto isApartAlong = [&](const Vec3& axis) {
        const double a = dot(axis, p[0]), b = dot(axis, p[1]), c = dot(axis, p[2]);
        const double reach =
            std::abs(axis.x) * half.x + std::abs(axis.y) * half.y + std::abs(axis.z) * half.z;
        const double rounding =
            1e-14 * size * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
        return std::min({a, b, c}) > reach + rounding || std::max({a, b, c}) < -reach - rounding;
    };
    const std::array<Vec3, 3> edges{p[1] - p[0], p[2] - p[1], p[0] - p[2]};
    for (int a = 0; a < 3; ++a) {
        Vec3 axis;
        axis[a] = 1;
        if (isApartAlong(axis)) return false;
        for (const Vec3& edge : edges) {
            if (isApartAlong(cross(axis, edge))) return false;
        }
    }
    return !isApartAlong(cross(edges[0], edges[1]));
}

}  // namespace adaptiso::detail
