#include "adaptive/rounds/PatchRound.h"

#include <algorithm>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

using Number = SurfaceState::Number;

/// \param newVertex  of each vertex, kGone for those that are gone
/// \param mergedInto of each vertex, what it was merged into in this round
void passOn(const std::vector<Number>& newVertex, const std::vector<Number>& mergedInto,
            std::vector<Number>& heirs) {
    for (Number& heir : heirs) {
        while (newVertex[heir] == SimplifiedSurface::kGone) heir = mergedInto[heir];
        heir = newVertex[heir];
    }
}

/// \param mergedInto  of each vertex, in this round; empty where the surface keeps no heirs
void removeGone(SimplifiedSurface& surface, const std::vector<Number>& mergedInto) {
    constexpr Number kGone = SimplifiedSurface::kGone;
    std::vector<Number> newTriangle, newVertex;
    assignInHugePages(newTriangle, surface.triangles.size());
    assignInHugePages(newVertex, surface.points.size(), kGone);
    Number triangles = 0, vertices = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (surface.triangles[t][0] == kGone) continue;
        for (const Number v : surface.triangles[t]) newVertex[v] = 0;
        newTriangle[t] = triangles;
        surface.triangles[triangles++] = surface.triangles[t];
    }
    for (Number& v : newVertex) {
        if (v != kGone) v = vertices++;
    }
    const auto keep = [&](auto& members) {
        for (std::size_t v = 0; v < newVertex.size(); ++v) {
            if (newVertex[v] != kGone) members[newVertex[v]] = members[v];
        }
        members.resize(vertices);
        shrinkInHugePages(members);
    };
    parallelInvoke(
        [&] {
            surface.triangles.resize(triangles);
            shrinkInHugePages(surface.triangles);
            for (auto& t : surface.triangles) {
                for (Number& v : t) v = newVertex[v];
            }
        },
        [&] { keep(surface.quadrics); }, [&] { keep(surface.points); },
        [&] { keep(surface.states); },
        [&] {
            if (!surface.marks.empty()) keep(surface.marks);
        },
        [&] {
            for (Number& t : surface.sampleTriangle) t = newTriangle[t];
        },
        [&] { passOn(newVertex, mergedInto, surface.heirs); });
}

}  // namespace

PatchRound::PatchRound(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame)
    : surface_(surface), frame_(frame) {
    groups_.emplace(surface, cut, frame);
}

/// A patch that is the only one works with the surface's own samples: a copy of them would be the
/// largest list of all. Called again it gives them back.
void PatchRound::lendSamples(Patch& patch) const {
    if (groups_->isOne()) patch.samples.swap(surface_.samples);
}

void PatchRound::run(const PatchWork& work, CollapseCosts* costs) {
    if (costs != nullptr) costs->assign(groups_->count(), {});
    const std::vector<std::int64_t> quota = groups_->shares(work.mostCollapses);
    std::vector<Number> mergedInto;
    if (work.collapses && !surface_.heirs.empty()) mergedInto.resize(surface_.points.size());
    PerThread<PatchScratch> scratches;
    parallelForPieces(
        static_cast<std::int64_t>(groups_->count()), 1, [&](std::int64_t n, std::int64_t) {
            if (groups_->isIdle(n)) return;
            PatchScratch& scratch = scratches.local();
            Patch patch = groups_->take(n, scratch);
            lendSamples(patch);
            PatchSimplifier simplifier(patch, frame_, work.limits);
            if (work.collapses) {
                simplifier.collapseEdges(quota[n], costs == nullptr ? nullptr : &(*costs)[n]);
            }
            if (work.fits) simplifier.fitVertices();
            lendSamples(patch);
            groups_->putBack(n, patch, scratch, surface_);
            if (!mergedInto.empty()) groups_->noteMerges(n, patch, mergedInto);
        });
    scratches.clear();
    groups_.reset();
    if (work.collapses) removeGone(surface_, mergedInto);
}

}  // namespace adaptiso::detail
