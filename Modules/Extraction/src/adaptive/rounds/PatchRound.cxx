#include "adaptive/rounds/PatchRound.h"

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/PerThread.h"

namespace adaptiso::detail {

void runPatchRound(SimplifiedSurface& surface, const PatchCut& cut, const MetricFrame& frame,
                   const PatchWork& work, CollapseCosts* costs) {
    std::vector<SurfaceState::Number> mergedInto;
    if (work.collapses && !surface.heirs.empty()) mergedInto.resize(surface.points.size());
    {
        const PatchGroups groups(surface, cut, frame);
        if (costs != nullptr) costs->assign(groups.count(), {});
        const std::vector<std::int64_t> quota = groups.shares(work.mostCollapses);
        // a patch that is the only one works with the surface's own samples: a copy of them would
        // be the largest list of all
        const auto swapSamples = [&](Patch& patch) {
            if (groups.isOne()) patch.samples.swap(surface.samples);
        };
        PerThread<PatchScratch> scratches;
        parallelForPieces(std::ssize(quota), 1, [&](std::int64_t n, std::int64_t) {
            if (groups.isIdle(n)) return;
            Patch patch = groups.take(n, scratches.local());
            swapSamples(patch);
            PatchSimplifier simplifier(patch, frame, work.limits);
            if (work.collapses) {
                simplifier.collapseEdges(quota[n], costs == nullptr ? nullptr : &(*costs)[n]);
            }
            if (work.fits) simplifier.fitVertices();
            swapSamples(patch);
            groups.putBack(n, patch, surface, mergedInto);
        });
    }
    if (work.collapses) removeGone(surface, mergedInto);
}

}  // namespace adaptiso::detail
