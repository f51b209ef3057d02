#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "WallMesh.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::detail {

/// Goals of simplification.
struct WallAim {
    double limitMm = 0;        ///< between them and the full ones, both ways
    bool mayGrow = false;      ///< the limit may be passed; the bound then says by how much
    std::int64_t enough = 0;   ///< triangles below which nothing more is done
    double leastAngleDeg = 0;  ///< no smaller one is made
};

/// Division of space into cubes, by planes across each axis of the image.
class CubeCut {
public:
    /// \param side  voxels, more or less \param isShifted  cut half-way between the other planes
    CubeCut(const Index3& size, double side, bool isShifted);

    std::int64_t count() const { return count_[0] * count_[1] * count_[2]; }
    /// Number of a cube along an axis, from a coordinate in voxels.
    std::int64_t along(int axis, double x) const;
    std::int64_t number(const Index3& cube) const {
        return cube[0] + count_[0] * (cube[1] + count_[1] * cube[2]);
    }
    Index3 cubeOf(const Vec3& index) const {
        return {along(0, index.x), along(1, index.y), along(2, index.z)};
    }
    /// Its corners, in voxels; the outermost cubes have no end.
    Vec3 lowOf(std::int64_t number) const;
    Vec3 highOf(std::int64_t number) const;

private:
    Index3 indexOf(std::int64_t number) const {
        return {number % count_[0], number / count_[0] % count_[1],
                number / (count_[0] * count_[1])};
    }

    std::array<double, 3> side_{};
    double shift_;
    Index3 count_{1, 1, 1};
};

/// All walls, and what is kept of them from one simplification to the next.
///
/// They are simplified in cubes side by side: what reaches into other cubes stays as it is, and new
/// vertices stay in their cube, so that nothing can cross what changes in another one. Cubes that
/// are cut elsewhere take what was left.
class WholeWalls {
public:
    using Id = std::uint32_t;

    WholeWalls(LabelComplex&& full, const ImageGeometry& geometry);

    std::int64_t fullTriangles() const { return static_cast<std::int64_t>(full_.size()); }

    /// Simplifies what lies in each cube. \return the bound reached, mm
    double simplify(const CubeCut& cut, const WallAim& aim);

    LabelComplex complex() const;

private:
    struct Lists;
    struct Made;
    struct Numbers;

    bool isFull() const { return points_.empty(); }
    const std::vector<Vec3>& points() const { return isFull() ? fullPoints_ : points_; }
    const std::vector<WallTriangle>& triangles() const { return isFull() ? full_ : triangles_; }
    Vec3 toIndex(const Vec3& pointMm) const { return toIndex_ * (pointMm - geometry_.originMm); }

    Lists listsOf(const CubeCut& cut, const WallAim& aim) const;
    std::vector<Id> inBlocks(std::span<const Id> own) const;
    WallPatch patchOf(const CubeCut& cut, const Lists& lists, std::int64_t cube,
                      Numbers& numbers) const;
    void addFull(const Lists& lists, std::int64_t cube, WallPatch& patch, Numbers& numbers) const;
    Made simplifyOne(const CubeCut& cut, const Lists& lists, std::int64_t cube,
                     const WallAim& aim) const;
    void join(const Lists& lists, std::vector<Made>& made);

    const ImageGeometry& geometry_;
    Mat3 toIndex_;
    // at full resolution
    std::vector<Vec3> fullPoints_;
    std::vector<WallTriangle> full_;
    std::vector<std::array<Label, 2>> walls_;  ///< their labels
    // as they are; empty at first: the full ones
    std::vector<Vec3> points_;
    std::vector<WallKind> kinds_;
    std::vector<Quadric> quadrics_;
    std::vector<Id> origins_;
    std::vector<std::uint8_t> isTried_;
    std::vector<WallTriangle> triangles_;
    std::vector<WallAssignment> assignments_;
};

struct SimplifiedWalls {
    LabelComplex complex;
    double errorBoundMm = 0;
};

/// Walls of few triangles within a proved distance of the full ones, each wall of itself, that
/// cross nothing and leave every voxel centre in its region and the topology as it is.
///
/// Edges collapse, cheapest first [Garland1997], as far as quick tests let them. Then the distance
/// is proved and crossings are looked for, exactly; what breaks a promise is taken back. That is
/// done in cubes side by side, and again in cubes cut elsewhere; for a count in all at once.
/// \param aims  maxErrorMm > 0; the share is not looked at
SimplifiedWalls simplifyWalls(LabelComplex&& full, const ImageGeometry& geometry,
                              const SimplifyAims& aims, const ProgressCallback& progress);

}  // namespace adaptiso::detail
