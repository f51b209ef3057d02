#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptive/mesh/MetricFrame.h"
#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {

/// Places where a run did not keep what is promised, which the next one is to do better.
///
/// Where the allowed distance was not small enough to keep all points between the samples within
/// the bound, its square is halved, and more and more often when a place is added again. Where
/// triangles crossed, every star is proved. What neither mends stays at full resolution.
class LocalTolerances {
public:
    /// \param places  continuous sample indices
    void add(const std::vector<Vec3>& places);
    /// \param places  of triangles that crossed, continuous sample indices
    void addCrossings(const std::vector<Vec3>& places);

    /// The surface around the places stays as it is at full resolution.
    /// \param level  how far around: 1.5 voxels at level 0, twice as far at each next one
    void freeze(const std::vector<Vec3>& places, int level);
    /// \param index  continuous sample index
    bool isFrozen(const Vec3& index) const;

    /// A sample's tolerance never grows.
    void apply(const MetricFrame& frame, Sample& sample) const;
    void apply(const MetricFrame& frame, std::vector<Sample>& samples) const;

private:
    static Index3 cubeAt(const Vec3& place, int level = 0);
    static std::set<Index3> cubesAround(const std::vector<Vec3>& places, int level = 0);
    std::uint8_t halvingsAt(const Index3& cube) const;

    std::map<Index3, std::size_t> added_;  ///< of cubes of the lattice: how often they were added
    std::set<Index3> crossings_;
    std::map<int, std::set<Index3>> frozen_;  ///< cubes of each level
};

}  // namespace adaptiso::detail
