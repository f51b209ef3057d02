#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptiso/SurfaceProof/Quadric.h"
#include "adaptive/Parameters.h"
#include "adaptive/bricks/SheetClearance.h"

namespace adaptiso::detail {

/// A point of the full-resolution surface, in the metric frame: a vertex, or the middle of a
/// triangle where the surface bends.
struct Sample {
    std::array<float, 3> position{};
    std::array<std::int16_t, 3> direction{};          ///< of the normal, in parts of kUnit
    std::uint8_t clearance = SheetClearance::kAlone;  ///< to other sheets, see SheetClearance
    bool isInWeb : 1 = false;     ///< a smaller distance is allowed, see PatchLimits::webMm
    bool isOnBorder : 1 = false;  ///< a vertex of an open border
    bool isMiddle : 1 = false;    ///< of a triangle; else it is a vertex

    static constexpr double kUnit = 32767;

    bool isAlone() const { return clearance == SheetClearance::kAlone; }

    Vec3 point() const { return {position[0], position[1], position[2]}; }
    Vec3 normal() const {
        return (1 / kUnit) * Vec3{static_cast<double>(direction[0]),
                                  static_cast<double>(direction[1]),
                                  static_cast<double>(direction[2])};
    }
    void setPoint(const Vec3& p) { position = positionOf(p); }
    /// \param n  of any length
    void setNormal(const Vec3& n) {
        const Vec3 unit = kUnit * normalized(n);
        for (int a = 0; a < 3; ++a) {
            direction[a] = static_cast<std::int16_t>(std::lround(unit[a]));
        }
    }
    /// A vertex. \param n  of any length
    static Sample at(const Vec3& p, const Vec3& n, std::uint8_t clearance) {
        Sample sample;
        sample.setPoint(p);
        sample.setNormal(n);
        sample.clearance = clearance;
        return sample;
    }
    /// The middle of a triangle.
    static Sample middleOf(const Corners& t, std::uint8_t clearance) {
        Sample sample =
            at((1.0 / 3) * (t[0] + t[1] + t[2]), areaVector2(t[0], t[1], t[2]), clearance);
        sample.isMiddle = true;
        return sample;
    }
    static std::array<float, 3> positionOf(const Vec3& p) {
        return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    }
};

/// Normals at a triangle's corners, of any length, are so far apart that the triangle's middle is a
/// sample too.
inline bool cornersBend(const Vec3& first, const Vec3& second, const Vec3& third) {
    const Vec3 a = normalized(first), b = normalized(second), c = normalized(third);
    return !(std::min({dot(a, b), dot(b, c), dot(c, a)}) > kBentCosine);
}

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
        Tried,   ///< nothing around it has changed since all its edges were tried
        Fitted,  ///< no edge around it was collapsed since it was fitted
        Final    ///< stays
    };
    std::vector<State> states;         ///< of each point
    std::vector<std::uint32_t> marks;  ///< of each point, see SurfaceState
    std::vector<std::uint32_t> heirs;  ///< of each point: what it was merged into; may be empty
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::uint32_t ownTriangles = 0;

    std::vector<Sample> samples;
    std::vector<std::uint32_t> sampleTriangle;  ///< the triangle that each is assigned to

    TriangleView view() const { return {points, triangles}; }

    static constexpr std::uint32_t kPlain = 0, kBorder = 1;
    bool isBorder(std::uint32_t point) const { return !marks.empty() && marks[point] == kBorder; }

    /// New vertices stay in this box, in continuous index coordinates: so nothing that the patch
    /// makes can meet what other patches make at the same time in boxes of their own.
    Vec3 lowIndex, highIndex;

    /// Sets the box of a cube of `side` cells, a hair smaller, so that no rounding takes a vertex
    /// out, and none comes to lie in a wall beside those that are fixed there.
    void setBox(const Index3& low, std::int64_t side) {
        constexpr double kInside = 1e-6;
        for (int a = 0; a < 3; ++a) {
            lowIndex[a] = static_cast<double>(low[a]) + kInside;
            highIndex[a] = static_cast<double>(low[a] + side) - kInside;
        }
    }
};

}  // namespace adaptiso::detail
