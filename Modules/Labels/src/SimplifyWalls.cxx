#include "SimplifyWalls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "WallCollapser.h"
#include "WallMesh.h"
#include "WallProof.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::detail {
namespace {

using Id = WallMesh::Id;
constexpr Id kNone = WallMesh::kNone;

/// Places (cubes) of the walls.
class Places {
public:
    Places(const LabelComplex& walls, double cubeMm) : cubeMm_(cubeMm) {
        CornerBox box{walls.points.front(), walls.points.front()};
        for (const Vec3& p : walls.points) box.add(p);
        low_ = box.low;
        for (int axis = 0; axis < 3; ++axis) {
            count_[axis] = static_cast<std::int64_t>((box.high[axis] - low_[axis]) / cubeMm) + 1;
        }
        isMarked_.assign(count_[0] * count_[1] * count_[2], 0);
    }

    void clear() { std::fill(isMarked_.begin(), isMarked_.end(), 0); }
    void mark(const Corners& triangle, double aroundMm) {
        forEach(triangle, aroundMm, [&](std::uint8_t& cube) {
            cube = 1;
            return false;
        });
    }
    bool isAtMark(const Corners& triangle) {
        return forEach(triangle, 0, [](const std::uint8_t& cube) { return cube != 0; });
    }

private:
    /// Calls f(cube) until it is true.
    template <class F>
    bool forEach(const Corners& triangle, double aroundMm, const F& f) {
        CornerBox box = boxOf(triangle);
        box.widen(aroundMm);
        std::array<std::int64_t, 3> first, last;
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = [&](double x) {
                const auto n = static_cast<std::int64_t>(std::floor((x - low_[axis]) / cubeMm_));
                return std::clamp<std::int64_t>(n, 0, count_[axis] - 1);
            };
            first[axis] = at(box.low[axis]);
            last[axis] = at(box.high[axis]);
        }
        for (std::int64_t k = first[2]; k <= last[2]; ++k) {
            for (std::int64_t j = first[1]; j <= last[1]; ++j) {
                for (std::int64_t i = first[0]; i <= last[0]; ++i) {
                    if (f(isMarked_[i + count_[0] * (j + count_[1] * k)])) return true;
                }
            }
        }
        return false;
    }

    double cubeMm_;
    Vec3 low_;
    std::array<std::int64_t, 3> count_{};
    std::vector<std::uint8_t> isMarked_;
};

/// Proves what the collapses made, and takes back what breaks a promise.
class Mender {
public:
    Mender(const LabelComplex& full, WallCollapser& collapser, double limitMm, bool mayGrow)
        : collapser_(collapser),
          mesh_(collapser.mesh()),
          limitMm_(limitMm),
          boundMm_(limitMm),
          mayGrow_(mayGrow),
          places_(full, 2 * collapser.voxelMm()),
          isFullProved_(mesh_.fullTriangles(), 0) {
        std::vector<Id> numbers(mesh_.fullTriangles());
        for (Id t = 0; t < numbers.size(); ++t) numbers[t] = t;
        full_.emplace(mesh_, std::move(numbers));
    }

    double boundMm() const { return boundMm_; }

    /// Takes back what breaks a promise. \return false when nothing does
    bool mend() {
        changes_.clear();
        findCrossings();
        findBeyond();
        std::sort(changes_.begin(), changes_.end());
        changes_.erase(std::unique(changes_.begin(), changes_.end()), changes_.end());
        for (const Id change : changes_) collapser_.undo(change);
        return !changes_.empty();
    }

private:
    void blame(Id triangle) {
        if (triangle != kNone && mesh_.makerOf(triangle) != kNone) {
            changes_.push_back(mesh_.makerOf(triangle));
        }
    }

    void findCrossings() {
        std::vector<Id> numbers;
        LabelComplex now = mesh_.complex(&numbers);
        TriangleMesh mesh;
        mesh.points = std::move(now.points);
        mesh.triangles = std::move(now.triangles);
        SelfIntersectionOptions all;
        all.maxPairs = std::numeric_limits<std::int64_t>::max();
        for (const auto& [a, b] : findSelfIntersections(mesh, all).pairs) {
            for (const Id t : {numbers[a], numbers[b]}) {
                blame(t);
                collapser_.tightenNear(t);
            }
        }
    }

    /// Triangles of the full walls that what they were near may have left are to be proved again.
    void forgetChanged() {
        places_.clear();
        for (Id t = 0; t < isProved_.size(); ++t) {
            if (isLast_[t] != 0 && !mesh_.isTriangleAlive(t)) {
                places_.mark(mesh_.cornersOf(t), boundMm_);
            }
        }
        for (Id t = 0; t < mesh_.fullTriangles(); ++t) {
            if (isFullProved_[t] != 0 && places_.isAtMark(mesh_.cornersOf(t))) {
                isFullProved_[t] = 0;
            }
        }
        isProved_.resize(mesh_.triangleCount(), 0);
        isLast_.resize(mesh_.triangleCount(), 0);
        for (Id t = 0; t < isLast_.size(); ++t) isLast_[t] = mesh_.isTriangleAlive(t) ? 1 : 0;
    }

    void findBeyond() {
        forgetChanged();
        std::vector<Id> alive, unproved, starts;
        for (Id t = 0; t < mesh_.triangleCount(); ++t) {
            if (!mesh_.isTriangleAlive(t)) continue;
            alive.push_back(t);
            if (isProved_[t] != 0 || mesh_.makerOf(t) == kNone) continue;
            unproved.push_back(t);
            starts.push_back(collapser_.fullNear(t));
        }
        const WallBound ofSimple = proveNear(mesh_, unproved, starts, *full_, limitMm_, mayGrow_);
        for (const Id t : unproved) isProved_[t] = 1;
        for (const WallPlace& place : ofSimple.beyond) {
            isProved_[place.triangle] = 0;
            blame(place.triangle);
            collapser_.tightenNear(place.triangle);
        }
        const WallSurface simple(mesh_, std::move(alive));
        std::vector<Id> full;
        starts.clear();
        for (Id t = 0; t < mesh_.fullTriangles(); ++t) {
            if (mesh_.isTriangleAlive(t) || isFullProved_[t] != 0) continue;
            full.push_back(t);
            starts.push_back(collapser_.standInOf(t));
        }
        const WallBound ofFull = proveNear(mesh_, full, starts, simple, limitMm_, mayGrow_);
        for (const Id t : full) isFullProved_[t] = 1;
        for (const WallPlace& place : ofFull.beyond) {
            isFullProved_[place.triangle] = 0;
            const std::size_t before = changes_.size();
            blame(collapser_.standInOf(place.triangle));
            if (changes_.size() == before) {
                for (const Id t : place.near) blame(t);
            }
            if (changes_.size() == before) changes_.push_back(mesh_.killerOf(place.triangle));
            collapser_.tightenFull(place.triangle);
        }
        boundMm_ = std::max({boundMm_, ofSimple.largestMm, ofFull.largestMm});
    }

    WallCollapser& collapser_;
    const WallMesh& mesh_;
    double limitMm_, boundMm_;
    bool mayGrow_;
    Places places_;
    std::vector<std::uint8_t> isProved_;      ///< of triangles: within the limit of the full walls
    std::vector<std::uint8_t> isLast_;        ///< of triangles: alive when last proved
    std::vector<std::uint8_t> isFullProved_;  ///< of triangles of the full walls
    std::optional<WallSurface> full_;
    std::vector<Id> changes_;  ///< to take back
};

}  // namespace

SimplifiedWalls simplifyWalls(const LabelComplex& full, const ImageGeometry& geometry,
                              const SimplifyOptions& options) {
    constexpr double kLowCost = 4e-4, kHighCost = 30, kStep = 6;
    WallCollapser collapser(full, geometry);
    const double h = collapser.voxelMm();
    const std::int64_t enough = options.maxTriangles.value_or(0);
    const auto roundsWith = [&](double limitMm) {
        for (double cost = kLowCost; cost < kHighCost; cost *= kStep) {
            collapser.round(cost * h * h * h * h, limitMm, enough);
            if (collapser.mesh().aliveTriangles() <= enough) return;
        }
    };
    double limitMm = options.maxErrorMm.value_or(0.05 * h);
    if (options.maxErrorMm) {
        roundsWith(limitMm);
    } else {
        constexpr int kMostDoublings = 12;
        for (int n = 0; n < kMostDoublings; ++n) {
            roundsWith(limitMm);
            if (collapser.mesh().aliveTriangles() <= enough) break;
            limitMm *= 2;
            collapser.tryAllAgain();
        }
    }
    if (options.progress) options.progress("simplify", 0.6);
    SimplifiedWalls walls;
    // what is taken back collapses again, held tighter; in the end it stays
    constexpr int kMostTries = 4;
    Mender mender(full, collapser, limitMm, !options.maxErrorMm);
    for (int n = 0; mender.mend(); ++n) {
        if (n < kMostTries) roundsWith(limitMm);
    }
    walls.errorBoundMm = mender.boundMm();
    walls.complex = collapser.mesh().complex();
    if (options.progress) options.progress("simplify", 1);
    return walls;
}

}  // namespace adaptiso::detail
