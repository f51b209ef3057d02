#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "CellPattern.h"
#include "LabelGrid.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Labels/Labels.h"

namespace adaptiso::detail {

/// A vertex of a dual complex: there are many of them, so their numbers are kept short.
using DualId = std::uint32_t;
inline constexpr DualId kMostDualVertices = 1U << 31;

/// A cell that a wall runs through.
struct WallCell {
    std::int64_t place = 0;  ///< in the grid
    DualId firstVertex = 0;
    DualId firstPoint = 0;     ///< of its points on faces
    std::uint16_t code = 0;    ///< of its pattern
    std::uint16_t points = 0;  ///< faces with a point of their own, as bits: see facePoint()

    const CellPattern& pattern() const { return cellPattern(code); }
};

/// Edges of the dual complex: vertices of groups that share a face.
struct Adjacency {
    DualId a;
    DualId b : 31;
    DualId isJunction : 1;  ///< three or more labels meet there
};

/// The walls of a label map as polygons: the dual of Kuhn's triangulation of the lattice, one
/// polygon for each of its edges between two labels, one vertex for each group of tetrahedra.
///
/// Where the tetrahedra of two groups are not convex together, what joins their vertices bends at
/// a point on the face that they share. Polygons of less than three corners are left out.
struct DualComplex {
    struct Polygon {
        std::int64_t place;  ///< where its lattice edge begins
        std::array<Label, 2> labels;
        std::uint32_t begin;  ///< of its corners
        std::uint8_t kind;    ///< of its lattice edge
        std::uint8_t count;   ///< of corners
        bool isWhole;         ///< four corners, each anywhere in a cell of its own
    };

    std::vector<WallCell> cells;  ///< by place
    std::vector<Polygon> polygons;
    std::vector<DualId> corners;  ///< counter-clockwise, seen from where the lattice edge ends
    std::vector<Adjacency> adjacencies;
    VertexId groupCount = 0;  ///< vertices of groups: 0 ... groupCount - 1
    VertexId pointCount = 0;  ///< points on faces: from groupCount on

    std::span<const DualId> cornersOf(const Polygon& p) const {
        return {corners.data() + p.begin, p.count};
    }
};

/// Without its polygons. \throws InvalidInput  there are more vertices than are counted
DualComplex makeDualComplex(const LabelGrid& grid);

/// Adds the polygons, which smoothing does without: they are large. \throws InvalidInput  there are
/// more corners than are counted
void addPolygons(const LabelGrid& grid, DualComplex& complex);

/// A point on a face of a cell's tetrahedra: which vertices it lies between, and the face.
struct FacePoint {
    std::array<VertexId, 2> between;
    std::int64_t cell;        ///< place of the cell that has it
    std::array<int, 3> face;  ///< its corners
};

/// Those of the complex, in the order of their numbers.
std::vector<FacePoint> facePoints(const LabelGrid& grid, const DualComplex& complex);

struct Walls {
    LabelComplex complex;
    std::int64_t mendedCrossings = 0;  ///< polygons that were cut otherwise, as they crossed others
};

/// Cuts the polygons into triangles, none of which cross: along the shorter diagonal, along the
/// other one, or round a point on the polygon's lattice edge [JuUdeshi2006].
///
/// \param complex  its polygons and corners are taken
/// \param grid     its labels are not asked for
/// \param points   of the groups and the faces of the complex (lattice), each in its room; taken.
///                 The last of the three ways keeps each triangle in the rooms of its corners:
///                 always sound.
Walls cutPolygons(DualComplex&& complex, const LabelGrid& grid, std::vector<Vec3>&& points,
                  const ImageGeometry& geometry);

}  // namespace adaptiso::detail
