#pragma once

#include <cstdint>
#include <optional>

#include "adaptiso/Extraction/Extraction.h"
#include "adaptive/full/FullSurface.h"

namespace adaptiso::detail {

/// The adaptive method: error-bounded simplification of the marching cubes surface, brick by
/// brick. The blocks are the grid's that the isovalue touches; the
/// rest is as in extractSurface.
Extraction extractAdaptive(const VolumeView& volume, const BlockGrid& grid, BlockQuery query,
                           const ExtractionOptions& options);

struct AdaptiveResult {
    TriangleMesh mesh;
    double errorBoundMm = 0;
    std::optional<std::int64_t> wantedTriangles;  ///< where a count is asked for
    std::int64_t tableTriangles = 0;              ///< SimplifiedSurface's
    AdaptiveWork work;
};

/// Simplifies any surface, with all that the adaptive method promises proved.
/// \param mends  false: samples stay far within the bound, places beyond it go back to the full
///               surface, and there is one run. Mending takes long where some triangles are
///               thousands of times as long as others
/// \throws InternalError when that can't be
AdaptiveResult simplifyWithin(const FullSurface& full, const AdaptiveOptions& options,
                              const ProgressCallback& progress, bool mends = true);

}  // namespace adaptiso::detail
