#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "WallMesh.h"
#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/SurfaceProof/SurfaceWalk.h"

namespace adaptiso::detail {

/// Space cut into equal cells. What lies outside counts as in the outermost ones.
class SpaceCells {
public:
    using Range = std::array<std::array<std::int64_t, 2>, 3>;

    SpaceCells() = default;
    /// \param most  there are no more cells than that; where needed they are larger. \pre >= 1
    SpaceCells(const BoundingBox& box, double cellMm, std::int64_t most);

    std::int64_t count() const { return size_[0] * size_[1] * size_[2]; }
    /// First and last cell along each axis that a box reaches.
    Range rangeOf(const BoundingBox& box) const;
    static std::int64_t countOf(const Range& r) {
        return (r[0][1] - r[0][0] + 1) * (r[1][1] - r[1][0] + 1) * (r[2][1] - r[2][0] + 1);
    }

    /// Calls f(number, {i, j, k}) of each cell.
    template <class F>
    void forEach(const Range& r, const F& f) const {
        for (std::int64_t k = r[2][0]; k <= r[2][1]; ++k) {
            for (std::int64_t j = r[1][0]; j <= r[1][1]; ++j) {
                for (std::int64_t i = r[0][0]; i <= r[0][1]; ++i) {
                    f(i + size_[0] * (j + size_[1] * k), std::array<std::int64_t, 3>{i, j, k});
                }
            }
        }
    }

private:
    Vec3 low_;
    double perMm_ = 1;
    std::array<std::int64_t, 3> size_{1, 1, 1};
};

/// Triangles by the cells of space that their boxes reach.
class TriangleGrid {
public:
    using Id = std::uint32_t;

    /// \param boxOfTriangle  the box of triangle n
    template <class F>
    void assign(Id count, const F& boxOfTriangle);

    /// Calls f(n) once for each triangle whose box overlaps one.
    template <class F>
    void forEachNear(const BoundingBox& box, const F& f) const;
    /// The same, maybe several times.
    template <class F>
    void forEachNearOften(const BoundingBox& box, const F& f) const;

private:
    static constexpr std::int64_t kMostCells = 64;  ///< of a triangle in cells; others are large

    SpaceCells cells_;
    std::vector<BoundingBox> boxes_;
    Buckets<Id, std::uint32_t> own_;
    std::vector<Id> large_;
};

/// Cells of space that some boxes reach.
class MarkedCells {
public:
    explicit MarkedCells(const SpaceCells& cells) : cells_(cells), isMarked_(cells.count(), 0) {}

    void mark(const BoundingBox& box) {
        cells_.forEach(cells_.rangeOf(box), [&](std::int64_t n, const auto&) { isMarked_[n] = 1; });
    }
    /// A box reaches a cell that another one reached.
    bool isMarked(const BoundingBox& box) const {
        bool isOne = false;
        cells_.forEach(cells_.rangeOf(box),
                       [&](std::int64_t n, const auto&) { isOne = isOne || isMarked_[n] != 0; });
        return isOne;
    }

private:
    const SpaceCells& cells_;
    std::vector<std::uint8_t> isMarked_;
};

template <class F>
void TriangleGrid::assign(Id count, const F& boxOfTriangle) {
    boxes_.clear();
    large_.clear();
    if (count == 0) return;
    BoundingBox all = boxOfTriangle(0);
    double sides = 0;
    boxes_.reserve(count);
    for (Id n = 0; n < count; ++n) {
        const BoundingBox box = boxOfTriangle(n);
        all.add(box);
        const Vec3 side = box.size();
        sides += std::max({side.x, side.y, side.z});
        boxes_.push_back(box);
    }
    constexpr double kCellSize = 1.5;  // of the mean box's longest side
    cells_ = SpaceCells(all, kCellSize * sides / count, 4 * std::int64_t{count});
    own_.assign(cells_.count(), [&](const auto& give) {
        large_.clear();
        for (Id n = 0; n < count; ++n) {
            const auto range = cells_.rangeOf(boxes_[n]);
            if (SpaceCells::countOf(range) > kMostCells) {
                large_.push_back(n);
            } else {
                cells_.forEach(range, [&](std::int64_t cell, const auto&) { give(cell, n); });
            }
        }
    });
}

template <class F>
void TriangleGrid::forEachNearOften(const BoundingBox& box, const F& f) const {
    if (boxes_.empty()) return;
    for (const Id n : large_) {
        if (boxes_[n].overlaps(box)) f(n);
    }
    cells_.forEach(cells_.rangeOf(box), [&](std::int64_t cell, const auto&) {
        for (const Id n : own_.of(cell)) {
            if (boxes_[n].overlaps(box)) f(n);
        }
    });
}

template <class F>
void TriangleGrid::forEachNear(const BoundingBox& box, const F& f) const {
    if (boxes_.empty()) return;
    for (const Id n : large_) {
        if (boxes_[n].overlaps(box)) f(n);
    }
    const auto range = cells_.rangeOf(box);
    cells_.forEach(range, [&](std::int64_t cell, const std::array<std::int64_t, 3>& at) {
        for (const Id n : own_.of(cell)) {
            const BoundingBox& own = boxes_[n];
            if (!own.overlaps(box)) continue;
            const auto reached = cells_.rangeOf(own);  // in the first cell that both reach
            bool isFirst = true;
            for (int axis = 0; axis < 3; ++axis) {
                isFirst = isFirst && at[axis] == std::max(range[axis][0], reached[axis][0]);
            }
            if (isFirst) f(n);
        }
    });
}

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
    mutable std::once_flag gridIsMade_;
    mutable TriangleGrid grid_;
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
