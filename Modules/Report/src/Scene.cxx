#include "Scene.h"

#include <algorithm>
#include <utility>

namespace adaptiso {

namespace {

void extendByImage(BoundingBox& box, const ImageGeometry& image) {
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 index{corner & 1 ? static_cast<double>(image.size[0] - 1) : 0.0,
                         corner & 2 ? static_cast<double>(image.size[1] - 1) : 0.0,
                         corner & 4 ? static_cast<double>(image.size[2] - 1) : 0.0};
        box.add(lpsToRas(image.toPhysical(index)));
    }
}

BoundingBox boxOf(const Scene& scene, const Report& report) {
    auto box = BoundingBox::empty();
    for (const SceneSurface& surface : scene.surfaces) {
        if (surface.mesh.isEmpty()) continue;
        box.add(boxOf(surface.mesh));
    }
    if (box.isEmpty() && report.volume) {
        extendByImage(box, report.volume->view.geometry());
    }
    return box.isEmpty() ? BoundingBox{{-1, -1, -1}, {1, 1, 1}} : box;
}

Vec3 between(const Vec3& a, const Vec3& b, int axis, double atMm) {
    const double part = (atMm - a[axis]) / (b[axis] - a[axis]);
    Vec3 p = a + part * (b - a);
    p[axis] = atMm;
    return p;
}

}  // namespace

bool Scene::hasTriangles() const {
    return std::any_of(surfaces.begin(), surfaces.end(),
                       [](const SceneSurface& surface) { return !surface.mesh.isEmpty(); });
}

namespace {

void leaveOutFace(const Report& report, Scene& scene) {
    std::vector<SceneMesh> meshes;
    for (const SceneSurface& surface : scene.surfaces) meshes.push_back(surface.mesh);
    scene.face = std::make_shared<const FaceCut>(report, meshes);
    for (std::size_t n = 0; n < meshes.size(); ++n) {
        if (report.surfaces[n].isWithinSkull) continue;
        scene.surfaces[n].mesh.leaveOut([&](const Triangle& t) {
            return std::any_of(t.begin(), t.end(),
                               [&](VertexId v) { return scene.face->hides(meshes[n].point(v)); });
        });
    }
}

}  // namespace

Scene makeScene(const Report& report) {
    Scene scene;
    scene.isFrameSaid = report.frame != kUnsaidFrame;
    double largest = 0;  // NaN never is
    for (const ReportSurface& given : report.surfaces) {
        SceneSurface surface;
        surface.name = given.name;
        surface.color = given.color.value_or(surfaceColor(scene.surfaces.size()));
        surface.mesh = SceneMesh::of(given.mesh);
        surface.triangles = std::ssize(given.mesh.triangles);
        surface.areMarks = given.areMarks;
        if (given.valuesMm.size() == given.mesh.points.size()) surface.valuesMm = given.valuesMm;
        for (const double value : surface.valuesMm) largest = std::max(largest, value);
        scene.surfaces.push_back(std::move(surface));
    }
    for (SceneSurface& surface : scene.surfaces) {
        surface.largestValueMm = largest;
        surface.valuesAre = report.valuesAre;
    }
    for (const ReportSpot& spot : report.spots) {
        if (isFinite(spot.pointMm)) {
            scene.spots.push_back({spot.what, lpsToRas(spot.pointMm), spot.isFailure});
        }
    }
    if (report.leavesOutFaces) leaveOutFace(report, scene);
    scene.box = boxOf(scene, report);
    return scene;
}

std::vector<Segment> cutByPlane(const SceneMesh& mesh, int axis, double atMm) {
    std::vector<Segment> segments;
    mesh.forEachTriangle([&](const Triangle& t) {
        const Vec3 corners[3]{mesh.point(t[0]), mesh.point(t[1]), mesh.point(t[2])};
        Segment segment;
        std::size_t found = 0;
        for (int n = 0; n < 3; ++n) {
            const Vec3 &a = corners[n], &b = corners[(n + 1) % 3];
            if ((a[axis] >= atMm) == (b[axis] >= atMm)) continue;
            segment[found++] = between(a, b, axis, atMm);
        }
        if (found == 2) segments.push_back(segment);
    });
    return segments;
}

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
