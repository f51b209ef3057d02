#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::benchmarks {

/// Collects triangles whose corners are continuous indices; corners at one place (to 2^-20 voxel)
/// are one vertex.
class ContourMesh {
public:
    VertexId vertex(const Vec3& index);
    /// One that names a vertex twice is left out.
    void add(VertexId a, VertexId b, VertexId c) {
        if (a != b && b != c && a != c) mesh_.triangles.push_back({a, b, c});
    }
    const std::vector<Triangle>& triangles() const { return mesh_.triangles; }
    const Vec3& point(VertexId v) const { return mesh_.points[static_cast<std::size_t>(v)]; }

    /// In LPS mm, counter-clockwise seen from outside.
    TriangleMesh take(const ImageGeometry& geometry);

private:
    struct Key {
        std::array<std::int64_t, 3> place;
        friend bool operator==(const Key&, const Key&) = default;
    };
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };
    TriangleMesh mesh_;
    std::unordered_map<Key, VertexId, Hash> vertices_;
};

/// Where the isovalue is on the edge from a to b, by their values; the same from either end.
Vec3 crossing(const Vec3& a, double valueA, const Vec3& b, double valueB, double isovalue);

/// A cell of eight corners in the order of VTK: 000, 100, 110, 010, 001, 101, 111, 011.
struct Hexahedron {
    std::array<Vec3, 8> corners;
    std::array<double, 8> values;
};

/// Adds the triangles of marching cubes in a cell [Lorensen1987], by VTK's table.
/// \return  how many
int addCell(const Hexahedron& cell, double isovalue, ContourMesh& mesh);

}  // namespace adaptiso::benchmarks
