#include "RayHit.h"

#include <limits>

namespace adaptiso {
namespace {

/// Where `p` lies of the line from -> to: 1 left, -1 right, never 0. Ties are broken by moving p by
/// (e^2, e), e infinitely small; 0 only where from and to are one point.
int perturbedSide(const Point2& p, const Point2& from, const Point2& to) {
    const int side = orient2d(from, to, p);
    if (side != 0) return side;
    const double along = to[0] - from[0], up = to[1] - from[1];
    if (along != 0) return along > 0 ? 1 : -1;
    return up > 0 ? -1 : up < 0 ? 1 : 0;
}

/// \pre p lies in the triangle's plane
bool isOnTriangle(const Vec3& p, const Corners& t) {
    const int axis = axisWithArea(t);
    if (axis < 0) return false;
    const Point2 q = dropAxis(p, axis);
    const Point2 a = dropAxis(t[0], axis), b = dropAxis(t[1], axis), c = dropAxis(t[2], axis);
    return haveOneSign(orient2d(a, b, q), orient2d(b, c, q), orient2d(c, a, q));
}

}  // namespace

Hit hitOf(const Vec3& p, const Ray& ray, const Corners& t) {
    const Point2 q = dropAxis(p, ray.axis);
    const Point2 a = dropAxis(t[0], ray.axis), b = dropAxis(t[1], ray.axis),
                 c = dropAxis(t[2], ray.axis);
    const int height = orient3d(t[0], t[1], t[2], p);
    if (height == 0 && isOnTriangle(p, t)) return {.isOn = true};
    const int facing = perturbedSide(q, a, b);  // 1: the normal points along the axis
    if (facing == 0 || perturbedSide(q, b, c) != facing || perturbedSide(q, c, a) != facing) {
        return {};
    }
    return {.crosses = height * facing * ray.sign < 0};
}

BoundingBox boxOf(const Vec3& p, const Ray& ray) {
    BoundingBox box{p, p};
    (ray.sign > 0 ? box.maximum : box.minimum)[ray.axis] =
        ray.sign * std::numeric_limits<double>::infinity();
    return box;
}

}  // namespace adaptiso
