#pragma once

#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso::detail {

/// The thesis's method: simple cubic boxes, iso-line loops where resolutions meet, merged facets
/// of discretized marching cubes elsewhere. Discretized marching cubes [Montani1994] is the same
/// with unit boxes, which are never shared. Arguments as in extractSurface.
Extraction extractBoxes(const VolumeView& volume, const SpanSpaceIndex& index,
                        const ExtractionOptions& options);

}  // namespace adaptiso::detail
