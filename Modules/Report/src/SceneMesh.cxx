#include "SceneMesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace adaptiso {
namespace {

bool isFinite(const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

SceneMesh::SceneMesh(std::shared_ptr<const TriangleMesh> lps)
    : lps_(std::move(lps)), count_(std::ssize(lps_->triangles)) {
    const auto isBroken = [&](const Triangle& t) {
        return std::any_of(t.begin(), t.end(), [&](VertexId v) {
            return v < 0 || v >= pointCount() || !isFinite(lps_->points[v]);
        });
    };
    if (std::any_of(lps_->triangles.begin(), lps_->triangles.end(), isBroken)) leaveOut(isBroken);
}

SceneMesh::SceneMesh(TriangleMesh lps)
    : SceneMesh(std::make_shared<const TriangleMesh>(std::move(lps))) {}

SceneMesh SceneMesh::of(const TriangleMesh& lps) {
    return SceneMesh(std::shared_ptr<const TriangleMesh>(std::shared_ptr<const void>{}, &lps));
}

void SceneMesh::keepAllBut(std::vector<bool> left) {
    count_ = std::count(left.begin(), left.end(), false);
    left_ = std::make_shared<const std::vector<bool>>(std::move(left));
}

BoundingBox boxOf(const SceneMesh& mesh) {
    auto box = BoundingBox::empty();
    mesh.forEachTriangle([&](const Triangle& t) {
        for (const VertexId v : t) box.add(mesh.point(v));
    });
    return box;
}

double surfaceArea(const SceneMesh& mesh) {
    double area = 0;
    mesh.forEachTriangle([&](const Triangle& t) {
        area += 0.5 * norm(areaVector2(mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2])));
    });
    return area;
}

}  // namespace adaptiso
