#include "adaptive/mending/SurfaceMender.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

using Number = SurfaceState::Number;

std::array<double, 3> barycentric(const Vec3& p, const Corners& t) {
    const Vec3 area2 = areaVector2(t[0], t[1], t[2]);
    const double whole = squaredNorm(area2);
    const double u = dot(areaVector2(p, t[1], t[2]), area2) / whole,
                 v = dot(areaVector2(t[0], p, t[2]), area2) / whole;
    return {u, v, 1 - u - v};
}

double squaredDistanceToNearest(const Vec3& p, const std::vector<Corners>& triangles) {
    double least = squaredDistanceToTriangle(p, triangles[0]);
    for (const Corners& t : triangles) least = std::min(least, squaredDistanceToTriangle(p, t));
    return least;
}

/// The numbers below `count` of which isMeant(number) is true, ascending.
template <class IsMeant>
std::vector<Number> numbersWhere(std::size_t count, const IsMeant& isMeant) {
    constexpr std::int64_t kPiece = 1 << 14;
    const auto end = static_cast<std::int64_t>(count);
    std::vector<std::vector<Number>> found((end + kPiece - 1) / kPiece);
    parallelForPieces(end, kPiece, [&](std::int64_t first, std::int64_t last) {
        for (std::int64_t n = first; n < last; ++n) {
            if (isMeant(static_cast<Number>(n)))
                found[first / kPiece].push_back(static_cast<Number>(n));
        }
    });
    std::vector<Number> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    return all;
}

bool contains(const std::vector<Number>& numbers, Number number) {
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

}  // namespace

SurfaceMender::SurfaceMender(SimplifiedSurface& surface, const MetricFrame& frame, double limitMm,
                             const std::optional<BoundingBox>& box)
    : surface_(surface),
      squaredLimit_(limitMm * limitMm),
      cubeMm_(kNearCube * frame.voxelMm()),
      box_(box) {}

std::size_t SurfaceMender::mendDistances(std::vector<PlaceBeyond> places) {
    std::erase_if(places, [](const PlaceBeyond& p) { return p.triangle == PlaceBeyond::kNone; });
    std::stable_sort(places.begin(), places.end(), [](const PlaceBeyond& a, const PlaceBeyond& b) {
        return a.squaredDistance() > b.squaredDistance();
    });
    return mendAll(places, [&](const PlaceBeyond& place) { return mendPlace(place); });
}

std::size_t SurfaceMender::mendCrossings(const std::vector<std::int64_t>& triangles,
                                         bool mergesFirst) {
    std::vector<PlaceBeyond> places;
    for (const std::int64_t t : triangles) {
        PlaceBeyond& place = places.emplace_back();
        place.triangle = static_cast<Number>(t);
    }
    return mendAll(places, [&](const PlaceBeyond& place) {
        return mendCrossing(place.triangle, mergesFirst);
    });
}

/// \param mend  mends one place, if it can \return how many it did
template <class Mend>
std::size_t SurfaceMender::mendAll(const std::vector<PlaceBeyond>& places, const Mend& mend) {
    prepare(places);
    // one vertex for a place at most: lists that grow by themselves take twice their memory
    surface_.points.reserve(surface_.points.size() + places.size());
    surface_.triangles.reserve(surface_.triangles.size() + 2 * places.size());
    const auto mended = std::count_if(places.begin(), places.end(), [&](const PlaceBeyond& place) {
        return !contains(gone_, place.triangle) && mend(place);
    });
    forget();
    removeTriangles(std::exchange(gone_, {}), surface_, changes_);
    return static_cast<std::size_t>(mended);
}

/// Brings the triangle to one of its samples, or merges two of its corners.
bool SurfaceMender::mendCrossing(Number triangle, bool mergesFirst) {
    const Corners corners = cornersOf(triangle);
    if (crossesNothing({corners}, around_.at(surface_.triangles[triangle][0]))) return false;
    std::vector<PlaceBeyond> places;
    const auto samples = samplesOf_.find(triangle);
    if (samples != samplesOf_.end()) {
        for (const Number s : samples->second) {
            const Vec3 p = surface_.samples[s].point();
            places.push_back(
                {closestPointOnTriangle(p, corners[0], corners[1], corners[2]), p, triangle, true});
        }
    }
    if (mergesFirst && mergeCorners(triangle)) return true;
    for (const PlaceBeyond& place : places) {
        if (insert(place, triangle, barycentric(place.onSimplified, corners))) return true;
    }
    return mergeCorners(triangle);
}

bool SurfaceMender::mergeCorners(Number triangle) {
    const Corners corners = cornersOf(triangle);
    const Vec3 middle = (1.0 / 3) * (corners[0] + corners[1] + corners[2]);
    for (int corner = 0; corner < 3; ++corner) {
        if (collapseEdge(triangle, corner, {middle, middle, triangle, false})) return true;
    }
    return false;
}

void SurfaceMender::prepare(const std::vector<PlaceBeyond>& places) {
    inSlot_.assign(kSlots, {});
    isSlotNear_.assign(kSlots, false);
    std::vector<bool> isTrackedVertex(surface_.points.size()), isNear(surface_.triangles.size());
    for (const PlaceBeyond& place : places) {
        for (const Number v : surface_.triangles[place.triangle]) isTrackedVertex[v] = true;
    }
    const Numbers near = numbersWhere(isNear.size(), [&](Number t) {
        const auto& [a, b, c] = surface_.triangles[t];
        return isTrackedVertex[a] || isTrackedVertex[b] || isTrackedVertex[c];
    });
    for (const Number t : near) {
        for (const Number v : surface_.triangles[t]) {
            if (isTrackedVertex[v]) around_[v].push_back(t);
        }
        isNear[t] = true;
        BoundingBox box = boxOf(cornersOf(t));
        box.widen(cubeMm_ / 2);  // new vertices lie beside the triangle
        forEachSlot(box, [&](std::size_t slot) { isSlotNear_[slot] = true; });
    }
    // most triangles lie in none of them
    const Numbers inSlots = numbersWhere(isNear.size(), [&](Number t) {
        bool mayBeIn = false;
        forEachSlot(boxOf(cornersOf(t)),
                    [&](std::size_t slot) { mayBeIn = mayBeIn || isSlotNear_[slot]; });
        return mayBeIn;
    });
    for (const Number t : inSlots) trackBox(t);
    const Numbers samples = numbersWhere(surface_.sampleTriangle.size(), [&](Number s) {
        return isNear[surface_.sampleTriangle[s]];
    });
    for (const Number s : samples) samplesOf_[surface_.sampleTriangle[s]].push_back(s);
}

/// Gives back what prepare() filled: a proof follows, which needs the memory.
void SurfaceMender::forget() {
    for (auto* const lists : {&around_, &parts_, &samplesOf_}) *lists = decltype(around_)();
    parent_ = decltype(parent_)();
    freeMemory(inSlot_, isSlotNear_);
}

bool SurfaceMender::mendPlace(const PlaceBeyond& place) {
    const Number t = partAt(place);
    if (t == kNone) return false;
    if (insert(place, t, barycentric(place.onSimplified, cornersOf(t)))) return true;
    for (int corner = 0; corner < 3; ++corner) {
        if (collapseEdge(t, corner, place)) return true;
    }
    return false;
}

/// \param at  barycentric coordinates of the place in the triangle
bool SurfaceMender::insert(const PlaceBeyond& place, Number triangle,
                           const std::array<double, 3>& at) {
    const auto largest = std::max_element(at.begin(), at.end()) - at.begin(),
               least = std::min_element(at.begin(), at.end()) - at.begin();
    const Vec3 whole = place.onFine - place.onSimplified;
    for (const double part : kMendSteps) {
        const Vec3 target = place.onSimplified + part * whole;
        if (at[largest] > kAtVertex &&
            moveVertex(surface_.triangles[triangle][largest], part * whole)) {
            return true;
        }
        const auto besideLeast = static_cast<int>(least + 1) % 3;
        if (at[least] < kAtEdge && splitEdge(triangle, besideLeast, target)) return true;
        const auto [a, b, c] = surface_.triangles[triangle];
        if (split({triangle}, {{a, b, kNone}, {b, c, kNone}, {c, a, kNone}}, target)) return true;
    }
    return false;
}

/// The part of the place's triangle that it lies in; kNone when the surface has left the place.
Number SurfaceMender::partAt(const PlaceBeyond& place) const {
    Number best = place.triangle;
    double least = squaredDistanceToTriangle(place.onSimplified, cornersOf(best));
    const auto parts = parts_.find(place.triangle);
    if (parts != parts_.end()) {
        for (const Number t : parts->second) {
            if (contains(gone_, t)) continue;
            const double squared = squaredDistanceToTriangle(place.onSimplified, cornersOf(t));
            if (squared >= least) continue;
            least = squared;
            best = t;
        }
    }
    return least > kLeftPlace * kLeftPlace * place.squaredDistance() ? kNone : best;
}

bool SurfaceMender::moveVertex(Number vertex, const Vec3& step) {
    if (!mayMove(vertex)) return false;
    const Numbers around = around_.at(vertex);
    const Vec3 target = surface_.points[vertex] + step;
    const auto moved = movedCorners(around, vertex, vertex, target);
    if (!moved || !mayReplace(around, *moved, target)) return false;
    for (const Number t : around) note(t);
    surface_.points[vertex] = target;
    for (const Number t : around) replace(t, surface_.triangles[t]);
    return true;
}

/// Splits the edge from a corner of the triangle to the next one, and the triangles at it.
bool SurfaceMender::splitEdge(Number triangle, int corner, const Vec3& point) {
    const std::optional<Edge> edge = edgeAt(triangle, corner);
    if (!edge) return false;
    const auto [a, b, c, d, twin] = *edge;
    return split({triangle, twin}, {{a, kNone, c}, {b, kNone, d}, {kNone, b, c}, {kNone, a, d}},
                 point);
}

/// Puts a new vertex into triangles.
/// \param parts  of each triangle in turn; kNone in place of the new vertex
bool SurfaceMender::split(const Numbers& triangles, const std::vector<Triangle>& parts,
                          const Vec3& point) {
    const auto parentOf = [&](std::size_t part) { return triangles[part % triangles.size()]; };
    std::vector<Corners> corners(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            corners[i][c] = parts[i][c] == kNone ? point : surface_.points[parts[i][c]];
        }
        if (!facesAs(corners[i], cornersOf(parentOf(i)))) return false;
    }
    if (!mayReplace(triangles, corners, point)) return false;
    for (const Number t : triangles) note(t);
    const Number v = addVertex(point);
    Numbers numbers = triangles;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Triangle part = parts[i];
        std::replace(part.begin(), part.end(), kNone, v);
        if (i < triangles.size()) {
            replace(triangles[i], part);
        } else {
            numbers.push_back(addTriangle(part, parentOf(i)));
        }
    }
    handOver(triangles, numbers);
    return true;
}

/// Merges the ends of the edge from a corner to the next one, where that brings the surface nearer
/// to the place.
bool SurfaceMender::collapseEdge(Number triangle, int corner, const PlaceBeyond& place) {
    const std::optional<Edge> edge = edgeAt(triangle, corner);
    if (!edge || !mayMerge(*edge)) return false;
    const auto [a, b, c, d, twin] = *edge;
    Numbers replaced = around_.at(a);
    for (const Number t : around_.at(b)) {
        if (!contains(replaced, t)) replaced.push_back(t);
    }
    Numbers kept = replaced;
    std::erase(kept, triangle);
    std::erase(kept, twin);
    const Vec3 first = surface_.points[a], second = surface_.points[b];
    const double squared = place.squaredDistance();
    for (const Vec3& target : {place.onFine, 0.5 * (first + second), first, second}) {
        const auto parts = movedCorners(kept, a, b, target);
        if (!parts || (squared > 0 && squaredDistanceToNearest(place.onFine, *parts) >= squared) ||
            !mayReplace(replaced, *parts, target)) {
            continue;
        }
        for (const Number t : replaced) note(t);
        surface_.points[a] = target;
        for (const Number t : {triangle, twin}) {
            leave(t);
            gone_.push_back(t);
        }
        for (const Number t : kept) {
            Triangle corners = surface_.triangles[t];
            std::replace(corners.begin(), corners.end(), b, a);
            replace(t, corners);
        }
        handOver(replaced, kept);
        return true;
    }
    return false;
}

/// The corners of triangles after two vertices went to a place; none where one turns too far.
std::optional<std::vector<Corners>> SurfaceMender::movedCorners(const Numbers& triangles, Number a,
                                                                Number b,
                                                                const Vec3& target) const {
    std::vector<Corners> moved;
    for (const Number t : triangles) {
        Corners& now = moved.emplace_back(cornersOf(t));
        for (int i = 0; i < 3; ++i) {
            const Number v = surface_.triangles[t][i];
            if (v == a || v == b) now[i] = target;
        }
        if (!facesAs(now, cornersOf(t))) return {};
    }
    return moved;
}

/// Merging the edge's ends leaves a manifold (link condition), and both may move.
bool SurfaceMender::mayMerge(const Edge& edge) const {
    if (!mayMove(edge.a) || !mayMove(edge.b)) return false;
    const auto withNeighbours = [&](Number vertex) {
        std::set<Number> vertices;
        for (const Number t : around_.at(vertex)) {
            vertices.insert(surface_.triangles[t].begin(), surface_.triangles[t].end());
        }
        return vertices;
    };
    const std::set<Number> atA = withNeighbours(edge.a), atB = withNeighbours(edge.b);
    const auto common =
        std::count_if(atA.begin(), atA.end(), [&](Number v) { return atB.contains(v); });
    // both ends, and the two corners across the edge
    constexpr std::ptrdiff_t kShared = 4;
    // each end with its neighbours: four vertices in all would be a tetrahedron, which goes flat
    constexpr std::size_t kLeast = 10;
    return common == kShared && atA.size() + atB.size() >= kLeast;
}

/// The triangle is not flat, and faces about where another one does.
bool SurfaceMender::facesAs(const Corners& now, const Corners& before) const {
    const Vec3 area2 = areaVector2(now[0], now[1], now[2]),
               old = areaVector2(before[0], before[1], before[2]);
    const double longest = std::max(
        {squaredNorm(now[1] - now[0]), squaredNorm(now[2] - now[1]), squaredNorm(now[0] - now[2])});
    return norm(area2) > kFlatTriangle * longest &&
           dot(area2, old) > kMendCosine * norm(area2) * norm(old);
}

/// Triangles may come in place of others: the vertex of theirs that is new or moved is in the box.
bool SurfaceMender::mayReplace(const Numbers& replaced, const std::vector<Corners>& triangles,
                               const Vec3& vertex) const {
    return (!box_ || box_->contains(vertex)) && isFree(vertex, replaced) &&
           staysNear(triangles, replaced) && crossesNothing(triangles, replaced);
}

/// No other triangle has a corner there: two vertices at one place do not cross as trianglesCross
/// has it, but are one vertex to whoever welds them.
bool SurfaceMender::isFree(const Vec3& point, const Numbers& replaced) const {
    return !isAnyNear({point, point}, replaced, [&](const Corners& other) {
        return std::find(other.begin(), other.end(), point) != other.end();
    });
}

/// The samples of the replaced triangles lie within the bound of the new ones, or as near as the
/// farthest before.
bool SurfaceMender::staysNear(const std::vector<Corners>& triangles,
                              const Numbers& replaced) const {
    double before = squaredLimit_, after = 0;
    for (const Number t : replaced) {
        const auto samples = samplesOf_.find(t);
        if (samples == samplesOf_.end()) continue;
        for (const Number s : samples->second) {
            const Vec3 p = surface_.samples[s].point();
            after = std::max(after, squaredDistanceToNearest(p, triangles));
            before = std::max(before, squaredDistanceToTriangle(p, cornersOf(t)));
        }
    }
    return after <= before;
}

bool SurfaceMender::crossesNothing(const std::vector<Corners>& triangles,
                                   const Numbers& replaced) const {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (trianglesCross(triangles[i], triangles[j])) return false;
        }
        const bool crosses = isAnyNear(boxOf(triangles[i]), replaced, [&](const Corners& other) {
            return trianglesCross(triangles[i], other);
        });
        if (crosses) return false;
    }
    return true;
}

/// isMeant(corners) is true of a triangle that overlaps the box, and does not go.
template <class IsMeant>
bool SurfaceMender::isAnyNear(const BoundingBox& box, const Numbers& replaced,
                              const IsMeant& isMeant) const {
    bool isAny = false;
    forEachSlot(box, [&](std::size_t slot) {
        isAny = isAny || std::any_of(inSlot_[slot].begin(), inSlot_[slot].end(), [&](Number t) {
                    const Corners other = cornersOf(t);
                    return boxOf(other).overlaps(box) && isMeant(other) && !contains(replaced, t) &&
                           !contains(gone_, t);
                });
    });
    return isAny;
}

/// The triangle with this half-edge.
/// \pre one of its ends is tracked
Number SurfaceMender::triangleOf(Number from, Number to) const {
    for (const Number t : around_.at(isTracked(from) ? from : to)) {
        const Triangle& c = surface_.triangles[t];
        for (int i = 0; i < 3; ++i) {
            if (c[i] == from && c[(i + 1) % 3] == to) return t;
        }
    }
    return kNone;
}

/// The edge from a corner of the triangle to the next one; none at an open border.
std::optional<SurfaceMender::Edge> SurfaceMender::edgeAt(Number triangle, int corner) const {
    const Triangle& t = surface_.triangles[triangle];
    const Number a = t[corner], b = t[(corner + 1) % 3];
    if (!isTracked(a) && !isTracked(b)) return {};
    const Number twin = triangleOf(b, a);
    if (twin == kNone) return {};
    const Triangle& u = surface_.triangles[twin];
    const auto d = std::find_if(u.begin(), u.end(), [&](auto v) { return v != a && v != b; });
    return Edge{a, b, t[(corner + 2) % 3], *d, twin};
}

/// Not at an open border.
bool SurfaceMender::mayMove(Number vertex) const {
    if (!isTracked(vertex) || surface_.states[vertex] == Patch::State::Final) return false;
    Number open = 0;  // where the edges around it lead, less where they start: 0 where they close
    for (const Number t : around_.at(vertex)) {
        const Triangle& c = surface_.triangles[t];
        const auto i = std::find(c.begin(), c.end(), vertex) - c.begin();
        open += c[(i + 2) % 3] - c[(i + 1) % 3];
    }
    return open == 0;
}

Number SurfaceMender::addVertex(const Vec3& point) {
    const auto v = static_cast<Number>(surface_.points.size());
    surface_.points.push_back(point);
    surface_.states.push_back(Patch::State::Open);
    if (!surface_.marks.empty()) surface_.marks.push_back(Patch::kPlain);
    around_[v];
    return v;
}

/// \param parent  the triangle that it was a part of
Number SurfaceMender::addTriangle(const Triangle& triangle, Number parent) {
    const auto number = static_cast<Number>(surface_.triangles.size());
    surface_.triangles.push_back(triangle);
    changes_.triangles.push_back(number);
    track(number);
    const auto older = parent_.find(parent);
    const Number oldest = older == parent_.end() ? parent : older->second;
    parent_[number] = oldest;
    parts_[oldest].push_back(number);
    return number;
}

/// Its vertices list the triangle no longer.
void SurfaceMender::leave(Number triangle) {
    for (const Number v : surface_.triangles[triangle]) {
        const auto around = around_.find(v);
        if (around != around_.end()) std::erase(around->second, triangle);
    }
}

void SurfaceMender::replace(Number number, const Triangle& triangle) {
    leave(number);
    surface_.triangles[number] = triangle;
    track(number);
}

/// The triangle is about to change.
void SurfaceMender::note(Number triangle) {
    changes_.triangles.push_back(triangle);
    changes_.before.push_back(cornersOf(triangle));
    changed_.push_back(surface_.triangles[triangle]);
}

/// Lists a triangle with its vertices and its cubes.
void SurfaceMender::track(Number triangle) {
    changed_.push_back(surface_.triangles[triangle]);
    for (const Number v : surface_.triangles[triangle]) {
        const auto around = around_.find(v);
        if (around != around_.end()) around->second.push_back(triangle);
    }
    trackBox(triangle);
}

void SurfaceMender::trackBox(Number triangle) {
    forEachSlot(boxOf(cornersOf(triangle)), [&](std::size_t slot) {
        if (isSlotNear_[slot]) inSlot_[slot].push_back(triangle);
    });
}

/// Gives the samples of some triangles to the nearest of others.
void SurfaceMender::handOver(const Numbers& from, const Numbers& to) {
    Numbers samples;
    for (const Number t : from) {
        const auto of = samplesOf_.find(t);
        if (of == samplesOf_.end()) continue;
        samples.insert(samples.end(), of->second.begin(), of->second.end());
        of->second.clear();
    }
    for (const Number s : samples) {
        const Vec3 p = surface_.samples[s].point();
        const Number nearest = *std::min_element(to.begin(), to.end(), [&](Number t, Number u) {
            return squaredDistanceToTriangle(p, cornersOf(t)) <
                   squaredDistanceToTriangle(p, cornersOf(u));
        });
        surface_.sampleTriangle[s] = nearest;
        samplesOf_[nearest].push_back(s);
    }
}

/// Calls f(slot) for the cubes that a box overlaps.
template <class F>
void SurfaceMender::forEachSlot(const BoundingBox& box, const F& f) const {
    const auto at = [&](double mm) { return static_cast<std::int64_t>(std::floor(mm / cubeMm_)); };
    for (std::int64_t z = at(box.minimum.z); z <= at(box.maximum.z); ++z) {
        for (std::int64_t y = at(box.minimum.y); y <= at(box.maximum.y); ++y) {
            for (std::int64_t x = at(box.minimum.x); x <= at(box.maximum.x); ++x) {
                const auto hash = static_cast<std::uint64_t>(x) * 73856093 ^
                                  static_cast<std::uint64_t>(y) * 19349663 ^
                                  static_cast<std::uint64_t>(z) * 83492791;
                f(static_cast<std::size_t>(hash % kSlots));
            }
        }
    }
}

}  // namespace adaptiso::detail
