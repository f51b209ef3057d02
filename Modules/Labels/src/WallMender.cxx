#include "WallMender.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adaptiso/Core/AabbTree.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::detail {
namespace {

CornerBox boxOfAll(const WallMesh& mesh) {
    CornerBox box{mesh.point(0), mesh.point(0)};
    for (std::uint32_t v = 1; v < mesh.pointCount(); ++v) box.add(mesh.point(v));
    return box;
}

Corners cornersOf(const TriangleMesh& mesh, std::int64_t t) {
    const Triangle& v = mesh.triangles[t];
    return {mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]};
}

/// Pairs of triangles that cross, of which one is asked for.
std::vector<TrianglePair> crossingPairs(const TriangleMesh& mesh,
                                        const std::vector<std::uint8_t>& isAsked) {
    const auto asked = std::count(isAsked.begin(), isAsked.end(), 1);
    if (asked == 0) return {};
    constexpr std::int64_t kPiece = 2048;
    const auto count = static_cast<std::int64_t>(isAsked.size());
    std::vector<std::vector<TrianglePair>> found((count + kPiece - 1) / kPiece);
    const auto test = [&](std::int64_t begin, std::int64_t a, std::int64_t b) {
        if (!trianglesCross(cornersOf(mesh, a), cornersOf(mesh, b))) return;
        found[begin / kPiece].push_back({a, b});
    };
    if (4 * asked > count) {
        const AabbTree tree(mesh);
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            tree.forEachOverlappingPair(begin, end, [&](std::int64_t a, std::int64_t b) {
                if (isAsked[a] != 0 || isAsked[b] != 0) test(begin, a, b);
            });
        });
    } else {  // all others through a tree of the few
        TriangleMesh few{mesh.points, {}, {}};
        std::vector<std::int64_t> numbers;
        for (std::int64_t n = 0; n < count; ++n) {
            if (isAsked[n] == 0) continue;
            few.triangles.push_back(mesh.triangles[n]);
            numbers.push_back(n);
        }
        const AabbTree tree(few);
        parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t a = begin; a < end; ++a) {
                const CornerBox box = boxOf(cornersOf(mesh, a));
                tree.forEachOverlap({box.low, box.high}, [&](std::int64_t n) {
                    const std::int64_t b = numbers[n];
                    if (a != b && (isAsked[a] == 0 || a < b)) test(begin, a, b);
                });
            }
        });
    }
    std::vector<TrianglePair> all;
    for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
    return all;
}

}  // namespace

TrianglesByPlace::TrianglesByPlace(const CornerBox& box, double cubeMm)
    : cubeMm_(cubeMm), low_(box.low) {
    for (int axis = 0; axis < 3; ++axis) {
        count_[axis] = static_cast<std::int64_t>((box.high[axis] - low_[axis]) / cubeMm) + 1;
    }
}

std::array<std::array<std::int64_t, 2>, 3> TrianglesByPlace::rangeOf(const CornerBox& box) const {
    std::array<std::array<std::int64_t, 2>, 3> range;
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](double x) {
            const auto n = static_cast<std::int64_t>(std::floor((x - low_[axis]) / cubeMm_));
            return std::clamp<std::int64_t>(n, 0, count_[axis] - 1);
        };
        range[axis] = {at(box.low[axis]), at(box.high[axis])};
    }
    return range;
}

/// Calls f(cube) until it is true.
template <class F>
void TrianglesByPlace::forEachCube(const CornerBox& box, const F& f) const {
    const auto [x, y, z] = rangeOf(box);
    for (std::int64_t k = z[0]; k <= z[1]; ++k) {
        for (std::int64_t j = y[0]; j <= y[1]; ++j) {
            for (std::int64_t i = x[0]; i <= x[1]; ++i) {
                if (f(i + count_[0] * (j + count_[1] * k))) return;
            }
        }
    }
}

void TrianglesByPlace::assign(const WallMesh& mesh, const std::vector<WallMesh::Id>& triangles,
                              double aroundMm) {
    mesh_ = &mesh;
    aroundMm_ = aroundMm;
    cubes_.assign(count_[0] * count_[1] * count_[2], [&](const auto& give) {
        for (const WallMesh::Id t : triangles) {
            CornerBox box = boxOf(mesh.cornersOf(t));
            box.widen(aroundMm);
            forEachCube(box, [&](std::int64_t cube) {
                give(cube, t);
                return false;
            });
        }
    });
}

bool TrianglesByPlace::isOneNear(WallMesh::Id triangle) const {
    const CornerBox box = boxOf(mesh_->cornersOf(triangle));
    const WallMesh::Id wall = mesh_->triangle(triangle).wall;
    bool isNear = false;
    forEachCube(box, [&](std::int64_t cube) {
        for (const WallMesh::Id t : cubes_.of(cube)) {
            if (mesh_->triangle(t).wall != wall) continue;
            CornerBox other = boxOf(mesh_->cornersOf(t));
            other.widen(aroundMm_);
            if (!other.overlaps(box)) continue;
            isNear = true;
            return true;
        }
        return false;
    });
    return isNear;
}

WallMender::WallMender(WallCollapser& collapser, double limitMm, bool mayGrow)
    : collapser_(collapser),
      mesh_(collapser.mesh()),
      limitMm_(limitMm),
      boundMm_(limitMm),
      mayGrow_(mayGrow),
      near_(boxOfAll(mesh_), 2 * collapser.voxelMm()),
      isLast_(mesh_.firstTriangle(), 0),
      isFullProved_(mesh_.fullTriangles(), 1) {
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        // what was there when the collapser began
        isLast_.push_back(mesh_.makerOf(t) == kNone ? 1 : 0);
    }
}

bool WallMender::mend() {
    changes_.clear();
    findCrossings();
    findBeyond();
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

/// Triangles that were there before cross nothing.
void WallMender::findCrossings() {
    isClear_.resize(mesh_.triangleCount(), 0);
    TriangleMesh mesh;
    std::vector<Id> numbers;
    std::vector<std::uint8_t> isAsked;
    std::vector<VertexId> number(mesh_.pointCount(), -1);
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        if (!mesh_.isTriangleAlive(t)) continue;
        isAsked.push_back(mesh_.makerOf(t) != kNone && isClear_[t] == 0 ? 1 : 0);
        numbers.push_back(t);
        Triangle corners;
        for (int c = 0; c < 3; ++c) {
            VertexId& v = number[mesh_.triangle(t).v[c]];
            if (v < 0) {
                v = static_cast<VertexId>(mesh.points.size());
                mesh.points.push_back(mesh_.point(mesh_.triangle(t).v[c]));
            }
            corners[c] = v;
        }
        mesh.triangles.push_back(corners);
    }
    const auto pairs = crossingPairs(mesh, isAsked);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
        if (isAsked[n] != 0) isClear_[numbers[n]] = 1;
    }
    for (const TrianglePair& pair : pairs) {
        for (const std::int64_t n : pair) {
            const Id t = numbers[n];
            isClear_[t] = 0;
            blame(t);
            collapser_.tightenNear(t);
        }
    }
}

/// Triangles of the full walls that what they were near may have left are to be proved again.
void WallMender::forgetChanged() {
    std::vector<Id> gone;
    for (Id t = mesh_.firstTriangle(); t < isLast_.size(); ++t) {
        if (isLast_[t] != 0 && !mesh_.isTriangleAlive(t)) gone.push_back(t);
    }
    near_.assign(mesh_, gone, boundMm_);
    for (Id t = 0; t < mesh_.fullTriangles(); ++t) {
        if (isFullProved_[t] == 0 || mesh_.isTriangleAlive(t)) continue;
        const bool isGoneNow = t >= mesh_.firstTriangle() && isLast_[t] != 0;
        if (isGoneNow || near_.isOneNear(t)) isFullProved_[t] = 0;
    }
    isProved_.resize(mesh_.triangleCount(), 0);
    isLast_.resize(mesh_.triangleCount(), 0);
    for (Id t = 0; t < isLast_.size(); ++t) isLast_[t] = mesh_.isTriangleAlive(t) ? 1 : 0;
}

/// What was taken away where a triangle of the full walls lies too far from what is there now.
void WallMender::blameNear(const WallPlace& place) {
    const std::size_t before = changes_.size();
    blame(collapser_.standInOf(place.triangle));
    if (changes_.size() > before) return;
    for (const Id t : place.near) blame(t);
    if (changes_.size() > before) return;
    CornerBox box = boxOf(mesh_.cornersOf(place.triangle));
    box.widen(boundMm_);
    for (Id t = 0; t < mesh_.triangleCount(); ++t) {
        if (mesh_.isTriangleAlive(t) || mesh_.killerOf(t) >= mesh_.changeCount()) continue;
        const Id killer = mesh_.killerOf(t);
        const bool isStanding = mesh_.isChangeStanding(killer);
        if (isStanding && box.overlaps(boxOf(mesh_.cornersOf(t)))) changes_.push_back(killer);
    }
}

/// The full walls near triangles of a mesh.
WallSurface WallMender::fullNear(const std::vector<Id>& triangles) {
    const bool areMany = 8 * triangles.size() > mesh_.fullTriangles();
    if (!areMany) near_.assign(mesh_, triangles, limitMm_ + collapser_.voxelMm());
    std::vector<Id> numbers;
    for (Id t = 0; t < mesh_.fullTriangles(); ++t) {
        if (areMany || near_.isOneNear(t)) numbers.push_back(t);
    }
    return {mesh_, std::move(numbers)};
}

void WallMender::findBeyond() {
    forgetChanged();
    std::vector<Id> alive, unproved, starts;
    for (Id t = mesh_.firstTriangle(); t < mesh_.triangleCount(); ++t) {
        if (!mesh_.isTriangleAlive(t)) continue;
        alive.push_back(t);
        if (isProved_[t] != 0 || mesh_.makerOf(t) == kNone) continue;
        unproved.push_back(t);
        starts.push_back(collapser_.fullNear(t));
    }
    const WallBound ofSimple =
        proveNear(mesh_, unproved, starts, fullNear(unproved), limitMm_, mayGrow_);
    for (const Id t : unproved) isProved_[t] = 1;
    for (const WallPlace& place : ofSimple.beyond) {
        isProved_[place.triangle] = 0;
        blame(place.triangle);
        collapser_.tightenNear(place.triangle);
    }
    boundMm_ = std::max(boundMm_, ofSimple.largestMm);
    std::vector<Id> full;
    starts.clear();
    for (Id t = 0; t < mesh_.fullTriangles(); ++t) {
        if (mesh_.isTriangleAlive(t) || isFullProved_[t] != 0) continue;
        full.push_back(t);
        starts.push_back(collapser_.standInOf(t));
    }
    if (full.empty()) return;
    // of the walls only what is near those is asked
    if (4 * full.size() < mesh_.fullTriangles()) {
        near_.assign(mesh_, full, limitMm_ + collapser_.voxelMm());
        std::erase_if(alive, [&](Id t) { return !near_.isOneNear(t); });
    }
    const WallSurface simple(mesh_, std::move(alive));
    const WallBound ofFull = proveNear(mesh_, full, starts, simple, limitMm_, mayGrow_);
    for (const Id t : full) isFullProved_[t] = 1;
    for (const WallPlace& place : ofFull.beyond) {
        isFullProved_[place.triangle] = 0;
        blameNear(place);
        collapser_.tightenFull(place.triangle);
    }
    boundMm_ = std::max(boundMm_, ofFull.largestMm);
}

}  // namespace adaptiso::detail
