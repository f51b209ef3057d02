#include "Support/AnalyticVolumes.h"

#include <numbers>

namespace adaptiso::testing {
namespace {

constexpr double kPi = std::numbers::pi;

/// Turns about an axis through the origin [Rodrigues' formula].
Mat3 rotation(const Vec3& axis, double radians) {
    const Vec3 u = normalized(axis);
    const auto turned = [&](const Vec3& v) {
        return std::cos(radians) * v + std::sin(radians) * cross(u, v) +
               (1 - std::cos(radians)) * dot(u, v) * u;
    };
    return {{{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})}}};
}

ImageGeometry centredOnOrigin(const Index3& size, const Mat3& indexToPhysical) {
    ImageGeometry geometry;
    geometry.size = size;
    geometry.indexToPhysical = indexToPhysical;
    geometry.originMm = -(indexToPhysical * Vec3{static_cast<double>(size[0] - 1) / 2,
                                                 static_cast<double>(size[1] - 1) / 2,
                                                 static_cast<double>(size[2] - 1) / 2});
    return geometry;
}

}  // namespace

Shape sphere(const Vec3& centreMm, double radiusMm) {
    return {[=](const Vec3& p) { return radiusMm - norm(p - centreMm); },
            4 * kPi / 3 * std::pow(radiusMm, 3), 4 * kPi * radiusMm * radiusMm, 1, 0};
}

Shape torus(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm) {
    return {[=](const Vec3& p) {
                const Vec3 d = p - centreMm;
                return minorRadiusMm - std::hypot(std::hypot(d.x, d.y) - majorRadiusMm, d.z);
            },
            2 * kPi * kPi * majorRadiusMm * minorRadiusMm * minorRadiusMm,
            4 * kPi * kPi * majorRadiusMm * minorRadiusMm, 1, 1};
}

Shape shell(const Vec3& centreMm, double innerRadiusMm, double outerRadiusMm) {
    return {[=](const Vec3& p) {
                const double r = norm(p - centreMm);
                return std::min(outerRadiusMm - r, r - innerRadiusMm);
            },
            4 * kPi / 3 * (std::pow(outerRadiusMm, 3) - std::pow(innerRadiusMm, 3)),
            4 * kPi * (outerRadiusMm * outerRadiusMm + innerRadiusMm * innerRadiusMm), 2, 0};
}

Shape box(const Vec3& centreMm, const Vec3& halfSizeMm) {
    const Vec3 h = halfSizeMm;
    return {[=](const Vec3& p) {
                const Vec3 d{std::abs(p.x - centreMm.x) - h.x, std::abs(p.y - centreMm.y) - h.y,
                             std::abs(p.z - centreMm.z) - h.z};
                const Vec3 outside{std::max(d.x, 0.0), std::max(d.y, 0.0), std::max(d.z, 0.0)};
                return -(norm(outside) + std::min(std::max({d.x, d.y, d.z}), 0.0));
            },
            8 * h.x * h.y * h.z, 8 * (h.x * h.y + h.y * h.z + h.z * h.x), 1, 0};
}

Shape halfSpace(const Vec3& pointMm, const Vec3& normal) {
    const Vec3 unit = normalized(normal);
    return {[=](const Vec3& p) { return dot(unit, pointMm - p); }, std::nullopt, std::nullopt, 1,
            0};
}

ImageGeometry centredGeometry(const Index3& size, const Vec3& spacingMm) {
    return centredOnOrigin(size, Mat3::diagonal(spacingMm.x, spacingMm.y, spacingMm.z));
}

ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm) {
    return centredOnOrigin(
        size, rotation({1, 2, 3}, 0.7) * Mat3::diagonal(spacingMm.x, spacingMm.y, spacingMm.z));
}

ImageGeometry shearedGeometry(const Index3& size, const Vec3& spacingMm) {
    Mat3 axes = Mat3::diagonal(spacingMm.x, spacingMm.y, spacingMm.z);
    axes.column[2].y = 0.3 * spacingMm.z;
    return centredOnOrigin(size, axes);
}

ImageGeometry mirroredGeometry(const Index3& size, const Vec3& spacingMm) {
    return centredOnOrigin(
        size, rotation({1, 2, 3}, 0.7) * Mat3::diagonal(-spacingMm.x, spacingMm.y, spacingMm.z));
}

std::uint64_t nextRandom(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

}  // namespace adaptiso::testing
