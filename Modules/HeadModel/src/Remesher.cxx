#include "Remesher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso {
namespace {

constexpr double kLong = 4.0 / 3, kShort = 4.0 / 5;  // [Botsch2004]: each halves to the other
constexpr double kUpright = 0.1;     // a triangle within 84 degrees of the surface under it
constexpr double kMaxTurnCos = 0.7;  // vertices on a crest, where normals turn fast, stay there
constexpr double kCrestCos =
    0.3;  // 72 degrees along an edge: bent more sharply than edges are long
constexpr double kCrestLoss = 0.15;  // of an edge length, that a crest may lose to a collapse
constexpr double kMaxFoldCos = 0.5;  // edges sharper than 60 degrees are features: not flipped
constexpr double kFitEdges = 0.75;   // radius of the local fit, edge lengths
constexpr std::int64_t kSlotGrain = 256;

double angleAt(const Vec3& apex, const Vec3& a, const Vec3& b) {
    return std::atan2(norm(areaVector2(apex, a, b)), dot(a - apex, b - apex));
}

double cosBetween(const Vec3& a, const Vec3& b) {
    const double lengths = std::sqrt(squaredNorm(a) * squaredNorm(b));
    return lengths > 0 ? dot(a, b) / lengths : 1;
}

/// Along an edge, between the normals at its ends.
bool turnsAtCrest(const Vec3& a, const Vec3& b) {
    return dot(a, b) < kCrestCos;
}

}  // namespace

Remesher::Remesher(const RemeshTarget& target) : target_(target), mesh_(target.surface()) {
    for (VertexId v = 0; v < mesh_.vertexSlots(); ++v) {
        if (mesh_.isVertexAlive(v)) {
            settle(v, target.atVertex(v));
        } else {
            settle(v, {});
        }
    }
}

void Remesher::settle(VertexId v, const Landing& landing) {
    if (v >= std::ssize(sizesMm_)) {
        sizesMm_.resize(v + 1);
        normals_.resize(v + 1);
        triangles_.resize(v + 1);
    }
    mesh_.setPoint(v, landing.pointMm);
    sizesMm_[v] = landing.sizeMm;
    normals_[v] = landing.normal;
    triangles_[v] = landing.triangle;
}

double Remesher::trianglesAtScaleOne() const {
    double triangles = 0;
    for (HalfEdge h = 0; h < mesh_.halfEdgeSlots(); h += 3) {
        if (!mesh_.isAlive(h)) continue;
        const double size =
            (sizesMm_[mesh_.from(h)] + sizesMm_[mesh_.from(h + 1)] + sizesMm_[mesh_.from(h + 2)]) /
            3;
        triangles += norm(mesh_.areaVector(h)) / 2 / (std::numbers::sqrt3 / 4 * size * size);
    }
    return triangles;
}

// Euler: T = 2 V - 4
std::int64_t Remesher::verticesWanted() const {
    return std::llround(trianglesAtScaleOne() / (scale_ * scale_) / 2) + 2;
}

double Remesher::scaleFor(std::int64_t vertices) const {
    return std::sqrt(trianglesAtScaleOne() / static_cast<double>(2 * vertices - 4));
}

double Remesher::relativeLength(HalfEdge h) const {
    return 2 * std::sqrt(mesh_.squaredLength(h)) /
           (scale_ * (sizesMm_[mesh_.from(h)] + sizesMm_[mesh_.to(h)]));
}

double Remesher::uprightness(HalfEdge h) const {
    return cosBetween(mesh_.areaVector(h), normals_[mesh_.from(h)] + normals_[mesh_.to(h)] +
                                               normals_[mesh_.opposite(h)]);
}

bool Remesher::staysUpright(HalfEdge h, const Vec3& area, const Vec3& normals) const {
    const double then = cosBetween(area, normals);
    return then >= kUpright || then >= uprightness(h);
}

Landing Remesher::midpoint(HalfEdge h) const {
    return target_.project(0.5 * (mesh_.point(mesh_.from(h)) + mesh_.point(mesh_.to(h))),
                           triangles_[mesh_.from(h)]);
}

bool Remesher::losesCrest(VertexId a, VertexId b, const Landing& landing) const {
    double nearest2 = squaredNorm(mesh_.point(a) - landing.pointMm);
    const auto look = [&](VertexId end, VertexId other) {
        mesh_.forEachOut(end, [&](HalfEdge out) {
            const VertexId p = mesh_.to(out), q = mesh_.opposite(out);
            if (p == other || q == other) return;
            const Vec3 near = closestPointOnTriangle(mesh_.point(a), landing.pointMm,
                                                     mesh_.point(p), mesh_.point(q));
            nearest2 = std::min(nearest2, squaredNorm(mesh_.point(a) - near));
        });
    };
    look(a, b);
    look(b, a);
    const double allowed = kCrestLoss * scale_ * sizesMm_[a];
    return nearest2 > allowed * allowed;
}

bool Remesher::tryCollapse(HalfEdge h, const Landing& landing, double longestAllowed) {
    if (!mesh_.canCollapse(h)) return false;
    const VertexId a = mesh_.from(h), b = mesh_.to(h);
    bool isGood = true;
    const auto inspect = [&](VertexId end, VertexId other) {
        mesh_.forEachOut(end, [&](HalfEdge out) {
            const VertexId p = mesh_.to(out), q = mesh_.opposite(out);
            if (!isGood || p == other || q == other) return;
            const Vec3 normals = landing.normal + normals_[p] + normals_[q];
            const Vec3 area = areaVector2(landing.pointMm, mesh_.point(p), mesh_.point(q));
            const double longest = longestAllowed * scale_ / 2 * (landing.sizeMm + sizesMm_[p]);
            isGood = squaredNorm(mesh_.point(p) - landing.pointMm) <= longest * longest &&
                     staysUpright(out, area, normals);
        });
    };
    inspect(a, b);
    if (isGood) inspect(b, a);
    if (!isGood || (isOnCrest(a) && losesCrest(a, b, landing))) return false;
    mesh_.collapse(h);
    settle(b, landing);
    return true;
}

void Remesher::coarsen(std::int64_t vertices) {
    constexpr double kGrowth = 1.3;
    constexpr int kIdleRounds = 12;  // by then the bound has grown twentyfold without effect
    double sum = 0;
    std::int64_t edges = 0;
    for (HalfEdge h = 0; h < mesh_.halfEdgeSlots(); ++h) {
        if (!mesh_.isFirst(h)) continue;
        sum += relativeLength(h);
        ++edges;
    }
    double bound = sum / static_cast<double>(edges);
    for (int idle = 0; vertexCount() > vertices && idle < kIdleRounds; bound *= kGrowth) {
        const std::int64_t before = vertexCount();
        for (HalfEdge h = 0; h < mesh_.halfEdgeSlots() && vertexCount() > vertices; ++h) {
            if (!mesh_.isFirst(h) || relativeLength(h) >= bound) continue;
            const VertexId a = mesh_.from(h), b = mesh_.to(h);
            const auto stay = [&](VertexId v) {
                return Landing{mesh_.point(v), triangles_[v], normals_[v], sizesMm_[v]};
            };
            if (!tryCollapse(h, stay(b), 2 * bound)) tryCollapse(mesh_.twin(h), stay(a), 2 * bound);
        }
        idle = vertexCount() < before ? 0 : idle + 1;
    }
}

void Remesher::compact() {
    const std::vector<VertexId> former = mesh_.compact();
    const auto pick = [&](auto& values) {
        for (std::size_t v = 0; v < former.size(); ++v) values[v] = values[former[v]];
        values.resize(former.size());
    };
    pick(sizesMm_);
    pick(normals_);
    pick(triangles_);
}

void Remesher::splitLongEdges(std::int64_t mostVertices) {
    const HalfEdge end = mesh_.halfEdgeSlots();  // new edges are short enough
    for (HalfEdge h = 0; h < end && vertexCount() < mostVertices; ++h) {
        if (!mesh_.isFirst(h) || relativeLength(h) <= kLong) continue;
        const Landing landing = midpoint(h);
        settle(mesh_.split(h, landing.pointMm), landing);
    }
}

void Remesher::collapseShortEdges() {
    for (HalfEdge h = 0; h < mesh_.halfEdgeSlots(); ++h) {
        if (mesh_.isFirst(h) && relativeLength(h) < kShort) tryCollapse(h, midpoint(h), kLong);
    }
}

bool Remesher::tryFlip(HalfEdge h) {
    const HalfEdge g = mesh_.twin(h);
    const Vec3 left = mesh_.areaVector(h), right = mesh_.areaVector(g);
    if (cosBetween(left, right) < kMaxFoldCos || !mesh_.canFlip(h)) return false;
    const VertexId a = mesh_.from(h), b = mesh_.to(h), c = mesh_.opposite(h), d = mesh_.opposite(g);
    const Vec3 &pa = mesh_.point(a), &pb = mesh_.point(b), &pc = mesh_.point(c),
               &pd = mesh_.point(d);
    const Vec3 newLeft = areaVector2(pd, pc, pa), newRight = areaVector2(pc, pd, pb);
    const Vec3 edge = normals_[c] + normals_[d];
    const double before = std::min({kUpright, uprightness(h), uprightness(g)});
    if (cosBetween(newLeft, newRight) < kMaxFoldCos ||
        cosBetween(newLeft, edge + normals_[a]) < before ||
        cosBetween(newRight, edge + normals_[b]) < before) {
        return false;
    }
    mesh_.flip(h);
    return true;
}

void Remesher::evenValences() {
    const auto excess = [&](VertexId v) { return mesh_.valence(v) - 6; };
    const auto square = [](std::int64_t n) { return n * n; };
    for (HalfEdge h = 0; h < mesh_.halfEdgeSlots(); ++h) {
        if (!mesh_.isFirst(h)) continue;
        const std::int64_t a = excess(mesh_.from(h)), b = excess(mesh_.to(h)),
                           c = excess(mesh_.opposite(h)), d = excess(mesh_.opposite(mesh_.twin(h)));
        const std::int64_t now = square(a) + square(b) + square(c) + square(d);
        const std::int64_t then = square(a - 1) + square(b - 1) + square(c + 1) + square(d + 1);
        if (then < now) tryFlip(h);
    }
}

void Remesher::flipToDelaunay() {
    constexpr int kMaxRounds = 20;
    constexpr double kSlack = 1e-6;  // radians: squares aren't flipped to and fro
    bool hasFlipped = true;
    for (int round = 0; round < kMaxRounds && hasFlipped; ++round) {
        hasFlipped = false;
        for (HalfEdge h = 0; h < mesh_.halfEdgeSlots(); ++h) {
            if (!mesh_.isFirst(h)) continue;
            const Vec3 &a = mesh_.point(mesh_.from(h)), &b = mesh_.point(mesh_.to(h));
            const double sum = angleAt(mesh_.point(mesh_.opposite(h)), a, b) +
                               angleAt(mesh_.point(mesh_.opposite(mesh_.twin(h))), a, b);
            if (sum > std::numbers::pi + kSlack && tryFlip(h)) hasFlipped = true;
        }
    }
}

std::optional<Vec3> Remesher::relaxed(VertexId v) const {
    // The centre of mass of the triangles round v, as cells of a centroidal tessellation have
    // theirs [Du1999]. Triangles grow with size^2 and lie off by size, so size^-3 is what leaves
    // a well graded mesh where it is.
    Vec3 sum;
    double weights = 0;
    bool isCrest = false;
    mesh_.forEachOut(v, [&](HalfEdge h) {
        const VertexId p = mesh_.to(h), q = mesh_.opposite(h);
        isCrest = isCrest || turnsAtCrest(normals_[v], normals_[p]);
        const double size = sizesMm_[v] + sizesMm_[p] + sizesMm_[q];
        const double weight = norm(mesh_.areaVector(h)) / (size * size * size);
        sum += weight / 3 * (mesh_.point(v) + mesh_.point(p) + mesh_.point(q));
        weights += weight;
    });
    if (isCrest) return std::nullopt;
    if (!(weights > 0)) return mesh_.point(v);
    const Vec3 move = 1 / weights * sum - mesh_.point(v);
    return mesh_.point(v) + (move - dot(move, normals_[v]) * normals_[v]);
}

bool Remesher::isOnCrest(VertexId v) const {
    bool isCrest = false;
    mesh_.forEachOut(v, [&](HalfEdge h) {
        isCrest = isCrest || turnsAtCrest(normals_[v], normals_[mesh_.to(h)]);
    });
    return isCrest;
}

bool Remesher::tryMove(VertexId v, const Landing& landing) {
    bool isGood = dot(landing.normal, normals_[v]) >= kMaxTurnCos;
    mesh_.forEachOut(v, [&](HalfEdge h) {
        const VertexId p = mesh_.to(h), q = mesh_.opposite(h);
        const Vec3 area = areaVector2(landing.pointMm, mesh_.point(p), mesh_.point(q));
        isGood = isGood && staysUpright(h, area, landing.normal + normals_[p] + normals_[q]);
    });
    if (isGood) settle(v, landing);
    return isGood;
}

Landing Remesher::moved(VertexId v, const Vec3& p) const {
    // what lies this far off slid into a dead end, or the surface bends sharply
    constexpr double kFarEdges = 0.1;
    if (isThorough_) return target_.project(p, triangles_[v]);
    const Landing slid = target_.slide(p, triangles_[v]);
    const double farMm = kFarEdges * scale_ * sizesMm_[v];
    if (squaredNorm(slid.pointMm - p) <= farMm * farMm) return slid;
    return target_.project(p, slid.triangle);
}

void Remesher::relax(int rounds) {
    const std::int64_t slots = mesh_.vertexSlots();
    std::vector<Landing> landings(slots);
    for (int round = 0; round < rounds; ++round) {
        parallelForPieces(slots, kSlotGrain, [&](std::int64_t begin, std::int64_t end) {
            for (VertexId v = begin; v < end; ++v) {
                landings[v].triangle = -1;
                if (!mesh_.isVertexAlive(v)) continue;
                if (const auto to = relaxed(v)) landings[v] = moved(v, *to);
            }
        });
        for (VertexId v = 0; v < slots; ++v) {
            if (landings[v].triangle >= 0) tryMove(v, landings[v]);
        }
    }
}

struct Remesher::Ranked {
    double length;
    HalfEdge edge;
};

std::vector<EditMesh::HalfEdge> Remesher::rankedEdges(bool isLongestFirst) const {
    std::vector<Ranked> ranked;
    for (HalfEdge h = 0; h < mesh_.halfEdgeSlots(); ++h) {
        if (mesh_.isFirst(h)) ranked.push_back({relativeLength(h), h});
    }
    std::sort(ranked.begin(), ranked.end(), [&](const Ranked& l, const Ranked& r) {
        if (l.length != r.length) return (l.length > r.length) == isLongestFirst;
        return l.edge < r.edge;
    });
    std::vector<HalfEdge> edges;
    edges.reserve(ranked.size());
    for (const Ranked& r : ranked) edges.push_back(r.edge);
    return edges;
}

std::int64_t Remesher::splitLongest(std::int64_t count) {
    std::vector<bool> isTouched(mesh_.vertexSlots());
    std::int64_t done = 0;
    for (const HalfEdge h : rankedEdges(true)) {
        if (done == count) break;
        const std::array<VertexId, 4> corners{mesh_.from(h), mesh_.to(h), mesh_.opposite(h),
                                              mesh_.opposite(mesh_.twin(h))};
        if (std::any_of(corners.begin(), corners.end(),
                        [&](VertexId v) { return v >= std::ssize(isTouched) || isTouched[v]; })) {
            continue;
        }
        const Landing landing = midpoint(h);
        settle(mesh_.split(h, landing.pointMm), landing);
        for (const VertexId v : corners) isTouched[v] = true;
        ++done;
    }
    return done;
}

std::int64_t Remesher::collapseShortest(std::int64_t count) {
    std::vector<bool> isTouched(mesh_.vertexSlots());
    std::int64_t done = 0;
    for (const HalfEdge h : rankedEdges(false)) {
        if (done == count) break;
        if (!mesh_.isAlive(h)) continue;
        const VertexId a = mesh_.from(h), b = mesh_.to(h);
        if (isTouched[a] || isTouched[b]) continue;
        constexpr double kAnyLength = std::numeric_limits<double>::infinity();
        if (!tryCollapse(h, midpoint(h), kAnyLength)) continue;
        isTouched[b] = true;
        mesh_.forEachOut(b, [&](HalfEdge out) { isTouched[mesh_.to(out)] = true; });
        ++done;
    }
    return done;
}

void Remesher::fitVertices(double limitMm) {
    const std::int64_t slots = mesh_.vertexSlots();
    std::vector<Landing> landings(slots);
    parallelForPieces(slots, kSlotGrain, [&](std::int64_t begin, std::int64_t end) {
        for (VertexId v = begin; v < end; ++v) {
            if (!mesh_.isVertexAlive(v)) continue;
            Landing& at = landings[v] = {mesh_.point(v), triangles_[v], normals_[v], sizesMm_[v]};
            const LocalFit fit = target_.fit(at, kFitEdges * scale_ * sizesMm_[v]);
            if (!fit.isValid) continue;
            at.pointMm += std::clamp(fit.heightMm, -limitMm, limitMm) * at.normal;
        }
    });
    for (VertexId v = 0; v < slots; ++v) {
        if (mesh_.isVertexAlive(v)) tryMove(v, landings[v]);
    }
}

}  // namespace adaptiso
