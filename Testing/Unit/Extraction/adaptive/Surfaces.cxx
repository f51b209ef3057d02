#include "Surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "adaptiso/SurfaceProof/PieceBound.h"
#include "adaptive/rounds/BrickRound.h"

namespace adaptiso::testing {
namespace {

Volume volumeOf(const Index3& size, const std::function<double(const Vec3&)>& valueAt) {
    ImageGeometry geometry;
    geometry.size = size;
    std::vector<float> samples;
    for (std::int64_t i = 0; i < geometry.voxelCount(); ++i) {
        samples.push_back(static_cast<float>(
            valueAt({static_cast<double>(i % size[0]), static_cast<double>(i / size[0] % size[1]),
                     static_cast<double>(i / (size[0] * size[1]))})));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

/// \param triangles  those that are gone begin with a number that no point has
template <class Triangles>
TriangleMesh compacted(const std::vector<Vec3>& points, const Triangles& triangles) {
    TriangleMesh mesh;
    std::vector<VertexId> number(points.size(), -1);
    for (const auto& t : triangles) {
        if (t[0] >= points.size()) continue;
        for (const auto v : t) {
            if (number[v] >= 0) continue;
            number[v] = std::ssize(mesh.points);
            mesh.points.push_back(points[v]);
        }
        mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    }
    return mesh;
}

}  // namespace

detail::MetricFrame unitFrame() {
    return detail::MetricFrame(ImageGeometry{});
}

detail::Patch patchOf(const TriangleMesh& mesh, std::size_t obstacles) {
    detail::Patch patch;
    patch.points = mesh.points;
    patch.quadrics.resize(mesh.points.size());
    patch.states.assign(mesh.points.size(), detail::Patch::State::Open);
    for (const auto& t : mesh.triangles) {
        const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        auto& corners = patch.triangles.emplace_back();
        for (int i = 0; i < 3; ++i) {
            corners[i] = static_cast<std::uint32_t>(t[i]);
            patch.quadrics[corners[i]] += detail::Quadric::ofTriangle(areaVector2(a, b, c), a);
        }
    }
    patch.ownTriangles = static_cast<std::uint32_t>(mesh.triangles.size() - obstacles);
    constexpr double kFar = 1e6;
    patch.lowIndex = {-kFar, -kFar, -kFar};
    patch.highIndex = {kFar, kFar, kFar};
    return patch;
}

void addSamples(detail::Patch& patch) {
    std::vector<std::uint32_t> triangleAt(patch.points.size());
    for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) {
        for (const std::uint32_t v : patch.triangles[t]) triangleAt[v] = t;
    }
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
        detail::Sample& sample = patch.samples.emplace_back();
        sample.setPoint(patch.points[v]);
        sample.setNormal({0, 0, 1});
        patch.sampleTriangle.push_back(triangleAt[v]);
    }
}

TriangleMesh meshOf(const detail::Patch& patch) {
    return compacted(patch.points, patch.triangles);
}

TriangleMesh meshOf(const detail::SurfaceState& surface) {
    return compacted(surface.points, surface.triangles);
}

detail::SimplifiedSurface surfaceOf(const TriangleMesh& mesh) {
    detail::Patch patch = patchOf(mesh);
    addSamples(patch);
    detail::SimplifiedSurface surface;
    surface.points = patch.points;
    surface.states = patch.states;
    surface.samples = patch.samples;
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
        surface.quadrics.push_back(detail::StoredQuadric::of(patch.quadrics[v], patch.points[v]));
        surface.sampleTriangle.push_back(patch.sampleTriangle[v]);
    }
    for (const auto& [a, b, c] : patch.triangles) surface.triangles.push_back({a, b, c});
    surface.fineTriangles = surface.tableTriangles = surface.triangleCount();
    return surface;
}

Scene::Scene(const Index3& size, const std::function<double(const Vec3&)>& valueAt, Border border)
    : Scene(volumeOf(size, valueAt), 0, border) {}

Scene::Scene(Volume samples, double isovalue, Border border, int blockSize)
    : volume(std::move(samples)),
      index(SpanSpaceIndex::build(volume.view(), {blockSize, border})),
      sampler(detail::LatticeSampler::make(volume.view(), isovalue, border)),
      bricks(index.grid(), index.blocksAt(isovalue).blocks),
      frame(volume.view().geometry()) {}

detail::SimplifiedSurface Scene::fullSurface() const {
    // a collapse costs more than nothing: none is made
    return detail::simplifyBricks(*sampler, bricks, frame, {}, nullptr);
}

Scene ballScene() {
    return Scene({38, 38, 38}, [](const Vec3& p) { return kBallRadius - norm(p - kBallMiddle); });
}

detail::SurfaceChanges moveVertex(detail::SimplifiedSurface& surface, std::uint32_t vertex,
                                  const Vec3& place) {
    detail::SurfaceChanges changes;
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& c = surface.triangles[t];
        if (std::find(c.begin(), c.end(), vertex) == c.end()) continue;
        changes.triangles.push_back(t);
        changes.before.push_back(
            {surface.points[c[0]], surface.points[c[1]], surface.points[c[2]]});
    }
    surface.points[vertex] = place;
    return changes;
}

double distanceTo(const TriangleMesh& mesh, const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : mesh.triangles) {
        least = std::min(least, detail::squaredDistanceToTriangle(
                                    p, {mesh.points[a], mesh.points[b], mesh.points[c]}));
    }
    return std::sqrt(least);
}

}  // namespace adaptiso::testing
