#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "MetricFrame.h"
#include "Patch.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"

namespace adaptiso::detail {

/// Places where a run did not keep what is promised, which the next one is to do better.
///
/// Where the allowed distance was not small enough to keep all points between the samples within
/// the bound, its square is halved, and more and more often when a place is added again. Where
/// triangles crossed, every star is proved.
class TightPlaces {
public:
    /// \param places  continuous sample indices
    void add(const std::vector<Vec3>& places);
    /// \param places  of triangles that crossed, continuous sample indices
    void addCrossings(const std::vector<Vec3>& places);

    /// The sample lies at a place added by add().
    bool has(const MetricFrame& frame, const Sample& sample) const;

    void apply(const MetricFrame& frame, Sample& sample) const;
    void apply(const MetricFrame& frame, std::vector<Sample>& samples) const;

private:
    static constexpr double kCube = 1.5;  ///< voxels
    static Index3 cubeAt(const Vec3& place);
    static std::set<Index3> cubesAround(const std::vector<Vec3>& places);
    std::uint8_t tightnessAt(const Index3& cube) const;

    std::map<Index3, std::size_t> tightness_;  ///< of cubes of the lattice: how often added
    std::set<Index3> crossings_;
};

}  // namespace adaptiso::detail
