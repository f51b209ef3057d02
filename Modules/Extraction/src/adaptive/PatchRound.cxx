#include "PatchRound.h"

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

void removeGone(SurfaceState& surface) {
    constexpr std::uint64_t kGone = SimplifiedSurface::kGone;
    std::vector<std::uint64_t> newTriangle(surface.triangles.size()),
        newVertex(surface.points.size(), kGone);
    std::uint64_t triangles = 0, vertices = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (surface.triangles[t][0] == kGone) continue;
        for (const std::uint64_t v : surface.triangles[t]) newVertex[v] = 0;
        newTriangle[t] = triangles;
        surface.triangles[triangles++] = surface.triangles[t];
    }
    surface.triangles.resize(triangles);
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
        if (newVertex[v] == kGone) continue;
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
    surface.triangles.shrink_to_fit();
    surface.points.shrink_to_fit();
    surface.states.shrink_to_fit();
    surface.quadrics.shrink_to_fit();
}

}  // namespace

void simplifyPatches(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame,
                     const PatchWork& work, CollapseCosts* costs) {
    const PatchGroups groups(surface, cut, frame);
    if (costs != nullptr) costs->assign(groups.count(), {});
    const std::vector<std::int64_t> quota = groups.shares(work.mostCollapses);
    parallelForPieces(
        static_cast<std::int64_t>(groups.count()), 1, [&](std::int64_t n, std::int64_t) {
            if (groups.isIdle(n)) return;
            Patch patch = groups.take(n);
            PatchSimplifier simplifier(patch, frame, work.limits);
            if (work.collapses) {
                simplifier.collapseEdges(quota[n], costs != nullptr ? &(*costs)[n] : nullptr);
            }
            if (work.fits) simplifier.fitVertices();
            groups.putBack(n, patch, surface);
        });
    if (work.collapses) removeGone(surface);
}

}  // namespace adaptiso::detail
