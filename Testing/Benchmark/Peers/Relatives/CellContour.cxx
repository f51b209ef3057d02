#include "CellContour.h"

#include <vtkMarchingCubesTriangleCases.h>

#include <cmath>

namespace adaptiso::benchmarks {

std::size_t ContourMesh::Hash::operator()(const Key& key) const {
    std::uint64_t hash = 0;
    for (const std::int64_t part : key.place) {
        hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15ULL;
        hash ^= hash >> 29;
    }
    return hash;
}

VertexId ContourMesh::vertex(const Vec3& index) {
    constexpr double kGrid = 1 << 20;
    const Key key{{std::llround(index.x * kGrid), std::llround(index.y * kGrid),
                   std::llround(index.z * kGrid)}};
    const auto [place, isNew] = vertices_.emplace(key, std::ssize(mesh_.points));
    if (isNew) mesh_.points.push_back(index);
    return place->second;
}

TriangleMesh ContourMesh::take(const ImageGeometry& geometry) {
    for (Vec3& p : mesh_.points) p = geometry.toPhysical(p);
    if (geometry.isMirrored()) flipOrientation(mesh_);
    vertices_.clear();
    return std::move(mesh_);
}

Vec3 crossing(const Vec3& a, double valueA, const Vec3& b, double valueB, double isovalue) {
    const bool isTurned = valueA > valueB;
    const Vec3 &low = isTurned ? b : a, &high = isTurned ? a : b;
    const double least = isTurned ? valueB : valueA, most = isTurned ? valueA : valueB;
    return low + (isovalue - least) / (most - least) * (high - low);
}

int addCell(const Hexahedron& cell, double isovalue, ContourMesh& mesh) {
    static constexpr int kEdges[12][2] = {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6},
                                          {7, 6}, {4, 7}, {0, 4}, {1, 5}, {3, 7}, {2, 6}};
    int mask = 0;
    for (int n = 0; n < 8; ++n) {
        mask |= (cell.values[static_cast<std::size_t>(n)] >= isovalue) << n;
    }
    const EDGE_LIST* edge = vtkMarchingCubesTriangleCases::GetCases()[mask].edges;
    int triangles = 0;
    for (; *edge >= 0; edge += 3, ++triangles) {
        VertexId corner[3];
        for (int c = 0; c < 3; ++c) {
            const auto a = static_cast<std::size_t>(kEdges[edge[c]][0]);
            const auto b = static_cast<std::size_t>(kEdges[edge[c]][1]);
            corner[c] = mesh.vertex(crossing(cell.corners[a], cell.values[a], cell.corners[b],
                                             cell.values[b], isovalue));
        }
        mesh.add(corner[0], corner[1], corner[2]);
    }
    return triangles;
}

}  // namespace adaptiso::benchmarks
