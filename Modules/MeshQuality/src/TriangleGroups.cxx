#include "TriangleGroups.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "Triangles.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/ParallelSort.h"

namespace adaptiso {

void TriangleGroups::Symmetric::add(const Vec3& v, double weight) {
    xx += weight * v.x * v.x;
    xy += weight * v.x * v.y;
    xz += weight * v.x * v.z;
    yy += weight * v.y * v.y;
    yz += weight * v.y * v.z;
    zz += weight * v.z * v.z;
}

/// Of a matrix that is symmetric and made positive by a little of the unit matrix, by Cholesky's
/// factors: directions in which points hardly spread keep their digits.
class TriangleGroups::Inverse {
public:
    Inverse(const Symmetric& of, double ridge) {
        constexpr double kTiny = 1e-300;  // the largest roots still have an inverse
        const double more = ridge * of.trace() + kTiny;
        const auto root = [&](double square) { return std::sqrt(std::max(square, more)); };
        xx_ = root(of.xx + more);
        xy_ = of.xy / xx_;
        xz_ = of.xz / xx_;
        yy_ = root(of.yy + more - xy_ * xy_);
        yz_ = (of.yz - xz_ * xy_) / yy_;
        zz_ = root(of.zz + more - xz_ * xz_ - yz_ * yz_);
    }

    Vec3 operator*(const Vec3& v) const {
        Vec3 s;
        s.x = v.x / xx_;
        s.y = (v.y - xy_ * s.x) / yy_;
        s.z = (v.z - xz_ * s.x - yz_ * s.y) / zz_;
        s.z /= zz_;
        s.y = (s.y - yz_ * s.z) / yy_;
        s.x = (s.x - xy_ * s.y - xz_ * s.z) / xx_;
        return s;
    }

private:
    double xx_, xy_, xz_, yy_, yz_, zz_;  ///< the lower triangle
};

namespace {

Vec3 centreOf(const Corners& c) {
    return 1.0 / 3 * (c[0] + c[1] + c[2]);
}

}  // namespace

TriangleGroups::Budget TriangleGroups::Budget::of(std::int64_t triangles) {
    constexpr std::int64_t kGroups = 64, kPairs = 32;  // near each group of triangles
    constexpr std::int64_t kAllGroups = 1 << 18, kAllPairs = 1 << 22;  // near all of few groups
    constexpr std::int64_t kFewPut = 1 << 14, kTests = 16;
    const std::int64_t groups = triangles / kLeafTriangles + 1;
    return {std::max(kGroups, kAllGroups / groups), std::max(kPairs, kAllPairs / groups),
            kFewPut + groups, kAllGroups + kTests * groups};
}

BoundingBox TriangleGroups::wholeBoxOf(const Node& node) const {
    BoundingBox box = node.box;
    for (const std::uint32_t hub : node.hubs) {
        if (hub == kNone) break;
        box.add(hubs_[hub]);
    }
    return box;
}

std::span<const Vec3> TriangleGroups::pointsOf(const Subtree& group) const {
    static_assert(sizeof(Corners) == 3 * sizeof(Vec3));
    return {corners_[begin(group)].data(),
            static_cast<std::size_t>(3 * (end(group) - begin(group)))};
}

TriangleGroups::TriangleGroups(const TriangleView& of, bool leavesOutFlat) {
    std::vector<Item> items;
    for (std::uint32_t t = 0; t < of.triangles.size(); ++t) {
        if (!leavesOutFlat || axisWithArea(of.cornersOf(t)) >= 0) items.push_back({0, kNone, t});
    }
    if (items.empty()) return;
    const BoundingBox box = of.box();
    gap_ = 1e-13 * (norm(box.maximum) + norm(box.minimum));
    findHubs(of);
    order_.resize(items.size());
    corners_.resize(items.size());
    nodes_.resize(static_cast<std::size_t>(2 * leafCount() - 1));
    for (Item& item : items) {
        for (const std::uint32_t v : of.triangles[item.triangle]) {
            const std::uint32_t hub = hubOf_[v];
            if (hub != kNone && isLarge_[hub] != 0) item.hub = std::min(item.hub, hub);
        }
    }
    order(of, items, root());
    measure(of, root());
    hubOf_ = {};
    isLarge_ = {};
}

/// Places of more triangles than a surface has at most of its vertices.
void TriangleGroups::findHubs(const TriangleView& of) {
    constexpr std::int64_t kMany = 16, kLargeShare = 16;
    std::vector<std::uint32_t> places(of.points.size());
    std::iota(places.begin(), places.end(), 0U);
    std::erase_if(places, [&](std::uint32_t v) {
        return !std::isfinite(of.points[v].x + of.points[v].y + of.points[v].z);
    });
    const auto placeOf = [&](std::uint32_t v) {
        const Vec3& p = of.points[v];
        return std::tie(p.x, p.y, p.z);
    };
    parallelSort(places, [&](std::uint32_t a, std::uint32_t b) {
        const auto l = placeOf(a), r = placeOf(b);
        return l != r ? l < r : a < b;
    });
    std::vector<std::uint32_t> triangles(of.points.size());
    for (const auto& t : of.triangles) {
        for (const std::uint32_t v : t) ++triangles[v];
    }
    hubOf_.assign(of.points.size(), kNone);
    for (std::size_t i = 0, end = 0; i < places.size(); i = end) {
        std::int64_t count = 0;
        for (end = i; end < places.size() && placeOf(places[end]) == placeOf(places[i]); ++end) {
            count += triangles[places[end]];
        }
        if (count <= kMany) continue;
        for (std::size_t n = i; n < end; ++n) {
            hubOf_[places[n]] = static_cast<std::uint32_t>(hubs_.size());
        }
        hubs_.push_back(of.points[places[i]]);
        isLarge_.push_back(kLargeShare * count >= std::ssize(of.triangles) ? 1 : 0);
    }
}

/// Along which the centres spread most compared with the triangles; some of many tell.
Vec3 TriangleGroups::splitDirection(const TriangleView& of, std::span<const Item> items) const {
    constexpr std::size_t kSome = 256;
    constexpr int kSteps = 12;
    constexpr double kRidge = 1e-6;  // less, and flat triangles are split across their plane
    const std::size_t step = std::max<std::size_t>(1, items.size() / kSome);
    Vec3 mean;
    double count = 0;
    const Vec3 origin = centreOf(of.cornersOf(items[0].triangle));
    for (std::size_t i = 0; i < items.size(); i += step, ++count) {
        mean += centreOf(of.cornersOf(items[i].triangle)) - origin;
    }
    mean = origin + 1 / count * mean;
    Symmetric spread, size;
    for (std::size_t i = 0; i < items.size(); i += step) {
        const Corners corners = of.cornersOf(items[i].triangle);
        const Vec3 centre = centreOf(corners);
        spread.add(centre - mean, 1);
        for (const Vec3& p : corners) size.add(p - centre, 1);
    }
    const Inverse inverse(size, kRidge);
    Vec3 direction{spread.xx + spread.xy + spread.xz, spread.xy + spread.yy + spread.yz,
                   spread.xz + spread.yz + spread.zz};
    if (spread.xx >= spread.yy && spread.xx >= spread.zz) direction.x += spread.xx;
    if (!(squaredNorm(direction) > 0)) direction = {1, 0, 0};
    for (int n = 0; n < kSteps; ++n) {  // power iteration
        const Vec3 next =
            inverse *
            Vec3{spread.xx * direction.x + spread.xy * direction.y + spread.xz * direction.z,
                 spread.xy * direction.x + spread.yy * direction.y + spread.yz * direction.z,
                 spread.xz * direction.x + spread.yz * direction.y + spread.zz * direction.z};
        const double length = norm(next);
        if (!(length > 0) || !std::isfinite(length)) break;
        direction = 1 / length * next;
    }
    return direction;
}

void TriangleGroups::order(const TriangleView& of, std::vector<Item>& items, const Subtree& group) {
    const auto begin = items.begin() + this->begin(group), end = items.begin() + this->end(group);
    if (group.isLeaf()) {
        std::sort(begin, end, [](const Item& a, const Item& b) { return a.triangle < b.triangle; });
        for (auto item = begin; item != end; ++item) {
            order_[item - items.begin()] = item->triangle;
            corners_[item - items.begin()] = of.cornersOf(item->triangle);
        }
        return;
    }
    const Subtree left = group.left(), right = group.right();
    const Vec3 direction = splitDirection(of, {&*begin, static_cast<std::size_t>(end - begin)});
    for (auto item = begin; item != end; ++item) {
        item->key = dot(direction, centreOf(of.cornersOf(item->triangle)));
    }
    std::nth_element(
        begin, items.begin() + this->begin(right), end, [](const Item& a, const Item& b) {
            return std::tie(a.hub, a.key, a.triangle) < std::tie(b.hub, b.key, b.triangle);
        });
    constexpr std::int64_t kParallelLeaves = 512;  // below, a task costs more than it saves
    if (group.leaves >= kParallelLeaves) {
        parallelInvoke([&] { order(of, items, left); }, [&] { order(of, items, right); });
    } else {
        order(of, items, left);
        order(of, items, right);
    }
}

void TriangleGroups::measure(const TriangleView& of, const Subtree& group) {
    Node& node = nodes_[group.node];
    node.box = BoundingBox::empty();
    const auto addHub = [&](std::uint32_t hub) {
        if (hub == kNone || node.hasHub(hub)) return;
        if (node.hubs.back() != kNone) return;
        node.hubs.back() = hub;
        std::sort(node.hubs.begin(), node.hubs.end());
    };
    if (group.isLeaf()) {
        const std::span<const Vec3> points = pointsOf(group);
        for (const Vec3& p : points) node.mean += p - points[0];
        node.count = static_cast<double>(points.size());
        node.mean = points[0] + 1 / node.count * node.mean;
        for (const Vec3& p : points) node.moments.add(p - node.mean, 1);
        for (std::int64_t n = begin(group); n < end(group); ++n) {
            for (const std::uint32_t v : of.triangles[order_[n]]) addHub(hubOf_[v]);
        }
        for (std::int64_t n = begin(group); n < end(group); ++n) {
            for (const std::uint32_t v : of.triangles[order_[n]]) {
                if (hubOf_[v] == kNone || !node.hasHub(hubOf_[v])) node.box.add(of.points[v]);
            }
        }
        return;
    }
    const std::array<Subtree, 2> halves{group.left(), group.right()};
    constexpr std::int64_t kParallelLeaves = 512;
    if (group.leaves >= kParallelLeaves) {
        parallelInvoke([&] { measure(of, halves[0]); }, [&] { measure(of, halves[1]); });
    } else {
        for (const Subtree& half : halves) measure(of, half);
    }
    for (const Subtree& half : halves) node.count += nodes_[half.node].count;
    const Node& first = nodes_[halves[0].node];
    for (const Subtree& half : halves) {
        const Node& part = nodes_[half.node];
        node.box.add(part.box);
        node.mean += part.count / node.count * (part.mean - first.mean);
        for (const std::uint32_t hub : part.hubs) addHub(hub);
    }
    for (const Subtree& half : halves) {
        for (const std::uint32_t hub : nodes_[half.node].hubs) {
            if (hub != kNone && !node.hasHub(hub)) node.box.add(hubs_[hub]);
        }
    }
    node.mean += first.mean;
    for (const Subtree& half : halves) {
        const Node& part = nodes_[half.node];
        node.moments.xx += part.moments.xx;
        node.moments.xy += part.moments.xy;
        node.moments.xz += part.moments.xz;
        node.moments.yy += part.moments.yy;
        node.moments.yz += part.moments.yz;
        node.moments.zz += part.moments.zz;
        node.moments.add(part.mean - node.mean, part.count);
    }
}

/// No point of a group lies lower, but for rounding.
double TriangleGroups::leastHeight(const Subtree& group, const Heights& over) const {
    const Node& node = nodes_[group.node];
    double least = over.lowestOf(node.box);
    for (const std::uint32_t hub : node.hubs) {
        if (hub == kNone) break;
        if (!over.leavesOut(hubs_[hub])) least = std::min(least, over.of(hubs_[hub]));
    }
    return least - over.gap;
}

/// Walks down to what may hold a lower point than `lowest`, the half that may hold the lowest
/// first.
void TriangleGroups::findLowest(const Subtree& group, const Heights& over, Point& lowest) const {
    if (group.isLeaf()) {
        for (const Vec3& p : pointsOf(group)) {
            const double height = over.of(p);
            if (!(height < lowest.height) || over.leavesOut(p)) continue;
            lowest = {p, height};
            if (height <= over.enough) return;
        }
        return;
    }
    std::array<Subtree, 2> halves{group.left(), group.right()};
    std::array<double, 2> least{leastHeight(halves[0], over), leastHeight(halves[1], over)};
    if (least[1] < least[0]) {
        std::swap(halves[0], halves[1]);
        std::swap(least[0], least[1]);
    }
    for (int n = 0; n < 2; ++n) {
        if (least[n] >= lowest.height || lowest.height <= over.enough) return;
        findLowest(halves[n], over, lowest);
    }
}

/// True if the hulls of two groups surely lie further apart than `reach`: the nearest points of
/// hulls by [Gilbert1988], whose every direction bounds their distance from below.
bool TriangleGroups::areHullsFarther(const TriangleGroups& a, const Subtree& i,
                                     const TriangleGroups& b, const Subtree& j, double reach) {
    constexpr int kSteps = 24;
    const double gap = std::max(a.gap_, b.gap_);
    Vec3 v = a.nodes_[i.node].mean - b.nodes_[j.node].mean;
    std::array<Vec3, 3> simplex{v, v, v};
    for (int step = 0; step < kSteps; ++step) {
        const double length = norm(v);
        if (!(length > reach)) return false;
        Point low, high;  // the latter's height is negated
        a.findLowest(i, {.along = v, .gap = gap * length}, low);
        b.findLowest(j, {.along = -v, .gap = gap * length}, high);
        if (low.height + high.height > reach * length) return true;
        const Vec3 support = low.place - high.place;
        const std::array<Vec3, 3> before = simplex;
        Vec3 next = v;
        for (int n = 0; n < 3; ++n) {
            std::array<Vec3, 3> sides = before;
            sides[n] = support;
            const Vec3 nearest = closestPointOnTriangle({}, sides[0], sides[1], sides[2]);
            if (squaredNorm(nearest) >= squaredNorm(next)) continue;
            next = nearest;
            simplex = sides;
        }
        if (next == v) return false;
        v = next;
    }
    return false;
}

/// A plane lies between two groups; of one mesh, it may pass through one or two hubs that both
/// have.
///
/// With hubs, triangles of different sides have no more in common than the hubs that both have as
/// corners, and the edge between these: trianglesCross() is false. Without, nothing.
bool TriangleGroups::areApart(const TriangleGroups& a, const Subtree& i, const TriangleGroups& b,
                              const Subtree& j, double reachMm) {
    const Node &m = a.nodes_[i.node], &n = b.nodes_[j.node];
    if (squaredDistance(a.wholeBoxOf(m), b.wholeBoxOf(n)) > reachMm * reachMm) return true;
    if (reachMm > 0) {
        return areHullsFarther(a, i, b, j, reachMm + std::max(a.gap_, b.gap_));
    }
    std::array<Vec3, 2> hubs;
    std::size_t shared = 0;
    if (&a == &b) {
        for (const std::uint32_t hub : m.hubs) {
            if (hub == kNone || !n.hasHub(hub)) continue;
            if (shared == hubs.size()) return false;
            hubs[shared++] = a.hubs_[hub];
        }
    }

    // the plane w x = const by least squares: +1 at the points of one group, -1 at the other's
    Symmetric squares = m.moments;
    squares.xx += n.moments.xx;
    squares.xy += n.moments.xy;
    squares.xz += n.moments.xz;
    squares.yy += n.moments.yy;
    squares.yz += n.moments.yz;
    squares.zz += n.moments.zz;
    Vec3 between = m.mean - n.mean;
    const Vec3 origin = shared == 0 ? n.mean : hubs[0];
    if (shared > 0) {
        squares.add(m.mean - origin, m.count);
        squares.add(n.mean - origin, n.count);
        between = m.count * (m.mean - origin) - n.count * (n.mean - origin);
    }
    Vec3 along;
    if (shared == 2) {
        along = hubs[1] - hubs[0];
        along = 1 / norm(along) * along;
    }
    const auto sideways = [&](const Vec3& v) {
        return shared == 2 ? v - dot(v, along) * along : v;
    };
    if (shared == 2) {
        constexpr double kMuch = 1e3;  // the plane holds the edge
        squares.add(along, kMuch * squares.trace());
    }
    constexpr double kRidge = 1e-14;
    const Inverse inverse(squares, kRidge);
    Vec3 w = sideways(inverse * sideways(between));

    const double gap = std::max(a.gap_, b.gap_);
    const std::span<const Vec3> leftOut{hubs.data(), shared};
    constexpr int kTries = 4;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        const double length = norm(w);
        if (!(length > 0) || !std::isfinite(length)) return false;
        w = 1 / length * w;
        // a group that reaches beyond the other's middle is hopeless
        const double ourMean = dot(w, m.mean - origin), theirMean = dot(w, n.mean - origin);
        Point ours, theirs;  // the latter's height is negated
        a.findLowest(i, {w, origin, leftOut, theirMean, gap}, ours);
        if (ours.height <= theirMean) return false;
        b.findLowest(j, {-w, origin, leftOut, -ourMean, gap}, theirs);
        if (theirs.height <= -ourMean) return false;
        const double low = ours.height, high = -theirs.height;
        if (shared == 0 ? low - high > gap : low > gap && high < -gap) return true;
        // turn the plane until the farthest off of both lies right
        const Vec3 lowest = ours.place - origin, highest = theirs.place - origin;
        const Vec3 off = shared == 0 ? lowest - highest : low < -high ? lowest : -highest;
        const Vec3 turn = sideways(inverse * sideways(off));
        const double gain = dot(turn, off);
        if (!(gain > 0)) return false;
        constexpr double kFurther = 1.5;
        w += kFurther * (std::max(0.0, -dot(w, off)) + 10 * gap) / gain * turn;
    }
    return false;
}

/// Walks down the tree with the groups that are near.
struct TriangleGroups::Search {
    const TriangleGroups& own;
    const TriangleGroups& other;
    double reachMm;
    const std::function<bool(std::uint32_t, std::uint32_t)>& meets;
    Budget budget;
    std::vector<std::uint8_t> isUndecided, isOtherUndecided;  ///< by node

    struct Found {
        std::vector<std::array<std::uint32_t, 2>> pairs;
        std::int64_t tests = 0;
        std::vector<std::array<Subtree, 2>> putOff;  ///< pairs of groups beyond the budget
        bool areTooMany = false;                     ///< there were more of them
    };

    bool isOne() const { return &own == &other; }

    void leaveUndecided(const Subtree& i, const Subtree& j) {
        std::atomic_ref(isUndecided[i.node]).store(1, std::memory_order_relaxed);
        std::atomic_ref((isOne() ? isUndecided : isOtherUndecided)[j.node])
            .store(1, std::memory_order_relaxed);
    }

    void putOff(const Subtree& i, const Subtree& j, Found& found) {
        if (std::ssize(found.putOff) < budget.putOff) {
            found.putOff.push_back({i, j});
        } else {
            found.areTooMany = true;
            leaveUndecided(i, j);
        }
    }

    /// Those of `near`, or their halves, that are near the group.
    std::vector<Subtree> nearOf(const Subtree& group, std::span<const Subtree> near, Found& found) {
        std::vector<Subtree> nearer;
        const auto add = [&](const Subtree& j) {
            if (!areApart(own, group, other, j, reachMm)) nearer.push_back(j);
        };
        for (const Subtree& j : near) {
            if (j.isLeaf()) {
                add(j);
            } else {
                add(j.left());
                add(j.right());
            }
        }
        const std::int64_t count = std::ssize(nearer);
        if (count <= budget.groups) return nearer;
        std::int64_t kept = 0;
        for (std::int64_t n = 0; n < count; ++n) {  // some of everywhere
            if (n * budget.groups / count == kept) {
                nearer[kept++] = nearer[n];
            } else {
                putOff(group, nearer[n], found);
            }
        }
        nearer.resize(static_cast<std::size_t>(kept));
        return nearer;
    }

    void visit(const Subtree& group, const std::vector<Subtree>& near, Found& found) {
        if (group.isLeaf()) return visitLeaf(group, near, found);
        const Subtree left = group.left(), right = group.right();
        std::vector<Subtree> ofLeft = nearOf(left, near, found),
                             ofRight = nearOf(right, near, found);
        if (isOne() && !areApart(own, left, own, right, 0)) ofLeft.push_back(right);
        if (!isOne() && ofLeft.empty() && ofRight.empty()) return;
        constexpr std::int64_t kParallelLeaves = 64;
        if (group.leaves < kParallelLeaves) {
            visit(left, ofLeft, found);
            visit(right, ofRight, found);
            return;
        }
        Found more;
        parallelInvoke([&] { visit(left, ofLeft, found); }, [&] { visit(right, ofRight, more); });
        found.pairs.insert(found.pairs.end(), more.pairs.begin(), more.pairs.end());
        found.tests += more.tests;
        found.areTooMany = found.areTooMany || more.areTooMany;
        for (const auto& [i, j] : more.putOff) putOff(i, j, found);
    }

    void visitLeaf(const Subtree& group, std::vector<Subtree> near, Found& found) {
        while (
            std::any_of(near.begin(), near.end(), [](const Subtree& j) { return !j.isLeaf(); })) {
            near = nearOf(group, near, found);
        }
        const std::size_t before = found.pairs.size();
        if (isOne()) {
            for (std::int64_t n = own.begin(group); n < own.end(group); ++n) {
                for (std::int64_t k = n + 1; k < own.end(group); ++k) test(n, k, found);
            }
        }
        for (const Subtree& j : near) {
            if (std::ssize(found.pairs) - static_cast<std::int64_t>(before) >= budget.pairs) {
                leaveUndecided(group, j);
                continue;
            }
            testAll(group, j, found);
        }
    }

    void testAll(const Subtree& i, const Subtree& j, Found& found) const {
        for (std::int64_t n = own.begin(i); n < own.end(i); ++n) {
            for (std::int64_t k = other.begin(j); k < other.end(j); ++k) test(n, k, found);
        }
    }

    /// Groups that hold triangles of two places, as where a hub's number is no multiple of a
    /// leaf's, are near very many others, but few: they share what all are allowed.
    void decidePutOff(Found& found) {
        const std::int64_t mostPairs =
            std::ssize(found.pairs) + budget.pairs * std::max(own.leafCount(), other.leafCount());
        std::int64_t tests = 0;
        std::vector<std::array<Subtree, 2>> left = std::move(found.putOff);
        std::reverse(left.begin(), left.end());
        while (!left.empty()) {
            const auto [i, j] = left.back();
            left.pop_back();
            if (found.areTooMany || tests > budget.tests || std::ssize(found.pairs) > mostPairs) {
                leaveUndecided(i, j);
                continue;
            }
            ++tests;
            if (areApart(own, i, other, j, reachMm)) continue;
            if (i.isLeaf() && j.isLeaf()) {
                testAll(i, j, found);
            } else if (j.leaves > i.leaves) {
                left.insert(left.end(), {{i, j.right()}, {i, j.left()}});
            } else {
                left.insert(left.end(), {{i.right(), j}, {i.left(), j}});
            }
        }
    }

    void test(std::int64_t n, std::int64_t k, Found& found) const {
        const double apart = squaredDistance(boxOf(own.corners_[n]), boxOf(other.corners_[k]));
        if (apart > reachMm * reachMm) return;
        std::uint32_t a = own.order_[n], b = other.order_[k];
        if (isOne() && b < a) std::swap(a, b);
        ++found.tests;
        if (meets(a, b)) found.pairs.push_back({a, b});
    }

    /// The triangles of nodes that are marked, or below one.
    static std::vector<std::uint32_t> trianglesOf(const TriangleGroups& groups,
                                                  std::vector<std::uint8_t>& isMarked) {
        std::vector<std::uint32_t> triangles;
        if (groups.order_.empty()) return triangles;
        Subtree::Stack stack;
        std::size_t depth = 0;
        stack[depth++] = groups.root();
        while (depth > 0) {
            const Subtree at = stack[--depth];
            if (isMarked[at.node] != 0) {
                triangles.insert(triangles.end(), groups.order_.begin() + groups.begin(at),
                                 groups.order_.begin() + groups.end(at));
            } else if (!at.isLeaf()) {
                stack[depth++] = at.left();
                stack[depth++] = at.right();
            }
        }
        std::sort(triangles.begin(), triangles.end());
        return triangles;
    }

    Pairs run() {
        Found found;
        if (isOne()) {
            visit(own.root(), {}, found);
        } else if (!areApart(own, own.root(), other, other.root(), reachMm)) {
            visit(own.root(), {other.root()}, found);
        }
        decidePutOff(found);
        return {std::move(found.pairs), trianglesOf(own, isUndecided),
                isOne() ? std::vector<std::uint32_t>{} : trianglesOf(other, isOtherUndecided),
                found.tests};
    }
};

TriangleGroups::Pairs TriangleGroups::findPairs(
    const std::function<bool(std::uint32_t, std::uint32_t)>& meets) const {
    return findPairs(*this, 0, meets);
}

TriangleGroups::Pairs TriangleGroups::findPairs(
    const TriangleGroups& other, double reachMm,
    const std::function<bool(std::uint32_t, std::uint32_t)>& meets) const {
    if (order_.empty() || other.order_.empty()) return {};
    const std::int64_t triangles = std::max(std::ssize(order_), std::ssize(other.order_));
    return Search{*this,
                  other,
                  reachMm,
                  meets,
                  Budget::of(triangles),
                  std::vector<std::uint8_t>(nodes_.size()),
                  std::vector<std::uint8_t>(&other == this ? 0 : other.nodes_.size())}
        .run();
}

TriangleGroups::Boxes::Boxes(const TriangleGroups& groups)
    : groups_(groups), boxes_(groups.nodes_.size()) {
    if (!boxes_.empty()) measure(groups.root());
}

void TriangleGroups::Boxes::measure(const HalvedLeaves& group) {
    const Node& node = groups_.nodes_[group.node];
    const Symmetric& m = node.moments;
    const auto times = [&](const Vec3& v) {
        return Vec3{m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
                    m.xz * v.x + m.yz * v.y + m.zz * v.z};
    };
    Box& box = boxes_[group.node];
    // the longest axis by power iteration, the next one at right angles to it
    constexpr int kSteps = 12;
    Vec3 first{1, 0, 0};
    if (m.yy >= m.xx && m.yy >= m.zz) first = {0, 1, 0};
    if (m.zz >= m.xx && m.zz >= m.yy) first = {0, 0, 1};
    const auto settle = [&](Vec3 axis, const Vec3& across) {
        const auto unit = [&](Vec3 v) {
            v = v - dot(v, across) * across;
            const double length = norm(v);
            return length > 0 && std::isfinite(length) ? 1 / length * v : Vec3{};
        };
        axis = unit(axis);
        for (int n = 0; n < kSteps; ++n) {
            const Vec3 next = unit(times(axis));
            if (!(squaredNorm(next) > 0)) break;
            axis = next;
        }
        return axis;
    };
    first = settle(first, {});
    const Vec3 aside = std::abs(first.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 second = settle(aside, first);
    box.axes = {first, second, cross(first, second)};
    Vec3 low{0, 0, 0}, high{0, 0, 0};
    for (const Vec3& p : groups_.pointsOf(group)) {
        for (int a = 0; a < 3; ++a) {
            const double along = dot(box.axes[a], p - node.mean);
            low[a] = std::min(low[a], along);
            high[a] = std::max(high[a], along);
        }
    }
    box.middle = node.mean;
    for (int a = 0; a < 3; ++a) {
        box.middle += 0.5 * (low[a] + high[a]) * box.axes[a];
        box.half[a] = 0.5 * (high[a] - low[a]) + groups_.gap_;  // for rounding
    }
    if (group.isLeaf()) return;
    constexpr std::int64_t kParallelLeaves = 512;
    if (group.leaves >= kParallelLeaves) {
        parallelInvoke([&] { measure(group.left()); }, [&] { measure(group.right()); });
    } else {
        measure(group.left());
        measure(group.right());
    }
}

double TriangleGroups::Boxes::squaredDistance(const Vec3& p, const HalvedLeaves& group) const {
    const Box& box = boxes_[group.node];
    const Vec3 d = p - box.middle;
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
        const double beyond = std::max(std::abs(dot(box.axes[a], d)) - box.half[a], 0.0);
        sum += beyond * beyond;
    }
    return sum;
}

ClosestPoint TriangleGroups::Boxes::closestPoint(const Vec3& p, const ClosestPoint& first,
                                                 SearchEffort& effort) const {
    ClosestPoint best = first;
    effort.begin();
    if (boxes_.empty()) return best;
    constexpr double kRough = SearchEffort::kRough * SearchEffort::kRough;
    const double gap = groups_.gap_;
    struct Candidate {
        HalvedLeaves group;
        double squared;
    };
    std::array<Candidate, std::tuple_size_v<HalvedLeaves::Stack>> stack;
    std::size_t depth = 0;
    stack[depth++] = {groups_.root(), squaredDistance(p, groups_.root())};
    while (depth > 0) {
        const Candidate at = stack[--depth];
        if (at.squared >= best.squaredDistanceMm2) continue;
        if (best.squaredDistanceMm2 <= gap * gap) break;  // none is known to be nearer
        if (effort.isUsedUp()) {
            if (effort.ends()) break;
            if (at.squared >= kRough * best.squaredDistanceMm2) {
                effort.isRough = true;
                continue;
            }
        }
        if (at.group.isLeaf()) {
            effort.triangles -= kLeafTriangles;
            for (std::int64_t n = groups_.begin(at.group); n < groups_.end(at.group); ++n) {
                const Corners& c = groups_.corners_[n];
                const Vec3 nearest = closestPointOnTriangle(p, c[0], c[1], c[2]);
                const double squared = squaredNorm(p - nearest);
                if (squared < best.squaredDistanceMm2) best = {groups_.order_[n], squared, nearest};
            }
            continue;
        }
        Candidate nearer{at.group.left(), squaredDistance(p, at.group.left())};
        Candidate farther{at.group.right(), squaredDistance(p, at.group.right())};
        if (farther.squared < nearer.squared) std::swap(nearer, farther);
        stack[depth++] = farther;
        stack[depth++] = nearer;
    }
    return best;
}

}  // namespace adaptiso
