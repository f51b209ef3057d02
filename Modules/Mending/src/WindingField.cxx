#include "WindingField.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adaptiso::detail {
namespace {

/// The angle of (x, y), radians, to some 1e-14, by arithmetic that every processor rounds alike.
double angleOf(double y, double x) {
    const double ax = std::abs(x), ay = std::abs(y);
    if (ax == 0 && ay == 0) return 0;
    double t = ay <= ax ? ay / ax : ax / ay;
    for (int n = 0; n < 2; ++n) t /= 1 + std::sqrt(1 + t * t);  // halves the angle, to pi / 16
    const double square = t * t;
    double series = 1.0 / 17;
    for (int n = 15; n > 0; n -= 2) series = 1.0 / n - square * series;
    double angle = 4 * t * series;
    if (ay > ax) angle = std::numbers::pi / 2 - angle;
    if (x < 0) angle = std::numbers::pi - angle;
    return y < 0 ? -angle : angle;
}

/// The solid angle of a triangle seen from a point, as a part of the whole sphere.
double solidAnglePart(const Corners& triangle, const Vec3& p) {
    const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double y = dot(a, cross(b, c)),
                 x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return angleOf(y, x) / (2 * std::numbers::pi);
}

}  // namespace

WindingField::WindingField(const TriangleMesh& mesh, const AabbTree& tree)
    : mesh_(mesh), order_(tree.triangles().begin(), tree.triangles().end()) {
    const std::int64_t leaves = (std::ssize(order_) + kLeafTriangles - 1) / kLeafTriangles;
    nodes_.resize(std::max<std::int64_t>(2 * leaves - 1, 0));
    if (leaves > 0) build({0, 0, leaves});
}

void WindingField::build(const HalvedLeaves& subtree) {
    Node& node = nodes_[subtree.node];
    node.begin = subtree.firstLeaf * kLeafTriangles;
    node.end = std::min<std::int64_t>((subtree.firstLeaf + subtree.leaves) * kLeafTriangles,
                                      std::ssize(order_));
    node.behind = subtree.node + 2 * subtree.leaves - 1;
    double area = 0;
    for (std::int64_t n = node.begin; n < node.end; ++n) {
        const Corners c = cornersOf(mesh_, order_[n]);
        const Vec3 vector = 0.5 * areaVector2(c[0], c[1], c[2]);
        const double size = norm(vector);
        node.dipole += vector;
        node.middle += size / 3 * (c[0] + c[1] + c[2]);
        area += size;
    }
    node.middle = area > 0 ? 1 / area * node.middle : cornersOf(mesh_, order_[node.begin])[0];
    double squared = 0;
    for (std::int64_t n = node.begin; n < node.end; ++n) {
        for (const Vec3& corner : cornersOf(mesh_, order_[n])) {
            squared = std::max(squared, squaredNorm(corner - node.middle));
        }
    }
    node.radius = std::sqrt(squared);
    if (subtree.isLeaf()) return;
    build(subtree.left());
    build(subtree.right());
}

double WindingField::at(const Vec3& p, std::int64_t without, double far) const {
    double sum = 0;
    for (std::int64_t n = 0; n < std::ssize(nodes_);) {
        const Node& node = nodes_[n];
        const Vec3 away = node.middle - p;
        const double squared = squaredNorm(away);
        if (squared > far * far * node.radius * node.radius) {
            sum += dot(away, node.dipole) / (squared * std::sqrt(squared) * 4 * std::numbers::pi);
            n = node.behind;
        } else if (node.behind > n + 1) {
            ++n;
        } else {
            for (std::int64_t i = node.begin; i < node.end; ++i) {
                if (order_[i] != without) sum += solidAnglePart(cornersOf(mesh_, order_[i]), p);
            }
            n = node.behind;
        }
    }
    return sum;
}

}  // namespace adaptiso::detail
