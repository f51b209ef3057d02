#pragma once

#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// A solid on an isotropic grid: for every voxel the part of it that lies inside, 0 to 1. The
/// solid's surface is where the samples interpolate to kFractionIsovalue, so that a voxel that is
/// inside by half holds the surface at its centre.
struct FractionField {
    ImageGeometry grid;  ///< voxels are cubes, axes at right angles, LPS mm
    std::vector<float> part;

    VolumeView view() const { return {part.data(), grid}; }
};

inline constexpr double kFractionIsovalue = 0.5;

}  // namespace adaptiso
