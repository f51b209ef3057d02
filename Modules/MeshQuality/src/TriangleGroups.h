#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso {

/// A tree over triangles that tells groups apart by planes of any direction, where boxes along the
/// axes all overlap: thousands of triangles around one vertex, bundles of needles, shells within
/// shells.
///
/// Groups are those of the vertices with a large share of all triangles, and of the other
/// triangles: the two sides of a rim in one group would have what lies between them in their hull.
/// They are halved along the direction in which their triangles' centres spread most compared
/// with the triangles' own size (Fisher's criterion). A plane lies between two groups if all points
/// of one are on its one side and all of the other on its other side; points at one or two
/// vertices of many triangles may lie in it, where triangles meet in no more than the vertex or
/// the edge. The plane is guessed by least squares and checked point by point.
/// Cost: O(T log T), 150 bytes a triangle. Same triangles, same groups, whatever the number of
/// threads.
class TriangleGroups {
public:
    /// \param leavesOutFlat  triangles with corners on a line are left out: they cross and meet
    ///                       nothing
    /// \pre the corners are finite
    explicit TriangleGroups(const TriangleView& of, bool leavesOutFlat = true);

    /// Limits that bound what findPairs() costs where most triangles are near most others.
    struct Budget {
        std::int64_t groups;  ///< that are near one group of 4 triangles, or one that holds it
        std::int64_t pairs;   ///< found, of one group of 4 triangles with others
        std::int64_t putOff;  ///< pairs of groups beyond `groups` that are looked at in the end
        std::int64_t tests;   ///< of two groups then

        /// In proportion to the triangles, and more where they are few.
        static Budget of(std::int64_t triangles);
    };
    struct Pairs {
        std::vector<std::array<std::uint32_t, 2>> pairs;
        /// Triangles of groups that are near more than the budget allows, ascending: what they meet
        /// is not all known. Of the second mesh, where there are two.
        std::vector<std::uint32_t> undecided, otherUndecided;
        std::int64_t tests = 0;  ///< of two triangles
    };

    /// The pairs for which meets(a, b) holds, a < b, in an order that is always the same.
    /// \param meets  is asked for pairs whose boxes overlap, but for pairs that share no more than
    ///               corners or an edge; from any thread
    Pairs findPairs(const std::function<bool(std::uint32_t, std::uint32_t)>& meets) const;

    /// The same between the triangles of two meshes: a of this one, b of the other.
    /// \param reachMm  how near they may come
    /// \param meets    is asked for all pairs that come as near; with 0, have a point in common
    Pairs findPairs(const TriangleGroups& other, double reachMm,
                    const std::function<bool(std::uint32_t, std::uint32_t)>& meets) const;

    /// Boxes along each group's own axes.
    class Boxes {
    public:
        /// Keeps a reference to the groups. Cost: O(T log T), 60 bytes a triangle.
        explicit Boxes(const TriangleGroups& groups);

        /// As AabbTree::closestPoint(); the triangle is a number of the view.
        ClosestPoint closestPoint(const Vec3& p, const ClosestPoint& first,
                                  SearchEffort& effort) const;

    private:
        struct Box {
            Vec3 middle;
            std::array<Vec3, 3> axes;
            Vec3 half;
        };
        void measure(const HalvedLeaves& group);
        double squaredDistance(const Vec3& p, const HalvedLeaves& group) const;

        const TriangleGroups& groups_;
        std::vector<Box> boxes_;
    };

private:
    using Subtree = HalvedLeaves;
    static constexpr std::int64_t kLeafTriangles = 4;
    static constexpr std::size_t kMostHubs = 4;
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;

    struct Symmetric {
        double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

        void add(const Vec3& v, double weight);
        double trace() const { return xx + yy + zz; }
    };
    class Inverse;
    struct Node {
        BoundingBox box;    ///< of all corners but the hubs below
        Vec3 mean;          ///< of all corners
        Symmetric moments;  ///< sums of their squared distances from the mean
        double count = 0;   ///< of corners
        std::array<std::uint32_t, kMostHubs> hubs{kNone, kNone, kNone, kNone};  ///< ascending

        bool hasHub(std::uint32_t hub) const {
            return std::find(hubs.begin(), hubs.end(), hub) != hubs.end();
        }
    };
    /// Heights of points along a direction of any length.
    struct Heights {
        Vec3 along, origin{};
        std::span<const Vec3> places{};                            ///< whose points are left out
        double enough = -std::numeric_limits<double>::infinity();  ///< no lower point is looked for
        double gap = 0;                                            ///< that rounding may hide

        double of(const Vec3& p) const { return dot(along, p - origin); }
        double lowestOf(const BoundingBox& box) const {
            return of({along.x > 0 ? box.minimum.x : box.maximum.x,
                       along.y > 0 ? box.minimum.y : box.maximum.y,
                       along.z > 0 ? box.minimum.z : box.maximum.z});
        }
        bool leavesOut(const Vec3& p) const {
            return std::find(places.begin(), places.end(), p) != places.end();
        }
    };
    struct Point {
        Vec3 place;
        double height = std::numeric_limits<double>::infinity();
    };
    struct Item {
        double key;
        std::uint32_t hub;  ///< a large one at a corner; kNone
        std::uint32_t triangle;
    };
    struct Search;

    Subtree root() const { return {0, 0, leafCount()}; }
    std::int64_t leafCount() const {
        return (std::ssize(order_) + kLeafTriangles - 1) / kLeafTriangles;
    }
    std::int64_t begin(const Subtree& group) const { return group.firstLeaf * kLeafTriangles; }
    std::int64_t end(const Subtree& group) const {
        return std::min<std::int64_t>((group.firstLeaf + group.leaves) * kLeafTriangles,
                                      std::ssize(order_));
    }
    BoundingBox wholeBoxOf(const Node& node) const;
    std::span<const Vec3> pointsOf(const Subtree& group) const;

    void findHubs(const TriangleView& of);
    Vec3 splitDirection(const TriangleView& of, std::span<const Item> items) const;
    void order(const TriangleView& of, std::vector<Item>& items, const Subtree& group);
    void measure(const TriangleView& of, const Subtree& group);
    double leastHeight(const Subtree& group, const Heights& over) const;
    void findLowest(const Subtree& group, const Heights& over, Point& lowest) const;
    static bool areHullsFarther(const TriangleGroups& a, const Subtree& i, const TriangleGroups& b,
                                const Subtree& j, double reach);
    static bool areApart(const TriangleGroups& a, const Subtree& i, const TriangleGroups& b,
                         const Subtree& j, double reachMm);

    std::vector<std::uint32_t> order_;  ///< triangles, leaf after leaf
    std::vector<Corners> corners_;      ///< theirs
    std::vector<Node> nodes_;
    std::vector<Vec3> hubs_;             ///< places of vertices of many triangles
    std::vector<std::uint32_t> hubOf_;   ///< of each point while the tree is made
    std::vector<std::uint8_t> isLarge_;  ///< of each hub, likewise
    double gap_ = 0;                     ///< distance that rounding may hide
};

}  // namespace adaptiso
