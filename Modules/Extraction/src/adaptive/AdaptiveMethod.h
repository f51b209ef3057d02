#pragma once

#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::detail {

/// The adaptive method: error-bounded simplification of the marching cubes surface, brick by
/// brick. Arguments as in extractSurface.
Extraction extractAdaptive(const VolumeView& volume, const SpanSpaceIndex& index,
                           const ExtractionOptions& options);

}  // namespace adaptiso::detail
