#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Tiles.h"

namespace adaptiso {
namespace {

/// Triangles this near a wall between tiles may change, in cells: there the first pass has left
/// full resolution, a cell deep. All others are final.
constexpr double kReach = 2;

BoundingBox extentOf(const TriangleMesh& mesh, const Triangle& t) {
    return boxOf({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]});
}

}  // namespace

TriangleMesh withoutUnusedPoints(TriangleMesh mesh) {
    constexpr VertexId kUnused = -1;
    std::vector<VertexId> number(mesh.points.size(), kUnused);
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId v : t) number[v] = 0;
    }
    VertexId used = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        number[v] = used++;
        mesh.points[number[v]] = mesh.points[v];
        if (!mesh.normals.empty()) mesh.normals[number[v]] = mesh.normals[v];
    }
    if (used == std::ssize(mesh.points)) return mesh;
    mesh.points.resize(used);
    mesh.points.shrink_to_fit();
    if (!mesh.normals.empty()) mesh.normals.resize(used);
    mesh.normals.shrink_to_fit();
    for (Triangle& t : mesh.triangles) {
        for (VertexId& v : t) v = number[v];
    }
    return mesh;
}

namespace {

/// The walls between tiles in a seam box: one along each axis, or none.
std::array<std::optional<double>, 3> wallsIn(const TileCut& cut, const Index3& seam) {
    std::array<std::optional<double>, 3> walls;
    for (int a = 0; a < 3; ++a) {
        if (seam[a] + 1 < cut.tiles()[a]) walls[a] = cut.boxOf(seam).maximum[a];
    }
    return walls;
}

}  // namespace

SeamPart seamPartOf(const TriangleMesh& tiles, const TileCut& cut, const Index3& seam) {
    const BoundingBox box = cut.seamBox(seam);
    const std::array<std::optional<double>, 3> walls = wallsIn(cut, seam);
    SeamPart part;
    part.mesh.points = tiles.points;
    part.mesh.normals = tiles.normals;
    for (const Triangle& t : tiles.triangles) {
        const BoundingBox extent = extentOf(tiles, t);
        bool isIn = true, touches = true, isNear = false;
        for (int a = 0; a < 3; ++a) {
            isIn = isIn && extent.minimum[a] > box.minimum[a] && extent.maximum[a] < box.maximum[a];
            isNear = isNear || (walls[a] && extent.minimum[a] < *walls[a] + kReach &&
                                extent.maximum[a] > *walls[a] - kReach);
            touches = touches && extent.maximum[a] >= box.minimum[a] &&
                      extent.minimum[a] <= box.maximum[a];
        }
        if (!touches) continue;
        part.mesh.triangles.push_back(t);
        part.isFixed.push_back(static_cast<std::uint8_t>(!(isIn && isNear)));
    }
    part.mesh = withoutUnusedPoints(std::move(part.mesh));
    return part;
}

TriangleMesh ownTriangles(const SimplifiedPart& part, const TileCut& cut, const Index3& seam) {
    TriangleMesh own;
    own.points = part.mesh.points;
    own.normals = part.mesh.normals;
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = part.mesh.triangles[t];
        if (part.isKept[t] != 0) {
            // by its corners in an order of their places: the same in every box
            std::array<Vec3, 3> corner{part.mesh.points[a], part.mesh.points[b],
                                       part.mesh.points[c]};
            std::sort(corner.begin(), corner.end(), [](const Vec3& p, const Vec3& q) {
                return std::array{p.x, p.y, p.z} < std::array{q.x, q.y, q.z};
            });
            const Vec3 middle = (1.0 / 3) * (corner[0] + corner[1] + corner[2]);
            if (cut.seamAt(middle) != seam) continue;
        }
        own.triangles.push_back(part.mesh.triangles[t]);
    }
    return withoutUnusedPoints(std::move(own));
}

}  // namespace adaptiso
