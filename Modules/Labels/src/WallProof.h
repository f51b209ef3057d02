#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "TriangleGrid.h"
#include "WallMesh.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"

namespace adaptiso::detail {

/// Walls for walks: each a surface of its own, that ends where it meets others.
class WallSurface {
public:
    using Id = WallMesh::Id;

    /// The triangles of `mesh` with these numbers.
    WallSurface(const WallMesh& mesh, std::vector<Id> numbers);
    WallSurface(const WallSurface&) = delete;

    std::size_t count() const { return numbers_.size(); }
    /// Of the mesh's triangle n here.
    Id numberOf(std::size_t n) const { return numbers_[n]; }
    const std::vector<Id>& numbers() const { return numbers_; }
    /// Its place here; kNone: not here.
    Id placeOf(Id number) const;

    const WallMesh& mesh() const { return mesh_; }
    const WalkableSurface<Id>& walkable() const { return walkable_; }
    /// Triangles that may lie within a distance of a piece, of the piece's wall.
    void collect(const Corners& piece, Id wall, double distanceMm, std::vector<Id>& places) const;

private:
    const WallMesh& mesh_;
    std::vector<Id> numbers_;
    std::vector<Vec3> points_;
    std::vector<std::array<Id, 3>> triangles_;
    WalkableSurface<Id> walkable_;
    mutable std::once_flag gridIsMade_;
    mutable TriangleGrid grid_;
};

/// A triangle that could not be shown to lie within the limit of the other surface, and what of
/// that lies near.
struct WallPlace {
    WallMesh::Id triangle;
    std::vector<WallMesh::Id> near;
};

/// What was proved of some triangles.
struct WallBound {
    double largestMm = 0;  ///< of all that is not in `beyond`, and of that without a limit
    std::vector<WallPlace> beyond;
    /// Of each triangle in turn, where asked for: how many triangles of `to` (numbers) it was shown
    /// to lie near, and these. While they are there, what was proved of it holds.
    std::vector<WallMesh::Id> witnessCounts, witnesses;
};

/// Bounds the distance of triangles of one surface to the same wall of another.
/// \param triangles  numbers \param starts  for each, a triangle of `to` (number) of the same wall
/// \param mayGrow  what lies beyond the limit counts for the bound, and is no place
/// \param hasWitnesses  they are listed
WallBound proveNear(const WallMesh& mesh, const std::vector<WallMesh::Id>& triangles,
                    const std::vector<WallMesh::Id>& starts, const WallSurface& to, double limitMm,
                    bool mayGrow, bool hasWitnesses);

}  // namespace adaptiso::detail
