#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "adaptiso/Core/BoundingBox.h"
#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// The point of the triangle a, b, c that lies nearest to `p`. Triangles without area are taken as
/// the segment or point that they are.
Vec3 closestPointOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// The nearest place of a surface.
struct ClosestPoint {
    std::int64_t triangle = -1;  ///< triangle number; -1: the surface is empty, or too far away
    double squaredDistanceMm2 = std::numeric_limits<double>::infinity();
    Vec3 pointMm;
};

/// Bounds what many searches cost together. A point that lies as far from thousands of triangles,
/// as the centre of a sphere, has all of them looked at.
struct SearchEffort {
    std::int64_t triangles;  ///< left to look at
    bool isRough = false;    ///< they were used up: the last distance may be a hundredth too large
    bool isOpen = false;     ///< twice as many were: it is of the nearest triangle looked at

    /// Of boxes that are nearer than the best by less, none is opened once the effort is used up.
    static constexpr double kRough = 0.99;
    /// More triangles that are looked at to know the distance to a hundredth. Where boxes do not
    /// tell triangles apart, as where all cross each other, these are not enough.
    static constexpr std::int64_t kMore = 384;

    void begin() { isRough = isOpen = false; }
    bool isUsedUp() const { return triangles <= 0; }
    /// Nothing more is looked at.
    bool ends() {
        isOpen = isOpen || triangles <= -kMore;
        return isOpen;
    }
};

/// A binary tree of axis-aligned boxes over the triangles of a mesh: finds the nearest triangle to
/// a point and the triangles near a box.
///
/// Triangles are halved by their centres along the longest side, down to leaves of up to four. The
/// nodes lie in one array in depth-first order; where children lie follows from counts alone, so a
/// node is nothing but its box. Triangles with a non-finite corner are left out.
/// Cost: O(T log T) to build, in parallel; 32 bytes a triangle, as much again while building.
/// Queries take O(log T + k) on surfaces. The same mesh gives the same tree and the same answers,
/// whatever the number of threads; queries may run in parallel.
class AabbTree {
public:
    /// Keeps a reference to `mesh`, which must outlive the tree and not change.
    /// \pre triangles name points that are there \throws InvalidInput otherwise
    explicit AabbTree(const TriangleMesh& mesh);
    explicit AabbTree(TriangleMesh&&) = delete;

    /// The nearest triangle to `p`, and where on it. Of triangles equally near one is chosen,
    /// always the same.
    /// \param hint  a triangle that is thought to be near, to save time; -1: none
    /// \param effort  shrinks by the triangles looked at; null: exact, whatever it takes
    /// \pre p is finite; hint < the number of triangles
    ClosestPoint closestPoint(const Vec3& p, std::int64_t hint = -1,
                              SearchEffort* effort = nullptr) const;

    /// Calls visit(triangle) for every triangle whose box overlaps `box`, always in the same order.
    /// The box is read at every step: visit() stops the search by emptying it.
    template <class Visit>
    void forEachOverlap(const BoundingBox& box, const Visit& visit) const;

    /// Calls visit(triangle) for every triangle that may lie within a distance of `box`, nearer
    /// ones first by and large: all triangles of the leaves whose boxes do. squaredReachMm2() gives
    /// the distance's square; it is asked at every box, so that it may shrink as the search goes
    /// on.
    template <class Reach, class Visit>
    void forEachNear(const BoundingBox& box, const Reach& squaredReachMm2,
                     const Visit& visit) const;

    /// The triangles of the tree in the order of its leaves: near ones follow each other.
    std::span<const std::int64_t> triangles() const { return order_; }

    /// Number of triangles in the tree.
    std::int64_t triangleCount() const { return static_cast<std::int64_t>(order_.size()); }

    BoundingBox triangleBox(std::int64_t triangle) const;

private:
    static constexpr std::int64_t kLeafTriangles = 4;

    using Subtree = HalvedLeaves;
    using Stack = HalvedLeaves::Stack;

    struct Item;
    void build(std::vector<Item>& items, const Subtree& subtree);
    Subtree root() const { return {0, 0, (triangleCount() + kLeafTriangles - 1) / kLeafTriangles}; }
    std::int64_t leafBegin(std::int64_t leaf) const { return leaf * kLeafTriangles; }
    std::int64_t leafEnd(std::int64_t leaf) const {
        const std::int64_t end = (leaf + 1) * kLeafTriangles;
        return end < triangleCount() ? end : triangleCount();
    }
    void improve(ClosestPoint& best, const Vec3& p, std::int64_t triangle) const;

    const TriangleMesh* mesh_;
    std::vector<std::int64_t> order_;  ///< triangle numbers, leaf after leaf
    std::vector<BoundingBox> boxes_;   ///< of every node
};

template <class Visit>
void AabbTree::forEachOverlap(const BoundingBox& box, const Visit& visit) const {
    if (order_.empty() || !box.overlaps(boxes_[0])) return;
    Stack stack;
    std::size_t depth = 0;
    stack[depth++] = root();
    const auto push = [&](const Subtree& subtree) {
        if (box.overlaps(boxes_[subtree.node])) stack[depth++] = subtree;
    };
    while (depth > 0) {
        const Subtree at = stack[--depth];
        if (at.isLeaf()) {
            for (std::int64_t n = leafBegin(at.firstLeaf); n < leafEnd(at.firstLeaf); ++n) {
                if (box.overlaps(triangleBox(order_[n]))) visit(order_[n]);
            }
            continue;
        }
        push(at.right());
        push(at.left());
    }
}

template <class Reach, class Visit>
void AabbTree::forEachNear(const BoundingBox& box, const Reach& squaredReachMm2,
                           const Visit& visit) const {
    if (order_.empty()) return;
    struct Candidate {
        Subtree subtree;
        double squaredDistanceMm2;
    };
    std::array<Candidate, std::tuple_size_v<Stack>> stack;
    std::size_t depth = 0;
    stack[depth++] = {root(), squaredDistance(box, boxes_[0])};
    while (depth > 0) {
        const Candidate at = stack[--depth];
        if (at.squaredDistanceMm2 > squaredReachMm2()) continue;
        if (at.subtree.isLeaf()) {
            const std::int64_t end = leafEnd(at.subtree.firstLeaf);
            for (std::int64_t n = leafBegin(at.subtree.firstLeaf); n < end; ++n) {
                visit(order_[n]);
            }
            continue;
        }
        const Subtree left = at.subtree.left(), right = at.subtree.right();
        Candidate nearer{left, squaredDistance(box, boxes_[left.node])};
        Candidate farther{right, squaredDistance(box, boxes_[right.node])};
        if (farther.squaredDistanceMm2 < nearer.squaredDistanceMm2) std::swap(nearer, farther);
        stack[depth++] = farther;
        stack[depth++] = nearer;
    }
}

}  // namespace adaptiso
