#include "WallProof.h"

#include <algorithm>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/SurfaceProof/PieceBound.h"

namespace adaptiso::detail {

namespace {

/// Most triangles that a walk may visit: some, and more for large triangles.
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
    const TriangleView own{points_, triangles_};
    std::call_once(treeIsMade_, [&] { tree_ = TriangleTree(own); });
    places.clear();
    BoundingBox box = boxOf(piece);
    box.widen(distanceMm);
    tree_.forEachOverlap(box, own, [&](std::int64_t n) {
        if (mesh_.triangle(numbers_[n]).wall == wall) places.push_back(static_cast<Id>(n));
    });
}

namespace {

/// Proves one triangle after the other; keeps its working memory.
class NearProof {
public:
    using Id = WallMesh::Id;

    NearProof(const WallMesh& mesh, const WallSurface& to, double limitMm, bool mayGrow)
        : mesh_(mesh), to_(to), limitMm_(limitMm), mayGrow_(mayGrow), enoughMm_(limitMm) {}

    /// \param start  of `to`, a number
    void prove(Id triangle, Id start, int steps) {
        const Corners corners = mesh_.cornersOf(triangle);
        const Id place = to_.placeOf(start);
        witnesses_.clear();
        beyond_.clear();
        isBeyond_ = false;
        left_.clear();
        if (place == WallMesh::kNone) {
            left_.emplace_back(corners);
        } else {
            walk_.cover(ConvexPiece(corners), to_.walkable(), place, limitMm_ * limitMm_, steps);
            left_ = walk_.left();
            for (const std::uint64_t t : walk_.witnesses()) witnesses_.push_back(to_.numberOf(t));
        }
        const Id wall = mesh_.triangle(triangle).wall;
        for (const ConvexPiece& piece : left_) {
            for (int i = 2; i < piece.count(); ++i) {
                provePart({piece.corner(0), piece.corner(i - 1), piece.corner(i)}, wall);
            }
        }
    }

    /// Triangles near the last one.
    std::vector<Id>& witnesses() { return witnesses_; }
    bool isBeyond() const { return isBeyond_; }
    const std::vector<Id>& nearWhatIsBeyond() const { return beyond_; }
    /// The same for all so far.
    double boundMm() const { return enoughMm_; }

private:
    /// Proves what the walk could not, by all that lies near.
    void provePart(const Corners& part, Id wall) {
        PieceBound own(enoughMm_);
        for (double reachMm = enoughMm_; own.nearby().empty(); reachMm *= 4) {
            to_.collect(part, wall, reachMm, near_);
            for (const Id t : near_) own.nearby().push_back(to_.walkable().cornersOf(t));
            if (!mayGrow_ || reachMm > 1e6 * limitMm_) break;
        }
        for (const Id t : near_) witnesses_.push_back(to_.numberOf(t));
        own.include(part);
        if (own.boundMm() <= enoughMm_) return;
        if (mayGrow_) {
            enoughMm_ = own.boundMm();
            return;
        }
        isBeyond_ = true;
        for (const Id t : near_) beyond_.push_back(to_.numberOf(t));
    }

    const WallMesh& mesh_;
    const WallSurface& to_;
    double limitMm_;
    bool mayGrow_;
    double enoughMm_;
    SurfaceWalk walk_;
    std::vector<ConvexPiece> left_;
    std::vector<Id> near_, witnesses_, beyond_;
    bool isBeyond_ = false;
};

double meanArea2Of(const WallSurface& surface) {
    double area2 = 0;
    for (const WallMesh::Id n : surface.numbers()) {
        const Corners c = surface.mesh().cornersOf(n);
        area2 += norm(areaVector2(c[0], c[1], c[2]));
    }
    return area2 / std::max<double>(1, static_cast<double>(surface.count()));
}

}  // namespace

WallBound proveNear(const WallMesh& mesh, const std::vector<WallMesh::Id>& triangles,
                    const std::vector<WallMesh::Id>& starts, const WallSurface& to, double limitMm,
                    bool mayGrow, bool hasWitnesses) {
    constexpr std::int64_t kPiece = 256;
    const auto count = static_cast<std::int64_t>(triangles.size());
    const double meanArea2 = meanArea2Of(to);
    std::vector<WallBound> bounds((count + kPiece - 1) / kPiece);
    parallelForPieces(count, kPiece, [&](std::int64_t begin, std::int64_t end) {
        WallBound& bound = bounds[begin / kPiece];
        NearProof proof(mesh, to, limitMm, mayGrow);
        for (std::int64_t n = begin; n < end; ++n) {
            const Corners c = mesh.cornersOf(triangles[n]);
            const double size = norm(areaVector2(c[0], c[1], c[2])) / meanArea2;
            proof.prove(
                triangles[n], starts[n],
                kLeastSteps + static_cast<int>(std::min(kMostSteps, kStepsPerTriangle * size)));
            if (hasWitnesses) {
                std::vector<WallMesh::Id>& near = proof.witnesses();
                std::sort(near.begin(), near.end());
                const auto last = std::unique(near.begin(), near.end());
                bound.witnessCounts.push_back(static_cast<WallMesh::Id>(last - near.begin()));
                bound.witnesses.insert(bound.witnesses.end(), near.begin(), last);
            }
            if (proof.isBeyond()) bound.beyond.push_back({triangles[n], proof.nearWhatIsBeyond()});
        }
        bound.largestMm = proof.boundMm();
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
