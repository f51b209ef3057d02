#pragma once

#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso::detail {

/// Cells of the blocks by which a tile finds its surface: the largest, as of a large volume all
/// are numbered.
inline constexpr int kTileBlock = 16;

/// The blocks of a whole volume with a closed border. Walls between tiles are walls between
/// blocks, and between bricks. \throws InvalidInput  there are too many
BlockGrid tileGrid(const Index3& imageSize);

}  // namespace adaptiso::detail
