#include "WholeWalls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "WallCollapser.h"
#include "WallMender.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PortableMath.h"
#include "adaptiso/SurfaceProof/PieceBound.h"

namespace adaptiso::detail {

/// Numbers things from 0 on in the order in which they come. Memory goes with how many there are,
/// not with how large their own numbers are.
class IdNumbers {
public:
    using Id = std::uint32_t;
    static constexpr Id kNone = ~Id{0};

    /// The number of a thing; a new one gets the next.
    Id numberOf(Id id) {
        if (2 * ids_.size() >= table_.size()) grow();
        Id& at = table_[placeOf(id)];
        if (at == kNone) {
            at = static_cast<Id>(ids_.size());
            ids_.push_back(id);
        }
        return at;
    }
    /// kNone for a thing that never came.
    Id find(Id id) const { return table_.empty() ? kNone : table_[placeOf(id)]; }
    /// The ids, in order of appearance.
    const std::vector<Id>& ids() const { return ids_; }

private:
    std::size_t placeOf(Id id) const {
        const std::size_t mask = table_.size() - 1;
        std::size_t at = (id * std::uint64_t{0x9E3779B97F4A7C15} >> 32) & mask;
        while (table_[at] != kNone && ids_[table_[at]] != id) at = (at + 1) & mask;
        return at;
    }
    void grow() {
        table_.assign(table_.empty() ? 64 : 2 * table_.size(), kNone);
        for (std::size_t n = 0; n < ids_.size(); ++n) table_[placeOf(ids_[n])] = static_cast<Id>(n);
    }

    std::vector<Id> ids_;
    std::vector<Id> table_;  ///< a power of two of places
};

namespace {

using Id = std::uint32_t;
constexpr Id kNone = IdNumbers::kNone;

/// Collapses edges, cheapest first, until one limit of cost after the other is used up.
void collapseAll(WallCollapser& collapser, double limitMm, std::int64_t enough) {
    constexpr double kLowCost = 2.4e-3, kHighCost = 30, kStep = 6;
    const double h = collapser.voxelMm();
    for (double cost = kLowCost; cost < kHighCost; cost *= kStep) {
        collapser.round(cost * h * h * h * h, limitMm, enough);
        if (collapser.mesh().aliveTriangles() <= enough) return;
    }
}

/// Distance of the vertices of the full walls to the triangles that they are assigned to.
double largestSampleDistance(const WallCollapser& collapser) {
    const WallMesh& mesh = collapser.mesh();
    double largest = 0;
    for (Id s = 0; s < mesh.fullPoints(); ++s) {
        const Id assigned = collapser.assignmentOf(s).triangle;
        if (assigned == kNone) continue;
        largest =
            std::max(largest, squaredDistanceToTriangle(mesh.point(s), mesh.cornersOf(assigned)));
    }
    return std::sqrt(largest);
}

/// \return  the bound reached, mm
double simplifyPatch(WallCollapser& collapser, const WallAim& aim) {
    double limitMm = aim.limitMm;
    collapseAll(collapser, limitMm, aim.enough);
    constexpr int kMostDoublings = 12;
    for (int n = 0; aim.mayGrow && n < kMostDoublings; ++n) {
        if (collapser.mesh().aliveTriangles() <= aim.enough) break;
        limitMm *= 2;
        collapser.tryAllAgain();
        collapseAll(collapser, limitMm, aim.enough);
    }
    // what is taken back collapses again, held tighter; in the end it stays
    constexpr int kMostTries = 3;
    const double startMm =
        aim.mayGrow ? std::clamp(largestSampleDistance(collapser), aim.limitMm, limitMm) : limitMm;
    WallMender mender(collapser, startMm, aim.mayGrow);
    for (int n = 0; mender.mend(); ++n) {
        if (n < kMostTries) collapseAll(collapser, limitMm, aim.enough);
    }
    return mender.boundMm();
}

/// No edge at the vertex was left out because an end of it was frozen.
bool isTried(const WallCollapser& collapser, Id v) {
    const WallMesh& mesh = collapser.mesh();
    for (const Id t : mesh.around(v)) {
        for (const Id x : mesh.triangle(t).v) {
            if (collapser.isFrozen(x)) return false;
        }
    }
    return true;
}

}  // namespace

CubeCut::CubeCut(const Index3& size, double side, bool isShifted) : shift_(isShifted ? 0.5 : 0) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto length = static_cast<double>(size[axis] + 1);
        const double parts = std::max(1.0, std::round(length / side));
        side_[axis] = length / parts;
        count_[axis] = static_cast<std::int64_t>(parts) + (isShifted && parts > 1 ? 1 : 0);
    }
}

std::int64_t CubeCut::along(int axis, double x) const {
    const auto n = static_cast<std::int64_t>(std::floor((x + 1) / side_[axis] + shift_));
    return std::clamp<std::int64_t>(n, 0, count_[axis] - 1);
}

Vec3 CubeCut::lowOf(std::int64_t number) const {
    const Index3 cube = indexOf(number);
    Vec3 low;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = cube[axis] == 0 ? -std::numeric_limits<double>::infinity()
                                    : (static_cast<double>(cube[axis]) - shift_) * side_[axis] - 1;
    }
    return low;
}

Vec3 CubeCut::highOf(std::int64_t number) const {
    const Index3 cube = indexOf(number);
    Vec3 high;
    for (int axis = 0; axis < 3; ++axis) {
        high[axis] = cube[axis] == count_[axis] - 1
                         ? std::numeric_limits<double>::infinity()
                         : (static_cast<double>(cube[axis]) + 1 - shift_) * side_[axis] - 1;
    }
    return high;
}

/// Content of each cube.
struct WholeWalls::Lists {
    std::vector<Id> cubeOf;           ///< of each vertex
    std::vector<std::uint8_t> isOwn;  ///< of each triangle: in one cube
    Buckets<Id> own;                  ///< triangles in a cube
    Buckets<Id> beside;               ///< triangles that reach into it
    Buckets<Id> full;                 ///< triangles of the full walls in it or near
    Buckets<Id> samples;              ///< of each triangle
};

/// Numbers of a patch's things in the whole.
struct WholeWalls::Numbers {
    IdNumbers vertices, triangles;          ///< of the walls as they are
    IdNumbers fullVertices, fullTriangles;  ///< of the full ones
    std::size_t ownTriangles = 0;           ///< come first
};

/// Result for the walls in a cube.
struct WholeWalls::Made {
    std::vector<Vec3> points;
    std::vector<WallKind> kinds;
    std::vector<Quadric> quadrics;
    std::vector<Id> origins;
    std::vector<std::uint8_t> isTried;
    std::vector<Id> were;                 ///< their numbers before; kNone: new
    std::vector<WallTriangle> triangles;  ///< by these points
    struct Sample {
        Id sample;
        WallAssignment assigned;  ///< one of these triangles,
        bool isInCube;            ///< or one that reaches out of the cube, by its number before
    };
    std::vector<Sample> samples;
    double boundMm = 0;
};

WholeWalls::WholeWalls(LabelComplex&& full, const ImageGeometry& geometry)
    : geometry_(geometry),
      toIndex_(inverse(geometry.indexToPhysical)),
      fullPoints_(std::move(full.points)),
      full_(full.triangles.size()) {
    if (full.triangles.size() > kNone / 8) {
        throw InvalidInput("extractLabels: too many triangles to simplify: " +
                           std::to_string(full.triangles.size()));
    }
    std::map<std::array<Label, 2>, Id> numbers;
    std::array<Label, 2> last{};
    Id wall = kNone;
    for (std::size_t t = 0; t < full_.size(); ++t) {
        if (wall == kNone || full.labels[t] != last) {
            last = full.labels[t];
            const auto [at, isNew] = numbers.try_emplace(last, static_cast<Id>(walls_.size()));
            if (isNew) walls_.push_back(last);
            wall = at->second;
        }
        full_[t].wall = wall;
        for (int c = 0; c < 3; ++c) full_[t].v[c] = static_cast<Id>(full.triangles[t][c]);
    }
    full = {};
    assignments_.resize(fullPoints_.size());
}

WholeWalls::Lists WholeWalls::listsOf(const CubeCut& cut, const WallAim& aim) const {
    Lists lists;
    const std::vector<Vec3>& at = points();
    const std::vector<WallTriangle>& all = triangles();
    const auto cubes = static_cast<std::size_t>(cut.count());
    lists.cubeOf.resize(at.size());
    constexpr std::int64_t kPiece = 8192;
    const auto count = [](const auto& of) { return static_cast<std::int64_t>(of.size()); };
    parallelForPieces(count(at), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            lists.cubeOf[v] = static_cast<Id>(cut.number(cut.cubeOf(toIndex(at[v]))));
        }
    });
    lists.isOwn.resize(all.size());
    for (std::size_t t = 0; t < all.size(); ++t) {
        const auto& v = all[t].v;
        lists.isOwn[t] =
            lists.cubeOf[v[0]] == lists.cubeOf[v[1]] && lists.cubeOf[v[0]] == lists.cubeOf[v[2]]
                ? 1
                : 0;
    }
    lists.own.assign(cubes, [&](const auto& give) {
        for (Id t = 0; t < all.size(); ++t) {
            if (lists.isOwn[t] != 0) give(lists.cubeOf[all[t].v[0]], t);
        }
    });
    const auto giveReached = [&](const std::vector<Vec3>& corners, const WallTriangle& triangle,
                                 double around, Id t, const auto& give) {
        BoundingBox box = boxOf({toIndex(corners[triangle.v[0]]), toIndex(corners[triangle.v[1]]),
                                 toIndex(corners[triangle.v[2]])});
        box.widen(around);
        const Index3 first = cut.cubeOf(box.minimum), last = cut.cubeOf(box.maximum);
        for (std::int64_t k = first[2]; k <= last[2]; ++k) {
            for (std::int64_t j = first[1]; j <= last[1]; ++j) {
                for (std::int64_t i = first[0]; i <= last[0]; ++i) give(cut.number({i, j, k}), t);
            }
        }
    };
    lists.beside.assign(cubes, [&](const auto& give) {
        for (Id t = 0; t < all.size(); ++t) {
            if (lists.isOwn[t] == 0) giveReached(at, all[t], 0, t, give);
        }
    });
    if (isFull()) return lists;
    // what a collapse looks at lies within the limit, or is a neighbour of that
    const double around = 4 + 2 * aim.limitMm / leastPlaneDistanceMm(geometry_);
    lists.full.assign(cubes, [&](const auto& give) {
        for (Id t = 0; t < full_.size(); ++t) giveReached(fullPoints_, full_[t], around, t, give);
    });
    lists.samples.assign(all.size(), [&](const auto& give) {
        for (Id s = 0; s < assignments_.size(); ++s) {
            if (assignments_[s].triangle != kNone) give(assignments_[s].triangle, s);
        }
    });
    return lists;
}

/// Triangles block after block, so that what is near lies near in memory.
std::vector<Id> WholeWalls::inBlocks(std::span<const Id> own) const {
    constexpr double kBlockVoxels = 16;
    struct Place {
        Index3 block;
        Id triangle;
    };
    std::vector<Place> places;
    places.reserve(own.size());
    for (const Id t : own) {
        const Vec3 at = (1 / kBlockVoxels) * toIndex(points()[triangles()[t].v[0]]);
        const auto along = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
        places.push_back({{along(at.z), along(at.y), along(at.x)}, t});
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const Place& a, const Place& b) { return a.block < b.block; });
    std::vector<Id> ordered;
    ordered.reserve(places.size());
    for (const Place& place : places) ordered.push_back(place.triangle);
    return ordered;
}

WallPatch WholeWalls::patchOf(const CubeCut& cut, const Lists& lists, std::int64_t cube,
                              Numbers& numbers) const {
    WallPatch patch;
    patch.low = cut.lowOf(cube);
    patch.high = cut.highOf(cube);
    std::vector<WallTriangle> local;
    const auto add = [&](Id t) {
        numbers.triangles.numberOf(t);
        WallTriangle triangle = triangles()[t];
        for (Id& v : triangle.v) v = numbers.vertices.numberOf(v);
        local.push_back(triangle);
    };
    for (const Id t : inBlocks(lists.own.of(cube))) add(t);
    numbers.ownTriangles = local.size();
    for (const Id t : lists.beside.of(cube)) add(t);
    std::vector<Vec3> corners;
    for (const Id v : numbers.vertices.ids()) {
        corners.push_back(points()[v]);
        patch.isOwn.push_back(lists.cubeOf[v] == cube ? 1 : 0);
        patch.isFrozen.push_back(lists.cubeOf[v] == cube ? 0 : 1);
    }
    for (std::size_t t = numbers.ownTriangles; t < local.size(); ++t) {
        for (const Id v : local[t].v) patch.isFrozen[v] = 1;
    }
    if (isFull()) {
        patch.fullPoints = std::move(corners);
        patch.fullTriangles = std::move(local);
        return patch;
    }
    patch.points = std::move(corners);
    patch.triangles = std::move(local);
    addFull(lists, cube, patch, numbers);
    return patch;
}

/// The part of the full walls that a patch needs, where the walls are no longer these.
void WholeWalls::addFull(const Lists& lists, std::int64_t cube, WallPatch& patch,
                         Numbers& numbers) const {
    const auto addTriangle = [&](Id t) {
        if (numbers.fullTriangles.find(t) != kNone) return;
        numbers.fullTriangles.numberOf(t);
        WallTriangle triangle = full_[t];
        for (Id& v : triangle.v) v = numbers.fullVertices.numberOf(v);
        patch.fullTriangles.push_back(triangle);
    };
    for (const Id t : lists.full.of(cube)) addTriangle(t);
    for (const Id t : lists.own.of(cube)) {
        for (const Id s : lists.samples.of(t)) numbers.fullVertices.numberOf(s);
    }
    const auto addAssignment = [&](Id sample) {
        WallAssignment assigned = assignments_[sample];
        if (assigned.triangle != kNone)
            assigned.triangle = numbers.triangles.find(assigned.triangle);
        patch.assignments.push_back(assigned);
    };
    for (const Id v : numbers.fullVertices.ids()) {
        patch.fullPoints.push_back(fullPoints_[v]);
        addAssignment(v);
    }
    for (std::size_t n = 0; n < patch.points.size(); ++n) {
        const Id v = numbers.vertices.ids()[n];
        patch.kinds.push_back(kinds_[v]);
        patch.quadrics.push_back(quadrics_[v]);
        patch.isTried.push_back(isTried_[v]);
        patch.origins.push_back(origins_[v] == kNone ? kNone
                                                     : numbers.fullVertices.find(origins_[v]));
        if (patch.origins.back() == kNone) patch.isFrozen[n] = 1;
    }
}

WholeWalls::Made WholeWalls::simplifyOne(const CubeCut& cut, const Lists& lists, std::int64_t cube,
                                         const WallAim& aim) const {
    Made made;
    if (lists.own.of(cube).empty() && lists.beside.of(cube).empty()) return made;
    Numbers numbers;
    const WallPatch patch = patchOf(cut, lists, cube, numbers);
    WallCollapser collapser(patch, geometry_, aim.leastAngleDeg);
    made.boundMm = simplifyPatch(collapser, aim);
    const WallMesh& mesh = collapser.mesh();
    const Id firstPoint = mesh.firstPoint(), firstTriangle = mesh.firstTriangle();
    const IdNumbers& fullVertices = isFull() ? numbers.vertices : numbers.fullVertices;
    std::vector<Id> newVertex(mesh.pointCount(), kNone), newTriangle(mesh.triangleCount(), kNone);
    const auto olds = static_cast<Id>(numbers.vertices.ids().size());
    for (Id v = firstPoint; v < mesh.pointCount(); ++v) {
        if (!mesh.isAlive(v) || !collapser.isOwn(v)) continue;
        newVertex[v] = static_cast<Id>(made.points.size());
        made.points.push_back(mesh.point(v));
        made.kinds.push_back(mesh.kind(v));
        made.isTried.push_back(isTried(collapser, v) ? 1 : 0);
        made.quadrics.push_back(collapser.quadricOf(v));
        const Id origin = collapser.originOf(v);
        made.origins.push_back(origin == kNone ? kNone : fullVertices.ids()[origin]);
        made.were.push_back(v - firstPoint < olds ? numbers.vertices.ids()[v - firstPoint] : kNone);
    }
    for (Id t = firstTriangle; t < mesh.triangleCount(); ++t) {
        WallTriangle triangle = mesh.triangle(t);
        const bool isIn = std::all_of(triangle.v.begin(), triangle.v.end(),
                                      [&](Id v) { return collapser.isOwn(v); });
        if (!mesh.isTriangleAlive(t) || !isIn) continue;
        for (Id& v : triangle.v) v = newVertex[v];
        newTriangle[t] = static_cast<Id>(made.triangles.size());
        made.triangles.push_back(triangle);
    }
    const auto samples = static_cast<Id>(patch.fullPoints.size());
    for (Id s = 0; s < samples; ++s) {
        // those that this cube alone can have moved
        const bool isMine =
            isFull() ? patch.isOwn[s] != 0 : patch.assignments[s].triangle < numbers.ownTriangles;
        WallAssignment assigned = collapser.assignmentOf(s);
        if (!isMine || assigned.triangle == kNone) continue;
        const bool isInCube = newTriangle[assigned.triangle] != kNone;
        assigned.triangle = isInCube ? newTriangle[assigned.triangle]
                                     : numbers.triangles.ids()[assigned.triangle - firstTriangle];
        made.samples.push_back({fullVertices.ids()[s], assigned, isInCube});
    }
    return made;
}

void WholeWalls::join(const Lists& lists, std::vector<Made>& made) {
    std::size_t vertices = 0;
    for (const Made& each : made) vertices += each.points.size();
    std::vector<Vec3> newPoints;
    std::vector<WallTriangle> newTriangles;
    std::vector<Id> vertexNow(points().size(), kNone), triangleNow(triangles().size(), kNone);
    std::vector<Id> triangleBases;
    newPoints.reserve(vertices);
    kinds_.clear(), quadrics_.clear(), origins_.clear(), isTried_.clear();
    for (Made& each : made) {
        const auto base = static_cast<Id>(newPoints.size());
        for (std::size_t v = 0; v < each.points.size(); ++v) {
            if (each.were[v] != kNone) vertexNow[each.were[v]] = base + static_cast<Id>(v);
        }
        newPoints.insert(newPoints.end(), each.points.begin(), each.points.end());
        kinds_.insert(kinds_.end(), each.kinds.begin(), each.kinds.end());
        quadrics_.insert(quadrics_.end(), each.quadrics.begin(), each.quadrics.end());
        origins_.insert(origins_.end(), each.origins.begin(), each.origins.end());
        isTried_.insert(isTried_.end(), each.isTried.begin(), each.isTried.end());
        triangleBases.push_back(static_cast<Id>(newTriangles.size()));
        for (WallTriangle t : each.triangles) {
            for (Id& v : t.v) v += base;
            newTriangles.push_back(t);
        }
        const std::vector<Made::Sample> samples = std::move(each.samples);
        each = {};
        each.samples = samples;
    }
    for (std::size_t t = 0; t < lists.isOwn.size(); ++t) {
        if (lists.isOwn[t] != 0) continue;
        WallTriangle triangle = triangles()[t];
        for (Id& v : triangle.v) v = vertexNow[v];
        triangleNow[t] = static_cast<Id>(newTriangles.size());
        newTriangles.push_back(triangle);
    }
    for (WallAssignment& assigned : assignments_) {
        if (assigned.triangle != kNone) assigned.triangle = triangleNow[assigned.triangle];
    }
    for (std::size_t n = 0; n < made.size(); ++n) {
        for (const Made::Sample& sample : made[n].samples) {
            assignments_[sample.sample] = sample.assigned;
            Id& triangle = assignments_[sample.sample].triangle;
            triangle = sample.isInCube ? triangleBases[n] + triangle : triangleNow[triangle];
        }
    }
    points_ = std::move(newPoints);
    triangles_ = std::move(newTriangles);
}

double WholeWalls::simplify(const CubeCut& cut, const WallAim& aim) {
    const Lists lists = listsOf(cut, aim);
    std::vector<Made> made(cut.count());
    std::vector<std::int64_t> sizes(cut.count());
    for (std::int64_t cube = 0; cube < cut.count(); ++cube)
        sizes[cube] = std::ssize(lists.own.of(cube));
    parallelLargestFirst(
        sizes, [&](std::int64_t cube) { made[cube] = simplifyOne(cut, lists, cube, aim); });
    double boundMm = aim.limitMm;
    for (const Made& each : made) boundMm = std::max(boundMm, each.boundMm);
    join(lists, made);
    return boundMm;
}

LabelComplex WholeWalls::complex() const {
    LabelComplex out;
    out.points = points();
    out.triangles.reserve(triangles().size());
    out.labels.reserve(triangles().size());
    for (const WallTriangle& t : triangles()) {
        out.triangles.push_back({t.v[0], t.v[1], t.v[2]});
        out.labels.push_back(walls_[t.wall]);
    }
    return out;
}

namespace {

/// Sides of the cubes that are simplified side by side, in voxels: few enough triangles to stay in
/// a processor's own memory, enough that few reach out of the cube.
constexpr double kCubeVoxels = 64;
/// Where the limit is large, so are the triangles: the least side, of the limit.
constexpr double kCubeLimits = 24;

}  // namespace

SimplifiedWalls simplifyWalls(LabelComplex&& full, const ImageGeometry& geometry,
                              const SimplifyAims& aims, const ProgressCallback& progress) {
    const double h = portable::cubeRoot(geometry.voxelVolumeMm3());
    const auto tell = [&](double part) {
        if (progress) progress("simplify", part);
    };
    WallAim aim;
    aim.limitMm = aims.maxErrorMm.value_or(0.05 * h);
    aim.mayGrow = !aims.maxErrorMm;
    aim.leastAngleDeg = aims.minAngleDeg;
    aim.enough = aims.maxTriangles.value_or(0);
    SimplifiedWalls walls;
    WholeWalls whole(std::move(full), geometry);
    if (aims.maxTriangles) {  // the cheapest edges are chosen among all
        const auto all = static_cast<double>(
            std::max({geometry.size[0], geometry.size[1], geometry.size[2]}) + 1);
        walls.errorBoundMm = whole.simplify(CubeCut(geometry.size, 2 * all, false), aim);
    } else {
        const double side = std::max(kCubeVoxels, kCubeLimits * aim.limitMm / h);
        const CubeCut cut(geometry.size, side, false), shifted(geometry.size, side, true);
        walls.errorBoundMm = whole.simplify(cut, aim);
        tell(0.6);
        if (cut.count() > 1) whole.simplify(shifted, aim);
    }
    walls.complex = whole.complex();
    tell(1);
    return walls;
}

}  // namespace adaptiso::detail
