#include "Parts.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "Bytes.h"

namespace adaptiso::meshio {

void mergeEqualPoints(PlacedMesh& placed) {
    TriangleMesh& mesh = placed.mesh;
    const auto key = [&](std::size_t i) {
        const Vec3& p = mesh.points[i];
        return std::tuple(p.x, p.y, p.z, i);
    };
    const auto isSame = [&](std::size_t a, std::size_t b) {
        return mesh.points[a] == mesh.points[b];
    };
    if (!std::ranges::all_of(mesh.points, [](const Vec3& p) { return isFinite(p); })) return;
    std::vector<std::size_t> order(mesh.points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    std::vector<std::size_t> first(order.size());
    bool areNormalsAlike = true, areColorsAlike = true;
    for (std::size_t n = 0; n < order.size(); ++n) {
        const std::size_t i = order[n];
        first[i] = n > 0 && isSame(order[n - 1], i) ? first[order[n - 1]] : i;
        if (first[i] == i) continue;
        areNormalsAlike =
            areNormalsAlike && (mesh.normals.empty() || mesh.normals[i] == mesh.normals[first[i]]);
        areColorsAlike = areColorsAlike &&
                         (placed.colors.empty() || placed.colors[i] == placed.colors[first[i]]);
    }
    if (!areNormalsAlike) mesh.normals.clear();
    if (!areColorsAlike) placed.colors.clear();
    std::vector<VertexId> number(order.size());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (first[i] != i) {
            number[i] = number[first[i]];
            continue;
        }
        mesh.points[kept] = mesh.points[i];
        if (!mesh.normals.empty()) mesh.normals[kept] = mesh.normals[i];
        if (!placed.colors.empty()) placed.colors[kept] = placed.colors[i];
        number[i] = static_cast<VertexId>(kept++);
    }
    mesh.points.resize(kept);
    if (!mesh.normals.empty()) mesh.normals.resize(kept);
    if (!placed.colors.empty()) placed.colors.resize(kept);
    for (Triangle& triangle : mesh.triangles) {
        for (VertexId& vertex : triangle) {
            if (vertex >= 0 && vertex < std::ssize(number)) {
                vertex = number[static_cast<std::size_t>(vertex)];
            }
        }
    }
}

void JoinedMeshes::add(PlacedMesh&& placed, const AffineTransform& transform) {
    if (!isIdentity(transform)) {
        const double volume = std::abs(determinant(transform.linear));
        if (!(volume > 0) || !std::isfinite(volume)) {
            unsupported("a matrix flattens one of its meshes", "repair the mesh");
        }
        placed.mesh = transformed(placed.mesh, transform);
    }
    const TriangleMesh& mesh = placed.mesh;
    if (!mesh.triangles.empty()) solids_.push_back(std::ssize(mesh_.triangles));
    const auto before = static_cast<VertexId>(mesh_.points.size());
    mesh_.points.insert(mesh_.points.end(), mesh.points.begin(), mesh.points.end());
    mesh_.normals.insert(mesh_.normals.end(), mesh.normals.begin(), mesh.normals.end());
    haveNormals_ = haveNormals_ && !mesh.normals.empty();
    for (Triangle t : mesh.triangles) {
        for (VertexId& vertex : t) {
            const bool isThere = vertex >= 0 && vertex < std::ssize(mesh.points);
            vertex = isThere ? vertex + before : -1;  // not a point of the next mesh
        }
        mesh_.triangles.push_back(t);
    }
    if (placed.colors.empty() && placed.color) {
        placed.colors.assign(mesh.points.size(), *placed.color);
    }
    haveColors_ = haveColors_ && !placed.colors.empty();
    colors_.insert(colors_.end(), placed.colors.begin(), placed.colors.end());
}

void JoinedMeshes::moveTo(MeshFile& file, const MeshReadOptions& options) && {
    if (!haveNormals_) mesh_.normals.clear();
    file.mesh = std::move(mesh_);
    if (options.keepsPointArrays && haveColors_ && !colors_.empty()) {
        file.pointArrays.push_back({"RGB", std::move(colors_)});
    }
    if (solids_.size() < 2) return;
    file.warnings.push_back({"several-solids", "it holds " + std::to_string(solids_.size()) +
                                                   " meshes, read as one surface; adaptiso-check "
                                                   "looks at each by itself where all are closed"});
    file.solids = std::move(solids_);
}

bool isIdentity(const AffineTransform& transform) {
    constexpr double kRounding = 1e-12;
    for (int axis = 0; axis < 3; ++axis) {
        for (int row = 0; row < 3; ++row) {
            const double due = axis == row ? 1 : 0;
            if (!(std::abs(transform.linear.column[axis][row] - due) <= kRounding)) return false;
        }
        if (!(std::abs(transform.offset[axis]) <= kRounding)) return false;
    }
    return true;
}

}  // namespace adaptiso::meshio
