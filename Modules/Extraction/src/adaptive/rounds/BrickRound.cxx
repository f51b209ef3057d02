#include "adaptive/rounds/BrickRound.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"
#include "adaptiso/Core/Progress.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

/// A vertex on walls.
struct WallVertex {
    std::uint64_t edge;
    SurfaceState::Number vertex, triangle;  ///< and one of its triangles
    Vec3 normal;                            ///< of several bricks: the sum of theirs
    std::uint8_t clearance;
};

/// A brick after its own round. Vertices on walls are no samples, and not among the full-resolution
/// surface's, whose triangles have them as kOnWall + their number in `walls`.
struct BrickSurface : SimplifiedSurface {
    static constexpr Number kOnWall = Number{1} << 31;
    std::vector<WallVertex> walls;
    bool isWhole = false;  ///< noise: it is left so, and has no quadrics
};

/// Takes over what is not gone of the patch; heirs of all vertices.
void takeOver(Patch& patch, BrickSurface& brick) {
    if (!brick.isWhole) {
        brick.quadrics.reserve(patch.points.size());
        for (std::size_t v = 0; v < patch.points.size(); ++v) {
            brick.quadrics.push_back(StoredQuadric::of(patch.quadrics[v], patch.points[v]));
        }
    }
    brick.heirs.resize(patch.points.size());
    std::iota(brick.heirs.begin(), brick.heirs.end(), 0U);
    brick.points = std::move(patch.points);
    brick.states = std::move(patch.states);
    brick.triangles = std::move(patch.triangles);
    brick.samples = std::move(patch.samples);
    brick.sampleTriangle = std::move(patch.sampleTriangle);
    brick.samples.shrink_to_fit();
    brick.sampleTriangle.shrink_to_fit();
    // this thread must not begin another brick meanwhile
    isolated([&] { removeGone(brick, patch.heirs); });
    std::vector<std::uint32_t> triangleAt(brick.points.size());
    for (std::uint32_t t = 0; t < brick.triangles.size(); ++t) {
        for (const std::uint32_t v : brick.triangles[t]) triangleAt[v] = t;
    }
    for (WallVertex& wall : brick.walls) {
        wall.vertex = brick.heirs[wall.vertex];
        wall.triangle = triangleAt[wall.vertex];
    }
}

/// The surface comes round a sample whose value is the isovalue. There are many in whole-numbered
/// volumes, and nearly all are simplified soundly: they are no webs.
constexpr double kHairGap = 3 * kHair;

/// The brick's full-resolution surface as it is made, metric frame.
struct FineBrick {
    FineSurface surface;
    std::vector<Vec3> points;
    std::vector<Vec3> areas;  ///< the sum of the area vectors around each point
    bool isNoise = false;

    void setPoints(const MetricFrame& frame);
    bool bends(const std::array<std::uint32_t, 3>& t) const {
        return cornersBend(areas[t[0]], areas[t[1]], areas[t[2]]);
    }
    bool findNoise() const;
};

void FineBrick::setPoints(const MetricFrame& frame) {
    points.clear();
    points.reserve(surface.vertices.size());
    for (const FineVertex& v : surface.vertices) points.push_back(frame.fromIndex(v.index));
    areas = areasAround({points, surface.triangles});
}

/// Half of the cells are crossed, nearly all of the surface has other parts of it near, and most of
/// it bends: there is nothing flat to simplify, and each change would take long to prove.
bool FineBrick::findNoise() const {
    const auto isPart = [](double part, std::int64_t of, std::int64_t all) {
        return static_cast<double>(of) >= part * static_cast<double>(all);
    };
    if (!isPart(kNoiseCrossed, surface.cellsCrossed, surface.cellsSeen)) return false;
    const auto single = std::count_if(surface.vertices.begin(), surface.vertices.end(),
                                      [](const FineVertex& v) { return v.isSingleSheet; });
    if (isPart(kNoiseSingle, single, std::ssize(surface.vertices))) return false;
    const auto bent = std::count_if(surface.triangles.begin(), surface.triangles.end(),
                                    [&](const auto& t) { return bends(t); });
    return isPart(kNoiseBent, bent, std::ssize(surface.triangles));
}

/// Distances to other sheets at a brick's vertices.
struct Nearness {
    std::vector<std::uint8_t> clearance;  ///< see SheetClearance
    std::vector<std::uint8_t> isInWeb;    ///< see PatchLimits::webMm
};

/// A brick of noise is not searched: its vertices are known to be alone, or taken as near others.
Nearness nearnessOf(const FineBrick& made, const MetricFrame& frame, double webMm) {
    const std::vector<FineVertex>& vertices = made.surface.vertices;
    Nearness near;
    near.isInWeb.resize(vertices.size());
    near.clearance.reserve(vertices.size());
    for (const FineVertex& v : vertices) {
        near.clearance.push_back(v.isSingleSheet ? SheetClearance::kAlone : 0);
    }
    if (made.isNoise) return near;
    SheetClearance::fillIn(made.points, made.areas, frame, near.clearance);
    const std::array stepMm{norm(frame.fromIndex({1, 0, 0})), norm(frame.fromIndex({0, 1, 0})),
                            norm(frame.fromIndex({0, 0, 1}))};
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const FineVertex& vertex = vertices[v];
        if (vertex.gap == FineVertex::kNoGap) continue;
        const double gapMm = vertex.gap * stepMm[vertex.edge.axis()];
        if (gapMm < kNarrowGap * frame.narrowestMm()) {
            near.clearance[v] = std::min(near.clearance[v], SheetClearance::of(gapMm, frame));
        }
        near.isInWeb[v] = static_cast<std::uint8_t>(gapMm < webMm && vertex.gap > kHairGap);
    }
    return near;
}

/// Where the surface bends within a triangle its middle is a sample too: between corners a ridge
/// could pass unseen.
void addMiddles(const FineBrick& made, const Nearness& near, Patch& patch) {
    for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) {
        const auto& v = patch.triangles[t];
        if (!made.bends(v)) continue;
        Sample& middle = patch.samples.emplace_back(Sample::middleOf(
            patch.view().cornersOf(t),
            std::min({near.clearance[v[0]], near.clearance[v[1]], near.clearance[v[2]]})));
        middle.isInWeb =
            near.isInWeb[v[0]] != 0 || near.isInWeb[v[1]] != 0 || near.isInWeb[v[2]] != 0;
        patch.sampleTriangle.push_back(t);
    }
}

/// The brick's full-resolution surface as a patch; vertices on walls go to the brick's list.
Patch patchOf(const FineBrick& made, const Nearness& near, BrickSurface& brick) {
    Patch patch;
    patch.points = made.points;
    patch.triangles = made.surface.triangles;
    patch.ownTriangles = static_cast<std::uint32_t>(patch.triangles.size());
    patch.states.assign(patch.points.size(),
                        made.isNoise ? Patch::State::Final : Patch::State::Open);
    patch.heirs.resize(patch.points.size());
    std::iota(patch.heirs.begin(), patch.heirs.end(), 0U);
    std::vector<std::uint32_t> triangleAt(patch.points.size());
    for (std::uint32_t t = 0; t < patch.ownTriangles; ++t) {
        for (const std::uint32_t v : patch.triangles[t]) triangleAt[v] = t;
    }
    for (std::uint32_t v = 0; v < patch.points.size(); ++v) {
        const FineVertex& vertex = made.surface.vertices[v];
        if (vertex.isOnWall) {
            brick.walls.push_back(
                {vertex.edge.word, v, 0, normalized(made.areas[v]), near.clearance[v]});
            continue;
        }
        Sample& sample = patch.samples.emplace_back(
            Sample::at(patch.points[v], made.areas[v], near.clearance[v]));
        sample.isInWeb = near.isInWeb[v] != 0;
        patch.sampleTriangle.push_back(triangleAt[v]);
    }
    return patch;
}

/// Keeps the full-resolution surface, for the proof and to be brought back.
void keepFine(const FineBrick& made, BrickSurface& brick) {
    std::vector<std::uint32_t> number(made.points.size());
    std::uint32_t onWall = BrickSurface::kOnWall;
    for (std::uint32_t v = 0; v < number.size(); ++v) {
        if (made.surface.vertices[v].isOnWall) {
            number[v] = onWall++;
            continue;
        }
        number[v] = static_cast<std::uint32_t>(brick.fine.points.size());
        brick.fine.points.push_back(made.points[v]);
        brick.heirs[number[v]] = brick.heirs[v];
    }
    brick.heirs.resize(brick.fine.points.size());
    brick.fine.triangles.reserve(made.surface.triangles.size());
    for (const auto& [a, b, c] : made.surface.triangles) {
        brick.fine.triangles.push_back({number[a], number[b], number[c]});
    }
}

/// The brick after its own round; one of noise as it is: nothing of it is simplified later either.
/// \param lowIndex  sample index of the brick's first lattice position
BrickSurface simplifyBrick(const FineBrick& made, const Index3& lowIndex, const MetricFrame& frame,
                           const PatchLimits& limits, const BoundingBox* moving,
                           std::vector<double>* costs) {
    BrickSurface result;
    result.isWhole = made.isNoise;
    const Nearness near = nearnessOf(made, frame, limits.webMm);
    Patch patch = patchOf(made, near, result);
    if (!made.isNoise) {
        patch.quadrics = quadricsOf(patch.view());
        addMiddles(made, near, patch);
        patch.setBox(lowIndex, Brick::kSide);
        for (std::size_t v = 0; v < patch.points.size(); ++v) {
            const Vec3& index = made.surface.vertices[v].index;
            const bool isOutside = moving != nullptr && !moving->contains(index);
            if (isOutside) patch.states[v] = Patch::State::Final;
        }
        PatchSimplifier(patch, frame, limits).collapseEdges(patch.ownTriangles, costs);
    }
    takeOver(patch, result);
    keepFine(made, result);
    return result;
}

/// Joins bricks at their walls, one after the other, so that few of them are there at a time.
/// Vertices of the whole are numbered in the order in which bricks first have them.
class Joiner {
public:
    Joiner(const Bricks& bricks, bool keepsHeirs) : bricks_(bricks), keepsHeirs_(keepsHeirs) {
        for (std::int64_t b = 0; b < bricks.count(); ++b) blocks_ += bricks[b].blocks.size();
    }

    /// \pre the bricks come in their order
    void add(const BrickSurface& brick) {
        requireRoomFor(brick);
        makeRoomFor(brick);
        const auto firstTriangle = static_cast<Number>(joined_.triangles.size());
        numberVertices(brick, firstTriangle);
        for (const auto& t : brick.triangles) {
            joined_.triangles.push_back({number_[t[0]], number_[t[1]], number_[t[2]]});
        }
        addFine(brick);
        joined_.samples.insert(joined_.samples.end(), brick.samples.begin(), brick.samples.end());
        for (const std::uint32_t t : brick.sampleTriangle) {
            joined_.sampleTriangle.push_back(firstTriangle + t);
        }
        joined_.fineTriangles += std::ssize(brick.fine.triangles);
        joined_.tableTriangles += brick.tableTriangles;
    }

    SimplifiedSurface join() {
        wallAt_.clear();
        std::vector<Number> order(walls_.size()), place(walls_.size());
        std::iota(order.begin(), order.end(), Number{0});
        std::sort(order.begin(), order.end(),
                  [&](Number a, Number b) { return walls_[a].edge < walls_[b].edge; });
        for (const Number wall : order) {
            place[wall] = static_cast<Number>(joined_.fine.points.size());
            addWallSample(walls_[wall]);
        }
        for (auto& t : joined_.fine.triangles) {
            for (Number& v : t) {
                if (v >= BrickSurface::kOnWall) v = place[v - BrickSurface::kOnWall];
            }
        }
        if (!joined_.quadrics.empty()) joined_.quadrics.resize(joined_.points.size());
        return std::move(joined_);
    }

private:
    using Number = SurfaceState::Number;

    void requireRoomFor(const BrickSurface& brick) const {
        const auto fits = [](const auto& whole, const auto& part, std::size_t most) {
            return part.size() <= most - whole.size();
        };
        if (fits(joined_.fine.triangles, brick.fine.triangles, SurfaceState::kMost) &&
            fits(joined_.points, brick.points, SurfaceState::kMost) &&
            fits(joined_.samples, brick.samples, SimplifiedSurface::kMostSamples - walls_.size())) {
            return;
        }
        throw InvalidInput(
            "extractSurface: the surface is too large for the adaptive method in one piece; mc has "
            "no such limit, and adaptiso-giant works in tiles");
    }

    /// Lets the lists grow to what all bricks will need, by how much those so far did: so they are
    /// copied rarely, and little of them is there twice.
    void makeRoomFor(const BrickSurface& brick) {
        blocksJoined_ += bricks_[bricksJoined_++].blocks.size();
        const double share = static_cast<double>(blocksJoined_) /
                             static_cast<double>(std::max<std::size_t>(blocks_, 1));
        const auto grow = [&](auto& list, std::size_t more) {
            const std::size_t least = list.size() + more;
            if (least <= list.capacity()) return;
            const double needed = static_cast<double>(least);
            const double space = std::clamp(kRoomToGrow * needed / share, kLeastGrowth * needed,
                                            kMostGrowth * needed);
            reserveInHugePages(list, static_cast<std::size_t>(space));
        };
        grow(joined_.points, brick.points.size());
        grow(joined_.states, brick.points.size());
        if (!brick.isWhole) grow(joined_.quadrics, brick.points.size());
        grow(joined_.triangles, brick.triangles.size());
        // those on walls come last
        const std::size_t samples = brick.samples.size() + walls_.size() + brick.walls.size();
        grow(joined_.samples, samples);
        grow(joined_.sampleTriangle, samples);
        grow(joined_.fine.triangles, brick.fine.triangles.size());
        if (keepsHeirs_)
            grow(joined_.heirs, brick.heirs.size() + walls_.size() + brick.walls.size());
        grow(joined_.fine.points, brick.fine.points.size() + walls_.size() + brick.walls.size());
    }

    /// Gives the brick's vertices their numbers in the whole, and appends those that are new: at a
    /// wall the first brick keeps the vertex, the others add their quadrics to it.
    void numberVertices(const BrickSurface& brick, Number firstTriangle) {
        constexpr Number kNew = ~Number{0};
        if (!brick.isWhole) joined_.quadrics.resize(joined_.points.size());
        number_.assign(brick.points.size(), kNew);
        for (const auto& wall : brick.walls) {
            const auto known = wallAt_.find(wall.edge);
            if (known != wallAt_.end()) number_[wall.vertex] = walls_[known->second].vertex;
        }
        for (std::size_t v = 0; v < number_.size(); ++v) {
            if (number_[v] == kNew) {
                number_[v] = static_cast<Number>(joined_.points.size());
                joined_.points.push_back(brick.points[v]);
                joined_.states.push_back(brick.states[v]);
                if (!brick.isWhole) joined_.quadrics.push_back(brick.quadrics[v]);
                continue;
            }
            // a brick that is left whole keeps its walls, too
            if (brick.states[v] == Patch::State::Final) {
                joined_.states[number_[v]] = Patch::State::Final;
            }
            if (!brick.isWhole) joined_.quadrics[number_[v]] += brick.quadrics[v];
        }
        wallNumber_.clear();
        for (const auto& wall : brick.walls) {
            const auto [at, isNew] = wallAt_.try_emplace(wall.edge, walls_.size());
            if (isNew) {
                walls_.push_back({wall.edge, number_[wall.vertex], firstTriangle + wall.triangle,
                                  Vec3{}, SheetClearance::kAlone});
            }
            wallNumber_.push_back(static_cast<Number>(at->second));
            WallVertex& joined = walls_[at->second];
            joined.normal += wall.normal;
            joined.clearance = std::min(joined.clearance, wall.clearance);
        }
    }

    /// \pre numberVertices() has numbered the brick's walls
    void addFine(const BrickSurface& brick) {
        const FineMesh& fine = brick.fine;
        const auto first = static_cast<Number>(joined_.fine.points.size());
        joined_.fine.points.insert(joined_.fine.points.end(), fine.points.begin(),
                                   fine.points.end());
        if (keepsHeirs_) {
            for (const Number heir : brick.heirs) joined_.heirs.push_back(number_[heir]);
        }
        const auto numberOf = [&](Number v) {
            constexpr Number kOnWall = BrickSurface::kOnWall;
            return v < kOnWall ? first + v : kOnWall + wallNumber_[v - kOnWall];
        };
        for (const auto& [a, b, c] : fine.triangles) {
            joined_.fine.triangles.push_back({numberOf(a), numberOf(b), numberOf(c)});
        }
    }

    void addWallSample(const WallVertex& wall) {
        Sample sample;
        sample.clearance = wall.clearance;
        sample.setPoint(joined_.points[wall.vertex]);
        sample.setNormal(wall.normal);
        joined_.samples.push_back(sample);
        joined_.sampleTriangle.push_back(wall.triangle);
        joined_.fine.points.push_back(joined_.points[wall.vertex]);
        if (keepsHeirs_) joined_.heirs.push_back(wall.vertex);
    }

    const Bricks& bricks_;
    bool keepsHeirs_;
    std::size_t blocks_ = 0, blocksJoined_ = 0;  ///< of all bricks; of those that were added
    std::int64_t bricksJoined_ = 0;
    std::vector<Number> number_;      ///< in the whole, of a brick's vertices
    std::vector<Number> wallNumber_;  ///< in walls_, of a brick's
    std::vector<WallVertex> walls_;
    std::unordered_map<std::uint64_t, std::size_t> wallAt_;  ///< by edge
    SimplifiedSurface joined_;
};

}  // namespace

SimplifiedSurface simplifyBricks(const LatticeSampler& sampler, const Bricks& bricks,
                                 const MetricFrame& frame, const PatchLimits& limits,
                                 CollapseCosts* costs, const BoundingBox* moving) {
    struct Tools {
        BrickMesher mesher;
        FineBrick fine;
    };
    if (costs != nullptr) costs->assign(static_cast<std::size_t>(bricks.count()), {});
    PerThread<Tools> tools([&] { return Tools{BrickMesher(sampler, bricks.grid()), {}}; });
    const auto simplified = [&](std::int64_t b) {
        InterruptionCheck::ask();
        Tools& mine = tools.local();
        FineBrick& fine = mine.fine;
        mine.mesher.mesh(bricks[b], fine.surface);
        fine.setPoints(frame);
        fine.isNoise = limits.leavesNoise && fine.findNoise();
        if (!fine.isNoise) mine.mesher.findGaps(bricks[b], fine.surface);
        Index3 lowIndex = bricks[b].low;
        for (std::int64_t& along : lowIndex) along -= bricks.grid().offset;
        BrickSurface brick = simplifyBrick(fine, lowIndex, frame, limits, moving,
                                           costs != nullptr ? &(*costs)[b] : nullptr);
        brick.tableTriangles = std::ssize(brick.fine.triangles) - 2 * fine.surface.middles;
        return brick;
    };
    Joiner joiner(bricks, limits.keepsHeirs);
    parallelInOrder(bricks.count(), simplified,
                    [&](const BrickSurface& brick) { joiner.add(brick); });
    tools.clear();
    return joiner.join();
}

}  // namespace adaptiso::detail
