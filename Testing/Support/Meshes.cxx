#include "Support/Meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace adaptiso::testing {
namespace {

/// Unit icosahedron, outward.
TriangleMesh icosahedron() {
    constexpr double g = std::numbers::phi;
    TriangleMesh mesh;
    mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Vec3& p : mesh.points) p = normalized(p);
    mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    return mesh;
}

/// Each triangle in four, the new points pushed out to the unit sphere.
TriangleMesh subdividedOnSphere(const TriangleMesh& coarse) {
    TriangleMesh fine;
    fine.points = coarse.points;
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) {
        const auto [it, isNew] =
            middles.try_emplace(std::minmax(a, b), static_cast<VertexId>(fine.points.size()));
        if (isNew) fine.points.push_back(normalized(fine.points[a] + fine.points[b]));
        return it->second;
    };
    for (const auto& [a, b, c] : coarse.triangles) {
        const VertexId ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.triangles.insert(fine.triangles.end(),
                              {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    return fine;
}

VertexId pointCount(const TriangleMesh& mesh) {
    return static_cast<VertexId>(mesh.points.size());
}

void addPoint(TriangleMesh& mesh, const Vec3& point) {
    mesh.points.push_back(point);
    if (!mesh.normals.empty()) mesh.normals.push_back(mesh.normals.front());
}

}  // namespace

TriangleMesh icosphere(int subdivisions, const Vec3& centreMm, double radiusMm) {
    TriangleMesh mesh = icosahedron();
    for (int i = 0; i < subdivisions; ++i) mesh = subdividedOnSphere(mesh);
    for (Vec3& p : mesh.points) {
        mesh.normals.push_back(toNormal(p));
        p = centreMm + radiusMm * p;
    }
    return mesh;
}

TriangleMesh torusMesh(int majorSteps, int minorSteps, double majorRadiusMm, double minorRadiusMm) {
    TriangleMesh mesh;
    for (int u = 0; u < majorSteps; ++u) {
        const double major = 2 * std::numbers::pi * u / majorSteps;
        const Vec3 out{std::cos(major), std::sin(major), 0};
        for (int v = 0; v < minorSteps; ++v) {
            const double minor = 2 * std::numbers::pi * v / minorSteps;
            const Vec3 normal = std::cos(minor) * out + Vec3{0, 0, std::sin(minor)};
            mesh.points.push_back(majorRadiusMm * out + minorRadiusMm * normal);
            mesh.normals.push_back(toNormal(normal));
        }
    }
    const auto at = [&](int u, int v) {
        return VertexId{u % majorSteps} * minorSteps + v % minorSteps;
    };
    for (int u = 0; u < majorSteps; ++u) {
        for (int v = 0; v < minorSteps; ++v) {
            mesh.triangles.push_back({at(u, v), at(u + 1, v), at(u + 1, v + 1)});
            mesh.triangles.push_back({at(u, v), at(u + 1, v + 1), at(u, v + 1)});
        }
    }
    return mesh;
}

TriangleMesh cubeMesh(const Vec3& minimumMm, const Vec3& maximumMm) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {  // bit a: at the maximum of axis a
        mesh.points.push_back({corner & 1 ? maximumMm.x : minimumMm.x,
                               corner & 2 ? maximumMm.y : minimumMm.y,
                               corner & 4 ? maximumMm.z : minimumMm.z});
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

TriangleMesh planeMesh(int steps, double sizeMm, double heightMm) {
    TriangleMesh mesh;
    for (int v = 0; v <= steps; ++v) {
        for (int u = 0; u <= steps; ++u) {
            mesh.points.push_back({sizeMm * u / steps, sizeMm * v / steps, heightMm});
        }
    }
    for (VertexId v = 0; v < steps; ++v) {
        for (VertexId u = 0; u < steps; ++u) {
            const VertexId a = v * (steps + 1) + u, b = a + 1, c = a + steps + 1, d = c + 1;
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
        }
    }
    return mesh;
}

TriangleMesh merged(const std::vector<TriangleMesh>& meshes) {
    TriangleMesh all;
    bool haveNormals = true;
    for (const TriangleMesh& mesh : meshes) {
        const VertexId offset = pointCount(all);
        all.points.insert(all.points.end(), mesh.points.begin(), mesh.points.end());
        all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
        haveNormals = haveNormals && mesh.normals.size() == mesh.points.size();
        for (const auto& [a, b, c] : mesh.triangles) {
            all.triangles.push_back({a + offset, b + offset, c + offset});
        }
    }
    if (!haveNormals) all.normals.clear();
    return all;
}

TriangleMesh translated(TriangleMesh mesh, const Vec3& byMm) {
    for (Vec3& p : mesh.points) p += byMm;
    return mesh;
}

TriangleMesh withHole(TriangleMesh mesh) {
    mesh.triangles.pop_back();
    return mesh;
}

TriangleMesh withFlippedTriangle(TriangleMesh mesh) {
    std::swap(mesh.triangles.front()[1], mesh.triangles.front()[2]);
    return mesh;
}

TriangleMesh withDuplicateTriangle(TriangleMesh mesh) {
    const Triangle first = mesh.triangles.front();
    mesh.triangles.push_back(first);
    return mesh;
}

TriangleMesh withZeroAreaTriangle(TriangleMesh mesh) {
    const auto [a, b, c] = mesh.triangles.front();
    const VertexId middle = pointCount(mesh);
    addPoint(mesh, 0.5 * (mesh.points[a] + mesh.points[b]));
    mesh.triangles.front() = {a, middle, c};
    mesh.triangles.insert(mesh.triangles.end(), {{middle, b, c}, {a, b, middle}});
    return mesh;
}

TriangleMesh withRepeatedIndex(TriangleMesh mesh) {
    const Triangle first = mesh.triangles.front();
    mesh.triangles.push_back({first[0], first[0], first[1]});
    return mesh;
}

TriangleMesh withUnusedVertex(TriangleMesh mesh) {
    addPoint(mesh, {7, 7, 7});
    return mesh;
}

TriangleMesh withNanCoordinate(TriangleMesh mesh) {
    mesh.points.front().x = std::numeric_limits<double>::quiet_NaN();
    return mesh;
}

TriangleMesh withIndexOutOfRange(TriangleMesh mesh) {
    mesh.triangles.push_back({0, 1, pointCount(mesh)});
    return mesh;
}

TriangleMesh withRandomDamage(TriangleMesh mesh, unsigned seed) {
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return random() % n; };
    for (int n = 0; n < 12; ++n) {
        const std::size_t t = below(mesh.triangles.size());
        switch (below(5)) {
            case 0:
                mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
                break;
            case 1:
                std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
                break;
            case 2: {
                const Triangle again = mesh.triangles[t];
                mesh.triangles.push_back(again);
                break;
            }
            case 3:
                mesh.points[mesh.triangles[t][0]] =
                    mesh.points[mesh.triangles[below(mesh.triangles.size())][1]] +
                    Vec3{0.01, 0.02, 0.03};
                break;
            default:
                mesh.triangles[t][2] = static_cast<VertexId>(below(mesh.points.size()));
        }
    }
    return mesh;
}

TriangleMesh twoSpheresTouchingAtAVertex() {
    const TriangleMesh left = icosphere(1);
    TriangleMesh mesh = left;
    const VertexId offset = pointCount(left);
    const Vec3 touch = left.points.front();
    for (std::size_t i = 1; i < left.points.size(); ++i) {  // the mirror image through `touch`
        mesh.points.push_back(2 * touch - left.points[i]);
        mesh.normals.push_back(toNormal(-toVec3(left.normals[i])));
    }
    const auto mirrored = [&](VertexId v) { return v == 0 ? v : v + offset - 1; };
    for (const auto& [a, b, c] : left.triangles) {  // a point reflection turns triangles round
        mesh.triangles.push_back({mirrored(a), mirrored(c), mirrored(b)});
    }
    return mesh;
}

TriangleMesh threeTrianglesOnAnEdge() {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    return mesh;
}

TriangleMesh crossingSpheres(int subdivisions) {
    return merged({icosphere(subdivisions), icosphere(subdivisions, {0.5, 0, 0})});
}

}  // namespace adaptiso::testing
