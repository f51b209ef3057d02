#include "WallCollapser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/PortableMath.h"

namespace adaptiso::detail {

namespace {

/// Squared distance from the planes, in the mean, of the squared limit, above which a collapse is
/// not tried. At 1 there are 2.5 % fewer triangles for a seventh more time (aal).
constexpr double kMostMean2 = 0.5;

/// Cosine of a triangle's smallest angle.
double largestCosine(const std::array<Vec3, 3>& c) {
    double largest = -1;
    for (int n = 0; n < 3; ++n) {
        const Vec3 a = c[(n + 1) % 3] - c[n], b = c[(n + 2) % 3] - c[n];
        largest = std::max(largest, dot(a, b) / std::sqrt(squaredNorm(a) * squaredNorm(b)));
    }
    return largest;
}

}  // namespace

WallCollapser::WallCollapser(const WallPatch& patch, const ImageGeometry& geometry,
                             double leastAngleDeg)
    : patch_(patch),
      mesh_(patch),
      centres_(geometry),
      firstNew_(static_cast<Id>(mesh_.pointCount())),
      voxelMm_(portable::cubeRoot(geometry.voxelVolumeMm3())),
      largestCosine_(portable::cos(leastAngleDeg * std::numbers::pi / 180)),
      quadrics_(mesh_.pointCount()),
      origin_(mesh_.pointCount(), kNone),
      tried_(mesh_.pointCount(), -1),
      leastCost_(mesh_.pointCount(), 0),
      samples_(patch.fullPoints.size()),
      firstSample_(mesh_.triangleCount(), kNone),
      mark_(mesh_.pointCount(), 0) {
    for (std::size_t v = 0; v < patch.fullPoints.size(); ++v) {
        samples_[v].point = patch.fullPoints[v];
    }
    fullBegin_.assign(patch.fullPoints.size() + 2, 0);
    for (const WallTriangle& t : patch.fullTriangles) {
        for (const Id v : t.v) ++fullBegin_[v + 2];
    }
    for (std::size_t v = 2; v < fullBegin_.size(); ++v) fullBegin_[v] += fullBegin_[v - 1];
    fullAround_.resize(3 * patch.fullTriangles.size());
    for (Id t = 0; t < patch.fullTriangles.size(); ++t) {
        for (const Id v : patch.fullTriangles[t].v) fullAround_[fullBegin_[v + 1]++] = t;
    }
    fullBegin_.pop_back();
    findFans();
    if (patch.isFull()) {
        beginFull();
    } else {
        beginAsIs();
    }
}

/// The triangles round each sample, ready for isNearFull().
void WallCollapser::findFans() {
    const auto single = [](const Vec3& a) {
        return std::array{static_cast<float>(a.x), static_cast<float>(a.y),
                          static_cast<float>(a.z)};
    };
    fans_.resize(fullAround_.size());
    std::vector<std::uint64_t> next(fullBegin_.begin(), fullBegin_.end() - 1);
    for (const WallTriangle& t : patch_.fullTriangles) {
        const Plane plane({samples_[t.v[0]].point, samples_[t.v[1]].point, samples_[t.v[2]].point});
        const std::array<float, 3> normal = single(plane.normal);
        const std::array slopes{single(-plane.toFirst - plane.toSecond), single(plane.toFirst),
                                single(plane.toSecond)};
        for (int c = 0; c < 3; ++c) {
            fans_[next[t.v[c]]++] = {slopes[(c + 1) % 3], slopes[(c + 2) % 3], normal};
        }
    }
}

void WallCollapser::beginFull() {
    for (Id v = 0; v < mesh_.fullPoints(); ++v) {
        origin_[v] = v;
        if (isOwn(v)) linkVertex(v);
    }
    addQuadrics();
}

void WallCollapser::beginAsIs() {
    const Id first = mesh_.firstPoint();
    std::copy(patch_.quadrics.begin(), patch_.quadrics.end(), quadrics_.begin() + first);
    std::copy(patch_.origins.begin(), patch_.origins.end(), origin_.begin() + first);
    for (Id v = first; v < mesh_.pointCount(); ++v) {
        if (patch_.isTried[v - first] != 0) leastCost_[v] = kInfinity;
    }
    for (Id s = 0; s < samples_.size(); ++s) {
        const WallAssignment& assigned = patch_.assignments[s];
        samples_[s].tightness = assigned.tightness;
        if (assigned.triangle != kNone)
            link(s, mesh_.firstTriangle() + assigned.triangle, assigned.slot);
    }
}

void WallCollapser::tryAllAgain() {
    std::fill(leastCost_.begin(), leastCost_.end(), 0);
}

/// Assigns a vertex of the full walls, as a sample, to one of its triangles.
void WallCollapser::linkVertex(Id v) {
    const auto own = mesh_.around(v);
    if (mesh_.kind(v) == Kind::Wall) link(v, own.front(), kOnWall);
    if (mesh_.kind(v) != Kind::Curve) return;
    for (const Id t : own) {  // an edge of the curve
        const auto& c = mesh_.triangle(t).v;
        const auto at = static_cast<int>(std::find(c.begin(), c.end(), v) - c.begin());
        for (const int slot : {at, (at + 2) % 3}) {
            const Id other = c[slot == at ? (at + 1) % 3 : slot];
            if (mesh_.orderOf(v, other) < 3) continue;
            link(v, t, static_cast<std::uint8_t>(slot));
            return;
        }
    }
}

void WallCollapser::addQuadrics() {
    for (Id t = 0; t < mesh_.triangleCount(); ++t) {
        const auto& v = mesh_.triangle(t).v;
        const auto c = mesh_.cornersOf(t);
        const Vec3 area2 = areaVector2(c[0], c[1], c[2]);
        const Quadric q = Quadric::ofTriangle(area2, c[0]);
        for (const Id x : v) quadrics_[x] += q;
        for (int e = 0; e < 3; ++e) {  // planes upright on the wall hold curves
            const Id a = v[e], b = v[(e + 1) % 3];
            if (mesh_.kind(a) == Kind::Wall || mesh_.kind(b) == Kind::Wall) continue;
            if (mesh_.orderOf(a, b) < 3) continue;
            const Vec3 edge = c[(e + 1) % 3] - c[e];
            const Vec3 upright = norm(edge) * normalized(cross(edge, area2)) * norm(edge);
            const Quadric held = Quadric::ofTriangle(upright, c[e]);
            quadrics_[a] += held;
            quadrics_[b] += held;
        }
    }
}

void WallCollapser::link(Id sample, Id triangle, std::uint8_t slot) {
    Sample& own = samples_[sample];
    own.assigned = triangle;
    own.slot = slot;
    own.next = firstSample_[triangle];
    firstSample_[triangle] = sample;
}

WallCollapser::Plan WallCollapser::planFor(Id u, Id v) const {
    Plan plan;
    const Kind a = mesh_.kind(u), b = mesh_.kind(v);
    if (a == Kind::Corner && b == Kind::Corner) return plan;
    const bool isAlong = a != Kind::Wall && b != Kind::Wall;
    if (isAlong && mesh_.orderOf(u, v) < 3) return plan;
    const Quadric q = quadrics_[u] + quadrics_[v];
    const Vec3 &p = mesh_.point(u), &r = mesh_.point(v);
    plan.kind = std::max(a, b);
    if (a == b) {
        const QuadricMinimum best = minimize(q, 0.5 * (p + r));
        plan.point = best.point;
        plan.cost = best.error;
    } else {
        plan.point = a > b ? p : r;
        plan.cost = std::max(0.0, q.at(plan.point));
    }
    // of flat walls the short edges first: rounder triangles
    plan.cost += 1e-4 * voxelMm_ * voxelMm_ * squaredNorm(p - r);
    return plan;
}

void WallCollapser::collectStar(Id u, Id v) {
    star_.clear();
    for (const Id t : mesh_.around(u)) {
        if (!mesh_.triangle(t).has(v)) star_.push_back(t);
    }
    for (const Id t : mesh_.around(v)) {
        if (!mesh_.triangle(t).has(u)) star_.push_back(t);
    }
    kept_ = star_.size();
    for (const Id t : mesh_.around(u)) {
        if (mesh_.triangle(t).has(v)) star_.push_back(t);
    }
}

/// The link condition of complexes whose edges may have any number of triangles [Dey1999].
bool WallCollapser::keepsTopology(Id u, Id v) {
    const std::uint32_t ofU = ++stamp_, isCommon = ++stamp_;
    const auto mark = [&](Id x, std::uint32_t with) {
        if (mark_.size() <= x) mark_.resize(mesh_.pointCount() + 1, 0);
        mark_[x] = with;
    };
    for (const Id t : mesh_.around(u)) {
        for (const Id x : mesh_.triangle(t).v) mark(x, ofU);
    }
    common_.clear();
    for (const Id t : mesh_.around(v)) {
        for (const Id x : mesh_.triangle(t).v) {
            if (x == u || x == v || mark_[x] != ofU) continue;
            mark(x, isCommon);
            common_.push_back(x);
        }
    }
    if (common_.size() != star_.size() - kept_ || kept_ < 3) return false;
    // an edge that both links have
    for (std::size_t i = 0; i < kept_; ++i) {
        const auto& t = mesh_.triangle(star_[i]);
        if (!t.has(u)) break;
        int inBoth = 0;
        for (const Id x : t.v) inBoth += x != u && mark_[x] == isCommon ? 1 : 0;
        if (inBoth < 2) continue;
        for (std::size_t j = i + 1; j < kept_; ++j) {
            const auto& s = mesh_.triangle(star_[j]);
            if (!s.has(v)) continue;
            int shared = 0;
            for (const Id x : t.v) shared += x != u && s.has(x) ? 1 : 0;
            if (shared == 2) return false;
        }
    }
    if (mesh_.kind(u) != Kind::Wall && mesh_.kind(v) != Kind::Wall) {
        for (const Id x : common_) {  // the curve would close up
            if (mesh_.kind(x) != Kind::Wall && mesh_.orderOf(u, x) > 2 && mesh_.orderOf(v, x) > 2) {
                return false;
            }
        }
    }
    return true;
}

/// Moves the point of a wall so that the volume on both sides stays [LindstromTurk1998].
void WallCollapser::keepVolume(Id u, Id v, Plan& plan) const {
    const Vec3 origin = 0.5 * (mesh_.point(u) + mesh_.point(v));
    Vec3 slope;
    double volume = 0;
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const auto& t = mesh_.triangle(star_[i]).v;
        const Vec3 a = mesh_.point(t[0]) - origin, b = mesh_.point(t[1]) - origin,
                   c = mesh_.point(t[2]) - origin;
        volume += dot(a, cross(b, c));
        if (i >= kept_) continue;
        const auto isMoved = [&](int n) { return t[n] == u || t[n] == v; };
        slope += isMoved(0) ? cross(b, c) : isMoved(1) ? cross(c, a) : cross(a, b);
    }
    const double length2 = squaredNorm(slope);
    if (!(length2 > 0)) return;
    const double lack = (volume - dot(plan.point - origin, slope)) / length2;
    plan.point += lack * slope;
}

bool WallCollapser::keepsShape(Id u, Id v, const Vec3& point) const {
    constexpr double kLeastCosine = 0.3, kLeastRoundness = 0.06;
    double sharpest = -1;
    for (std::size_t i = 0; i < kept_; ++i) {
        const auto& t = mesh_.triangle(star_[i]).v;
        auto c = mesh_.cornersOf(star_[i]);
        const auto roundness = [&](const Vec3& area2) {
            return 2 * std::sqrt(3.0) * norm(area2) /
                   (squaredNorm(c[1] - c[0]) + squaredNorm(c[2] - c[1]) + squaredNorm(c[0] - c[2]));
        };
        const Vec3 before = areaVector2(c[0], c[1], c[2]);
        const double was = roundness(before);
        for (int n = 0; n < 3; ++n) {
            if (t[n] == u || t[n] == v) c[n] = point;
        }
        const Vec3 now = areaVector2(c[0], c[1], c[2]);
        if (!(dot(before, now) > kLeastCosine * norm(before) * norm(now))) return false;
        if (!(roundness(now) > std::min(kLeastRoundness, 0.7 * was))) return false;
        if (largestCosine_ < 1) sharpest = std::max(sharpest, largestCosine(c));
    }
    return sharpest <= largestCosine_ || std::any_of(star_.begin(), star_.end(), [&](Id t) {
               return largestCosine(mesh_.cornersOf(t)) >= sharpest;
           });
}

bool WallCollapser::sweepsCentre(Id u, Id v, const Vec3& point) const {
    const Vec3 atU = centres_.toIndex(mesh_.point(u)), atV = centres_.toIndex(mesh_.point(v)),
               to = centres_.toIndex(point);
    const auto at = [&](Id x) {
        return x == u ? atU : x == v ? atV : centres_.toIndex(mesh_.point(x));
    };
    return std::any_of(star_.begin(), star_.end(), [&](Id t) {
        const auto& c = mesh_.triangle(t).v;
        return SweptCentres::isCentreIn({at(c[0]), at(c[1]), at(c[2]), to});
    });
}

bool WallCollapser::isInRoom(const Vec3& point) const {
    const Vec3 p = centres_.toIndex(point);
    return patch_.low.x < p.x && p.x < patch_.high.x && patch_.low.y < p.y && p.y < patch_.high.y &&
           patch_.low.z < p.z && p.z < patch_.high.z;
}

bool WallCollapser::tryCollapse(Id u, Id v, Plan plan, double limitMm) {
    collectStar(u, v);
    if (!keepsTopology(u, v)) return false;
    const bool isMoved = mesh_.kind(u) == mesh_.kind(v);
    if (isMoved && plan.kind == Kind::Wall) keepVolume(u, v, plan);
    if (!isInRoom(plan.point) || !keepsShape(u, v, plan.point)) return false;
    if (!assignSamples(u, v, plan, limitMm)) return false;
    if (isMoved && !isNearFull(plan.point, nearestSample_, limitMm)) return false;
    if (mark_.size() < mesh_.pointCount()) mark_.resize(mesh_.pointCount(), 0);
    ++stamp_;
    mark_[u] = mark_[v] = stamp_;
    if (!spokesAreNear(plan, limitMm)) return false;
    if (sweepsCentre(u, v, plan.point)) return false;

    const Id n = mesh_.collapse(u, v, plan.point, plan.kind, star_, kept_);
    const auto& change = mesh_.change(n);
    firstSample_.resize(mesh_.triangleCount(), kNone);
    for (const Id t : star_) firstSample_[t] = kNone;
    for (const NewAssignment& assigned : newAssignments_) {
        link(assigned.sample, change.madeBegin + assigned.star, assigned.slot);
    }
    quadrics_.push_back(quadrics_[u] + quadrics_[v]);
    origin_.push_back(nearestSample_);
    leastCost_.push_back(0);
    tried_.push_back(-1);
    mark_.push_back(0);
    for (Id t = change.madeBegin; t < change.madeEnd; ++t) {
        for (const Id x : mesh_.triangle(t).v) leastCost_[x] = 0;
    }
    return true;
}

/// Calls f(vertex at the other end) once for each edge of a vertex that may move.
template <class F>
void WallCollapser::forEachNeighbour(Id u, const F& f) {
    if (mesh_.kind(u) == Kind::Wall) {  // its triangles go round it once
        for (const Id t : mesh_.around(u)) {
            const auto& c = mesh_.triangle(t).v;
            f(c[0] == u ? c[1] : c[1] == u ? c[2] : c[0]);
        }
        return;
    }
    const std::uint32_t seen = ++stamp_;
    for (const Id t : mesh_.around(u)) {
        for (const Id x : mesh_.triangle(t).v) {
            if (x == u || mark_[x] == seen) continue;
            mark_[x] = seen;
            f(x);
        }
    }
}

void WallCollapser::round(double maxCost, double limitMm, std::int64_t enough) {
    struct Edge {
        double cost;
        Id to;
        Plan plan;
    };
    std::vector<Edge> edges;
    const double mostMean2 = kMostMean2 * limitMm * limitMm;
    for (Id u = mesh_.firstPoint(); u < mesh_.pointCount(); ++u) {
        if (!mesh_.isAlive(u) || leastCost_[u] > maxCost || isFrozen(u)) continue;
        if (mesh_.aliveTriangles() <= enough) return;
        edges.clear();
        double least = kInfinity;
        if (leastCost_[u] == 0) tried_[u] = -1;
        forEachNeighbour(u, [&](Id x) {
            if (x <= u || isFrozen(x)) return;
            const Plan plan = planFor(u, x);
            if (plan.cost <= tried_[u]) return;
            // as far from the planes in the mean, samples rarely all lie within the limit
            if (plan.cost > mostMean2 * (quadrics_[u].weight() + quadrics_[x].weight())) return;
            if (plan.cost <= maxCost) {
                edges.push_back({plan.cost, x, plan});
            } else {
                least = std::min(least, plan.cost);
            }
        });
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            return a.cost != b.cost ? a.cost < b.cost : a.to < b.to;
        });
        for (const Edge& edge : edges) {
            if (tryCollapse(u, edge.to, edge.plan, limitMm)) break;
        }
        if (!mesh_.isAlive(u)) continue;
        tried_[u] = maxCost;
        leastCost_[u] = std::max(least, 1e-300);
    }
}

void WallCollapser::undo(Id change) {
    mesh_.undo(change, [&](const WallMesh::Change& c) {
        const auto star = mesh_.removedBy(c);
        for (Id t = c.madeBegin; t < c.madeEnd; ++t) {
            for (Id s = firstSample_[t]; s != kNone;) {
                const Id next = samples_[s].next;
                double best2 = kInfinity;
                Id assigned = star[t - c.madeBegin];
                for (const Id to : star) {
                    if (mesh_.triangle(to).wall != mesh_.triangle(t).wall) continue;
                    const auto p = mesh_.cornersOf(to);
                    const Vec3 at = samples_[s].point;
                    const double d2 =
                        squaredNorm(at - closestPointOnTriangle(at, p[0], p[1], p[2]));
                    if (d2 < best2) {
                        best2 = d2;
                        assigned = to;
                    }
                }
                link(s, assigned, samples_[s].slot);
                s = next;
            }
            firstSample_[t] = kNone;
        }
        for (const Id t : star) {
            for (const Id x : mesh_.triangle(t).v) leastCost_[x] = 0;
        }
    });
}

void WallCollapser::tightenFull(Id full) {
    for (const Id v : patch_.fullTriangles[full].v) samples_[v].tightness *= kTighter;
}

void WallCollapser::tightenNear(Id triangle) {
    for (Id s = firstSample_[triangle]; s != kNone; s = samples_[s].next) {
        samples_[s].tightness *= kTighter;
    }
    for (const Id v : mesh_.triangle(triangle).v) {
        if (origin_[v] != kNone) samples_[origin_[v]].tightness *= kTighter;
    }
}

WallCollapser::Id WallCollapser::meshNear(Id full) const {
    const auto& t = patch_.fullTriangles[full];
    for (const Id v : t.v) {
        if (samples_[v].assigned != kNone && samples_[v].slot == kOnWall)
            return samples_[v].assigned;
    }
    for (const Id v : t.v) {
        if (samples_[v].assigned == kNone) continue;
        const auto& own = mesh_.triangle(samples_[v].assigned);
        for (const Id x : own.v) {
            for (const Id at : mesh_.around(x)) {
                if (mesh_.triangle(at).wall == t.wall) return at;
            }
        }
    }
    return kNone;
}

WallCollapser::Id WallCollapser::fullNear(Id triangle) const {
    const auto& t = mesh_.triangle(triangle);
    for (const Id v : t.v) {
        const Id from = origin_[v];
        if (from == kNone) continue;
        for (std::uint64_t n = fullBegin_[from]; n < fullBegin_[from + 1]; ++n) {
            if (patch_.fullTriangles[fullAround_[n]].wall == t.wall) return fullAround_[n];
        }
    }
    return kNone;
}

namespace {

/// Voxels that are kept clear around what is swept.
constexpr double kMargin = 1e-4;
/// Cosine below which a line of voxel centres counts as parallel to a plane.
constexpr double kParallel = 1e-12;

/// Half-space: dot(normal, p) >= least. Normals may have any length.
struct HalfSpace {
    Vec3 normal;
    double least;
};

/// The intersection of up to four half-spaces.
struct HalfSpaces {
    std::array<HalfSpace, 4> sides;
    int count = 0;
};

/// The tetrahedron, wider by the margin; of a flat one, a slab round it.
HalfSpaces widened(const std::array<Vec3, 4>& p) {
    HalfSpaces around;
    for (int i = 0; i < 4; ++i) {
        const Vec3 &a = p[(i + 1) % 4], &b = p[(i + 2) % 4], &c = p[(i + 3) % 4];
        Vec3 normal = areaVector2(a, b, c);
        const double margin = kMargin * norm(normal);
        double height = dot(normal, p[i] - a);
        if (height < 0) {
            normal = -normal;
            height = -height;
        }
        if (height < margin || margin == 0) {
            const double at = dot(normal, a);
            if (margin == 0) return {};
            around.sides[0] = {normal, at - 2 * margin};
            around.sides[1] = {-normal, -at - 2 * margin};
            around.count = 2;
            return around;
        }
        around.sides[around.count++] = {normal, dot(normal, a) - margin};
    }
    return around;
}

/// std::ceil and std::floor of what 64 bits hold, without a call.
double roundedUp(double x) {
    const auto whole = static_cast<double>(static_cast<std::int64_t>(x));
    return whole < x ? whole + 1 : whole;
}
double roundedDown(double x) {
    const auto whole = static_cast<double>(static_cast<std::int64_t>(x));
    return whole > x ? whole - 1 : whole;
}

}  // namespace

bool SweptCentres::isCentreIn(const std::array<Vec3, 4>& p) {
    std::array<double, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
        const double x = p[0][axis], y = p[1][axis], z = p[2][axis], w = p[3][axis];
        low[axis] = roundedUp(std::min(std::min(x, y), std::min(z, w)) - kMargin);
        high[axis] = roundedDown(std::max(std::max(x, y), std::max(z, w)) + kMargin);
        if (low[axis] > high[axis]) return false;
    }
    const HalfSpaces around = widened(p);
    // lines of centres along the axis that the triangle faces most: few lie in a flat one
    const Vec3 facing = areaVector2(p[0], p[1], p[2]);
    int along = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (std::abs(facing[axis]) > std::abs(facing[along])) along = axis;
    }
    const int u = (along + 1) % 3, v = (along + 2) % 3;
    std::array<double, 4> perSlope{};  // 0: the line runs along the side
    for (int i = 0; i < around.count; ++i) {
        const Vec3& normal = around.sides[i].normal;
        const double slope = normal[along];
        if (slope * slope >= kParallel * kParallel * squaredNorm(normal)) perSlope[i] = 1 / slope;
    }
    Vec3 at;
    for (at[u] = low[u]; at[u] <= high[u]; ++at[u]) {
        for (at[v] = low[v]; at[v] <= high[v]; ++at[v]) {
            double first = low[along], last = high[along];
            for (int i = 0; i < around.count; ++i) {
                const auto& [normal, least] = around.sides[i];
                const double lack = least - dot(normal, at);
                if (perSlope[i] == 0) {
                    if (lack > 0) last = first - 1;
                } else if (perSlope[i] > 0) {
                    first = std::max(first, lack * perSlope[i]);
                } else {
                    last = std::min(last, lack * perSlope[i]);
                }
            }
            if (first <= last + 1 && roundedUp(first - 1e-9) <= last + 1e-9) return true;
        }
    }
    return false;
}

}  // namespace adaptiso::detail
