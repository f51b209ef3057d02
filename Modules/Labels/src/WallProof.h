#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "WallMesh.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"

namespace adaptiso::detail {

/// Some triangles of a mesh, found by their boxes.
class NearTriangles {
public:
    using Id = WallMesh::Id;

    NearTriangles() = default;
    /// \param numbers  of triangles of the mesh, which stay what they are
    NearTriangles(const WallMesh& mesh, std::vector<Id> numbers) : numbers_(std::move(numbers)) {
        for (const Id n : numbers_) triangles_.push_back(mesh.triangle(n).v);
        tree_ = TriangleTree({mesh.points(), triangles_});
    }

    /// Calls f(number) for each triangle whose box overlaps one.
    template <class F>
    void forEach(const WallMesh& mesh, const BoundingBox& box, const F& f) const {
        tree_.forEachOverlap(box, {mesh.points(), triangles_},
                             [&](std::int64_t n) { f(numbers_[n]); });
    }
    bool hasOne(const WallMesh& mesh, const BoundingBox& box) const {
        bool hasOne = false;
        forEach(mesh, box, [&](Id) { hasOne = true; });
        return hasOne;
    }

private:
    std::vector<Id> numbers_;
    std::vector<TriangleView::Triangle> triangles_;
    TriangleTree tree_;
};

/// Walls for walks: each a surface of its own, that ends where it meets others.
class WallSurface {
public:
    using Id = WallMesh::Id;

    /// The triangles of `mesh` with these numbers.
    WallSurface(const WallMesh& mesh, std::vector<Id> numbers);
    WallSurface(const WallSurface&) = delete;

    std::size_t count() const { return numbers_.size(); }
    /// Place of the mesh's triangle n here.
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
    mutable std::once_flag treeIsMade_;
    mutable TriangleTree tree_;
};

/// A triangle that could not be shown to lie within the limit of the other surface, and what of
/// that lies near.
struct WallPlace {
    WallMesh::Id triangle;
    std::vector<WallMesh::Id> near;
};

/// Proof for some triangles.
struct WallBound {
    double largestMm = 0;  ///< of all that is not in `beyond`, and of that without a limit
    std::vector<WallPlace> beyond;
    /// For each triangle in turn, where asked for: how many triangles of `to` (numbers) it was
    /// shown to lie near, and these. While they are there, what was proved of it holds.
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
