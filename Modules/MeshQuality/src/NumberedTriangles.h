#pragma once

#include <cstdint>
#include <vector>

#include "Triangles.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshQuality/TriangleTree.h"

namespace adaptiso {

/// The triangles with finite corners, by numbers of 32 bits.
struct NumberedTriangles {
    explicit NumberedTriangles(const TriangleMesh& mesh) : points(mesh.points) {
        for (std::int64_t n = 0; n < std::ssize(mesh.triangles); ++n) {
            if (!areFinite(cornersOf(mesh, n))) continue;
            const auto& [a, b, c] = mesh.triangles[n];
            triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                 static_cast<std::uint32_t>(c)});
            numbers.push_back(n);
        }
    }
    TriangleView view() const { return {points, triangles}; }

    const std::vector<Vec3>& points;
    std::vector<TriangleView::Triangle> triangles;
    std::vector<std::int64_t> numbers;
};

}  // namespace adaptiso
