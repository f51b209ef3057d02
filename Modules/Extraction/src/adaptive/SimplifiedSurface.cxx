#include "SimplifiedSurface.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <unordered_map>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

SimplifiedSurface::Sample toPoint(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Vec3 toVec(const SimplifiedSurface::Sample& p) {
    return {p[0], p[1], p[2]};
}

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
    Patch patch;  ///< without gone vertices and triangles
    struct WallVertex {
        std::uint64_t edge;
        std::uint32_t vertex;
        Normal normal;
        bool isSingleSheet;
    };
    std::vector<WallVertex> walls;
    std::int64_t fineTriangles = 0, tableTriangles = 0;
};

/// Leaves out gone triangles and vertices.
void compact(BrickSurface& brick) {
    Patch& patch = brick.patch;
    std::vector<std::uint32_t> newTriangle(patch.triangles.size(), kNone),
        newVertex(patch.points.size(), kNone);
    std::uint32_t triangles = 0;
    for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
        if (patch.triangles[t][0] == Patch::kGone) continue;
        newTriangle[t] = triangles;
        for (const std::uint32_t v : patch.triangles[t]) newVertex[v] = 0;
        patch.triangles[triangles++] = patch.triangles[t];
    }
    patch.triangles.resize(triangles);
    std::uint32_t vertices = 0;
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
        if (newVertex[v] == kNone) continue;
        newVertex[v] = vertices;
        patch.points[vertices] = patch.points[v];
        patch.states[vertices] = patch.states[v];
        patch.quadrics[vertices++] = patch.quadrics[v];
    }
    patch.points.resize(vertices);
    patch.states.resize(vertices);
    patch.quadrics.resize(vertices);
    patch.points.shrink_to_fit();
    patch.quadrics.shrink_to_fit();
    patch.triangles.shrink_to_fit();
    for (auto& t : patch.triangles) {
        for (std::uint32_t& v : t) v = newVertex[v];
    }
    for (std::uint32_t& t : patch.sampleTriangle) t = newTriangle[t];
    for (auto& wall : brick.walls) wall.vertex = newVertex[wall.vertex];
}

/// Where the surface bends within a triangle its middle is a sample too: between corners a ridge
/// could pass unseen.
void addMiddles(const FineSurface& fine, const std::vector<Vec3>& areas, Patch& patch) {
    constexpr double kLeastCosine = 0.94;  // 20 degrees
    for (std::uint32_t t = 0; t < fine.triangles.size(); ++t) {
        const auto& v = fine.triangles[t];
        const Vec3 a = normalized(areas[v[0]]), b = normalized(areas[v[1]]),
                   c = normalized(areas[v[2]]);
        if (std::min({dot(a, b), dot(b, c), dot(c, a)}) > kLeastCosine) continue;
        const Vec3 &p = patch.points[v[0]], &q = patch.points[v[1]], &r = patch.points[v[2]];
        patch.samples.push_back((1.0 / 3) * (p + q + r));
        patch.sampleNormals.push_back(toNormal(areaVector2(p, q, r)));
        patch.sampleTriangle.push_back(t);
        patch.sampleIsSingleSheet.push_back(fine.vertices[v[0]].isSingleSheet &&
                                            fine.vertices[v[1]].isSingleSheet &&
                                            fine.vertices[v[2]].isSingleSheet);
    }
}

/// Nearly all of the surface has other parts of it near: there is nothing flat to simplify, and
/// each change would take long to prove.
bool isNoise(const Patch& patch) {
    constexpr double kMost = 0.05;
    const auto single = std::count(patch.sampleIsSingleSheet.begin(),
                                   patch.sampleIsSingleSheet.end(), std::uint8_t{1});
    return static_cast<double>(single) < kMost * static_cast<double>(patch.samples.size());
}

BrickSurface simplifyBrick(BrickMesher& mesher, FineSurface& fine, const Brick& brick,
                           const MetricFrame& frame, const TightPlaces& tight,
                           const PatchLimits& limits, std::vector<double>* costs) {
    mesher.mesh(brick, fine);
    BrickSurface result;
    Patch& patch = result.patch;
    patch.points.reserve(fine.vertices.size());
    for (const FineVertex& v : fine.vertices) patch.points.push_back(frame.fromIndex(v.index));
    patch.states.assign(patch.points.size(), Patch::State::Open);
    patch.triangles = fine.triangles;
    patch.ownTriangles = static_cast<std::uint32_t>(fine.triangles.size());
    const std::vector<Vec3> areas = addQuadrics(patch);
    std::vector<std::uint32_t> triangleAt(fine.vertices.size());
    for (std::uint32_t t = 0; t < fine.triangles.size(); ++t) {
        for (const std::uint32_t v : fine.triangles[t]) triangleAt[v] = t;
    }
    for (std::uint32_t v = 0; v < fine.vertices.size(); ++v) {
        const FineVertex& vertex = fine.vertices[v];
        if (vertex.isOnWall) {
            result.walls.push_back({vertex.edge.word, v, toNormal(areas[v]), vertex.isSingleSheet});
            continue;
        }
        patch.samples.push_back(patch.points[v]);
        patch.sampleNormals.push_back(toNormal(areas[v]));
        patch.sampleTriangle.push_back(triangleAt[v]);
        patch.sampleIsSingleSheet.push_back(vertex.isSingleSheet);
    }
    addMiddles(fine, areas, patch);
    result.fineTriangles = patch.ownTriangles;
    result.tableTriangles = result.fineTriangles - 2 * static_cast<std::int64_t>(fine.ownMiddles);
    for (const Vec3& sample : patch.samples) {
        patch.sampleTightness.push_back(
            static_cast<std::uint8_t>(tight.tightnessAt(frame.toIndex(sample))));
    }
    if (limits.leavesNoise && isNoise(patch)) {
        patch.states.assign(patch.points.size(), Patch::State::Final);
        return result;
    }
    PatchSimplifier simplifier(patch, frame, limits);
    simplifier.collapseEdges(patch.ownTriangles, costs);
    compact(result);
    return result;
}

SimplifiedSurface join(std::vector<BrickSurface> bricks, const MetricFrame& frame,
                       const TightPlaces& tight) {
    struct Entry {
        std::uint64_t edge;
        std::uint32_t brick, vertex;
        Normal normal;
        bool isSingleSheet;
    };
    std::vector<Entry> walls;
    for (std::uint32_t b = 0; b < bricks.size(); ++b) {
        for (const auto& w : bricks[b].walls) {
            walls.push_back({w.edge, b, w.vertex, w.normal, w.isSingleSheet});
        }
    }
    std::sort(walls.begin(), walls.end(), [](const Entry& a, const Entry& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.brick < b.brick;
    });
    // the first brick at a wall vertex keeps it
    std::vector<std::vector<std::uint64_t>> number(bricks.size());
    for (std::uint32_t b = 0; b < bricks.size(); ++b) {
        number[b].assign(bricks[b].patch.points.size(), 0);
    }
    constexpr std::uint64_t kShared = ~std::uint64_t{0};
    for (std::size_t i = 1; i < walls.size(); ++i) {
        if (walls[i].edge == walls[i - 1].edge) number[walls[i].brick][walls[i].vertex] = kShared;
    }
    SimplifiedSurface whole;
    for (std::uint32_t b = 0; b < bricks.size(); ++b) {
        const Patch& patch = bricks[b].patch;
        for (std::uint32_t v = 0; v < patch.points.size(); ++v) {
            if (number[b][v] == kShared) continue;
            number[b][v] = whole.points.size();
            whole.points.push_back(patch.points[v]);
            whole.quadrics.push_back(patch.quadrics[v]);
            whole.states.push_back(patch.states[v]);
        }
    }
    for (std::size_t i = 0, first = 0; i < walls.size(); ++i) {
        if (walls[i].edge != walls[first].edge) first = i;
        if (i == first) continue;
        const std::uint64_t id = number[walls[first].brick][walls[first].vertex];
        number[walls[i].brick][walls[i].vertex] = id;
        whole.quadrics[id] += bricks[walls[i].brick].patch.quadrics[walls[i].vertex];
    }
    std::size_t triangles = 0, samples = 0;
    for (const BrickSurface& brick : bricks) {
        triangles += brick.patch.triangles.size();
        samples += brick.patch.samples.size();
    }
    whole.triangles.reserve(triangles);
    whole.samples.reserve(samples + walls.size());
    std::vector<std::uint64_t> triangleAt(whole.points.size());
    for (std::uint32_t b = 0; b < bricks.size(); ++b) {
        Patch& patch = bricks[b].patch;
        whole.firstSample.push_back(whole.samples.size());
        const std::uint64_t first = whole.triangles.size();
        for (const auto& t : patch.triangles) {
            for (const std::uint32_t v : t) triangleAt[number[b][v]] = whole.triangles.size();
            whole.triangles.push_back({number[b][t[0]], number[b][t[1]], number[b][t[2]]});
        }
        for (std::size_t s = 0; s < patch.samples.size(); ++s) {
            whole.samples.push_back(toPoint(patch.samples[s]));
            whole.sampleNormals.push_back(patch.sampleNormals[s]);
            whole.sampleIsSingleSheet.push_back(patch.sampleIsSingleSheet[s]);
            whole.sampleTightness.push_back(patch.sampleTightness[s]);
            whole.sampleTriangle.push_back(first + patch.sampleTriangle[s]);
        }
        whole.fineTriangles += bricks[b].fineTriangles;
        whole.tableTriangles += bricks[b].tableTriangles;
        patch = {};
    }
    whole.firstSample.push_back(whole.samples.size());
    for (std::size_t i = 0; i < walls.size(); ++i) {
        if (i > 0 && walls[i].edge == walls[i - 1].edge) continue;
        bool isSingle = true;
        Vec3 normal;
        for (std::size_t j = i; j < walls.size() && walls[j].edge == walls[i].edge; ++j) {
            isSingle = isSingle && walls[j].isSingleSheet;
            normal += toVec3(walls[j].normal);
        }
        const std::uint64_t id = number[walls[i].brick][walls[i].vertex];
        whole.samples.push_back(toPoint(whole.points[id]));
        whole.sampleNormals.push_back(toNormal(normal));
        whole.sampleIsSingleSheet.push_back(isSingle);
        whole.sampleTightness.push_back(
            static_cast<std::uint8_t>(tight.tightnessAt(frame.toIndex(whole.points[id]))));
        whole.sampleTriangle.push_back(triangleAt[id]);
        whole.wallEdges.push_back(walls[i].edge);
    }
    return whole;
}

/// Numbers 0 .. n sorted by a small key, in their order where it is equal.
struct Groups {
    std::vector<std::uint64_t> begin, members;

    template <class KeyOf>
    Groups(std::size_t groups, std::size_t n, const KeyOf& keyOf) : begin(groups + 1, 0) {
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint64_t key = keyOf(i);
            if (key < groups) ++begin[key + 1];
        }
        for (std::size_t g = 0; g < groups; ++g) begin[g + 1] += begin[g];
        members.resize(begin[groups]);
        std::vector<std::uint64_t> at(begin.begin(), begin.end() - 1);
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint64_t key = keyOf(i);
            if (key < groups) members[at[key]++] = i;
        }
    }
    std::span<const std::uint64_t> of(std::size_t group) const {
        return {members.data() + begin[group], begin[group + 1] - begin[group]};
    }
};

/// The cubes of a cut that can hold the surface.
class Cubes {
public:
    Cubes(const SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame)
        : cut_(cut), frame_(frame) {
        if (surface.points.empty()) return;
        std::array<std::int64_t, 3> high{};
        bool isFirst = true;
        for (const Vec3& p : surface.points) {
            const Index3 c = cubeAt(p);
            for (int a = 0; a < 3; ++a) {
                low_[a] = isFirst ? c[a] : std::min(low_[a], c[a]);
                high[a] = isFirst ? c[a] : std::max(high[a], c[a]);
            }
            isFirst = false;
        }
        for (int a = 0; a < 3; ++a) count_[a] = high[a] - low_[a] + 1;
    }
    std::size_t count() const {
        return static_cast<std::size_t>(count_[0] * count_[1] * count_[2]);
    }
    Index3 cubeAt(const Vec3& p) const {
        const Vec3 index = frame_.toIndex(p);
        Index3 cube;
        for (int a = 0; a < 3; ++a) {
            cube[a] = static_cast<std::int64_t>(std::floor(
                (index[a] - static_cast<double>(cut_.shift)) / static_cast<double>(cut_.side)));
        }
        return cube;
    }
    std::uint64_t numberOf(const Index3& cube) const {
        return static_cast<std::uint64_t>(
            cube[0] - low_[0] + count_[0] * (cube[1] - low_[1] + count_[1] * (cube[2] - low_[2])));
    }
    void setBounds(std::size_t number, Patch& patch) const {
        const auto n = static_cast<std::int64_t>(number);
        const Index3 cube{n % count_[0] + low_[0], n / count_[0] % count_[1] + low_[1],
                          n / (count_[0] * count_[1]) + low_[2]};
        // a hair inside, so that no rounding takes a vertex out
        for (int a = 0; a < 3; ++a) {
            const auto low = static_cast<double>(cube[a] * cut_.side + cut_.shift);
            patch.lowIndex[a] = low + 1e-6;
            patch.highIndex[a] = low + static_cast<double>(cut_.side) - 1e-6;
        }
    }

private:
    PatchCut cut_;
    const MetricFrame& frame_;
    Index3 low_{0, 0, 0}, count_{1, 1, 1};
};

/// The patches of a cut: who belongs to which.
class PatchGroups {
public:
    PatchGroups(const SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame)
        : surface_(surface),
          cubes_(surface, cut, frame),
          cubeOfVertex_(cubesOfVertices()),
          vertices_(cubes_.count(), surface.points.size(),
                    [&](std::size_t v) { return cubeOfVertex_[v]; }),
          triangles_(cubes_.count(), surface.triangles.size(),
                     [&](std::size_t t) { return cubeOfTriangle(t); }),
          samples_(surface.triangles.size(), surface.samples.size(),
                   [&](std::size_t s) { return surface.sampleTriangle[s]; }),
          placeInCube_(surface.points.size()),
          obstacles_(cubes_.count()) {
        for (std::size_t n = 0; n < cubes_.count(); ++n) {
            const auto members = vertices_.of(n);
            for (std::size_t i = 0; i < members.size(); ++i) {
                placeInCube_[members[i]] = static_cast<std::uint32_t>(i);
            }
        }
        collectObstacles();
    }

    std::size_t count() const { return cubes_.count(); }
    bool isEmpty(std::size_t n) const { return triangles_.of(n).empty(); }
    bool isFinal(std::size_t n) const {
        const auto members = vertices_.of(n);
        return std::all_of(members.begin(), members.end(), [&](std::uint64_t v) {
            return surface_.states[v] == Patch::State::Final;
        });
    }

    /// `total` dealt out by the patches' numbers of triangles.
    std::vector<std::int64_t> shares(std::int64_t total) const {
        std::vector<std::int64_t> share(count(), total);
        const auto all = static_cast<double>(triangles_.members.size());
        if (static_cast<double>(total) > all) return share;
        std::int64_t dealt = 0;
        for (std::size_t n = 0; n < count(); ++n) {
            const double upToHere = static_cast<double>(triangles_.begin[n + 1]) / all;
            const auto due =
                static_cast<std::int64_t>(std::floor(upToHere * static_cast<double>(total) + 0.5));
            share[n] = due - dealt;
            dealt = due;
        }
        return share;
    }

    /// A copy of a patch, with the triangles around it as obstacles.
    Patch take(std::size_t n) const {
        Patch patch;
        cubes_.setBounds(n, patch);
        const auto members = vertices_.of(n);
        patch.points.reserve(members.size());
        patch.quadrics.reserve(members.size());
        for (const std::uint64_t v : members) {
            patch.points.push_back(surface_.points[v]);
            patch.quadrics.push_back(surface_.quadrics[v]);
            patch.states.push_back(surface_.states[v]);
        }
        std::unordered_map<std::uint64_t, std::uint32_t> outside;
        const auto localVertex = [&](std::uint64_t v) {
            if (cubeOfVertex_[v] == n) return placeInCube_[v];
            const auto [at, isNew] =
                outside.try_emplace(v, static_cast<std::uint32_t>(patch.points.size()));
            if (isNew) {
                patch.points.push_back(surface_.points[v]);
                patch.quadrics.emplace_back();
                patch.states.push_back(Patch::State::Open);
            }
            return at->second;
        };
        const auto add = [&](std::uint64_t t) {
            for (const std::uint64_t s : samples_.of(t)) {
                patch.samples.push_back(toVec(surface_.samples[s]));
                patch.sampleNormals.push_back(surface_.sampleNormals[s]);
                patch.sampleIsSingleSheet.push_back(surface_.sampleIsSingleSheet[s]);
                patch.sampleTightness.push_back(surface_.sampleTightness[s]);
                patch.sampleTriangle.push_back(static_cast<std::uint32_t>(patch.triangles.size()));
            }
            const SimplifiedSurface::Triangle& c = surface_.triangles[t];
            patch.triangles.push_back({localVertex(c[0]), localVertex(c[1]), localVertex(c[2])});
        };
        for (const std::uint64_t t : triangles_.of(n)) add(t);
        patch.ownTriangles = static_cast<std::uint32_t>(patch.triangles.size());
        for (const std::uint64_t t : obstacles_[n]) add(t);
        return patch;
    }

    /// Writes what take() copied, and has changed since, back to the surface. Different patches
    /// touch different members, so this may run in parallel.
    void putBack(std::size_t n, const Patch& patch, SimplifiedSurface& surface) const {
        const auto members = vertices_.of(n);
        for (std::size_t v = 0; v < members.size(); ++v) {
            surface.states[members[v]] = patch.states[v];
            // those that other patches look at have not changed, and must not be written
            if (surface.points[members[v]] == patch.points[v]) continue;
            surface.points[members[v]] = patch.points[v];
            surface.quadrics[members[v]] = patch.quadrics[v];
        }
        const auto own = triangles_.of(n);
        std::size_t sample = 0;
        for (std::size_t t = 0; t < own.size(); ++t) {
            for (const std::uint64_t s : samples_.of(own[t])) {
                surface.sampleTriangle[s] = own[patch.sampleTriangle[sample++]];
            }
            for (int c = 0; c < 3; ++c) {
                const std::uint32_t v = patch.triangles[t][c];
                surface.triangles[own[t]][c] =
                    v == Patch::kGone ? SimplifiedSurface::kGone : members[v];
            }
        }
    }

private:
    static constexpr std::uint64_t kStraddles = ~std::uint64_t{0};

    std::vector<std::uint64_t> cubesOfVertices() const {
        std::vector<std::uint64_t> cubes(surface_.points.size());
        for (std::size_t v = 0; v < cubes.size(); ++v) {
            cubes[v] = cubes_.numberOf(cubes_.cubeAt(surface_.points[v]));
        }
        return cubes;
    }
    std::uint64_t cubeOfTriangle(std::size_t t) const {
        const auto& c = surface_.triangles[t];
        const std::uint64_t cube = cubeOfVertex_[c[0]];
        return cubeOfVertex_[c[1]] == cube && cubeOfVertex_[c[2]] == cube ? cube : kStraddles;
    }
    /// Triangles that straddle cubes are obstacles in all the cubes that they may reach into.
    void collectObstacles() {
        for (std::uint64_t t = 0; t < surface_.triangles.size(); ++t) {
            if (cubeOfTriangle(t) != kStraddles) continue;
            Index3 low{}, high{};
            for (int c = 0; c < 3; ++c) {
                const Index3 cube = cubes_.cubeAt(surface_.points[surface_.triangles[t][c]]);
                for (int a = 0; a < 3; ++a) {
                    low[a] = c == 0 ? cube[a] : std::min(low[a], cube[a]);
                    high[a] = c == 0 ? cube[a] : std::max(high[a], cube[a]);
                }
            }
            for (std::int64_t z = low[2]; z <= high[2]; ++z) {
                for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
                        obstacles_[cubes_.numberOf({x, y, z})].push_back(t);
                    }
                }
            }
        }
    }

    const SimplifiedSurface& surface_;
    Cubes cubes_;
    std::vector<std::uint64_t> cubeOfVertex_;
    Groups vertices_, triangles_, samples_;
    std::vector<std::uint32_t> placeInCube_;
    std::vector<std::vector<std::uint64_t>> obstacles_;
};

void removeGone(SimplifiedSurface& surface) {
    std::vector<std::uint64_t> newTriangle(surface.triangles.size()),
        newVertex(surface.points.size(), SimplifiedSurface::kGone);
    std::uint64_t triangles = 0, vertices = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (surface.triangles[t][0] == SimplifiedSurface::kGone) continue;
        for (const std::uint64_t v : surface.triangles[t]) newVertex[v] = 0;
        newTriangle[t] = triangles;
        surface.triangles[triangles++] = surface.triangles[t];
    }
    surface.triangles.resize(triangles);
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
        if (newVertex[v] == SimplifiedSurface::kGone) continue;
        newVertex[v] = vertices;
        surface.points[vertices] = surface.points[v];
        surface.states[vertices] = surface.states[v];
        surface.quadrics[vertices++] = surface.quadrics[v];
    }
    surface.points.resize(vertices);
    surface.states.resize(vertices);
    surface.quadrics.resize(vertices);
    for (auto& t : surface.triangles) {
        for (std::uint64_t& v : t) v = newVertex[v];
    }
    for (std::uint64_t& t : surface.sampleTriangle) t = newTriangle[t];
}

}  // namespace

SimplifiedSurface simplifyBricks(const LatticeSampler& sampler, const Bricks& bricks,
                                 const MetricFrame& frame, const TightPlaces& tight,
                                 const PatchLimits& limits, CollapseCosts* costs) {
    struct Tools {
        BrickMesher mesher;
        FineSurface fine;
    };
    tbb::enumerable_thread_specific<Tools> tools([&] {
        return Tools{BrickMesher(sampler, bricks.grid()), {}};
    });
    std::vector<BrickSurface> surfaces(static_cast<std::size_t>(bricks.count()));
    if (costs != nullptr) costs->assign(surfaces.size(), {});
    parallelForPieces(bricks.count(), 1, [&](std::int64_t b, std::int64_t) {
        Tools& mine = tools.local();
        surfaces[b] = simplifyBrick(mine.mesher, mine.fine, bricks[b], frame, tight, limits,
                                    costs != nullptr ? &(*costs)[b] : nullptr);
    });
    return join(std::move(surfaces), frame, tight);
}

Index3 TightPlaces::cubeAt(const Vec3& place) {
    Index3 cube;
    for (int a = 0; a < 3; ++a) cube[a] = static_cast<std::int64_t>(std::floor(place[a] / kCube));
    return cube;
}

void TightPlaces::add(const std::vector<Vec3>& places) {
    std::set<Index3> cubes;
    for (const Vec3& place : places) {
        const Index3 cube = cubeAt(place);
        for (int n = 0; n < 27; ++n) {
            cubes.insert({cube[0] + n % 3 - 1, cube[1] + n / 3 % 3 - 1, cube[2] + n / 9 - 1});
        }
    }
    for (const Index3& cube : cubes) ++tightness_[cube];
}

int TightPlaces::tightnessAt(const Vec3& place) const {
    constexpr std::array kHalvings{0, 1, 4, 12, 24, 40};
    if (tightness_.empty()) return 0;
    const auto at = tightness_.find(cubeAt(place));
    return at == tightness_.end() ? 0 : kHalvings[std::min<std::size_t>(at->second, 5)];
}

double costLimitFor(const CollapseCosts& costs, std::int64_t collapses) {
    // a patch stops for good at its first collapse above the limit: what counts is the largest so
    // far
    std::vector<double> largestSoFar;
    for (const std::vector<double>& patch : costs) {
        double largest = 0;
        for (const double cost : patch) {
            largest = std::max(largest, cost);
            largestSoFar.push_back(largest);
        }
    }
    if (static_cast<std::int64_t>(largestSoFar.size()) <= collapses) {
        return std::numeric_limits<double>::max();
    }
    const auto first = largestSoFar.begin() + collapses;  // the first one too many
    std::nth_element(largestSoFar.begin(), first, largestSoFar.end());
    return std::nextafter(*first, 0.0);
}

void simplifyPatches(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame,
                     const PatchWork& work, CollapseCosts* costs) {
    const PatchGroups groups(surface, cut, frame);
    if (costs != nullptr) costs->assign(groups.count(), {});
    std::vector<std::int64_t> quota = groups.shares(work.mostCollapses);
    parallelForPieces(
        static_cast<std::int64_t>(groups.count()), 1, [&](std::int64_t n, std::int64_t) {
            if (groups.isEmpty(n) || groups.isFinal(n)) return;
            Patch patch = groups.take(n);
            PatchSimplifier simplifier(patch, frame, work.limits);
            if (work.collapses) {
                simplifier.collapseEdges(quota[n], costs != nullptr ? &(*costs)[n] : nullptr);
            }
            if (work.fits) simplifier.fitVertices();
            groups.putBack(n, patch, surface);
        });
    removeGone(surface);
}

}  // namespace adaptiso::detail
