#include "adaptive/rounds/BrickRound.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "adaptiso/Core/Parallel.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

/// Gives the vertices of a full-resolution surface their quadrics.
/// \return the sum of the area vectors around each vertex
std::vector<Vec3> addQuadrics(Patch& patch) {
    patch.quadrics.assign(patch.points.size(), {});
    std::vector<Vec3> areas(patch.points.size());
    for (const auto& t : patch.triangles) {
        const Vec3& a = patch.points[t[0]];
        const Vec3 area2 = areaVector2(a, patch.points[t[1]], patch.points[t[2]]);
        const Quadric q = Quadric::ofTriangle(area2, a);
        for (const std::uint32_t v : t) {
            patch.quadrics[v] += q;
            areas[v] += area2;
        }
    }
    return areas;
}

/// A brick after its own round.
struct BrickSurface {
    std::vector<Vec3> points;
    std::vector<StoredQuadric> quadrics;
    std::vector<Patch::State> states;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Sample> samples;  ///< those on walls are not among them
    std::vector<std::uint32_t> sampleTriangle;
    struct WallVertex {
        std::uint64_t edge;
        std::uint32_t vertex, triangle;  ///< and one of its triangles
        Vec3 normal;
        std::uint8_t room;
    };
    std::vector<WallVertex> walls;
    std::int64_t fineTriangles = 0, tableTriangles = 0;
};

/// Takes over what is not gone of the patch.
void takeOver(Patch& patch, BrickSurface& brick) {
    std::vector<std::uint32_t> newTriangle(patch.triangles.size(), kNone),
        newVertex(patch.points.size(), kNone);
    std::uint32_t triangles = 0, vertices = 0;
    for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
        if (patch.triangles[t][0] == Patch::kGone) continue;
        newTriangle[t] = triangles++;
        for (const std::uint32_t v : patch.triangles[t]) newVertex[v] = 0;
    }
    for (std::uint32_t& v : newVertex) {
        if (v != kNone) v = vertices++;
    }
    brick.triangles.reserve(triangles);
    for (const auto& t : patch.triangles) {
        if (t[0] == Patch::kGone) continue;
        brick.triangles.push_back({newVertex[t[0]], newVertex[t[1]], newVertex[t[2]]});
    }
    brick.points.reserve(vertices);
    brick.quadrics.reserve(vertices);
    brick.states.reserve(vertices);
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
        if (newVertex[v] == kNone) continue;
        brick.points.push_back(patch.points[v]);
        brick.quadrics.push_back(StoredQuadric::of(patch.quadrics[v], patch.points[v]));
        brick.states.push_back(patch.states[v]);
    }
    brick.samples = std::move(patch.samples);
    brick.sampleTriangle = std::move(patch.sampleTriangle);
    brick.samples.shrink_to_fit();
    brick.sampleTriangle.shrink_to_fit();
    for (std::uint32_t& t : brick.sampleTriangle) t = newTriangle[t];
    std::vector<std::uint32_t> triangleAt(vertices);
    for (std::uint32_t t = 0; t < triangles; ++t) {
        for (const std::uint32_t v : brick.triangles[t]) triangleAt[v] = t;
    }
    for (auto& wall : brick.walls) {
        wall.vertex = newVertex[wall.vertex];
        wall.triangle = triangleAt[wall.vertex];
    }
}

/// Where the surface bends within a triangle its middle is a sample too: between corners a ridge
/// could pass unseen.
void addMiddles(const FineSurface& fine, const std::vector<Vec3>& areas,
                const std::vector<std::uint8_t>& room, Patch& patch) {
    for (std::uint32_t t = 0; t < fine.triangles.size(); ++t) {
        const auto& v = fine.triangles[t];
        const Vec3 a = normalized(areas[v[0]]), b = normalized(areas[v[1]]),
                   c = normalized(areas[v[2]]);
        if (std::min({dot(a, b), dot(b, c), dot(c, a)}) > kBentCosine) continue;
        const Vec3 &p = patch.points[v[0]], &q = patch.points[v[1]], &r = patch.points[v[2]];
        Sample& middle = patch.samples.emplace_back();
        middle.setPoint((1.0 / 3) * (p + q + r));
        middle.setNormal(areaVector2(p, q, r));
        middle.room = std::min({room[v[0]], room[v[1]], room[v[2]]});
        patch.sampleTriangle.push_back(t);
    }
}

/// Half of the cells are crossed, and nearly all of the surface has other parts of it near: there
/// is nothing flat to simplify, and each change would take long to prove.
bool isNoise(const FineSurface& fine) {
    if (static_cast<double>(fine.cells.size()) <
        kNoiseCrossed * static_cast<double>(fine.cellsSeen)) {
        return false;
    }
    const auto single = std::count_if(fine.vertices.begin(), fine.vertices.end(),
                                      [](const FineVertex& v) { return v.isSingleSheet; });
    return static_cast<double>(single) < kNoiseSingle * static_cast<double>(fine.vertices.size());
}

/// Vertices whose triangles all lie in one plane: their area vectors add up to their area.
/// \return nothing where they are few
std::vector<std::uint8_t> flatVertices(const Patch& patch, const std::vector<Vec3>& areas) {
    std::vector<std::uint8_t> isFlat(areas.size());
    std::size_t count = 0;
    for (std::size_t v = 0; v < areas.size(); ++v) {
        const double area2 = 2 * patch.quadrics[v].weight();
        isFlat[v] = static_cast<std::uint8_t>(norm(areas[v]) >= (1 - kFlatPart) * area2);
        count += isFlat[v];
    }
    if (static_cast<double>(count) < kFewFlat * static_cast<double>(isFlat.size())) return {};
    return isFlat;
}

/// The brick's full-resolution surface as a patch; vertices on walls go to the brick's list.
/// \param isFlat  gets what flatVertices() says
Patch patchOf(const FineSurface& fine, const MetricFrame& frame, BrickSurface& brick,
              std::vector<std::uint8_t>& isFlat) {
    Patch patch;
    patch.points.reserve(fine.vertices.size());
    for (const FineVertex& v : fine.vertices) patch.points.push_back(frame.fromIndex(v.index));
    patch.states.assign(patch.points.size(), Patch::State::Open);
    patch.triangles = fine.triangles;
    patch.ownTriangles = static_cast<std::uint32_t>(fine.triangles.size());
    const std::vector<Vec3> areas = addQuadrics(patch);
    isFlat = flatVertices(patch, areas);
    std::vector<std::uint8_t> room;
    room.reserve(fine.vertices.size());
    for (const FineVertex& v : fine.vertices)
        room.push_back(v.isSingleSheet ? SheetRoom::kAlone : 0);
    SheetRoom::fillIn(patch.points, areas, frame, room);
    std::vector<std::uint32_t> triangleAt(fine.vertices.size());
    for (std::uint32_t t = 0; t < fine.triangles.size(); ++t) {
        for (const std::uint32_t v : fine.triangles[t]) triangleAt[v] = t;
    }
    for (std::uint32_t v = 0; v < fine.vertices.size(); ++v) {
        const FineVertex& vertex = fine.vertices[v];
        if (vertex.isOnWall) {
            brick.walls.push_back({vertex.edge.word, v, 0, normalized(areas[v]), room[v]});
            continue;
        }
        Sample& sample = patch.samples.emplace_back();
        sample.setPoint(patch.points[v]);
        sample.setNormal(areas[v]);
        sample.room = room[v];
        patch.sampleTriangle.push_back(triangleAt[v]);
    }
    addMiddles(fine, areas, room, patch);
    return patch;
}

/// \param lowIndex  sample index of the brick's first lattice position
BrickSurface simplifyBrick(const FineSurface& fine, const Index3& lowIndex,
                           const MetricFrame& frame, const TightPlaces& tight,
                           const PatchLimits& limits, std::vector<double>* costs) {
    BrickSurface result;
    std::vector<std::uint8_t> isFlat;
    Patch patch = patchOf(fine, frame, result, isFlat);
    patch.setBox(lowIndex, Brick::kSide);
    result.fineTriangles = patch.ownTriangles;
    result.tableTriangles = result.fineTriangles - 2 * static_cast<std::int64_t>(fine.ownMiddles);
    tight.apply(frame, patch.samples);
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
        if (tight.isFrozen(fine.vertices[v].index)) patch.states[v] = Patch::State::Final;
    }
    if (limits.leavesNoise && isNoise(fine)) {
        patch.states.assign(patch.points.size(), Patch::State::Final);
    } else {
        PatchSimplifier simplifier(patch, frame, limits);
        if (limits.maxCost > 0 && !isFlat.empty()) {
            simplifier.settleFlatBoxes(isFlat, Brick::kSide / 2, costs);
        }
        simplifier.collapseEdges(patch.ownTriangles, costs);
    }
    takeOver(patch, result);
    return result;
}

/// Joins bricks at their walls; empties them on the way.
class Joiner {
public:
    Joiner(std::vector<BrickSurface>& bricks, const MetricFrame& frame, const TightPlaces& tight)
        : bricks_(bricks), frame_(frame), tight_(tight), number_(bricks.size()) {}

    SimplifiedSurface join() {
        collectWalls();
        numberMembers();
        tbb::parallel_invoke([&] { appendPoints(); }, [&] { appendQuadrics(); },
                             [&] { appendTriangles(); }, [&] { appendSamples(); });
        addWallSamples();
        return std::move(whole_);
    }

private:
    /// What a brick has of a vertex on a wall.
    struct WallEntry {
        std::uint64_t edge;
        std::uint32_t brick, vertex, triangle;
        Vec3 normal;
        std::uint8_t room;
        StoredQuadric quadric;
    };
    static constexpr std::uint64_t kShared = ~std::uint64_t{0};

    void collectWalls() {
        for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
            for (const auto& w : bricks_[b].walls) {
                walls_.push_back({w.edge, b, w.vertex, w.triangle, w.normal, w.room,
                                  bricks_[b].quadrics[w.vertex]});
            }
            bricks_[b].walls = {};
            number_[b].assign(bricks_[b].points.size(), 0);
        }
        std::sort(walls_.begin(), walls_.end(), [](const WallEntry& a, const WallEntry& b) {
            return a.edge != b.edge ? a.edge < b.edge : a.brick < b.brick;
        });
        // the first brick at a wall vertex keeps it
        for (std::size_t i = 1; i < walls_.size(); ++i) {
            if (walls_[i].edge == walls_[i - 1].edge) {
                number_[walls_[i].brick][walls_[i].vertex] = kShared;
            }
        }
    }

    /// Of the whole's vertices and triangles.
    void numberMembers() {
        firstTriangle_.push_back(0);
        for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
            for (std::uint64_t& number : number_[b]) {
                if (number != kShared) number = vertices_++;
            }
            firstTriangle_.push_back(firstTriangle_.back() + bricks_[b].triangles.size());
        }
        for (std::size_t i = 0, first = 0; i < walls_.size(); ++i) {
            if (walls_[i].edge != walls_[first].edge) first = i;
            if (i != first) numberOf(walls_[i]) = numberOf(walls_[first]);
        }
    }

    std::uint64_t& numberOf(const WallEntry& wall) { return number_[wall.brick][wall.vertex]; }

    /// Vertices of the whole are numbered in the order in which bricks first have them.
    template <class F>
    void forEachNewVertex(const F& f) {
        std::uint64_t next = 0;
        for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
            for (std::uint32_t v = 0; v < number_[b].size(); ++v) {
                if (number_[b][v] != next) continue;
                f(bricks_[b], v);
                ++next;
            }
        }
    }

    void appendPoints() {
        whole_.points.reserve(vertices_);
        whole_.states.reserve(vertices_);
        forEachNewVertex([&](const BrickSurface& brick, std::uint32_t v) {
            whole_.points.push_back(brick.points[v]);
            whole_.states.push_back(brick.states[v]);
        });
        for (BrickSurface& brick : bricks_) brick.points = {};
    }

    void appendQuadrics() {
        whole_.quadrics.reserve(vertices_);
        forEachNewVertex([&](const BrickSurface& brick, std::uint32_t v) {
            whole_.quadrics.push_back(brick.quadrics[v]);
        });
        for (BrickSurface& brick : bricks_) brick.quadrics = {};
        for (std::size_t i = 1; i < walls_.size(); ++i) {
            if (walls_[i].edge != walls_[i - 1].edge) continue;
            StoredQuadric& sum = whole_.quadrics[numberOf(walls_[i])];
            for (std::size_t n = 0; n < sum.number.size(); ++n) {
                sum.number[n] += walls_[i].quadric.number[n];
            }
        }
    }

    void appendTriangles() {
        whole_.triangles.reserve(firstTriangle_.back());
        for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
            const auto& number = number_[b];
            for (const auto& t : bricks_[b].triangles) {
                whole_.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
            }
            bricks_[b].triangles = {};
            whole_.fineTriangles += bricks_[b].fineTriangles;
            whole_.tableTriangles += bricks_[b].tableTriangles;
        }
    }

    void appendSamples() {
        std::size_t samples = walls_.size();
        for (const BrickSurface& brick : bricks_) samples += brick.samples.size();
        whole_.samples.reserve(samples);
        whole_.sampleTriangle.reserve(samples);
        for (std::uint32_t b = 0; b < bricks_.size(); ++b) {
            BrickSurface& brick = bricks_[b];
            whole_.firstSample.push_back(whole_.samples.size());
            whole_.samples.insert(whole_.samples.end(), brick.samples.begin(), brick.samples.end());
            for (const std::uint32_t t : brick.sampleTriangle) {
                whole_.sampleTriangle.push_back(firstTriangle_[b] + t);
            }
            brick.samples = {};
            brick.sampleTriangle = {};
        }
        whole_.firstSample.push_back(whole_.samples.size());
    }

    void addWallSamples() {
        for (std::size_t i = 0, j = 0; i < walls_.size(); i = j) {
            Sample sample;
            Vec3 normal;
            for (j = i; j < walls_.size() && walls_[j].edge == walls_[i].edge; ++j) {
                sample.room = std::min(sample.room, walls_[j].room);
                normal += walls_[j].normal;
            }
            sample.setPoint(whole_.points[numberOf(walls_[i])]);
            sample.setNormal(normal);
            tight_.apply(frame_, sample);
            whole_.samples.push_back(sample);
            whole_.sampleTriangle.push_back(firstTriangle_[walls_[i].brick] + walls_[i].triangle);
            whole_.wallEdges.push_back(walls_[i].edge);
        }
    }

    std::vector<BrickSurface>& bricks_;
    const MetricFrame& frame_;
    const TightPlaces& tight_;
    std::vector<std::vector<std::uint64_t>> number_;  ///< in the whole, of each brick's vertices
    std::uint64_t vertices_ = 0;                      ///< of the whole
    std::vector<std::uint64_t> firstTriangle_;        ///< of each brick, in the whole
    std::vector<WallEntry> walls_;
    SimplifiedSurface whole_;
};

}  // namespace

SimplifiedSurface simplifyBricks(const LatticeSampler& sampler, const Bricks& bricks,
                                 const MetricFrame& frame, const TightPlaces& tight,
                                 const PatchLimits& limits, CollapseCosts* costs) {
    struct Tools {
        BrickMesher mesher;
        FineSurface fine;
    };
    std::vector<BrickSurface> surfaces(static_cast<std::size_t>(bricks.count()));
    if (costs != nullptr) costs->assign(surfaces.size(), {});
    {
        tbb::enumerable_thread_specific<Tools> tools([&] {
            return Tools{BrickMesher(sampler, bricks.grid()), {}};
        });
        parallelForPieces(bricks.count(), 1, [&](std::int64_t b, std::int64_t) {
            Tools& mine = tools.local();
            mine.mesher.mesh(bricks[b], mine.fine);
            Index3 lowIndex = bricks[b].low;
            for (std::int64_t& along : lowIndex) along -= bricks.grid().offset;
            surfaces[b] = simplifyBrick(mine.fine, lowIndex, frame, tight, limits,
                                        costs != nullptr ? &(*costs)[b] : nullptr);
        });
    }
    return Joiner(surfaces, frame, tight).join();
}

}  // namespace adaptiso::detail
