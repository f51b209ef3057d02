#pragma once

#include <cstdint>
#include <vector>

#include "DualComplex.h"
#include "LabelGrid.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// How near to the border of the room that it has a vertex may come, in voxels. Distances below are
/// lost in rounding only far beyond the size of any image.
inline constexpr double kLeastGap = 1.0 / 64;

/// Where a vertex of the dual complex may lie: a part of a cell, convex.
struct Room {
    std::array<std::int32_t, 3> cell{};
    std::uint8_t first = 0;  ///< of its tetrahedra
    std::uint8_t size = kTetrahedra;

    Vec3 corner() const {
        return {static_cast<double>(cell[0]), static_cast<double>(cell[1]),
                static_cast<double>(cell[2])};
    }
};

/// Rooms of the vertices of groups.
std::vector<Room> roomsOf(const LabelGrid& grid, const DualComplex& complex);

/// `p` (lattice), or the point of the room with its gap that stands for it.
Vec3 heldIn(const Room& room, const Vec3& p);

/// Where vertices begin (lattice): in the middle of a whole cell, so that the walls enclose the
/// volume of the voxels; else near the middles of the voxel edges that the walls cross.
std::vector<Vec3> startPoints(const LabelGrid& grid, const DualComplex& complex,
                              const std::vector<Room>& rooms);

/// Smooths walls: each vertex moves towards the middle of its neighbours and, by a little more,
/// back again, which takes the staircase away and leaves the volume [Taubin1995]. Vertices of
/// junctions look at neighbours along them only. None leaves its room; what thin regions would
/// still lose is given back.
void relax(const DualComplex& complex, const std::vector<Room>& rooms, std::vector<Vec3>& points);

/// Moves walls along their normals until each region has the volume of its voxels again, but for a
/// hundredth, as far as the rooms of its vertices let it: smoothing shrinks what is small.
void restoreVolumes(const LabelGrid& grid, const DualComplex& complex,
                    const std::vector<Room>& rooms, std::vector<Vec3>& points);

/// Vertices at the border of their rooms.
std::int64_t countHeld(const DualComplex& complex, const std::vector<Room>& rooms,
                       const std::vector<Vec3>& points);

/// Adds the points on faces, near where what they join passes the faces.
void appendFacePoints(const LabelGrid& grid, const DualComplex& complex, std::vector<Vec3>& points);

}  // namespace adaptiso::detail
