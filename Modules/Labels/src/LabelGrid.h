#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::detail {

/// The labels of a map, or of the part of it round chosen labels, with a layer of 0 around them:
/// lattice point (i, j, k) is voxel first + (i - 1, j - 1, k - 1). Cells are named by their lowest
/// lattice point.
struct LabelGrid {
    Index3 size{0, 0, 0};  ///< lattice points
    std::vector<Label> labels;
    Index3 first{0, 0, 0};
    std::vector<Label> chosen{};  ///< whose walls are wanted, ascending; empty: all

    std::int64_t placeOf(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return i + size[0] * (j + size[1] * k);
    }
    Index3 indexOf(std::int64_t place) const {
        return {place % size[0], place / size[0] % size[1], place / (size[0] * size[1])};
    }
    /// Offset of a cell's corner c from its first.
    std::int64_t step(int c) const {
        return (c & 1) + size[0] * ((c >> 1 & 1) + size[1] * (c >> 2));
    }
    std::array<Label, 8> cornersOf(std::int64_t place) const {
        std::array<Label, 8> corners;
        for (int c = 0; c < 8; ++c) corners[c] = labels[place + step(c)];
        return corners;
    }
    bool isWanted(Label label) const;
    /// The geometry of the grid's voxels, of that of the whole map.
    ImageGeometry partOf(const ImageGeometry& whole) const;
};

/// \param chosen  whose walls are wanted, each label once; empty: all
/// \pre  samples are whole numbers that Label holds; chosen labels are there, and not 0
///       \throws InvalidInput otherwise
LabelGrid makeGrid(const VolumeView& volume, std::vector<Label> chosen = {});

}  // namespace adaptiso::detail
