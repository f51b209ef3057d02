#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::detail {

/// The labels of a map with a layer of 0 around them: lattice point (i, j, k) is voxel
/// (i - 1, j - 1, k - 1). Cells are named by their lowest lattice point.
struct LabelGrid {
    Index3 size{0, 0, 0};  ///< lattice points
    std::vector<Label> labels;

    std::int64_t placeOf(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return i + size[0] * (j + size[1] * k);
    }
    Index3 indexOf(std::int64_t place) const {
        return {place % size[0], place / size[0] % size[1], place / (size[0] * size[1])};
    }
    /// How far a cell's corner c is behind its first.
    std::int64_t step(int c) const {
        return (c & 1) + size[0] * ((c >> 1 & 1) + size[1] * (c >> 2));
    }
    std::array<Label, 8> cornersOf(std::int64_t place) const {
        std::array<Label, 8> corners;
        for (int c = 0; c < 8; ++c) corners[c] = labels[place + step(c)];
        return corners;
    }
};

/// \pre  samples are whole numbers that Label holds \throws InvalidInput otherwise
LabelGrid makeGrid(const VolumeView& volume);

}  // namespace adaptiso::detail
