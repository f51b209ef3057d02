#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Triangles by 32-bit numbers, and their points: half the memory of a TriangleMesh.
struct TriangleView {
    using Triangle = std::array<std::uint32_t, 3>;

    std::span<const Vec3> points;
    std::span<const Triangle> triangles;

    Corners cornersOf(std::size_t t) const {
        const Triangle& c = triangles[t];
        return {points[c[0]], points[c[1]], points[c[2]]};
    }
    /// Around all points that are finite, used or not.
    BoundingBox box() const;
};

/// A tree of boxes over triangles, as AabbTree, in a third of its memory: 10 bytes a triangle, 16
/// more while it is made. Boxes are in single precision, rounded outward. It keeps no reference to
/// what it is made of: queries are given the same triangles again.
///
/// The same triangles give the same tree and the same answers, whatever the number of threads.
class TriangleTree {
public:
    TriangleTree() = default;
    /// \pre all corners are finite
    explicit TriangleTree(const TriangleView& of);

    std::int64_t leafCount() const {
        return (std::ssize(order_) + kLeafTriangles - 1) / kLeafTriangles;
    }

    /// Distance to the nearest triangle, or `most` if all are farther.
    double squaredDistance(const Vec3& p, const TriangleView& of,
                           double most = std::numeric_limits<double>::infinity()) const;

    /// Calls visit(triangle) for every triangle whose box overlaps `box`, in an order that is
    /// always the same.
    template <class Visit>
    void forEachOverlap(const BoundingBox& box, const TriangleView& of, const Visit& visit) const;

    class Pairs;

private:
    static constexpr std::int64_t kLeafTriangles = 8;

    struct Box {
        std::array<float, 3> low, high;

        static Box around(const BoundingBox& exact);
        bool overlaps(const Box& o) const {
            // no branches: most boxes near each other differ along one axis, now this, now that
            int count = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                count += int{low[a] <= o.high[a]} + int{o.low[a] <= high[a]};
            }
            return count == 6;
        }
        void add(const Box& o) {
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], o.low[a]);
                high[a] = std::max(high[a], o.high[a]);
            }
        }
    };
    using Subtree = HalvedLeaves;
    using Stack = HalvedLeaves::Stack;

    std::span<const std::uint32_t> leaf(std::int64_t number) const {
        const std::int64_t begin = number * kLeafTriangles;
        return std::span(order_).subspan(begin,
                                         std::min(kLeafTriangles, std::ssize(order_) - begin));
    }
    static Box boxAround(const TriangleView& of, std::uint32_t t) {
        return Box::around(boxOf(of.cornersOf(t)));
    }
    void build(const Subtree& subtree, const TriangleView& of);
    /// Calls f(leaf, box of the node) for leaves from one on that overlap a box.
    template <class F>
    void forEachLeaf(const Box& box, std::int64_t first, const F& f) const;

    std::vector<std::uint32_t> order_;  ///< triangles, leaf after leaf
    std::vector<Box> boxes_;            ///< of every node
};

template <class F>
void TriangleTree::forEachLeaf(const Box& box, std::int64_t first, const F& f) const {
    Stack stack;
    std::size_t depth = 0;
    const auto push = [&](const Subtree& subtree) {
        const bool isWanted = subtree.firstLeaf + subtree.leaves > first;
        if (isWanted && box.overlaps(boxes_[subtree.node])) stack[depth++] = subtree;
    };
    if (!order_.empty()) push({0, 0, leafCount()});
    while (depth > 0) {
        const Subtree at = stack[--depth];
        if (at.isLeaf()) {
            f(at.firstLeaf, boxes_[at.node]);
        } else {
            push(at.right());
            push(at.left());
        }
    }
}

template <class Visit>
void TriangleTree::forEachOverlap(const BoundingBox& box, const TriangleView& of,
                                  const Visit& visit) const {
    const Box rounded = Box::around(box);
    forEachLeaf(rounded, 0, [&](std::int64_t number, const Box&) {
        for (const std::uint32_t t : leaf(number)) {
            if (boxOf(of.cornersOf(t)).overlaps(box)) visit(t);
        }
    });
}

/// A tree that is made when it is first asked for, by whichever thread.
class TreeOnDemand {
public:
    explicit TreeOnDemand(const TriangleView& of) : of_(of) {}
    const TriangleTree& get();

private:
    TriangleView of_;
    std::once_flag isMade_;
    TriangleTree tree_;
};

/// Finds the pairs of triangles whose boxes, rounded outward, overlap. Keeps a reference to the
/// tree, and 24 bytes a triangle.
class TriangleTree::Pairs {
public:
    Pairs(const TriangleTree& tree, const TriangleView& of);

    /// Calls visit(a, b), a < b, for the pairs of which the triangle that comes first by order of
    /// leaves lies in one of the leaves [begin, end): all leaves give each pair once.
    /// \param most  pairs of leaves to look up, and of triangles to visit
    /// \return  false: there were more, and not all pairs are visited
    template <class Visit>
    bool forEach(std::int64_t begin, std::int64_t end, std::int64_t most, const Visit& visit) const;

private:
    template <class Visit>
    void forEachIn(std::int64_t number, const Visit& visit) const;
    template <class Visit>
    void forEachBetween(std::int64_t number, const Box& own, std::int64_t other, const Box& box,
                        const Visit& visit) const;
    template <class Visit>
    static void tell(std::uint32_t a, std::uint32_t b, const Visit& visit) {
        visit(std::min(a, b), std::max(a, b));
    }

    /// The boxes of a leaf's triangles, coordinate by coordinate: the compiler takes several at
    /// once. Those of places without a triangle overlap nothing.
    struct LeafBoxes {
        using Coordinates = std::array<float, kLeafTriangles>;
        std::array<Coordinates, 3> low, high;

        LeafBoxes() {
            for (Coordinates& along : low) along.fill(std::numeric_limits<float>::infinity());
            for (Coordinates& along : high) along.fill(-std::numeric_limits<float>::infinity());
        }
        void set(std::size_t i, const Box& box) {
            for (std::size_t a = 0; a < 3; ++a) {
                low[a][i] = box.low[a];
                high[a][i] = box.high[a];
            }
        }
        Box at(std::size_t i) const {
            return {{low[0][i], low[1][i], low[2][i]}, {high[0][i], high[1][i], high[2][i]}};
        }
        Box all() const {
            Box box = at(0);
            for (std::size_t i = 1; i < kLeafTriangles; ++i) box.add(at(i));
            return box;
        }
        /// A bit for each that overlaps a box.
        unsigned overlapping(const Box& o) const;
    };
    /// Calls f(place) for each bit.
    template <class F>
    static void forEachBit(unsigned bits, const F& f) {
        for (; bits != 0; bits &= bits - 1) f(static_cast<std::size_t>(std::countr_zero(bits)));
    }

    const TriangleTree& tree_;
    std::vector<LeafBoxes> leaves_;
};

template <class Visit>
bool TriangleTree::Pairs::forEach(std::int64_t begin, std::int64_t end, std::int64_t most,
                                  const Visit& visit) const {
    std::int64_t leaves = 0, pairs = 0;
    const auto visitNext = [&](std::uint32_t a, std::uint32_t b) {
        ++pairs;
        visit(a, b);
    };
    // leaves that come one after the other are near the same ones: these are looked up together
    constexpr std::int64_t kTogether = 8;
    std::vector<std::pair<std::int64_t, Box>> near;
    for (std::int64_t first = begin; first < end; first += kTogether) {
        const std::int64_t last = std::min(end, first + kTogether);
        Box all = leaves_[first].all();
        for (std::int64_t number = first + 1; number < last; ++number)
            all.add(leaves_[number].all());
        near.clear();
        tree_.forEachLeaf(all, first + 1, [&](std::int64_t other, const Box& box) {
            near.emplace_back(other, box);
        });
        leaves += std::ssize(near);
        if (leaves > most) return false;
        for (std::int64_t number = first; number < last; ++number) {
            forEachIn(number, visitNext);
            const Box own = leaves_[number].all();
            for (const auto& [other, box] : near) {
                if (other <= number || !box.overlaps(own)) continue;
                forEachBetween(number, own, other, box, visitNext);
                if (pairs > most) return false;
            }
        }
    }
    return pairs <= most;
}

/// Pairs within a leaf.
template <class Visit>
void TriangleTree::Pairs::forEachIn(std::int64_t number, const Visit& visit) const {
    const auto triangles = tree_.leaf(number);
    const LeafBoxes& boxes = leaves_[number];
    for (std::size_t i = 1; i < triangles.size(); ++i) {
        forEachBit(boxes.overlapping(boxes.at(i)) & ((1U << i) - 1),
                   [&](std::size_t j) { tell(triangles[i], triangles[j], visit); });
    }
}

/// Pairs of a triangle of a leaf and one of another.
/// \param own, box  around the leaves
template <class Visit>
void TriangleTree::Pairs::forEachBetween(std::int64_t number, const Box& own, std::int64_t other,
                                         const Box& box, const Visit& visit) const {
    const auto triangles = tree_.leaf(number), others = tree_.leaf(other);
    const LeafBoxes &boxes = leaves_[number], &theirs = leaves_[other];
    const unsigned near = boxes.overlapping(box);
    if (near == 0) return;
    forEachBit(theirs.overlapping(own), [&](std::size_t t) {
        forEachBit(near & boxes.overlapping(theirs.at(t)),
                   [&](std::size_t i) { tell(triangles[i], others[t], visit); });
    });
}

}  // namespace adaptiso
