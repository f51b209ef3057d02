#include "adaptive/rounds/PatchGroups.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

/// Cubes in the bounding box at most.
constexpr double kMostCubes = 1 << 20;

using Numbers = std::vector<std::uint32_t>;

/// The numbers 0 .. n by a key; those whose key is too large are left out.
template <class KeyOf>
auto grouped(std::size_t groups, std::size_t n, const KeyOf& keyOf) {
    return Buckets<std::uint32_t, std::uint32_t>(groups, [&](const auto& give) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint64_t key = keyOf(i);
            if (key < groups) give(key, i);
        }
    });
}

/// The place of each of `n` numbers in its group.
Numbers placesIn(const Buckets<std::uint32_t, std::uint32_t>& groups, std::size_t n) {
    Numbers places;
    assignInHugePages(places, n);
    for (std::size_t g = 0; g < groups.count(); ++g) {
        std::uint32_t place = 0;
        for (const std::uint32_t member : groups.of(g)) places[member] = place++;
    }
    return places;
}

}  // namespace

PatchCubes::PatchCubes(const SurfaceState& surface, const PatchCut& cut, const MetricFrame& frame)
    : cut_(cut) {
    if (surface.points.empty()) return;
    BoundingBox box = BoundingBox::empty();
    for (const Vec3& p : surface.points) box.add(frame.toIndex(p));
    for (;;) {
        low_ = cubeAt(box.minimum);
        const Index3 last = cubeAt(box.maximum);
        double cubes = 1;
        for (int a = 0; a < 3; ++a) {
            count_[a] = last[a] - low_[a] + 1;
            cubes *= static_cast<double>(count_[a]);
        }
        if (cubes <= kMostCubes) break;
        cut_.side *= 2;
        for (std::int64_t& along : cut_.shift) along *= 2;
    }
}

Index3 PatchCubes::cubeAt(const Vec3& index) const {
    Index3 cube;
    for (int a = 0; a < 3; ++a) {
        cube[a] = static_cast<std::int64_t>(std::floor(
            (index[a] - static_cast<double>(cut_.shift[a])) / static_cast<double>(cut_.side)));
    }
    return cube;
}

void PatchCubes::setBounds(std::size_t number, Patch& patch) const {
    const auto n = static_cast<std::int64_t>(number);
    Index3 low{n % count_[0] + low_[0], n / count_[0] % count_[1] + low_[1],
               n / (count_[0] * count_[1]) + low_[2]};
    for (int a = 0; a < 3; ++a) low[a] = low[a] * cut_.side + cut_.shift[a];
    patch.setBox(low, cut_.side);
}

PatchGroups::PatchGroups(const SimplifiedSurface& surface, const PatchCut& cut,
                         const MetricFrame& frame)
    : surface_(surface),
      frame_(frame),
      cubes_(surface, cut, frame),
      hasSettled_(!isOne() && manyAreFinal()),
      cubeOfVertex_(cubesOfVertices()),
      cubeOfTriangle_(cubesOfTriangles()),
      obstacles_(cubes_.count()) {
    if (hasSettled_) leaveOutSettled();
    parallelInvoke([&] { groupVertices(); }, [&] { groupTriangles(); },
                   [&] {
                       if (isOne()) return;  // it has them all
                       samples_ = grouped(count(), surface.samples.size(), [&](std::size_t s) {
                           return cubeOfTriangle_[surface.sampleTriangle[s]];
                       });
                   });
}

Numbers PatchGroups::cubesOfVertices() const {
    Numbers cubes;
    assignInHugePages(cubes, surface_.points.size());
    parallelForPieces(static_cast<std::int64_t>(cubes.size()), kPiece,
                      [&](std::int64_t begin, std::int64_t end) {
                          for (std::int64_t v = begin; v < end; ++v) {
                              cubes[v] = cubes_.numberAt(frame_.toIndex(surface_.points[v]));
                          }
                      });
    return cubes;
}

Numbers PatchGroups::cubesOfTriangles() const {
    Numbers cubes;
    assignInHugePages(cubes, surface_.triangles.size());
    parallelForPieces(
        static_cast<std::int64_t>(cubes.size()), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t t = begin; t < end; ++t) {
                const auto& c = surface_.triangles[t];
                const std::uint32_t cube = cubeOfVertex_[c[0]];
                const bool isWithin = cubeOfVertex_[c[1]] == cube && cubeOfVertex_[c[2]] == cube;
                cubes[t] = isWithin && !(hasSettled_ && isSettled(t)) ? cube : kNone;
            }
        });
    return cubes;
}

bool PatchGroups::manyAreFinal() const {
    const auto count =
        std::count(surface_.states.begin(), surface_.states.end(), Patch::State::Final);
    return static_cast<double>(count) > kFewFinal * static_cast<double>(surface_.states.size());
}

bool PatchGroups::isSettled(std::size_t triangle) const {
    const auto& corners = surface_.triangles[triangle];
    return std::all_of(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return surface_.states[v] == Patch::State::Final; });
}

/// Vertices of settled triangles alone belong to no cube.
void PatchGroups::leaveOutSettled() {
    std::vector<std::uint8_t> isNeeded(surface_.states.size(), 0);
    reach_.assign(count(), BoundingBox::empty());
    for (std::size_t t = 0; t < cubeOfTriangle_.size(); ++t) {
        if (isSettled(t)) continue;
        const SurfaceState::Triangle& corners = surface_.triangles[t];
        for (const std::uint32_t v : corners) isNeeded[v] = 1;
        if (cubeOfTriangle_[t] != kNone) reach_[cubeOfTriangle_[t]].add(indexBoxOf(corners));
    }
    for (BoundingBox& reach : reach_) reach.widen(kBeyondOwn);
    for (std::size_t v = 0; v < isNeeded.size(); ++v) {
        if (isNeeded[v] == 0) cubeOfVertex_[v] = kNone;
    }
}

BoundingBox PatchGroups::indexBoxOf(const SurfaceState::Triangle& triangle) const {
    const auto at = [&](int c) { return frame_.toIndex(surface_.points[triangle[c]]); };
    return boxOf({at(0), at(1), at(2)});
}

void PatchGroups::groupVertices() {
    vertices_ =
        grouped(count(), surface_.points.size(), [&](std::size_t v) { return cubeOfVertex_[v]; });
    placeOfVertex_ = placesIn(vertices_, surface_.points.size());
}

void PatchGroups::groupTriangles() {
    triangles_ = grouped(count(), surface_.triangles.size(),
                         [&](std::size_t t) { return cubeOfTriangle_[t]; });
    placeOfTriangle_ = placesIn(triangles_, surface_.triangles.size());
    if (isOne()) return;
    listObstacles();
    strayedSamples_ =
        grouped(obstacleTriangles_.size(), surface_.samples.size(), [&](std::size_t s) {
            const std::uint32_t t = surface_.sampleTriangle[s];
            return cubeOfTriangle_[t] == kNone ? placeOfTriangle_[t] : kNone;
        });
}

/// Triangles that straddle cubes, and settled ones, are obstacles in all the cubes that they may
/// reach into.
void PatchGroups::listObstacles() {
    for (std::uint32_t t = 0; t < cubeOfTriangle_.size(); ++t) {
        if (cubeOfTriangle_[t] != kNone) continue;
        const BoundingBox box = indexBoxOf(surface_.triangles[t]);
        const auto place = static_cast<std::uint32_t>(obstacleTriangles_.size());
        placeOfTriangle_[t] = kNone;
        cubes_.forEachIn(box, [&](std::uint32_t cube) {
            if (hasSettled_ && !reach_[cube].overlaps(box)) return;
            obstacles_[cube].push_back(place);
            placeOfTriangle_[t] = place;
        });
        if (placeOfTriangle_[t] == place) obstacleTriangles_.push_back(t);
    }
}

bool PatchGroups::isIdle(std::size_t n) const {
    const auto members = vertices_.of(n);
    return triangles_.of(n).empty() ||
           std::all_of(members.begin(), members.end(),
                       [&](std::uint32_t v) { return surface_.states[v] == Patch::State::Final; });
}

std::vector<std::int64_t> PatchGroups::shares(std::int64_t total) const {
    std::vector<std::int64_t> share(count(), total);
    const auto all = static_cast<double>(triangles_.itemCount());
    if (static_cast<double>(total) > all) return share;
    std::int64_t dealt = 0;
    for (std::size_t n = 0; n < count(); ++n) {
        const double upToHere = static_cast<double>(triangles_.of(0, n + 1).size()) / all;
        const auto due =
            static_cast<std::int64_t>(std::floor(upToHere * static_cast<double>(total) + 0.5));
        share[n] = due - dealt;
        dealt = due;
    }
    return share;
}

Patch PatchGroups::take(std::size_t n, PatchScratch& scratch) const {
    Patch patch;
    cubes_.setBounds(n, patch);
    if (hasSettled_) {
        for (int a = 0; a < 3; ++a) {
            patch.lowIndex[a] = std::max(patch.lowIndex[a], reach_[n].minimum[a]);
            patch.highIndex[a] = std::min(patch.highIndex[a], reach_[n].maximum[a]);
        }
    }
    const auto members = vertices_.of(n);
    patch.points.reserve(members.size());
    patch.quadrics.reserve(members.size());
    patch.states.reserve(members.size());
    for (const std::uint32_t v : members) {
        patch.points.push_back(surface_.points[v]);
        patch.quadrics.push_back(surface_.quadrics[v].about(surface_.points[v]));
        patch.states.push_back(surface_.states[v]);
        if (!surface_.marks.empty()) patch.marks.push_back(surface_.marks[v]);
    }
    if (!surface_.heirs.empty()) {
        patch.heirs.resize(members.size());
        std::iota(patch.heirs.begin(), patch.heirs.end(), 0U);
    }
    const auto own = triangles_.of(n);
    patch.triangles.reserve(own.size() + obstacles_[n].size());
    for (const std::uint32_t t : own) {
        const SurfaceState::Triangle& c = surface_.triangles[t];
        patch.triangles.push_back(
            {placeOfVertex_[c[0]], placeOfVertex_[c[1]], placeOfVertex_[c[2]]});
    }
    patch.ownTriangles = static_cast<std::uint32_t>(own.size());
    if (isOne()) {
        patch.sampleTriangle = surface_.sampleTriangle;  // triangles have their own numbers
    } else {
        addSamples(n, patch);
        addObstacles(n, patch, scratch);
    }
    return patch;
}

void PatchGroups::addSamples(std::size_t n, Patch& patch) const {
    const auto members = samples_.of(n);
    patch.samples.reserve(members.size());
    patch.sampleTriangle.reserve(members.size());
    for (const std::uint32_t s : members) {
        patch.samples.push_back(surface_.samples[s]);
        patch.sampleTriangle.push_back(placeOfTriangle_[surface_.sampleTriangle[s]]);
    }
}

/// Adds the triangles that straddle the cube's walls, with their vertices and samples.
void PatchGroups::addObstacles(std::size_t n, Patch& patch, PatchScratch& scratch) const {
    scratch.outsideNumber.resize(surface_.points.size());
    const auto localVertex = [&](std::uint32_t v) {
        if (cubeOfVertex_[v] == n) return placeOfVertex_[v];
        std::uint32_t& number = scratch.outsideNumber[v];
        if (number == 0) {
            patch.points.push_back(surface_.points[v]);
            patch.quadrics.emplace_back();
            patch.states.push_back(Patch::State::Open);
            if (!surface_.marks.empty()) patch.marks.push_back(Patch::kPlain);
            scratch.outsideVertices.push_back(v);
            number = static_cast<std::uint32_t>(patch.points.size());
        }
        return number - 1;
    };
    for (const std::uint32_t obstacle : obstacles_[n]) {
        for (const std::uint32_t s : strayedSamples_.of(obstacle)) {
            patch.samples.push_back(surface_.samples[s]);
            patch.sampleTriangle.push_back(static_cast<std::uint32_t>(patch.triangles.size()));
        }
        const SurfaceState::Triangle& c = surface_.triangles[obstacleTriangles_[obstacle]];
        patch.triangles.push_back({localVertex(c[0]), localVertex(c[1]), localVertex(c[2])});
    }
    for (const std::uint32_t v : scratch.outsideVertices) scratch.outsideNumber[v] = 0;
    scratch.outsideVertices.clear();
}

void PatchGroups::putBack(std::size_t n, const Patch& patch, SimplifiedSurface& surface,
                          Numbers& mergedInto) const {
    const auto members = vertices_.of(n);
    for (std::size_t v = 0; v < members.size(); ++v) {
        if (!mergedInto.empty()) mergedInto[members[v]] = members[patch.heirs[v]];
        surface.states[members[v]] = patch.states[v];
        if (!patch.marks.empty()) surface.marks[members[v]] = patch.marks[v];
        // those that other patches look at have not changed, and must not be written
        if (surface.points[members[v]] == patch.points[v]) continue;
        surface.points[members[v]] = patch.points[v];
        surface.quadrics[members[v]] = StoredQuadric::of(patch.quadrics[v], patch.points[v]);
    }
    const auto own = triangles_.of(n);
    if (isOne()) surface.sampleTriangle = patch.sampleTriangle;
    const auto samples = samples_.of(n);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        surface.sampleTriangle[samples[i]] = own[patch.sampleTriangle[i]];
    }
    for (std::size_t t = 0; t < own.size(); ++t) {
        for (int c = 0; c < 3; ++c) {
            const std::uint32_t v = patch.triangles[t][c];
            surface.triangles[own[t]][c] =
                v == Patch::kGone ? SimplifiedSurface::kGone : members[v];
        }
    }
}

}  // namespace adaptiso::detail
