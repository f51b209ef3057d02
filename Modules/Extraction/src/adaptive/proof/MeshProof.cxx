#include "adaptive/proof/MeshProof.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/Parameters.h"
#include "adaptive/proof/MeshMap.h"

namespace adaptiso::detail {
namespace {

using Number = SurfaceState::Number;

constexpr std::int64_t kPiece = 256;

Corners cornersOf(const SimplifiedSurface& surface, std::uint64_t t) {
    const SurfaceState::Triangle& c = surface.triangles[t];
    return {surface.points[c[0]], surface.points[c[1]], surface.points[c[2]]};
}

Corners cornersOf(const MeshParts& parts, std::size_t t) {
    const MeshParts::Triangle& c = parts.triangles[t];
    return {parts.points[c[0]], parts.points[c[1]], parts.points[c[2]]};
}

/// What is proved of some triangles.
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
    OneWayProof(const Target<Index>& to, double voxelMm, double enoughMm, double limitMm)
        : to_(to), looseMm_(kLooseBound * voxelMm), limitMm_(limitMm), bound_(enoughMm) {}

    /// \param starts  triangles of the other surface that are thought to be near: one or more
    /// \param makePlace  (point, nearest point, nearest triangle) -> PlaceBeyond
    template <class MakePlace>
    void include(const Corners& piece, std::span<const Index> starts, int steps,
                 const MakePlace& makePlace) {
        if (bound_.boundMm() > looseMm_ && quarters(piece) <= std::ssize(to_.view.triangles)) {
            walk_.coverLoosely(piece, to_.walkable, starts[0], bound_.squaredBound(), steps);
        } else {
            walk_.cover(ConvexPiece(piece), to_.walkable, starts[0], bound_.squaredBound(), steps);
        }
        if (walk_.left().empty()) return;
        collectAround(starts);
        for (const ConvexPiece& left : walk_.left()) {
            for (int i = 2; i < left.count(); ++i) {
                const Corners part{left.corner(0), left.corner(i - 1), left.corner(i)};
                bound_.nearby() = around_;
                if (!bound_.isWithin(part)) search(part, makePlace);
            }
        }
    }

    double squaredBound() const { return bound_.squaredBound(); }

    /// How many parts coverLoosely() makes of a triangle, about: of one that is huge beside the
    /// bound, in a mesh whose usual triangles are tiny, too many.
    std::int64_t quarters(const Corners& t) const {
        const double longest = std::max(
            {squaredNorm(t[1] - t[0]), squaredNorm(t[2] - t[1]), squaredNorm(t[0] - t[2])});
        const double parts = longest / (kLargeQuarter * kLargeQuarter * bound_.squaredBound());
        return static_cast<std::int64_t>(std::min(parts, 1e18));
    }

    PartBound result() {
        result_.provedMm = bound_.boundMm();
        return std::move(result_);
    }

private:
    /// The triangles where walks start, and those that share a corner with them.
    void collectAround(std::span<const Index> starts) {
        numbers_.clear();
        for (const Index t : starts) {
            to_.walkable.forEachBeside(t, [&](Index beside) { numbers_.push_back(beside); });
        }
        std::sort(numbers_.begin(), numbers_.end());
        const auto end = std::unique(numbers_.begin(), numbers_.end());
        around_.clear();
        for (auto at = numbers_.begin(); at != end; ++at) {
            around_.push_back(to_.walkable.cornersOf(*at));
        }
    }

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
            for (const Corners& t : around_) {
                nearest = std::min(nearest, squaredDistanceToTriangle(corner, t));
            }
            nearest = to_.tree.get().squaredDistance(corner, to_.view, nearest);
            reachMm = std::max(reachMm, std::sqrt(nearest));
        }
        collectWithin(reachMm, piece);
        includeNear(piece, makePlace);
    }

    void collectWithin(double distanceMm, const Corners& piece) {
        constexpr double kRounding = 1 + 1e-9;
        BoundingBox box = boxOf(piece);
        box.widen(kRounding * distanceMm);
        near_.clear();
        bound_.nearby().clear();
        to_.tree.get().forEachOverlap(box, to_.view, [&](std::uint32_t t) {
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
    double looseMm_, limitMm_;
    PieceBound bound_;
    SurfaceWalk walk_;
    std::vector<Index> numbers_;
    std::vector<Corners> around_;     ///< where walks start
    std::vector<std::int64_t> near_;  ///< as bound_.nearby()
    PartBound result_;
};

/// What is proved, but for which triangles.
struct Task {
    const MeshParts& parts;
    const SimplifiedSurface& surface;
    double voxelMm, enoughMm, limitMm;
};

/// Calls f(triangle) for those of a piece of work that are not known.
template <class F>
void forEachUnknown(const std::vector<std::uint8_t>& isKnown, std::int64_t piece, std::size_t count,
                    const F& f) {
    const std::size_t begin = static_cast<std::size_t>(piece) * kPiece;
    for (std::size_t t = begin; t < std::min<std::size_t>(count, begin + kPiece); ++t) {
        if (isKnown.empty() || isKnown[t] == 0) f(t);
    }
}

/// Of the full surface to the simplified one.
/// \param isMapped  gets 1 for each triangle that the map has, whose images the cover gets
PartBound proveFine(const Task& task, const WalkableSurface<std::uint32_t>& fine,
                    const Target<Number>& to, const std::vector<std::uint8_t>& isKnown,
                    std::int64_t piece, std::vector<std::uint8_t>& isMapped, SharedCover& cover) {
    OneWayProof<Number> proof(to, task.voxelMm, task.enoughMm, task.limitMm);
    PieceMap map(task.parts, fine, task.surface, to.walkable, task.enoughMm);
    forEachUnknown(isKnown, piece, task.parts.triangles.size(), [&](std::size_t t) {
        if (map.map(static_cast<std::uint32_t>(t), proof.squaredBound())) {
            isMapped[t] = 1;
            for (const auto& part : map.parts()) {
                cover.add(part.triangle, shareOf(part.area2, to.walkable.cornersOf(part.triangle)));
            }
            return;
        }
        const auto& [a, b, c] = task.parts.triangles[t];
        const auto& standsFor = task.surface.sampleTriangle;
        const std::array starts{standsFor[a], standsFor[b], standsFor[c]};
        proof.include(
            cornersOf(task.parts, t), starts, kStepsOfFine,
            [](const Vec3& p, const Vec3& nearest, std::int64_t other) {
                const auto triangle = static_cast<Number>(other);
                return PlaceBeyond{nearest, p, other < 0 ? PlaceBeyond::kNone : triangle, true};
            });
    });
    return proof.result();
}

/// Tells the cover of the border between triangles that are mapped and others.
void addBorders(const Task& task, const WalkableSurface<std::uint32_t>& fine,
                const WalkableSurface<Number>& onto, std::int64_t piece,
                const std::vector<std::uint8_t>& isMapped, SharedCover& cover) {
    PieceMap map(task.parts, fine, task.surface, onto, task.enoughMm);
    forEachUnknown({}, piece, isMapped.size(), [&](std::size_t t) {
        if (isMapped[t] == 0) return;
        for (auto h = static_cast<std::uint32_t>(3 * t); h < 3 * t + 3; ++h) {
            const std::uint32_t beside = fine.twin(h) / 3;
            if (beside < isMapped.size() && isMapped[beside] != 0) continue;
            map.forEachAlong(h, [&](std::uint64_t passed) { cover.addBorder(passed); });
        }
    });
}

/// Of the simplified surface to the full one.
PartBound proveSimplified(const Task& task, const Target<std::uint32_t>& to,
                          const std::vector<std::uint8_t>& isKnown,
                          const std::vector<std::uint32_t>& starts, std::int64_t piece,
                          const SharedCover& cover) {
    OneWayProof<std::uint32_t> proof(to, task.voxelMm, task.enoughMm, task.limitMm);
    forEachUnknown(isKnown, piece, task.surface.triangles.size(), [&](std::size_t t) {
        if (cover.covers(t)) return;
        const Corners corners = cornersOf(task.surface, t);
        const Vec3 extent = boxOf(corners).maximum - boxOf(corners).minimum;
        // along a needle, which has no area, lie triangles too
        const double faces =
            norm(areaVector2(corners[0], corners[1], corners[2])) / (task.voxelMm * task.voxelMm) +
            norm(extent) / task.voxelMm;
        const int steps = kFewSteps + static_cast<int>(std::min(kManySteps, kStepsPerFace * faces));
        proof.include(corners, {&starts[t], 1}, steps,
                      [&](const Vec3& p, const Vec3& nearest, std::int64_t) {
                          return PlaceBeyond{p, nearest, static_cast<Number>(t), false};
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

/// For each triangle of the simplified surface one of the full surface with a point assigned to it.
/// \param points  of the full surface, which are the first samples
std::vector<std::uint32_t> startsOf(const SimplifiedSurface& surface,
                                    const WalkableSurface<std::uint32_t>& fine,
                                    std::size_t points) {
    std::vector<std::uint32_t> starts(surface.triangles.size(), kNoStart);
    for (std::size_t v = points; v-- > 0;) {
        starts[surface.sampleTriangle[v]] = fine.triangleAt(static_cast<std::uint32_t>(v));
    }
    startBeside(surface, starts);
    return starts;
}

}  // namespace

MeshProof::MeshProof(const MeshParts& parts, const MetricFrame& frame, double limitMm)
    : parts_(parts), frame_(frame), limitMm_(limitMm), fineTree_(parts.view()) {}

double MeshProof::largestSampleDistance(const SimplifiedSurface& surface) const {
    constexpr std::int64_t kSamples = 1 << 14;
    const std::int64_t count = std::ssize(surface.samples);
    std::vector<double> largest((count + kSamples - 1) / kSamples, 0);
    parallelForPieces(count, kSamples, [&](std::int64_t begin, std::int64_t end) {
        double& here = largest[begin / kSamples];
        for (std::int64_t s = begin; s < end; ++s) {
            here = std::max(
                here, squaredDistanceToTriangle(surface.samples[s].point(),
                                                cornersOf(surface, surface.sampleTriangle[s])));
        }
    });
    return std::sqrt(*std::max_element(largest.begin(), largest.end()));
}

ErrorBound MeshProof::prove(const SimplifiedSurface& surface) {
    // bounds are as tight as the largest sample's distance, or as a hundredth of a voxel
    enoughMm_ =
        std::min(limitMm_, std::max(largestSampleDistance(surface), 0.01 * frame_.narrowestMm()));
    provedMm_ = 0;
    return prove(surface, Scope());
}

ErrorBound MeshProof::proveAgain(const SimplifiedSurface& surface, const SurfaceChanges& changes) {
    if (isWithin_.empty()) return prove(surface);
    return prove(surface, scopeOf(surface, changes));
}

ErrorBound MeshProof::prove(const SimplifiedSurface& surface, const Scope& scope) {
    if (fine_.isEmpty()) fine_.assign(parts_.points, parts_.triangles);
    const Target<std::uint32_t> fine{fine_, parts_.view(), fineTree_};
    WalkableSurface<Number> walkable;
    walkable.assign(surface.points, surface.triangles);
    const TriangleView view{surface.points, surface.triangles};
    TreeOnDemand tree(view);
    const Target<Number> simplified{walkable, view, tree};
    const Task task{parts_, surface, frame_.voxelMm(), enoughMm_, limitMm_};
    const std::vector<std::uint32_t> starts = startsOf(surface, fine_, parts_.points.size());
    const std::int64_t finePieces = (std::ssize(parts_.triangles) + kPiece - 1) / kPiece,
                       pieces = (std::ssize(surface.triangles) + kPiece - 1) / kPiece;
    std::vector<PartBound> results(finePieces + pieces);
    SharedCover cover(surface.triangles.size());
    std::vector<std::uint8_t> isMapped(parts_.triangles.size(), 0);
    parallelForPieces(finePieces, 1, [&](std::int64_t piece, std::int64_t) {
        results[piece] =
            proveFine(task, fine_, simplified, scope.isFineKnown, piece, isMapped, cover);
    });
    parallelForPieces(finePieces, 1, [&](std::int64_t piece, std::int64_t) {
        addBorders(task, fine_, simplified.walkable, piece, isMapped, cover);
    });
    // walks on the full surface will fail as well then: its tree is made by all threads, where each
    // would wait for the one that asks first
    if (std::any_of(results.begin(), results.end(),
                    [](const PartBound& result) { return result.hasSearched; })) {
        fineTree_.get();
    }
    parallelForPieces(pieces, 1, [&](std::int64_t piece, std::int64_t) {
        results[finePieces + piece] =
            proveSimplified(task, fine, scope.isKnown, starts, piece, cover);
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
    remember(surface.triangles.size(), bound.beyondLimit);
    return bound;
}

void MeshProof::remember(std::size_t triangles, std::vector<PlaceBeyond> beyond) {
    isWithin_.assign(triangles, 1);
    for (const PlaceBeyond& place : beyond) {
        if (!place.isOfFine) isWithin_[place.triangle] = 0;
    }
    beyond_ = std::move(beyond);
}

/// What is to be proved: the new triangles, and the full surface near those that came or went and
/// where it lay beyond the limit.
MeshProof::Scope MeshProof::scopeOf(const SimplifiedSurface& surface,
                                    const SurfaceChanges& changes) {
    Scope scope;
    scope.isKnown = isWithin_;
    scope.isKnown.resize(surface.triangles.size(), 0);
    for (const std::uint64_t t : changes.triangles) {
        if (t < scope.isKnown.size()) scope.isKnown[t] = 0;
    }
    std::vector<Corners> changed = changes.before;
    for (std::size_t t = 0; t < scope.isKnown.size(); ++t) {
        if (scope.isKnown[t] == 0) changed.push_back(cornersOf(surface, t));
    }
    markFine(changed, scope);
    return scope;
}

/// Finds the triangles of the full surface near some triangles, and near the last places beyond the
/// limit. What is farther than the proved distance lies as near another triangle.
void MeshProof::markFine(const std::vector<Corners>& changed, Scope& scope) {
    // where much has changed nearly all is near it
    if (changed.size() > scope.isKnown.size() / 4) return;
    const double reachMm = std::min(limitMm_, provedMm_);
    const TriangleTree& tree = fineTree_.get();
    scope.isFineKnown.assign(parts_.triangles.size(), 1);
    const auto markNear = [&](const Corners& corners) {
        constexpr double kRounding = 1 + 1e-9;
        BoundingBox box = boxOf(corners);
        box.widen(kRounding * reachMm);
        tree.forEachOverlap(box, parts_.view(), [&](std::uint32_t t) {
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
