#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "MetricFrame.h"
#include "Patch.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso::detail {

/// Places where the allowed distance was not small enough to keep all points between the samples
/// within the bound: its square is halved around them, and more and more often when they are added
/// again.
class TightPlaces {
public:
    /// \param places  continuous sample indices
    void add(const std::vector<Vec3>& places);

    /// How often the square is halved.
    std::uint8_t tightnessAt(const Vec3& place) const;
    void apply(const MetricFrame& frame, std::vector<Sample>& samples) const;

private:
    static constexpr double kCube = 1.5;  ///< voxels
    static Index3 cubeAt(const Vec3& place);

    std::map<Index3, std::size_t> tightness_;  ///< of cubes of the lattice: how often added
};

}  // namespace adaptiso::detail
