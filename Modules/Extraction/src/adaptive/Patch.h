#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "Quadric.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// A part of a surface that is simplified alone, in the metric frame.
///
/// The first `ownTriangles` triangles may change; those after them are looked at only, so that
/// nothing crosses them. A vertex moves or goes if all triangles around it are own ones.
struct Patch {
    using Corner = std::uint32_t;
    static constexpr std::uint32_t kGone = 0xFFFFFFFF;  ///< in place of a gone triangle's corners

    std::vector<Vec3> points;
    std::vector<Quadric> quadrics;  ///< of each point
    enum class State : std::uint8_t {
        Open,
        Tried,  ///< nothing around it has changed since all its edges were tried
        Final   ///< stays
    };
    std::vector<State> states;  ///< of each point
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::uint32_t ownTriangles = 0;

    /// Vertices of the full-resolution surface, and the triangle that stands for each.
    std::vector<Vec3> samples;
    std::vector<Normal> sampleNormals;  ///< of the full-resolution surface
    std::vector<std::uint32_t> sampleTriangle;
    std::vector<std::uint8_t> sampleIsSingleSheet;
    /// How often the square of the allowed distance is halved for a sample, see TightPlaces.
    std::vector<std::uint8_t> sampleTightness;

    /// New vertices stay in this box, in continuous index coordinates.
    Vec3 lowIndex{-kFar, -kFar, -kFar}, highIndex{kFar, kFar, kFar};
    static constexpr double kFar = std::numeric_limits<double>::infinity();
};

}  // namespace adaptiso::detail
