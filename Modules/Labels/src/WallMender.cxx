#include "WallMender.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "adaptiso/MeshQuality/CrossingSearch.h"

namespace adaptiso::detail {
namespace {

using Id = WallMesh::Id;

/// Where less than one in so many triangles is wanted, what is near them is looked up.
constexpr std::size_t kFew = 4;
/// Where more of the walls than one in so many full triangles are to be proved, all are mapped.
constexpr std::size_t kOfAll = 6;

/// The numbers below a count.
std::vector<Id> firstNumbers(Id count) {
    std::vector<Id> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

}  // namespace

WallMender::WallMender(WallCollapser& collapser, double limitMm, bool mayGrow)
    : collapser_(collapser),
      mesh_(collapser.mesh()),
      limitMm_(limitMm),
      boundMm_(limitMm),
      mayGrow_(mayGrow),
      isLast_(mesh_.firstTriangle(), 0),
      isFullProved_(mesh_.fullTriangles(), 1),
      witnessesOf_(mesh_.fullTriangles()) {
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        // what was there when the collapser began
        isLast_.push_back(mesh_.makerOf(t) == kNone ? 1 : 0);
    }
    if (mesh_.firstTriangle() != 0) {
        full_ = NearTriangles(mesh_, firstNumbers(mesh_.fullTriangles()));
    }
}

bool WallMender::mend() {
    changes_.clear();
    findCrossings();
    forgetChanged();
    proveByMap();
    findBeyondOfSimple();
    findBeyondOfFull();
    std::sort(changes_.begin(), changes_.end());
    changes_.erase(std::unique(changes_.begin(), changes_.end()), changes_.end());
    for (const Id change : changes_) collapser_.undo(change);
    return !changes_.empty();
}

void WallMender::blame(Id triangle) {
    if (triangle != kNone && mesh_.makerOf(triangle) != kNone) {
        changes_.push_back(mesh_.makerOf(triangle));
    }
}

BoundingBox WallMender::boxAround(Id triangle, double distanceMm) const {
    BoundingBox box = boxOf(mesh_.cornersOf(triangle));
    box.widen(distanceMm);
    return box;
}

/// Triangles that were there at the last look, or before the collapses, cross nothing. One that
/// came back since then was cleared among others than those that are there now.
void WallMender::findCrossings() {
    isClear_.resize(mesh_.triangleCount(), 0);
    const auto wasThere = [&](Id t) { return t < isLast_.size() && isLast_[t] != 0; };
    std::vector<Id> alive, wanted;
    const auto isWanted = [&](Id t) {
        return !wasThere(t) || (mesh_.makerOf(t) != kNone && isClear_[t] == 0);
    };
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        if (!mesh_.isTriangleAlive(t)) continue;
        alive.push_back(t);
        if (isWanted(t)) wanted.push_back(t);
    }
    if (wanted.empty()) return;
    if (kFew * wanted.size() < alive.size()) {
        const NearTriangles near(mesh_, wanted);
        std::erase_if(alive, [&](Id t) { return !near.hasOne(mesh_, boxAround(t, 0)); });
    }
    std::vector<std::uint8_t> areWanted;
    std::vector<Vec3> points;
    std::vector<TriangleView::Triangle> triangles;
    std::vector<Id> number(mesh_.pointCount(), kNone);
    for (const Id t : alive) {
        areWanted.push_back(isWanted(t) ? 1 : 0);
        for (const Id v : mesh_.triangle(t).v) {
            if (number[v] != kNone) continue;
            number[v] = static_cast<Id>(points.size());
            points.push_back(mesh_.point(v));
        }
        const auto& [a, b, c] = mesh_.triangle(t).v;
        triangles.push_back({number[a], number[b], number[c]});
    }
    const CrossingPairs crossing = findCrossingPairs(
        {points, triangles}, [&](Id a, Id b) { return (areWanted[a] | areWanted[b]) != 0; });
    for (const Id t : wanted) isClear_[t] = 1;
    const auto undo = [&](Id n) {
        const Id t = alive[n];
        isClear_[t] = 0;
        blame(t);
        collapser_.tightenNear(t);
    };
    for (const auto& [a, b] : crossing.pairs) {
        undo(a);
        undo(b);
    }
    for (const Id n : crossing.undecided) undo(n);
}

/// Triangles of the full walls that what they were near may have left are to be proved again.
void WallMender::forgetChanged() {
    const bool beginsFull = mesh_.firstTriangle() == 0;
    for (Id t = mesh_.firstTriangle(); t < isLast_.size(); ++t) {
        if (isLast_[t] == 0 || mesh_.isTriangleAlive(t)) continue;
        if (beginsFull) {  // at first each triangle of the full walls is near itself
            if (t < mesh_.fullTriangles()) isFullProved_[t] = 0;
            continue;
        }
        const Id wall = mesh_.triangle(t).wall;
        full_.forEach(mesh_, boxAround(t, boundMm_), [&](Id f) {
            if (witnessesOf_[f].count == 0 && mesh_.triangle(f).wall == wall) isFullProved_[f] = 0;
        });
    }
    isProved_.resize(mesh_.triangleCount(), 0);
    isLast_.resize(mesh_.triangleCount(), 0);
    for (Id t = 0; t < isLast_.size(); ++t) isLast_[t] = mesh_.isTriangleAlive(t) ? 1 : 0;
    for (Id f = 0; f < mesh_.fullTriangles(); ++f) {
        const auto& [begin, count] = witnessesOf_[f];
        for (Id n = begin; n < begin + count; ++n) isFullProved_[f] &= isLast_[witnesses_[n]];
    }
}

void WallMender::keepWitnesses(const std::vector<Id>& full, const WallBound& bound) {
    Id at = 0;
    for (std::size_t n = 0; n < full.size(); ++n) {
        witnessesOf_[full[n]] = {static_cast<Id>(witnesses_.size()), bound.witnessCounts[n]};
        const auto from = bound.witnesses.begin() + at;
        witnesses_.insert(witnesses_.end(), from, from + bound.witnessCounts[n]);
        at += bound.witnessCounts[n];
    }
}

/// Collapses to undo where triangles of the full walls lie too far from the present ones.
void WallMender::blameNear(const std::vector<WallPlace>& places) {
    std::vector<Id> unexplained;
    for (const WallPlace& place : places) {
        const std::size_t before = changes_.size();
        blame(collapser_.meshNear(place.triangle));
        if (changes_.size() > before) continue;
        for (const Id t : place.near) blame(t);
        if (changes_.size() == before) unexplained.push_back(place.triangle);
    }
    if (unexplained.empty()) return;
    const NearTriangles near(mesh_, std::move(unexplained));
    for (Id t = 0; t < mesh_.triangleCount(); ++t) {
        if (mesh_.isTriangleAlive(t) || mesh_.killerOf(t) >= mesh_.changeCount()) continue;
        const Id killer = mesh_.killerOf(t);
        if (!mesh_.isChangeStanding(killer)) continue;
        if (near.hasOne(mesh_, boxAround(t, boundMm_))) changes_.push_back(killer);
    }
}

/// The full walls, as far as they may be near triangles of the mesh: round the samples of these and
/// of their neighbours.
const WallSurface& WallMender::fullNear(const std::vector<Id>& triangles) {
    if (!wholeFull_ && (mayGrow_ || kFew * triangles.size() > mesh_.fullTriangles())) {
        wholeFull_.emplace(mesh_, firstNumbers(mesh_.fullTriangles()));
    }
    if (wholeFull_) return *wholeFull_;
    std::vector<std::uint8_t> isIn(mesh_.triangleCount(), 0);
    std::vector<Id> beside;
    for (const Id t : triangles) {
        for (const Id v : mesh_.triangle(t).v) {
            for (const Id n : mesh_.around(v)) {
                if (isIn[n] == 0) beside.push_back(n);
                isIn[n] = 1;
            }
        }
    }
    std::vector<Id> near = fullOver(beside);
    std::sort(near.begin(), near.end());
    nearFull_.emplace(mesh_, std::move(near));
    return *nearFull_;
}

/// Triangles of the full walls that have a vertex that is assigned to one of these.
std::vector<WallMender::Id> WallMender::fullOver(const std::vector<Id>& triangles) const {
    std::vector<std::uint8_t> isIn(mesh_.fullTriangles(), 0);
    std::vector<Id> over;
    for (const Id t : triangles) {
        collapser_.forEachSample(t, [&](Id sample) {
            for (const Id f : collapser_.fullAround(sample)) {
                if (isIn[f] == 0) over.push_back(f);
                isIn[f] = 1;
            }
        });
    }
    return over;
}

std::vector<WallMender::Id> WallMender::unprovedTriangles() const {
    std::vector<Id> unproved;
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        if (mesh_.isTriangleAlive(t) && isProved_[t] == 0 && mesh_.makerOf(t) != kNone) {
            unproved.push_back(t);
        }
    }
    return unproved;
}

/// Those of the full walls.
std::vector<WallMender::Id> WallMender::unprovedFull() const {
    std::vector<Id> unproved;
    for (Id t = 0; t < mesh_.fullTriangles(); ++t) {
        if (!mesh_.isTriangleAlive(t) && isFullProved_[t] == 0) unproved.push_back(t);
    }
    return unproved;
}

/// Triangles of the mesh: all, or those round what vertices of some of the full walls are assigned
/// to.
std::vector<WallMender::Id> WallMender::aliveTriangles(bool areAll,
                                                       const std::vector<Id>& full) const {
    std::vector<std::uint8_t> isNear(areAll ? 0 : mesh_.pointCount(), 0);
    if (!areAll) {
        for (const Id f : full) {
            for (const Id sample : collapser_.fullTriangle(f).v) {
                const Id assigned = collapser_.assignmentOf(sample).triangle;
                if (assigned == kNone) {
                    isNear[sample] = 1;
                } else {
                    for (const Id v : mesh_.triangle(assigned).v) isNear[v] = 1;
                }
            }
        }
    }
    std::vector<Id> alive;
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        if (!mesh_.isTriangleAlive(t)) continue;
        const auto& v = mesh_.triangle(t).v;
        if (areAll || (isNear[v[0]] | isNear[v[1]] | isNear[v[2]]) != 0) alive.push_back(t);
    }
    return alive;
}

/// Most of what is to be proved, both ways; the rest is left to walks.
void WallMender::proveByMap() {
    const std::vector<Id> unproved = unprovedTriangles();
    const bool areAll =
        mesh_.firstTriangle() == 0 && kOfAll * unproved.size() > mesh_.fullTriangles();
    std::vector<Id> full;
    if (areAll) {
        full = firstNumbers(mesh_.fullTriangles());
    } else {
        full = unprovedFull();
        const std::vector<Id> over = fullOver(unproved);
        full.insert(full.end(), over.begin(), over.end());
        std::sort(full.begin(), full.end());
        full.erase(std::unique(full.begin(), full.end()), full.end());
    }
    if (full.empty()) return;
    const WallSurface simple(mesh_, aliveTriangles(areAll, full));
    WallMap map(collapser_, simple);
    const WallMap::Result mapped = map.map(full, areAll, limitMm_);
    auto witness = mapped.witnesses.begin();
    for (std::size_t n = 0; n < full.size(); ++n) {
        const auto end = witness + mapped.witnessCounts[n];
        if (mapped.isMapped[n] != 0 && isFullProved_[full[n]] == 0) {
            isFullProved_[full[n]] = 1;
            witnessesOf_[full[n]] = {static_cast<Id>(witnesses_.size()), mapped.witnessCounts[n]};
            witnesses_.insert(witnesses_.end(), witness, end);
        }
        witness = end;
    }
    for (const Id t : unproved) {
        if (map.covers(t)) isProved_[t] = 1;
    }
}

void WallMender::findBeyondOfSimple() {
    const std::vector<Id> unproved = unprovedTriangles();
    if (unproved.empty()) return;
    std::vector<Id> starts;
    for (const Id t : unproved) starts.push_back(collapser_.fullNear(t));
    const WallBound bound =
        proveNear(mesh_, unproved, starts, fullNear(unproved), limitMm_, mayGrow_, false);
    for (const Id t : unproved) isProved_[t] = 1;
    for (const WallPlace& place : bound.beyond) {
        isProved_[place.triangle] = 0;
        blame(place.triangle);
        collapser_.tightenNear(place.triangle);
    }
    boundMm_ = std::max(boundMm_, bound.largestMm);
}

void WallMender::findBeyondOfFull() {
    const std::vector<Id> full = unprovedFull();
    if (full.empty()) return;
    std::vector<Id> starts;
    for (const Id t : full) starts.push_back(collapser_.meshNear(t));
    const WallSurface simple(
        mesh_, aliveTriangles(mayGrow_ || kFew * full.size() > mesh_.fullTriangles(), full));
    const WallBound bound = proveNear(mesh_, full, starts, simple, limitMm_, mayGrow_, true);
    keepWitnesses(full, bound);
    for (const Id t : full) isFullProved_[t] = 1;
    blameNear(bound.beyond);
    for (const WallPlace& place : bound.beyond) {
        isFullProved_[place.triangle] = 0;
        collapser_.tightenFull(place.triangle);
    }
    boundMm_ = std::max(boundMm_, bound.largestMm);
}

}  // namespace adaptiso::detail
