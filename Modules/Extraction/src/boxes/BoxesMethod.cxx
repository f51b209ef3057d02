#include "boxes/BoxesMethod.h"

#include "boxes/AscSurface.h"
#include "boxes/BoxSurface.h"
#include "filling/FillLoops.h"
#include "loops/SurfaceLoops.h"

namespace adaptiso::detail {
namespace {

template <int N, class Id>
Extraction extract(const VolumeView& volume, ActiveBlocks active,
                   const ExtractionOptions& options) {
    const BlockGrid grid = active.grid();
    const auto report = [&](double fraction) {
        if (options.progress) options.progress("extract", fraction);
    };
    const bool isDmc = options.method == Method::DiscretizedMarchingCubes;
    const auto sampler = LatticeSampler::make(volume, options.isovalue, grid.border);
    Extraction result;
    report(0);
    SurfaceLoops<Id> loops;
    if (options.method == Method::SkeletonClimbing) {
        loops = makeAscLoops<N, Id>(*sampler, active, result.statistics);
    } else {
        BoxSurface<N, Id> surface = makeBoxSurface<N, Id>(
            *sampler, std::move(active), isDmc ? Division::Unit : Division::Simple,
            options.discretized.mergeWithinBlocks ? MergeReach::Block : MergeReach::Surface);
        result.statistics.boxes = surface.boxCounts;
        result.statistics.boxesChangingTopology = surface.boxesChangingTopology;
        result.statistics.marchingCubesTriangles = surface.marchingCubesTriangles;
        report(0.5);
        loops = makeSurfaceLoops<N, Id>(std::move(surface));
    }
    report(0.7);
    const VertexPlacement placement = isDmc && !options.discretized.adjustVertices
                                          ? VertexPlacement::Midpoint
                                          : VertexPlacement::Crossing;
    result.mesh = fillLoops(std::move(loops), *sampler, volume.geometry(), grid.offset, placement,
                            result.statistics.edgesSplit);
    report(1);
    return result;
}

template <int N>
Extraction extractWithBlocks(const VolumeView& volume, ActiveBlocks active,
                             const ExtractionOptions& options) {
    // at most every lattice edge of the active blocks is a vertex, with few corners of loops at
    // each
    constexpr std::int64_t kMaximumCornersAtVertex = 16;
    const std::int64_t vertices = std::int64_t{3} * N * N * N * active.count();
    if (vertices * kMaximumCornersAtVertex <= std::int64_t{0xFFFFFFFF}) {
        return extract<N, std::uint32_t>(volume, std::move(active), options);
    }
    return extract<N, std::uint64_t>(volume, std::move(active), options);
}

}  // namespace

Extraction extractBoxes(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                        const ExtractionOptions& options) {
    ActiveBlocks active(grid, std::move(query.blocks));
    const std::int64_t activeCount = active.count();
    Extraction result;
    switch (grid.blockSize) {
        case 2:
            result = extractWithBlocks<2>(volume, std::move(active), options);
            break;
        case 4:
            result = extractWithBlocks<4>(volume, std::move(active), options);
            break;
        case 8:
            result = extractWithBlocks<8>(volume, std::move(active), options);
            break;
        default:
            result = extractWithBlocks<16>(volume, std::move(active), options);
            break;
    }
    result.statistics.blocksTotal = grid.blockCount();
    result.statistics.blocksActive = activeCount;
    result.statistics.indexNodesVisited = query.nodesVisited;
    return result;
}

}  // namespace adaptiso::detail
