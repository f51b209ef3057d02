#pragma once

#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// The blocks that one isovalue touches, found by a look at every sample: those that an index of
/// the volume gives, in the same order, without the memory of one. For one isovalue of a volume.
/// \pre grid is of the volume's size
BlockQuery findBlocksAt(const VolumeView& volume, const BlockGrid& grid, double isovalue);

}  // namespace adaptiso
