#pragma once

#include <cstdint>
#include <optional>

#include "adaptiso/Extraction/Extraction.h"
#include "adaptive/full/FullSurface.h"

namespace adaptiso::detail {

/// The adaptive method: error-bounded simplification of the marching cubes surface, brick by
/// brick. Arguments as in extractSurface.
Extraction extractAdaptive(const VolumeView& volume, const SpanSpaceIndex& index,
                           const ExtractionOptions& options);

/// \param function  named in the message \throws InvalidInput when an option is out of range
void requireInRange(const AdaptiveOptions& options, const char* function);

struct AdaptiveResult {
    TriangleMesh mesh;
    double errorBoundMm = 0;
    std::optional<std::int64_t> wantedTriangles;  ///< where a count is asked for
    std::int64_t tableTriangles = 0;              ///< SimplifiedSurface's
    AdaptiveWork work;
};

/// Simplifies any surface, with all that the adaptive method promises proved.
/// \throws InternalError when that can't be
AdaptiveResult simplifyWithin(const FullSurface& full, const AdaptiveOptions& options,
                              const ProgressCallback& progress);

}  // namespace adaptiso::detail
