#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "DualComplex.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// Least distance of a vertex to the border of its room, in voxels. Distances below are
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

/// Neighbours that each vertex is smoothed by: on junctions those along them only.
struct Neighbours {
    std::vector<std::uint32_t> begin;
    std::vector<std::uint32_t> of;
    std::vector<std::uint8_t> isJunction;

    std::span<const std::uint32_t> at(std::size_t v) const {
        return {of.data() + begin[v], begin[v + 1] - begin[v]};
    }
};
Neighbours neighboursOf(const DualComplex& complex);

/// Smooths walls: each vertex moves towards the middle of its neighbours and, by a little more,
/// back again, which takes the staircase away and leaves the volume [Taubin1995]. None leaves its
/// room. \param points  where the vertices begin; taken \return where they are
std::vector<Vec3> smooth(const std::vector<Room>& rooms, const Neighbours& neighbours,
                         std::vector<Vec3>&& points);

/// Gives back what thin regions lose by being smoothed from startPoints() to `points`.
/// \pre  the complex has its polygons
void takeBackShift(const LabelGrid& grid, const DualComplex& complex,
                   const std::vector<Room>& rooms, const Neighbours& neighbours,
                   std::vector<Vec3>& points);

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
