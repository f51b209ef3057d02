#include "adaptiso/Core/AabbTree.h"

#include <algorithm>
#include <string>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

int longestAxis(const BoundingBox& box) {
    const Vec3 size = box.size();
    if (size.x >= size.y && size.x >= size.z) return 0;
    return size.y >= size.z ? 1 : 2;
}

Vec3 closestPointOnSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double length2 = squaredNorm(b - a);
    if (!(length2 > 0)) return a;
    return a + std::clamp(dot(p - a, b - a) / length2, 0.0, 1.0) * (b - a);
}

Vec3 closestPointOnSides(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::array<Vec3, 3> candidates{closestPointOnSegment(p, a, b),
                                         closestPointOnSegment(p, b, c),
                                         closestPointOnSegment(p, c, a)};
    return *std::min_element(
        candidates.begin(), candidates.end(),
        [&](const Vec3& l, const Vec3& r) { return squaredNorm(p - l) < squaredNorm(p - r); });
}

}  // namespace

Vec3 closestPointOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    // Voronoi regions of corners, sides and face [Ericson2005, Real-Time Collision Detection,
    // section 5.1.5]. Flat triangles, where his quotients lose all digits, go by their sides: the
    // face bulges from them by less than 1e-10 of a side.
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    if (squaredNorm(cross(ab, ac)) <= 1e-20 * squaredNorm(ab) * squaredNorm(ac)) {
        return closestPointOnSides(p, a, b, c);
    }
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const Vec3 bp = p - b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const Vec3 cp = p - c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    }
    const double scale = 1 / (va + vb + vc);
    return a + vb * scale * ab + vc * scale * ac;
}

/// A triangle while the tree is built.
struct AabbTree::Item {
    Vec3 centre;
    std::int64_t triangle;
};

AabbTree::AabbTree(const TriangleMesh& mesh) : mesh_(&mesh) {
    const auto pointCount = static_cast<VertexId>(mesh.points.size());
    std::vector<Item> items;
    items.reserve(mesh.triangles.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const Triangle& t = mesh.triangles[n];
        for (const VertexId v : t) {
            if (v >= 0 && v < pointCount) continue;
            throw InvalidInput("AabbTree: triangle " + std::to_string(n) + " names vertex " +
                               std::to_string(v) + " of a mesh with " + std::to_string(pointCount) +
                               " points");
        }
        const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        if (!isFinite(a) || !isFinite(b) || !isFinite(c)) continue;
        items.push_back({1.0 / 3 * (a + b + c), static_cast<std::int64_t>(n)});
    }
    if (items.empty()) return;
    order_.resize(items.size());
    boxes_.resize(2 * root().leaves - 1);
    build(items, root());
}

void AabbTree::build(std::vector<Item>& items, const Subtree& subtree) {
    const std::int64_t begin = leafBegin(subtree.firstLeaf);
    const std::int64_t end = leafEnd(subtree.firstLeaf + subtree.leaves - 1);
    BoundingBox& box = boxes_[subtree.node] = BoundingBox::empty();
    if (subtree.isLeaf()) {
        // of triangles equally near the first is chosen, and libraries' nth_element() leave any
        // order
        std::sort(items.begin() + begin, items.begin() + end,
                  [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
        for (std::int64_t n = begin; n < end; ++n) {
            order_[n] = items[n].triangle;
            for (const VertexId v : mesh_->triangles[order_[n]]) box.add(mesh_->points[v]);
        }
        return;
    }
    BoundingBox centres = BoundingBox::empty();
    for (std::int64_t n = begin; n < end; ++n) centres.add(items[n].centre);
    const int axis = longestAxis(centres);
    const Subtree left = subtree.left(), right = subtree.right();
    std::nth_element(items.begin() + begin, items.begin() + leafBegin(right.firstLeaf),
                     items.begin() + end, [axis](const Item& a, const Item& b) {
                         return std::pair(a.centre[axis], a.triangle) <
                                std::pair(b.centre[axis], b.triangle);
                     });
    constexpr std::int64_t kParallelLeaves = 1024;  // below, a task costs more than it saves
    if (subtree.leaves >= kParallelLeaves) {
        parallelInvoke([&] { build(items, left); }, [&] { build(items, right); });
    } else {
        build(items, left);
        build(items, right);
    }
    for (const Subtree& half : {left, right}) {
        box.add(boxes_[half.node]);
    }
}

BoundingBox AabbTree::triangleBox(std::int64_t triangle) const {
    BoundingBox box = BoundingBox::empty();
    for (const VertexId v : mesh_->triangles[triangle]) box.add(mesh_->points[v]);
    return box;
}

void AabbTree::improve(ClosestPoint& best, const Vec3& p, std::int64_t triangle) const {
    const Triangle& t = mesh_->triangles[triangle];
    const Vec3 nearest =
        closestPointOnTriangle(p, mesh_->points[t[0]], mesh_->points[t[1]], mesh_->points[t[2]]);
    const double distance2 = squaredNorm(p - nearest);
    if (distance2 < best.squaredDistanceMm2) best = {triangle, distance2, nearest};
}

ClosestPoint AabbTree::closestPoint(const Vec3& p, std::int64_t hint, SearchEffort* effort) const {
    ClosestPoint best;
    if (effort != nullptr) effort->begin();
    if (order_.empty()) return best;
    if (hint >= 0) improve(best, p, hint);
    struct Candidate {
        Subtree subtree;
        double squaredDistanceMm2;
    };
    std::array<Candidate, std::tuple_size_v<Stack>> stack;
    std::size_t depth = 0;
    stack[depth++] = {root(), squaredDistance(p, boxes_[0])};
    while (depth > 0) {
        const Candidate at = stack[--depth];
        if (at.squaredDistanceMm2 >= best.squaredDistanceMm2) continue;
        if (effort != nullptr && effort->isUsedUp()) {
            if (effort->ends()) break;
            if (at.squaredDistanceMm2 >=
                SearchEffort::kRough * SearchEffort::kRough * best.squaredDistanceMm2) {
                effort->isRough = true;
                continue;
            }
        }
        if (at.subtree.isLeaf()) {
            if (effort != nullptr) effort->triangles -= kLeafTriangles;
            const std::int64_t end = leafEnd(at.subtree.firstLeaf);
            for (std::int64_t n = leafBegin(at.subtree.firstLeaf); n < end; ++n) {
                improve(best, p, order_[n]);
            }
            continue;
        }
        const Subtree left = at.subtree.left(), right = at.subtree.right();
        Candidate nearer{left, squaredDistance(p, boxes_[left.node])};
        Candidate farther{right, squaredDistance(p, boxes_[right.node])};
        if (farther.squaredDistanceMm2 < nearer.squaredDistanceMm2) std::swap(nearer, farther);
        stack[depth++] = farther;
        stack[depth++] = nearer;
    }
    return best;
}

}  // namespace adaptiso
