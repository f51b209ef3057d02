#include "WallProof.h"

#include <algorithm>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "adaptiso/Core/Parallel.h"
#include "adaptive/proof/PieceBound.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPiece = 256;

/// How many triangles a walk may visit: some, and more for large triangles.
constexpr int kLeastSteps = 60;
constexpr double kStepsPerTriangle = 12, kMostSteps = 1e5;

}  // namespace

WallSurface::WallSurface(const WallMesh& mesh, std::vector<Id> numbers)
    : mesh_(mesh), numbers_(std::move(numbers)), triangles_(numbers_.size()) {
    struct First {
        Id number = WallMesh::kNone, wall = 0;
    };
    std::vector<First> firsts(mesh.pointCount());
    std::unordered_map<std::uint64_t, Id> others;  // of vertices where walls meet
    const auto numberOf = [&](Id v, Id wall) {
        const auto next = static_cast<Id>(points_.size());
        First& first = firsts[v];
        if (first.number == WallMesh::kNone) {
            first = {next, wall};
            points_.push_back(mesh.point(v));
        }
        if (first.wall == wall) return first.number;
        const auto [at, isNew] = others.try_emplace(std::uint64_t{v} << 32 | wall, next);
        if (isNew) points_.push_back(mesh.point(v));
        return at->second;
    };
    for (std::size_t n = 0; n < numbers_.size(); ++n) {
        const auto& t = mesh.triangle(numbers_[n]);
        for (int c = 0; c < 3; ++c) triangles_[n][c] = numberOf(t.v[c], t.wall);
    }
    walkable_.assign(points_, triangles_);
    walkable_.keepNormals();
}

WallSurface::Id WallSurface::placeOf(Id number) const {
    if (number < numbers_.size() && numbers_[number] == number) return number;
    const auto at = std::lower_bound(numbers_.begin(), numbers_.end(), number);
    return at != numbers_.end() && *at == number ? static_cast<Id>(at - numbers_.begin())
                                                 : WallMesh::kNone;
}

void WallSurface::collect(const Corners& piece, Id wall, double distanceMm,
                          std::vector<Id>& places) const {
    std::call_once(gridIsMade_, [&] {
        grid_.assign(static_cast<Id>(triangles_.size()),
                     [&](Id n) { return boxOf(walkable_.cornersOf(n)); });
    });
    places.clear();
    CornerBox box = boxOf(piece);
    box.widen(distanceMm);
    grid_.forEachNear(box, [&](Id n) {
        if (mesh_.triangle(numbers_[n]).wall == wall) places.push_back(n);
    });
}

WallBound proveNear(const WallMesh& mesh, const std::vector<WallMesh::Id>& triangles,
                    const std::vector<WallMesh::Id>& starts, const WallSurface& to, double limitMm,
                    bool mayGrow, bool hasWitnesses) {
    using Id = WallMesh::Id;
    const auto count = static_cast<std::int64_t>(triangles.size());
    double area = 0;
    for (const Id n : to.numbers()) {
        const Corners c = mesh.cornersOf(n);
        area += norm(areaVector2(c[0], c[1], c[2]));
    }
    const double meanArea = area / std::max<double>(1, static_cast<double>(to.count()));
    std::vector<WallBound> bounds((count + kPiece - 1) / kPiece);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        WallBound& bound = bounds[begin / kPiece];
        SurfaceWalk walk;
        std::vector<Id> near, witnesses;
        double enoughMm = limitMm;
        for (std::int64_t n = begin; n < end; ++n) {
            const Corners corners = mesh.cornersOf(triangles[n]);
            const double size = norm(areaVector2(corners[0], corners[1], corners[2])) / meanArea;
            const int steps =
                kLeastSteps + static_cast<int>(std::min(kMostSteps, kStepsPerTriangle * size));
            const Id start = to.placeOf(starts[n]);
            witnesses.clear();
            std::vector<ConvexPiece> left;
            if (start == WallMesh::kNone) {
                left.emplace_back(corners);
            } else {
                walk.cover(ConvexPiece(corners), to.walkable(), start, limitMm * limitMm, steps);
                left = walk.left();
                for (const std::uint64_t t : walk.witnesses()) {
                    witnesses.push_back(to.numberOf(t));
                }
            }
            bool isBeyond = false;
            std::vector<Id> nearby;
            for (const ConvexPiece& piece : left) {
                for (int i = 2; i < piece.count(); ++i) {
                    const Corners part{piece.corner(0), piece.corner(i - 1), piece.corner(i)};
                    PieceBound own(enoughMm);
                    for (double reachMm = enoughMm; own.nearby().empty(); reachMm *= 4) {
                        to.collect(part, mesh.triangle(triangles[n]).wall, reachMm, near);
                        for (const Id t : near) {
                            own.nearby().push_back(to.walkable().cornersOf(t));
                        }
                        if (!mayGrow || reachMm > 1e6 * limitMm) break;
                    }
                    for (const Id t : near) witnesses.push_back(to.numberOf(t));
                    own.include(part);
                    if (own.boundMm() <= enoughMm) continue;
                    if (mayGrow) {
                        enoughMm = own.boundMm();
                        continue;
                    }
                    isBeyond = true;
                    for (const Id t : near) nearby.push_back(to.numberOf(t));
                }
            }
            if (hasWitnesses) {
                std::sort(witnesses.begin(), witnesses.end());
                const auto last = std::unique(witnesses.begin(), witnesses.end());
                bound.witnessCounts.push_back(static_cast<Id>(last - witnesses.begin()));
                bound.witnesses.insert(bound.witnesses.end(), witnesses.begin(), last);
            }
            if (isBeyond) bound.beyond.push_back({triangles[n], std::move(nearby)});
        }
        bound.largestMm = enoughMm;
    });
    WallBound all;
    all.largestMm = limitMm;
    for (WallBound& own : bounds) {
        all.largestMm = std::max(all.largestMm, own.largestMm);
        std::move(own.beyond.begin(), own.beyond.end(), std::back_inserter(all.beyond));
        all.witnessCounts.insert(all.witnessCounts.end(), own.witnessCounts.begin(),
                                 own.witnessCounts.end());
        all.witnesses.insert(all.witnesses.end(), own.witnesses.begin(), own.witnesses.end());
    }
    return all;
}

}  // namespace adaptiso::detail
