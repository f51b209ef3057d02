#include "adaptive/proof/DistanceProof.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/Parameters.h"
#include "adaptive/proof/PieceMap.h"

namespace adaptiso::detail {
namespace {

using Number = SurfaceState::Number;

constexpr std::int64_t kSimplifiedPiece = 256, kFinePiece = 2048;

/// Bounds proved for some triangles.
struct PartBound {
    double provedMm = 0;    ///< of all that lies within the limit
    double farthestMm = 0;  ///< of the rest
    std::vector<PlaceBeyond> beyond;
    bool hasSearched = false;  ///< walks alone did not do
};

/// A surface that the distance to is proved: for walks, and for searches where walks fail.
template <class Index>
struct Target {
    const WalkableSurface<Index>& walkable;
    TriangleView view;
    TreeOnDemand& tree;  ///< of the view
};

/// Bounds how far triangles of one surface are from another; keeps its working memory.
template <class Index>
class OneWayProof {
public:
    OneWayProof(const Target<Index>& to, double enoughMm, double limitMm)
        : to_(to), limitMm_(limitMm), bound_(enoughMm) {}

    /// \param starts  triangles of the other surface that are thought to be near: one or more
    /// \param makePlace  (point, nearest point, nearest triangle) -> PlaceBeyond
    template <class MakePlace>
    void include(const Corners& piece, std::span<const Index> starts, int steps,
                 const MakePlace& makePlace) {
        walk_.cover(ConvexPiece(piece), to_.walkable, starts[0], bound_.squaredBound(), steps);
        for (const ConvexPiece& left : walk_.left()) {
            for (int i = 2; i < left.count(); ++i) {
                const Corners part{left.corner(0), left.corner(i - 1), left.corner(i)};
                search(part, makePlace);
            }
        }
    }

    double squaredBound() const { return bound_.squaredBound(); }

    PartBound result() {
        result_.provedMm = bound_.boundMm();
        return std::move(result_);
    }

private:
    /// Among all triangles that can be as near as the bound; where those are not near enough, among
    /// all that can be nearer than what the corners are known to be.
    template <class MakePlace>
    void search(const Corners& piece, const MakePlace& makePlace) {
        result_.hasSearched = true;
        collectWithin(bound_.boundMm(), piece);
        if (!near_.empty() && bound_.isWithin(piece)) return;
        double reachMm = bound_.boundMm();
        for (const Vec3& corner : piece) {
            double nearest = std::numeric_limits<double>::infinity();
            for (const Corners& t : bound_.nearby()) {
                nearest = std::min(nearest, squaredDistanceToTriangle(corner, t));
            }
            if (near_.empty()) nearest = to_.tree.get().squaredDistance(corner, to_.view);
            reachMm = std::max(reachMm, std::sqrt(nearest));
        }
        if (near_.empty() || reachMm > bound_.boundMm()) collectWithin(reachMm, piece);
        includeNear(piece, makePlace);
    }

    void collectWithin(double distanceMm, const Corners& piece) {
        constexpr double kRounding = 1 + 1e-9;
        BoundingBox box = boxOf(piece);
        box.widen(kRounding * distanceMm);
        near_.clear();
        bound_.nearby().clear();
        to_.tree.get().forEachOverlap(box, to_.view, [&](Index t) {
            near_.push_back(t);
            bound_.nearby().push_back(to_.view.cornersOf(t));
        });
    }

    template <class MakePlace>
    void includeNear(const Corners& piece, const MakePlace& makePlace) {
        const auto far = bound_.includeWithin(limitMm_, piece, result_.farthestMm);
        if (!far) return;
        result_.beyond.push_back(
            makePlace(far->point, far->onOther, far->hasNearest ? near_[far->nearest] : -1));
    }

    const Target<Index>& to_;
    double limitMm_;
    PieceBound bound_;
    SurfaceWalk walk_;
    std::vector<std::int64_t> near_;  ///< as bound_.nearby()
    PartBound result_;
};

/// Input of a proof, but for the triangles' numbers.
struct Task {
    Target<std::uint32_t> fine;
    Target<Number> simplified;
    /// Per vertex of the full surface, the triangle that it is assigned to.
    std::vector<Number> assigned;
    double voxelMm, enoughMm, limitMm;
};

/// Facts found about the full surface's triangles.
struct FineFound {
    std::vector<std::uint8_t> isMapped;  ///< of each one: the map has it
    std::vector<std::uint8_t> isFine;    ///< of each simplified one: it is one of them
    SharedCover cover;                   ///< by the images of those that are mapped
};

/// Calls f(triangle) for those from one up to another that are not known.
template <class F>
void forEachUnknown(const std::vector<std::uint8_t>& isKnown, std::int64_t begin, std::int64_t end,
                    const F& f) {
    for (std::int64_t t = begin; t < end; ++t) {
        if (isKnown.empty() || isKnown[t] == 0) f(static_cast<std::uint32_t>(t));
    }
}

/// The simplified surface's triangle with the corners of one of the full surface, if there is one.
Number sameTriangle(const Task& task, std::uint32_t t) {
    const WalkableSurface<Number>& onto = task.simplified.walkable;
    std::array<Number, 3> corners{};
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t v = task.fine.walkable.verticesOf(t)[i];
        const auto& there = onto.verticesOf(task.assigned[v]);
        const auto at = std::find_if(there.begin(), there.end(), [&](Number corner) {
            return onto.point(corner) == task.fine.walkable.point(v);
        });
        if (at == there.end()) return PlaceBeyond::kNone;
        corners[i] = *at;
    }
    return onto.find(corners[0], corners[1], corners[2]);
}

/// Proves the distance of the full surface to the simplified one.
PartBound proveFine(const Task& task, const std::vector<std::uint8_t>& isKnown, std::int64_t begin,
                    std::int64_t end, PieceMap& map, FineFound& found) {
    const Target<Number>& to = task.simplified;
    OneWayProof<Number> proof(to, task.enoughMm, task.limitMm);
    map.beginPiece(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin));
    forEachUnknown(isKnown, begin, end, [&](std::uint32_t t) {
        const Number same = sameTriangle(task, t);
        if (same != PlaceBeyond::kNone) {
            std::atomic_ref(found.isFine[same]).store(1, std::memory_order_relaxed);
            return;
        }
        if (map.map(t, proof.squaredBound())) {
            found.isMapped[t] = 1;
            for (const auto& part : map.parts()) {
                found.cover.add(part.triangle,
                                shareOf(part.area2, to.walkable.cornersOf(part.triangle)));
            }
            return;
        }
        const auto& [a, b, c] = task.fine.walkable.verticesOf(t);
        const std::array starts{task.assigned[a], task.assigned[b], task.assigned[c]};
        proof.include(
            task.fine.walkable.cornersOf(t), starts, kStepsOfFine,
            [](const Vec3& p, const Vec3& nearest, std::int64_t other) {
                const auto triangle = static_cast<Number>(other);
                return PlaceBeyond{nearest, p, other < 0 ? PlaceBeyond::kNone : triangle, true};
            });
    });
    return proof.result();
}

/// Excludes from the cover what the border between triangles that are mapped and others passes.
void addBorders(const Task& task, std::int64_t begin, std::int64_t end, PieceMap& map,
                FineFound& found) {
    forEachUnknown({}, begin, end, [&](std::uint32_t t) {
        if (found.isMapped[t] == 0) return;
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
            const std::uint32_t beside = task.fine.walkable.twin(h) / 3;
            if (beside < found.isMapped.size() && found.isMapped[beside] != 0) continue;
            map.forEachAlong(h, [&](std::uint64_t passed) { found.cover.addBorder(passed); });
        }
    });
}

/// Proves the distance of the simplified surface to the full one.
/// \param starts  of each triangle, where walks on the full surface start
PartBound proveSimplified(const Task& task, const std::vector<std::uint8_t>& isKnown,
                          const std::vector<std::uint32_t>& starts, std::int64_t begin,
                          std::int64_t end, const FineFound& found) {
    OneWayProof<std::uint32_t> proof(task.fine, task.enoughMm, task.limitMm);
    forEachUnknown(isKnown, begin, end, [&](std::uint32_t t) {
        if (found.isFine[t] != 0 || found.cover.covers(t)) return;
        const Corners corners = task.simplified.walkable.cornersOf(t);
        const Vec3 extent = boxOf(corners).maximum - boxOf(corners).minimum;
        // along a needle, which has no area, lie triangles too
        const double faces =
            norm(areaVector2(corners[0], corners[1], corners[2])) / (task.voxelMm * task.voxelMm) +
            norm(extent) / task.voxelMm;
        const int steps = kFewSteps + static_cast<int>(std::min(kManySteps, kStepsPerFace * faces));
        proof.include(corners, {&starts[t], 1}, steps,
                      [&](const Vec3& p, const Vec3& nearest, std::int64_t) {
                          return PlaceBeyond{p, nearest, t, false};
                      });
    });
    return proof.result();
}

constexpr std::uint32_t kNoStart = 0xFFFFFFFF;

/// Triangles that no point is assigned to begin where one beside them does: on a surface with open
/// borders a walk from elsewhere may not arrive.
void startBeside(const SimplifiedSurface& surface, std::vector<std::uint32_t>& starts) {
    std::vector<std::uint32_t> atVertex(surface.points.size(), kNoStart);
    const auto note = [&](std::size_t t) {
        for (const std::uint64_t v : surface.triangles[t]) atVertex[v] = starts[t];
    };
    std::vector<std::size_t> left;
    for (std::size_t t = starts.size(); t-- > 0;) {
        if (starts[t] == kNoStart) {
            left.push_back(t);
        } else {
            note(t);
        }
    }
    for (std::size_t before = left.size() + 1; left.size() < before;) {
        before = left.size();
        std::erase_if(left, [&](std::size_t t) {
            for (const std::uint64_t v : surface.triangles[t]) {
                if (starts[t] == kNoStart) starts[t] = atVertex[v];
            }
            if (starts[t] == kNoStart) return false;
            note(t);
            return true;
        });
    }
    for (const std::size_t t : left) starts[t] = 0;
}

/// For each triangle of the simplified surface one of the full surface with a vertex assigned to
/// it.
std::vector<std::uint32_t> startsOf(const SimplifiedSurface& surface, const Task& task) {
    std::vector<std::uint32_t> starts(surface.triangles.size(), kNoStart);
    for (std::size_t v = task.assigned.size(); v-- > 0;) {
        starts[task.assigned[v]] = task.fine.walkable.triangleAt(static_cast<std::uint32_t>(v));
    }
    startBeside(surface, starts);
    return starts;
}

/// Assigned triangle of each vertex of the full surface.
std::vector<Number> assignedOf(const SimplifiedSurface& surface, std::size_t vertices) {
    std::vector<Number> assigned;
    assigned.reserve(vertices);
    for (std::size_t s = 0; s < surface.samples.size(); ++s) {
        if (!surface.samples[s].isMiddle) assigned.push_back(surface.sampleTriangle[s]);
    }
    return assigned;
}

double largestSampleDistance(const SimplifiedSurface& surface) {
    constexpr std::int64_t kSamples = 1 << 14;
    const std::int64_t count = std::ssize(surface.samples);
    std::vector<double> largest((count + kSamples - 1) / kSamples, 0);
    parallelForPieces(count, kSamples, [&](std::int64_t begin, std::int64_t end) {
        double& here = largest[begin / kSamples];
        for (std::int64_t s = begin; s < end; ++s) {
            here = std::max(here, squaredDistanceToTriangle(
                                      surface.samples[s].point(),
                                      surface.view().cornersOf(surface.sampleTriangle[s])));
        }
    });
    return std::sqrt(*std::max_element(largest.begin(), largest.end()));
}

/// Nothing was changed, as of noise: triangle by triangle both are the same.
bool isFineSurface(const SimplifiedSurface& surface, const TriangleView& fine) {
    if (surface.triangles.size() != fine.triangles.size()) return false;
    std::atomic<bool> isSame = true;
    parallelForPieces(std::ssize(surface.triangles), kFinePiece,
                      [&](std::int64_t begin, std::int64_t end) {
                          for (std::int64_t t = begin; t < end && isSame; ++t) {
                              if (surface.view().cornersOf(t) != fine.cornersOf(t)) isSame = false;
                          }
                      });
    return isSame;
}

}  // namespace

DistanceProof::DistanceProof(const TriangleView& fine, const MetricFrame& frame, double limitMm)
    : fineView_(fine), frame_(frame), limitMm_(limitMm), fineTree_(fine) {}

void DistanceProof::rest() {
    fine_ = {};
    fineTree_.emplace(fineView_);
}

ErrorBound DistanceProof::prove(const SimplifiedSurface& surface) {
    provedMm_ = 0;
    if (isFineSurface(surface, fineView_)) {
        freeMemory(isWithin_);
        isFine_.assign(surface.triangles.size(), 1);
        return {};
    }
    // bounds are as tight as the largest sample's distance, or as a hundredth of a voxel
    enoughMm_ =
        std::min(limitMm_, std::max(largestSampleDistance(surface), 0.01 * frame_.narrowestMm()));
    return prove(surface, Scope());
}

ErrorBound DistanceProof::proveAgain(const SimplifiedSurface& surface,
                                     const SurfaceChanges& changes) {
    if (isWithin_.empty()) return prove(surface);
    return prove(surface, scopeOf(surface, changes));
}

ErrorBound DistanceProof::prove(const SimplifiedSurface& surface, const Scope& scope) {
    if (fine_.isEmpty()) {
        fine_.assign(fineView_.points, fineView_.triangles);
        fine_.forgetFans();
    }
    const TriangleView view = surface.view();
    WalkableSurface<Number> walkable;
    TreeOnDemand tree(view);
    const Task task{{fine_, fineView_, *fineTree_},
                    {walkable, view, tree},
                    assignedOf(surface, fineView_.points.size()),
                    frame_.voxelMm(),
                    enoughMm_,
                    limitMm_};
    const std::vector<Number> some = trianglesFor(scope, view, task.assigned);
    walkable.assign(surface.points, surface.triangles, some);
    if (some.empty()) walkable.forgetFans();
    surface.returnFreedMemory();
    const std::vector<std::uint32_t> starts = startsOf(surface, task);
    const std::int64_t fineCount = std::ssize(fineView_.triangles), count = surface.triangleCount(),
                       finePieces = (fineCount + kFinePiece - 1) / kFinePiece,
                       pieces = (count + kSimplifiedPiece - 1) / kSimplifiedPiece;
    std::vector<PartBound> results(finePieces + pieces);
    FineFound found{std::vector<std::uint8_t>(fineCount), std::vector<std::uint8_t>(count),
                    SharedCover(count)};
    for (std::size_t t = 0; t < scope.isKnown.size(); ++t) {
        if (scope.isKnown[t] != 0) found.isFine[t] = isFine_[t];
    }
    PerThread<PieceMap> maps([&] { return PieceMap(fine_, task.assigned, walkable, enoughMm_); });
    parallelForPieces(fineCount, kFinePiece, [&](std::int64_t begin, std::int64_t end) {
        results[begin / kFinePiece] =
            proveFine(task, scope.isFineKnown, begin, end, maps.local(), found);
    });
    parallelForPieces(fineCount, kFinePiece, [&](std::int64_t begin, std::int64_t end) {
        addBorders(task, begin, end, maps.local(), found);
    });
    // walks on the full surface will fail as well then: its tree is made by all threads, where each
    // would wait for the one that asks first
    if (std::any_of(results.begin(), results.end(),
                    [](const PartBound& result) { return result.hasSearched; })) {
        fineTree_->get();
    }
    parallelForPieces(count, kSimplifiedPiece, [&](std::int64_t begin, std::int64_t end) {
        results[finePieces + begin / kSimplifiedPiece] =
            proveSimplified(task, scope.isKnown, starts, begin, end, found);
    });
    ErrorBound bound;
    double farthestMm = 0;
    for (const PartBound& result : results) {
        provedMm_ = std::max(provedMm_, result.provedMm);
        farthestMm = std::max(farthestMm, result.farthestMm);
        bound.beyondLimit.insert(bound.beyondLimit.end(), result.beyond.begin(),
                                 result.beyond.end());
    }
    bound.largestMm = std::max(provedMm_, farthestMm);
    isFine_ = std::move(found.isFine);
    remember(surface.triangles.size(), bound.beyondLimit);
    return bound;
}

/// Triangles of the simplified surface that maps and walks from unknown ones of the full surface
/// come to: two rings around those that their vertices are assigned to. Beyond, searches prove.
/// Empty: all.
std::vector<Number> DistanceProof::trianglesFor(const Scope& scope, const TriangleView& simplified,
                                                const std::vector<Number>& assigned) const {
    std::vector<Number> triangles;
    if (scope.isFineKnown.empty()) return triangles;
    std::vector<std::uint8_t> isNear(simplified.points.size());
    const auto mark = [&](Number t) {
        for (const Number v : simplified.triangles[t]) isNear[v] = 1;
    };
    forEachUnknown(scope.isFineKnown, 0, std::ssize(scope.isFineKnown), [&](std::uint32_t t) {
        for (const std::uint32_t v : fineView_.triangles[t]) mark(assigned[v]);
    });
    for (int ring = 0; ring < 2; ++ring) {
        for (const Number t : triangles) mark(t);
        triangles.clear();
        for (Number t = 0; t < simplified.triangles.size(); ++t) {
            const auto& [a, b, c] = simplified.triangles[t];
            if ((isNear[a] | isNear[b] | isNear[c]) != 0) triangles.push_back(t);
        }
    }
    return triangles;
}

void DistanceProof::remember(std::size_t triangles, std::vector<PlaceBeyond> beyond) {
    isWithin_.assign(triangles, 1);
    for (const PlaceBeyond& place : beyond) {
        if (!place.isOfFine) isWithin_[place.triangle] = 0;
    }
    beyond_ = std::move(beyond);
}

/// Triangles to prove: the new ones, and the full surface near those that came or went and
/// where it lay beyond the limit.
DistanceProof::Scope DistanceProof::scopeOf(const SimplifiedSurface& surface,
                                            const SurfaceChanges& changes) {
    Scope scope;
    scope.isKnown = isWithin_;
    scope.isKnown.resize(surface.triangles.size(), 0);
    for (const std::uint64_t t : changes.triangles) {
        if (t < scope.isKnown.size()) scope.isKnown[t] = 0;
    }
    std::vector<Corners> changed = changes.before;
    for (std::size_t t = 0; t < scope.isKnown.size(); ++t) {
        if (scope.isKnown[t] == 0) changed.push_back(surface.view().cornersOf(t));
    }
    markFine(changed, scope);
    return scope;
}

/// Finds the triangles of the full surface near some triangles, and near the last places beyond the
/// limit. What is farther than the proved distance lies as near another triangle.
void DistanceProof::markFine(const std::vector<Corners>& changed, Scope& scope) {
    // where much has changed nearly all is near it
    if (changed.size() > scope.isKnown.size() / 4) return;
    const double reachMm = std::min(limitMm_, provedMm_);
    const TriangleTree& tree = fineTree_->get();
    scope.isFineKnown.assign(fineView_.triangles.size(), 1);
    const auto markNear = [&](const Corners& corners) {
        constexpr double kRounding = 1 + 1e-9;
        BoundingBox box = boxOf(corners);
        box.widen(kRounding * reachMm);
        tree.forEachOverlap(box, fineView_, [&](std::uint32_t t) {
            std::atomic_ref(scope.isFineKnown[t]).store(0, std::memory_order_relaxed);
        });
    };
    constexpr std::int64_t kTriangles = 64;
    parallelForPieces(std::ssize(changed), kTriangles, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t n = begin; n < end; ++n) markNear(changed[n]);
    });
    for (const PlaceBeyond& place : beyond_) {
        markNear({place.point(), place.point(), place.point()});
    }
}

}  // namespace adaptiso::detail
