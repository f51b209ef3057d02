#include "WallCollapser.h"

#include <algorithm>
#include <cmath>

#include "adaptiso/Core/AabbTree.h"

namespace adaptiso::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double squaredDistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 e = b - a;
    const double length2 = squaredNorm(e);
    const double t = length2 > 0 ? std::clamp(dot(p - a, e) / length2, 0.0, 1.0) : 0;
    return squaredNorm(p - a - t * e);
}

}  // namespace

WallCollapser::WallCollapser(const LabelComplex& full, const ImageGeometry& geometry)
    : mesh_(full),
      centres_(geometry),
      voxelMm_(std::cbrt(geometry.voxelVolumeMm3())),
      quadrics_(full.points.size()),
      origin_(full.points.size()),
      tried_(full.points.size(), -1),
      leastCost_(full.points.size(), 0),
      home_(full.points.size() + full.triangles.size(), kNone),
      nextSample_(home_.size(), kNone),
      firstSample_(full.triangles.size(), kNone),
      tightness_(home_.size(), kTrust),
      slot_(home_.size(), kOnWall),
      mark_(full.points.size(), 0) {
    fullBegin_.reserve(full.points.size() + 1);
    fullBegin_.push_back(0);
    fullAround_.reserve(3 * full.triangles.size());
    for (Id v = 0; v < full.points.size(); ++v) {
        origin_[v] = v;
        const auto own = mesh_.around(v);
        fullAround_.insert(fullAround_.end(), own.begin(), own.end());
        fullBegin_.push_back(fullAround_.size());
        if (mesh_.kind(v) == Kind::Wall) link(v, own.front(), kOnWall);
        if (mesh_.kind(v) != Kind::Curve) continue;
        for (const Id t : own) {  // an edge of the curve
            const auto& c = mesh_.triangle(t).v;
            const auto at = static_cast<int>(std::find(c.begin(), c.end(), v) - c.begin());
            if (mesh_.orderOf(v, c[(at + 1) % 3]) > 2) {
                link(v, t, static_cast<std::uint8_t>(at));
                break;
            }
            if (mesh_.orderOf(v, c[(at + 2) % 3]) > 2) {
                link(v, t, static_cast<std::uint8_t>((at + 2) % 3));
                break;
            }
        }
    }
    for (Id t = 0; t < full.triangles.size(); ++t) {
        link(static_cast<Id>(full.points.size()) + t, t, kOnWall);
    }
    addQuadrics();
}

Vec3 WallCollapser::samplePoint(Id sample) const {
    const auto vertices = static_cast<Id>(mesh_.fullPoints());
    if (sample < vertices) return mesh_.point(sample);
    const auto c = mesh_.cornersOf(sample - vertices);
    return (1.0 / 3) * (c[0] + c[1] + c[2]);
}

WallCollapser::Id WallCollapser::vertexAt(Id sample) const {
    const auto vertices = static_cast<Id>(mesh_.fullPoints());
    return sample < vertices ? sample : mesh_.triangle(sample - vertices).v[0];
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
    home_[sample] = triangle;
    slot_[sample] = slot;
    nextSample_[sample] = firstSample_[triangle];
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
    }
    return true;
}

bool WallCollapser::sweepsCentre(const Vec3& point) const {
    return std::any_of(star_.begin(), star_.end(),
                       [&](Id t) { return centres_.isCentreIn(mesh_.cornersOf(t), point); });
}

/// Assigns the samples of the star to what replaces it.
/// \return false when one lies too far from that
bool WallCollapser::findHomes(Id u, Id v, const Plan& plan, double limitMm) {
    struct Part {
        std::array<Vec3, 3> corners;
        Id wall;
    };
    struct CurvePart {
        Vec3 end;
        Id star;
        std::uint8_t slot;
    };
    static thread_local std::vector<Part> parts;
    static thread_local std::vector<CurvePart> curve;
    parts.clear();
    curve.clear();
    const bool isOnCurve = plan.kind != Kind::Wall;
    for (std::size_t i = 0; i < kept_; ++i) {
        const auto& t = mesh_.triangle(star_[i]);
        auto c = mesh_.cornersOf(star_[i]);
        for (int n = 0; n < 3; ++n) {
            if (t.v[n] != u && t.v[n] != v) continue;
            c[n] = plan.point;
            if (!isOnCurve || mesh_.kind(t.v[n]) == Kind::Wall) continue;
            for (const int m : {(n + 1) % 3, (n + 2) % 3}) {
                const Id p = t.v[m];
                if (mesh_.kind(p) == Kind::Wall || mesh_.orderOf(t.v[n], p) < 3) continue;
                curve.push_back({mesh_.point(p), static_cast<Id>(i),
                                 static_cast<std::uint8_t>(m == (n + 1) % 3 ? n : m)});
            }
        }
        parts.push_back({c, t.wall});
    }
    const double limit2 = limitMm * limitMm;
    newHomes_.clear();
    double nearest2 = kInfinity;
    nearestSample_ = origin_[u];
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const auto& t = mesh_.triangle(star_[i]);
        for (Id s = firstSample_[star_[i]]; s != kNone; s = nextSample_[s]) {
            const Vec3 p = samplePoint(s);
            if (const double d2 = squaredNorm(p - plan.point); d2 < nearest2) {
                nearest2 = d2;
                nearestSample_ = s;
            }
            NewHome home{s, kNone, slot_[s], p};
            double best2 = kInfinity;
            if (slot_[s] == kOnWall) {
                for (std::size_t n = 0; n < kept_; ++n) {
                    if (parts[n].wall != t.wall) continue;
                    const auto& c = parts[n].corners;
                    const double d2 = squaredNorm(p - closestPointOnTriangle(p, c[0], c[1], c[2]));
                    if (d2 < best2) {
                        best2 = d2;
                        home.star = static_cast<Id>(n);
                    }
                }
            } else {
                const Id a = t.v[slot_[s]], b = t.v[(slot_[s] + 1) % 3];
                if (a != u && a != v && b != u && b != v && i < kept_) {
                    home.star = static_cast<Id>(i);
                    best2 = 0;
                } else {
                    for (const CurvePart& part : curve) {
                        const double d2 = squaredDistanceToSegment(p, plan.point, part.end);
                        if (d2 < best2) {
                            best2 = d2;
                            home.star = part.star;
                            home.slot = part.slot;
                        }
                    }
                }
            }
            if (!(best2 <= limit2 * tightness_[s] * tightness_[s])) return false;
            newHomes_.push_back(home);
        }
    }
    return true;
}

/// The full walls come near the point, as far as those round the nearest sample show.
bool WallCollapser::isNearFull(const Vec3& point, double limitMm) {
    limitMm *= tightness_[nearestSample_];
    const Id vertex = vertexAt(nearestSample_);
    for (std::uint64_t n = fullBegin_[vertex]; n < fullBegin_[vertex + 1]; ++n) {
        const auto c = mesh_.cornersOf(fullAround_[n]);
        if (squaredNorm(point - closestPointOnTriangle(point, c[0], c[1], c[2])) <=
            limitMm * limitMm) {
            return true;
        }
    }
    return false;
}

/// The middles of the edges at the new vertex are near the full walls: a ridge may pass between
/// samples.
bool WallCollapser::spokesAreNear(const Plan& plan, double limitMm) {
    for (std::size_t i = 0; i < kept_; ++i) {
        const auto& t = mesh_.triangle(star_[i]).v;
        for (const Id x : t) {
            if (mark_[x] == stamp_) continue;
            mark_[x] = stamp_;
            const Vec3 middle = 0.5 * (plan.point + mesh_.point(x));
            double nearest2 = kInfinity;
            for (const NewHome& home : newHomes_) {
                const double d2 = squaredNorm(home.point - middle);
                if (d2 >= nearest2) continue;
                nearest2 = d2;
                nearestSample_ = home.sample;
            }
            if (nearest2 < kInfinity && !isNearFull(middle, limitMm)) return false;
        }
    }
    return true;
}

bool WallCollapser::tryCollapse(Id u, Id v, Plan plan, double limitMm) {
    collectStar(u, v);
    if (!keepsTopology(u, v)) return false;
    const bool isMoved = mesh_.kind(u) == mesh_.kind(v);
    if (isMoved && plan.kind == Kind::Wall) keepVolume(u, v, plan);
    if (!keepsShape(u, v, plan.point)) return false;
    if (!findHomes(u, v, plan, limitMm)) return false;
    if (isMoved && !isNearFull(plan.point, limitMm)) return false;
    const Id nearest = nearestSample_;
    if (mark_.size() < mesh_.pointCount()) mark_.resize(mesh_.pointCount(), 0);
    ++stamp_;
    mark_[u] = mark_[v] = stamp_;
    if (!spokesAreNear(plan, limitMm)) return false;
    nearestSample_ = nearest;
    if (sweepsCentre(plan.point)) return false;

    const Id n = mesh_.collapse(u, v, plan.point, plan.kind, star_, kept_);
    const auto& change = mesh_.change(n);
    firstSample_.resize(mesh_.triangleCount(), kNone);
    for (const Id t : star_) firstSample_[t] = kNone;
    for (const NewHome& home : newHomes_) {
        link(home.sample, change.madeBegin + home.star, home.slot);
    }
    quadrics_.push_back(quadrics_[u] + quadrics_[v]);
    origin_.push_back(vertexAt(nearestSample_));
    leastCost_.push_back(0);
    tried_.push_back(-1);
    mark_.push_back(0);
    for (Id t = change.madeBegin; t < change.madeEnd; ++t) {
        for (const Id x : mesh_.triangle(t).v) leastCost_[x] = 0;
    }
    return true;
}

void WallCollapser::round(double maxCost, double limitMm, std::int64_t enough) {
    struct Edge {
        double cost;
        Id to;
        Plan plan;
    };
    std::vector<Edge> edges;
    for (Id u = 0; u < mesh_.pointCount(); ++u) {
        if (!mesh_.isAlive(u) || leastCost_[u] > maxCost) continue;
        if (mesh_.aliveTriangles() <= enough) return;
        edges.clear();
        double least = kInfinity;
        if (leastCost_[u] == 0) tried_[u] = -1;
        const std::uint32_t seen = ++stamp_;
        for (const Id t : mesh_.around(u)) {
            for (const Id x : mesh_.triangle(t).v) {
                if (x <= u || mark_[x] == seen) continue;
                mark_[x] = seen;
                const Plan plan = planFor(u, x);
                if (plan.cost <= tried_[u]) continue;
                if (plan.cost <= maxCost) {
                    edges.push_back({plan.cost, x, plan});
                } else {
                    least = std::min(least, plan.cost);
                }
            }
        }
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
                const Id next = nextSample_[s];
                double best2 = kInfinity;
                Id home = star[t - c.madeBegin];
                for (const Id to : star) {
                    if (mesh_.triangle(to).wall != mesh_.triangle(t).wall) continue;
                    const auto p = mesh_.cornersOf(to);
                    const Vec3 at = samplePoint(s);
                    const double d2 =
                        squaredNorm(at - closestPointOnTriangle(at, p[0], p[1], p[2]));
                    if (d2 < best2) {
                        best2 = d2;
                        home = to;
                    }
                }
                link(s, home, slot_[s]);
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
    for (const Id v : mesh_.triangle(full).v) tightness_[v] *= kTighter;
    tightness_[static_cast<Id>(mesh_.fullPoints()) + full] *= kTighter;
}

void WallCollapser::tightenNear(Id triangle) {
    for (Id s = firstSample_[triangle]; s != kNone; s = nextSample_[s]) {
        tightness_[s] *= kTighter;
    }
    for (const Id v : mesh_.triangle(triangle).v) tightness_[origin_[v]] *= kTighter;
}

WallCollapser::Id WallCollapser::standInOf(Id full) const {
    const auto& t = mesh_.triangle(full);
    const Id ofMiddle = home_[static_cast<Id>(mesh_.fullPoints()) + full];
    if (mesh_.isTriangleAlive(ofMiddle)) return ofMiddle;
    for (const Id v : t.v) {
        if (home_[v] != kNone && slot_[v] == kOnWall) return home_[v];
    }
    for (const Id v : t.v) {
        if (home_[v] == kNone) continue;
        const auto& own = mesh_.triangle(home_[v]);
        for (const Id x : own.v) {
            for (const Id at : mesh_.around(x)) {
                if (mesh_.triangle(at).wall == t.wall) return at;
            }
        }
    }
    for (const Id v : t.v) {
        for (const Id at : mesh_.around(v)) {
            if (mesh_.triangle(at).wall == t.wall) return at;
        }
    }
    return kNone;
}

WallCollapser::Id WallCollapser::fullNear(Id triangle) const {
    const auto& t = mesh_.triangle(triangle);
    for (const Id v : t.v) {
        const Id from = origin_[v];
        for (std::uint64_t n = fullBegin_[from]; n < fullBegin_[from + 1]; ++n) {
            if (mesh_.triangle(fullAround_[n]).wall == t.wall) return fullAround_[n];
        }
    }
    return kNone;
}

}  // namespace adaptiso::detail
