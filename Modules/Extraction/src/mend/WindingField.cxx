#include "mend/WindingField.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adaptiso::detail {

double solidAnglePart(const Corners& triangle, const Vec3& p) {
    const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double y = dot(a, cross(b, c)),
                 x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return std::atan2(y, x) / (2 * std::numbers::pi);
}

WindingField::WindingField(const TriangleMesh& mesh, const AabbTree& tree)
    : mesh_(mesh), order_(tree.triangles().begin(), tree.triangles().end()) {
    nodes_.reserve(2 * order_.size() / kLeaf + 2);
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

std::uint32_t WindingField::build(std::uint32_t begin, std::uint32_t end) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    Node node;
    node.begin = begin;
    node.end = end;
    double area = 0;
    for (std::uint32_t n = begin; n < end; ++n) {
        const Corners c = cornersOf(mesh_, order_[n]);
        const Vec3 vector = 0.5 * areaVector2(c[0], c[1], c[2]);
        const double size = norm(vector);
        node.dipole += vector;
        node.middle += size / 3 * (c[0] + c[1] + c[2]);
        area += size;
    }
    node.middle = area > 0 ? 1 / area * node.middle : cornersOf(mesh_, order_[begin])[0];
    for (std::uint32_t n = begin; n < end; ++n) {
        for (const Vec3& corner : cornersOf(mesh_, order_[n])) {
            node.radius = std::max(node.radius, norm(corner - node.middle));
        }
    }
    if (end - begin > kLeaf) {
        const std::uint32_t half = begin + (end - begin + 1) / 2;
        build(begin, half);
        build(half, end);
    }
    node.skip = static_cast<std::uint32_t>(nodes_.size());
    nodes_[number] = node;
    return number;
}

double WindingField::at(const Vec3& p, std::int64_t without) const {
    constexpr double kFar = 2.5;  // radii
    double sum = 0;
    for (std::uint32_t n = 0; n < nodes_.size();) {
        const Node& node = nodes_[n];
        const Vec3 away = node.middle - p;
        const double squared = squaredNorm(away);
        if (squared > kFar * kFar * node.radius * node.radius) {
            sum += dot(away, node.dipole) / (squared * std::sqrt(squared) * 4 * std::numbers::pi);
            n = node.skip;
        } else if (node.skip == n + 1) {
            for (std::uint32_t i = node.begin; i < node.end; ++i) {
                if (order_[i] != without) sum += solidAnglePart(cornersOf(mesh_, order_[i]), p);
            }
            n = node.skip;
        } else {
            ++n;
        }
    }
    return sum;
}

}  // namespace adaptiso::detail
