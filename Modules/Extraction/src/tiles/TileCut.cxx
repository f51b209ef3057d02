#include <algorithm>
#include <cmath>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Tiles.h"
#include "tiles/TileGrid.h"

namespace adaptiso {
namespace {

/// Walls of seam boxes keep off the lattice's planes, where vertices of full resolution lie.
constexpr double kOffLattice = 0.37;
/// Beyond all vertices.
constexpr double kOutside = 2;

}  // namespace

TileCut::TileCut(const Index3& imageSize, std::int64_t side) : imageSize_(imageSize), side_(side) {
    if (side < kStep || side > kLargestSide || side % kStep != 0) {
        throw InvalidInput("a tile's side is " + std::to_string(side) +
                           " cells, must be a multiple of 32 from 32 to 4096");
    }
    detail::tileGrid(imageSize);
}

/// The sample that a tile begins at.
std::int64_t TileCut::wall(std::int64_t tile) const {
    return tile * side_ - detail::kTileBlock;
}

Index3 TileCut::tiles() const {
    Index3 count;
    for (int a = 0; a < 3; ++a) count[a] = (imageSize_[a] - 1 + detail::kTileBlock) / side_ + 1;
    return count;
}

IndexBox TileCut::cellsOf(const Index3& tile) const {
    IndexBox cells;
    for (int a = 0; a < 3; ++a) {
        cells.first[a] = std::max<std::int64_t>(wall(tile[a]), -1);
        cells.end[a] = std::min(wall(tile[a] + 1), imageSize_[a]);
    }
    return cells;
}

IndexBox TileCut::samplesOf(const Index3& tile) const {
    IndexBox samples = cellsOf(tile);
    for (int a = 0; a < 3; ++a) {
        samples.first[a] = std::max<std::int64_t>(samples.first[a] - 1, 0);
        samples.end[a] = std::min(samples.end[a] + 2, imageSize_[a]);
    }
    return samples;
}

BoundingBox TileCut::boxOf(const Index3& tile) const {
    const IndexBox cells = cellsOf(tile);
    BoundingBox box;
    for (int a = 0; a < 3; ++a) {
        box.minimum[a] = static_cast<double>(cells.first[a]);
        box.maximum[a] = static_cast<double>(cells.end[a]);
    }
    return box;
}

Index3 TileCut::seams() const {
    Index3 count = tiles();
    for (std::int64_t& along : count) along = std::max<std::int64_t>(along - 1, 1);
    return count;
}

/// Where a seam box begins.
double TileCut::seamWall(std::int64_t seam, int axis) const {
    if (seam == 0) return -kOutside;
    if (seam == seams()[axis]) return static_cast<double>(imageSize_[axis]) + kOutside;
    return static_cast<double>(wall(seam) + side_ / 2) + kOffLattice;
}

BoundingBox TileCut::seamBox(const Index3& seam) const {
    BoundingBox box;
    for (int a = 0; a < 3; ++a) {
        box.minimum[a] = seamWall(seam[a], a);
        box.maximum[a] = seamWall(seam[a] + 1, a);
    }
    return box;
}

IndexBox TileCut::tilesOfSeam(const Index3& seam) const {
    const Index3 count = tiles();
    IndexBox of{seam, seam};
    for (int a = 0; a < 3; ++a) of.end[a] = std::min(seam[a] + 2, count[a]);
    return of;
}

Index3 TileCut::seamAt(const Vec3& index) const {
    const Index3 count = seams();
    Index3 seam{0, 0, 0};
    for (int a = 0; a < 3; ++a) {
        const double beyond = index[a] - static_cast<double>(wall(0) + side_ / 2) - kOffLattice;
        seam[a] = std::clamp<std::int64_t>(
            static_cast<std::int64_t>(std::floor(beyond / static_cast<double>(side_))), 0,
            count[a] - 1);
    }
    return seam;
}

}  // namespace adaptiso
