#include "adaptiso/MeshQuality/TriangleTree.h"

#include <cmath>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr float kInfiniteFloat = std::numeric_limits<float>::infinity();

/// The largest numbers stand for those that are larger.
float nearest(double x) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(x, -kLargest, kLargest));
}
float atMost(double x) {
    const float rounded = nearest(x);
    return rounded > x ? std::nextafter(rounded, -kInfiniteFloat) : rounded;
}
float atLeast(double x) {
    const float rounded = nearest(x);
    return rounded < x ? std::nextafter(rounded, kInfiniteFloat) : rounded;
}

}  // namespace

BoundingBox TriangleView::box() const {
    auto box = BoundingBox::empty();
    for (const Vec3& p : points) {
        if (std::isfinite(p.x + p.y + p.z)) box.add(p);
    }
    return box;
}

TriangleTree::Box TriangleTree::Box::around(const BoundingBox& exact) {
    return {{atMost(exact.minimum.x), atMost(exact.minimum.y), atMost(exact.minimum.z)},
            {atLeast(exact.maximum.x), atLeast(exact.maximum.y), atLeast(exact.maximum.z)}};
}

TriangleTree::TriangleTree(const TriangleView& of) {
    if (of.triangles.empty()) return;
    order_ = inMortonOrder(of.triangles.size(), of.box(), [&](std::uint32_t t) {
        const Corners c = of.cornersOf(t);
        return (1.0 / 3) * (c[0] + c[1] + c[2]);
    });
    assignInHugePages(boxes_, static_cast<std::size_t>(2 * leafCount() - 1));
    build({0, 0, leafCount()}, of);
}

/// The boxes of a node and of those below it.
void TriangleTree::build(const Subtree& subtree, const TriangleView& of) {
    Box& box = boxes_[subtree.node];
    if (subtree.isLeaf()) {
        const auto triangles = leaf(subtree.firstLeaf);
        BoundingBox exact = boxOf(of.cornersOf(triangles[0]));
        for (const std::uint32_t t : triangles) {
            for (const Vec3& p : of.cornersOf(t)) exact.add(p);
        }
        box = Box::around(exact);
        return;
    }
    const Subtree left = subtree.left(), right = subtree.right();
    constexpr std::int64_t kParallelLeaves = 512;  // below, a task costs more than it saves
    if (subtree.leaves >= kParallelLeaves) {
        parallelInvoke([&] { build(left, of); }, [&] { build(right, of); });
    } else {
        build(left, of);
        build(right, of);
    }
    box = boxes_[left.node];
    box.add(boxes_[right.node]);
}

TriangleTree::Pairs::Pairs(const TriangleTree& tree, const TriangleView& of) : tree_(tree) {
    assignInHugePages(leaves_, static_cast<std::size_t>(tree.leafCount()));
    constexpr std::int64_t kPiece = 1 << 13;
    parallelForPieces(tree.leafCount(), kPiece / kLeafTriangles,
                      [&](std::int64_t begin, std::int64_t end) {
                          for (std::int64_t number = begin; number < end; ++number) {
                              const auto triangles = tree.leaf(number);
                              for (std::size_t i = 0; i < triangles.size(); ++i) {
                                  leaves_[number].set(i, boxAround(of, triangles[i]));
                              }
                          }
                      });
}

// not inline: so GCC takes four at once
unsigned TriangleTree::Pairs::LeafBoxes::overlapping(const Box& o) const {
    std::array<std::int32_t, kLeafTriangles> overlaps;
    for (std::size_t i = 0; i < kLeafTriangles; ++i) {
        // int: Clang warns of & between bools
        overlaps[i] = int{low[0][i] <= o.high[0]} & (o.low[0] <= high[0][i]) &
                      (low[1][i] <= o.high[1]) & (o.low[1] <= high[1][i]) &
                      (low[2][i] <= o.high[2]) & (o.low[2] <= high[2][i]);
    }
    unsigned bits = 0;
    for (std::size_t i = 0; i < kLeafTriangles; ++i) {
        bits |= static_cast<unsigned>(overlaps[i]) << i;
    }
    return bits;
}

const TriangleTree& TreeOnDemand::get() {
    std::call_once(isMade_, [&] {
        // while it waits for its own tasks a thread must not take one that needs the tree
        isolated([&] { tree_ = TriangleTree(of_); });
    });
    return tree_;
}

double TriangleTree::squaredDistance(const Vec3& p, const TriangleView& of, double most) const {
    double best = most;
    if (order_.empty()) return best;
    const auto squaredTo = [&](const Subtree& subtree) {
        const Box& box = boxes_[subtree.node];
        double sum = 0;
        for (int a = 0; a < 3; ++a) {
            const double beyond =
                std::max({double{box.low[a]} - p[a], 0.0, p[a] - double{box.high[a]}});
            sum += beyond * beyond;
        }
        return sum;
    };
    struct Candidate {
        Subtree subtree;
        double squared;
    };
    std::array<Candidate, std::tuple_size_v<Stack>> stack;
    std::size_t depth = 0;
    stack[depth++] = {{0, 0, leafCount()}, 0};
    while (depth > 0) {
        const Candidate at = stack[--depth];
        if (at.squared >= best) continue;
        if (at.subtree.isLeaf()) {
            for (const std::uint32_t t : leaf(at.subtree.firstLeaf)) {
                const Corners c = of.cornersOf(t);
                if (adaptiso::squaredDistance(p, boxOf(c)) >= best) continue;
                best = std::min(best, squaredNorm(p - closestPointOnTriangle(p, c[0], c[1], c[2])));
            }
            continue;
        }
        const Subtree left = at.subtree.left(), right = at.subtree.right();
        Candidate nearer{left, squaredTo(left)}, farther{right, squaredTo(right)};
        if (farther.squared < nearer.squared) std::swap(nearer, farther);
        stack[depth++] = farther;
        stack[depth++] = nearer;
    }
    return best;
}

}  // namespace adaptiso
