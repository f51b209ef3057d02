#pragma once

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/SpanSpace/BlockGrid.h"
#include "lattice/LatticeSampler.h"

namespace adaptiso::detail {

/// Cells of the blocks by which a tile finds its surface: the largest, as of a large volume all
/// are numbered.
inline constexpr int kTileBlock = 16;

/// The blocks of a whole volume with a closed border. Walls between tiles are walls between
/// blocks, and between bricks. \throws InvalidInput  there are too many
BlockGrid tileGrid(const Index3& imageSize);

/// The surface passes through a block of kTileBlock cells.
bool isCrossed(const LatticeSampler& sampler, const BlockGrid& grid, std::uint32_t block);

/// \throws InvalidInput  the window does not hold the tile's samples, or the cut is of another
/// volume
void requireTile(const VolumeView& window, const Index3& first, const ImageGeometry& geometry,
                 const TileCut& cut, const Index3& tile);

/// Where new vertices lie of what is simplified in a box of the lattice: in the metric frame, a
/// hair inside.
BoundingBox boxWithin(const BoundingBox& box, const ImageGeometry& geometry);

}  // namespace adaptiso::detail
