#pragma once

#include <cstddef>
#include <optional>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// The different values of a volume that looks like a label map.
struct LabelValues {
    std::size_t count = 0;
    double first = 0;  ///< the smallest but one: the lowest is the background
};

/// Labels are 3 to 1,000 whole numbers that fill regions: 2 voxels or more in a row hold the same
/// one, but for the commonest, and neighbours differ by an eighth of the numbers or more, in their
/// order. Two numbers are a mask, multiples of 5 or more the intensities of a phantom. Atlases have
/// 3 to 20 voxels in a row and .25 to .5; T1 scans, however few their grey values, less than 2
/// voxels or, where they are smooth, less than .1.
/// Cost: one pass; a scan is known by its first layers with tissue.
std::optional<LabelValues> findLabelValues(const VolumeView& volume);

}  // namespace adaptiso
