#include "adaptive/rounds/Simplification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "adaptiso/Core/Memory.h"
#include "adaptive/Parameters.h"
#include "adaptive/collapse/TriedEdges.h"
#include "adaptive/rounds/BorderMarks.h"

namespace adaptiso::detail {
namespace {

/// A cut into one cube with all of the surface; none where that would be too large.
std::optional<PatchCut> cutAround(const SimplifiedSurface& surface, const MetricFrame& frame) {
    if (surface.points.empty()) return {};
    const Vec3 first = frame.toIndex(surface.points[0]);
    BoundingBox box{first, first};
    for (const Vec3& p : surface.points) box.add(frame.toIndex(p));
    const Vec3 extent = box.size();
    const double widest = std::max({extent.x, extent.y, extent.z});
    if (!(widest <= kOnePatchSide)) return {};
    PatchCut cut{static_cast<std::int64_t>(widest) + Brick::kSide};
    for (int a = 0; a < 3; ++a) {
        const double middle = 0.5 * (box.minimum[a] + box.maximum[a]);
        cut.shift[a] = static_cast<std::int64_t>(std::floor(middle)) - cut.side / 2;
    }
    return cut;
}

/// How often cubes are doubled until few triangles are long: those straddle a wall of every cut.
int doublingsFor(const SimplifiedSurface& surface, const MetricFrame& frame) {
    const auto all = static_cast<double>(surface.triangleCount());
    int doublings = 0;
    for (double side = Brick::kSide;; side *= 2, ++doublings) {
        const auto isLong = std::count_if(
            surface.triangles.begin(), surface.triangles.end(), [&](const auto& corners) {
                BoundingBox box = BoundingBox::empty();
                for (const std::uint32_t v : corners) box.add(frame.toIndex(surface.points[v]));
                const Vec3 extent = box.size();
                return std::max({extent.x, extent.y, extent.z}) > kLongPart * side;
            });
        if (static_cast<double>(isLong) <= kMostLong * all) return doublings;
    }
}

/// All of it stays as it is, as noise at full resolution does.
bool isAllFinal(const SurfaceState& surface) {
    return std::all_of(surface.states.begin(), surface.states.end(),
                       [](Patch::State state) { return state == Patch::State::Final; });
}

bool leavesLess(double part, std::int64_t now, std::int64_t before) {
    return static_cast<double>(now) < part * static_cast<double>(before);
}

/// How much the limit of cost may grow in a round: the more the farther the wanted count is, and
/// where the last round hardly brought it nearer.
/// \param collapsed  in the last round
double costStep(std::int64_t triangles, std::int64_t target, std::int64_t collapsed) {
    const double part = static_cast<double>(triangles) / static_cast<double>(target);
    if (part > 2 || leavesLess(kHardly, 2 * collapsed, triangles - target)) return 16;
    return part > 1.4 ? 4 : 2;
}

/// Within some times the target.
bool isWithin(double times, std::int64_t triangles, std::int64_t target) {
    return static_cast<double>(triangles) <= times * static_cast<double>(target);
}

}  // namespace

Simplification::Simplification(const FullSurface& full, const PatchLimits& limits)
    : full_(full), frame_(full.frame()), limits_(limits) {
    const double voxel = frame_.voxelMm();
    costUnit_ = voxel * voxel * voxel * voxel;
}

/// Cuts in turn, so that what straddles one cut lies within the next, also where their cubes grow;
/// one cube for few triangles. No two sizes have a wall in common.
PatchCut Simplification::nextCut(const SimplifiedSurface& surface) {
    ++rounds_;
    if (surface.triangleCount() <= kOnePatch) {
        if (const auto cut = cutAround(surface, frame_)) return *cut;
    }
    struct Cubes {
        double mostCost;
        std::int64_t side, shift;
    };
    constexpr std::int64_t kSide = Brick::kSide;
    constexpr double kAny = std::numeric_limits<double>::infinity();
    constexpr std::array<Cubes, 3> kSizes{{{kFineCost, kSide, 0},
                                           {kMiddleCost, 3 * kSide / 2, kSide / 8},
                                           {kAny, 2 * kSide, kSide / 4}}};
    const auto size = std::find_if(kSizes.begin(), kSizes.end(), [&](const Cubes& cubes) {
        return limits_.maxCost <= cubes.mostCost * costUnit_;
    });
    if (!doublings_) doublings_ = doublingsFor(surface, frame_);
    const std::int64_t side = size->side << *doublings_,
                       shift = (size->shift << *doublings_) + (rounds_ % 2 == 1 ? side / 2 : 0);
    return {side, {shift, shift, shift}};
}

void Simplification::roundUpTo(double cost, SimplifiedSurface& surface, bool fits) {
    limits_.triedCost = limits_.maxCost;
    limits_.maxCost = cost;
    if (isAllFinal(surface)) return;
    PatchWork work{limits_};
    work.fits = fits;
    runPatchRound(surface, nextCut(surface), frame_, work);
    fits_ = fits ? 1 : 0;
    surface.returnFreedMemory();
}

/// Rounds with changes that are small in every way.
SimplifiedSurface Simplification::beginGently() {
    const double distanceMm = limits_.maxDistanceMm, voxel = frame_.voxelMm();
    const double mostCost = kGentleCost * voxel * voxel * distanceMm * distanceMm;
    limits_.maxDistanceMm *= kGentleDistance;
    limits_.maxCost = kFirstCost * costUnit_;
    SimplifiedSurface surface = full_.firstRound(limits_, nullptr);
    surface.returnFreedMemory();
    for (const double cost : kBoundCosts) {
        if (cost * costUnit_ > mostCost) break;
        roundUpTo(cost * costUnit_, surface);
    }
    // what was refused for its distance is to be tried again
    TriedEdges::openAll(surface.states);
    limits_.maxDistanceMm = distanceMm;
    return surface;
}

SimplifiedSurface Simplification::toLimits() {
    SimplifiedSurface surface = beginGently();
    if (surface.quadrics.empty()) return surface;  // all bricks were left whole
    for (const double cost : kBoundCosts) {
        if (cost * costUnit_ > limits_.maxCost) roundUpTo(cost * costUnit_, surface);
    }
    std::int64_t before = 0;
    do {
        before = surface.triangleCount();
        roundUpTo(std::numeric_limits<double>::max(), surface, true);
    } while (leavesLess(kFutile, surface.triangleCount(), before));
    fit(surface);
    return surface;
}

/// A round up to a cost that does not lead below the target. Where it did it is made again, up to
/// the cost by which its own collapses were as many as wanted.
void Simplification::roundTowards(SimplifiedSurface& surface, std::int64_t target, double cost) {
    limits_.maxCost = std::min(cost * costUnit_, std::numeric_limits<double>::max());
    const std::int64_t before = surface.triangleCount(), wanted = (before - target + 1) / 2;
    const double times = static_cast<double>(before) / static_cast<double>(target);
    const PatchCut cut = nextCut(surface);
    const bool dealsOut = times < kNearCount || isTied_;
    const bool isNear = times <= kFarFromCount;  // from afar not reached but by a cost far too high
    const bool maySurpass = isNear && !dealsOut;
    PatchWork work{limits_};
    if (!maySurpass) {
        work.mostCollapses = wanted;
        work.fits = dealsOut;
    }
    std::optional<SurfaceState> kept;
    CollapseCosts costs;
    if (maySurpass) kept = surface.state();
    runPatchRound(surface, cut, frame_, work, maySurpass ? &costs : nullptr);
    const bool hasSurpassed = maySurpass && surface.triangleCount() + 1 < target;
    if (hasSurpassed) {
        surface.state() = std::move(*kept);
        work.limits.maxCost = costLimitFor(costs, wanted);
        work.fits = true;
        runPatchRound(surface, cut, frame_, work);
    }
    fits_ = work.fits ? fits_ + 1 : 0;
    limits_.triedCost = work.limits.maxCost;
    collapsed_ = (before - surface.triangleCount()) / 2;
    // where costs are equal, as on flat parts, a limit leaves all or none: the next round deals out
    isTied_ = hasSurpassed && before - surface.triangleCount() < wanted;
}

SimplifiedSurface Simplification::toCount(const WantedCount& wanted, double farthestMm) {
    CollapseCosts costs;
    double cost = kFirstCost;
    limits_.maxCost = cost * costUnit_;
    limits_.triedCost = -1;
    rounds_ = fits_ = 0;
    isTied_ = false;
    SimplifiedSurface surface = full_.firstRound(limits_, &costs);
    collapsed_ = (surface.fineTriangles - surface.triangleCount()) / 2;
    const std::int64_t target = wanted.of(surface.fineTriangles);
    if (surface.triangleCount() < target) {
        limits_.maxCost = costLimitFor(costs, (surface.fineTriangles - target) / 2);
        surface = full_.firstRound(limits_, nullptr);
    }
    limits_.triedCost = limits_.maxCost;
    approach(surface, target, farthestMm);
    // far from the full surface its planes hold vertices in vain: those of this one may not
    for (bool helps = limits_.maxDistanceMm < farthestMm;
         helps && !isWithin(kMet, surface.triangleCount(), target);) {
        SurfaceState before = surface.state();
        beginAnew(surface);
        approach(surface, target, farthestMm);
        helps = isWithin(kMet, surface.triangleCount(), target) ||
                leavesLess(kWorthDoubling, surface.triangleCount(), before.triangleCount());
        if (!helps) surface.state() = std::move(before);
    }
    fit(surface);
    return surface;
}

/// Rounds with a limit of cost that grows; then, where the count can't be met, with the allowed
/// distance doubled again and again.
void Simplification::approach(SimplifiedSurface& surface, std::int64_t target, double farthestMm) {
    double cost = kFirstCost;
    std::optional<SurfaceState> worthwhile;  // after the last doubling that was
    double worthwhileMm = 0;
    std::int64_t last = std::numeric_limits<std::int64_t>::max();
    for (int helpless = 0; helpless < kMostHelpless;) {
        const std::int64_t above = surface.triangleCount() - target;
        const bool mayGoFarther = limits_.maxDistanceMm < farthestMm;
        const double gains = mayGoFarther ? kWorthwhileAsFar : kWorthwhile;
        const int mostIdle = mayGoFarther ? 1 : 2;  // both cuts have their turn
        for (int idle = 0; surface.triangleCount() > target && idle < mostIdle;) {
            const std::int64_t before = surface.triangleCount();
            cost *= costStep(before, target, collapsed_);
            if (cost > kLastCost) cost = std::numeric_limits<double>::infinity();
            roundTowards(surface, target, cost);
            const bool helped =
                leavesLess(gains, surface.triangleCount() - target, before - target);
            if (cost > kLastCost) idle = helped ? 0 : idle + 1;
        }
        const std::int64_t now = surface.triangleCount();
        if (isWithin(kMet, now, target) || farthestMm == 0) return;
        if (leavesLess(kWorthDoubling, now, last)) {
            worthwhile = surface.state();
            worthwhileMm = limits_.maxDistanceMm;
        }
        last = now;
        if (!mayGoFarther) break;
        const bool helped = leavesLess(kHelped, now - target, above);
        helpless = helped ? 0 : helpless + 1;
        goFarther(surface);
        cost = kCostAfterDistance;
    }
    surface.state() = std::move(*worthwhile);
    limits_.maxDistanceMm = worthwhileMm;
}

/// Goes on with twice the allowed distance: what was refused for it is to be tried again.
void Simplification::goFarther(SimplifiedSurface& surface) {
    limits_.maxDistanceMm *= 2;
    limits_.provesAll = true;  // beyond what single sheets are certain of
    TriedEdges::openAll(surface.states);
}

/// Forgets the planes of the full surface: vertices get those of the triangles that there are.
void Simplification::beginAnew(SimplifiedSurface& surface) {
    setQuadrics(surface);
    std::vector<std::uint8_t> isOnBorder(surface.marks.size());
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
        if (surface.states[v] != Patch::State::Final) surface.states[v] = Patch::State::Open;
        if (!isOnBorder.empty()) isOnBorder[v] = surface.marks[v] == Patch::kBorder ? 1 : 0;
    }
    if (!isOnBorder.empty()) markBorders(openHalfEdges(surface, isOnBorder), surface);
    limits_.maxCost = kFirstCost * costUnit_;
    limits_.triedCost = -1;
}

/// Moves vertices to where they lie closest to their samples: twice, so that what straddles the cut
/// has its turn as well. Where no triangle was dropped they stay. The last step: the quadrics are
/// given up.
void Simplification::fit(SimplifiedSurface& surface) {
    PatchWork work{limits_};
    work.collapses = false;
    work.fits = true;
    const bool isFull = surface.triangleCount() == surface.fineTriangles;
    for (; !isFull && fits_ < 2 && !isAllFinal(surface); ++fits_) {
        runPatchRound(surface, nextCut(surface), frame_, work);
    }
    freeMemory(surface.quadrics);
    surface.returnFreedMemory();
}

}  // namespace adaptiso::detail
