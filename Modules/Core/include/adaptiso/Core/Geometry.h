#pragma once

#include <array>
#include <cmath>

namespace adaptiso {

/// A point or a vector in space; millimetres in LPS unless a name says otherwise.
struct Vec3 {
    double x = 0, y = 0, z = 0;

    constexpr double& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    constexpr double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vec3 operator-(const Vec3& a) {
    return {-a.x, -a.y, -a.z};
}
constexpr Vec3 operator*(double s, const Vec3& a) {
    return {s * a.x, s * a.y, s * a.z};
}
constexpr Vec3 operator*(const Vec3& a, double s) {
    return s * a;
}
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) {
    return a = a + b;
}
constexpr double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr double squaredNorm(const Vec3& a) {
    return dot(a, a);
}
inline double norm(const Vec3& a) {
    return std::sqrt(squaredNorm(a));
}

inline bool isFinite(const Vec3& a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// `a` scaled to length 1; the zero vector stays zero.
inline Vec3 normalized(const Vec3& a) {
    const double length = norm(a);
    return length > 0 ? (1 / length) * a : Vec3{};
}

/// A unit normal as stored in a mesh: single precision is ample for a direction.
struct Normal {
    float x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const Normal&, const Normal&) = default;
};

inline Normal toNormal(const Vec3& v) {
    const Vec3 unit = normalized(v);
    return {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)};
}
constexpr Vec3 toVec3(const Normal& n) {
    return {n.x, n.y, n.z};
}

/// A 3 x 3 matrix, kept by columns: `column[a]` is where axis a goes.
struct Mat3 {
    std::array<Vec3, 3> column{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

    static constexpr Mat3 diagonal(double x, double y, double z) {
        return {{{{x, 0, 0}, {0, y, 0}, {0, 0, z}}}};
    }
    friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};

constexpr Vec3 operator*(const Mat3& m, const Vec3& v) {
    return v.x * m.column[0] + v.y * m.column[1] + v.z * m.column[2];
}
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    return {{{a * b.column[0], a * b.column[1], a * b.column[2]}}};
}
constexpr double determinant(const Mat3& m) {
    return dot(m.column[0], cross(m.column[1], m.column[2]));
}
constexpr Mat3 transpose(const Mat3& m) {
    const auto& c = m.column;
    return {{{{c[0].x, c[1].x, c[2].x}, {c[0].y, c[1].y, c[2].y}, {c[0].z, c[1].z, c[2].z}}}};
}
/// \pre determinant(m) != 0
constexpr Mat3 inverse(const Mat3& m) {
    const auto& c = m.column;
    const double s = 1 / determinant(m);
    return transpose({{{s * cross(c[1], c[2]), s * cross(c[2], c[0]), s * cross(c[0], c[1])}}});
}

/// Twice the area vector of the triangle a, b, c (right-hand rule).
constexpr Vec3 areaVector2(const Vec3& a, const Vec3& b, const Vec3& c) {
    return cross(b - a, c - a);
}

using Point2 = std::array<double, 2>;

/// On which side of the line a -> b the point c lies, decided exactly: 1 left (a, b, c are
/// counter-clockwise), -1 right, 0 on it.
///
/// A floating-point filter answers almost always; the rest is done in exact expansion arithmetic
/// [Shewchuk1997]. Exact for coordinates that are 0 or between 1e-100 and 1e100 in size and that
/// differ by 0 or more than 1e-90 (so that no product underflows).
/// \pre coordinates are finite
int orient2d(const Point2& a, const Point2& b, const Point2& c);

/// On which side of the plane through a, b, c the point d lies, decided exactly: 1 where the
/// right-hand normal (b - a) x (c - a) points, -1 on the other side, 0 in the plane or when a, b
/// and c lie on a line. Method and limits as for orient2d. \pre coordinates are finite
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace adaptiso
