#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {

/// Faces as a file lists them. Polygons are cut into triangles once all points are there: files may
/// list faces first.
class Faces {
public:
    void reserve(std::size_t count) { triangles_.reserve(count); }

    /// A triangle or a polygon. A corner that is named twice in a row is one. What has fewer than 3
    /// corners then is a line or a point, and left out.
    void add(std::span<const VertexId> corners);

    /// A triangle strip, whose every second triangle is turned round. Triangles that name a point
    /// twice, by which strips are joined, are left out. \throws FileError  fewer than 3 corners
    void addStrip(std::span<const VertexId> corners);

    /// Faces added; a strip is one.
    std::int64_t count() const { return count_; }

    /// Moves the triangles to file.mesh, in the order of the file. Polygons are cut in the plane of
    /// best fit through them, by triangulatePolygon(); a warning says how many were cut, and how
    /// far their corners lie off these planes. Polygons without area give triangles without area.
    /// A polygon that crosses itself becomes a fan of triangles, with a warning (polygons-cross):
    /// the winding number of the fan is the polygon's.
    /// \param lines  that the file lists beside the faces; a note says how many were left out
    /// \pre    file.mesh has its points
    /// \throws FileError  a polygon names a point that is not there (but for keepsFaults, where it
    ///         is cut anyhow), or has too many corners
    void moveTo(MeshFile& file, bool keepsFaults, std::int64_t lines = 0) &&;

private:
    struct Polygon {
        std::int64_t number;       ///< among the faces
        std::size_t triangle;      ///< before which its own belong
        std::size_t corner, size;  ///< in corners_
    };

    std::vector<Triangle> triangles_;
    std::vector<Polygon> polygons_;
    std::vector<VertexId> corners_;  ///< of all polygons
    std::int64_t count_ = 0, lines_ = 0, strips_ = 0, stripTriangles_ = 0;
};

/// Says that lines and points beside the faces were left out, where there are some.
void noteLinesLeftOut(std::int64_t count, std::vector<Warning>& warnings);

}  // namespace adaptiso::meshio
