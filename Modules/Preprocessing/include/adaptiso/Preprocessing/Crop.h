#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// Voxel indices first, first + 1, ... up to but not including `end`.
struct IndexRange {
    std::int64_t first = 0;
    std::optional<std::int64_t> end;  ///< none: the end of the axis

    friend bool operator==(const IndexRange&, const IndexRange&) = default;
};

/// What to keep along i, j and k.
using CropRanges = std::array<IndexRange, 3>;

/// The part of a volume within ranges of voxel indices. Every voxel keeps its place in space: the
/// origin moves to the first voxel kept, along the image's own axes, oblique or sheared.
///
/// \return  samples of the same type (itk::RegionOfInterestImageFilter)
/// \throws  InvalidInput unless 0 <= first, end <= size, and 2 voxels or more are left along every
///          axis (fewer are no volume)
/// Cost: a copy of what is kept.
Volume cropVolume(const VolumeView& volume, const CropRanges& ranges);

}  // namespace adaptiso
