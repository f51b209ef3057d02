#include "adaptiso/Core/TriangleMesh.h"

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

double surfaceArea(const TriangleMesh& mesh) {
    double area2 = 0;
    for (const Triangle& t : mesh.triangles) {
        area2 += norm(areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
    }
    return area2 / 2;
}

double enclosedVolume(const TriangleMesh& mesh) {
    if (mesh.points.empty()) return 0;
    const Vec3 apex = mesh.points.front();  // near the surface: less cancellation than at 0, 0, 0
    double volume6 = 0;
    for (const Triangle& t : mesh.triangles) {
        volume6 += dot(mesh.points[t[0]] - apex,
                       cross(mesh.points[t[1]] - apex, mesh.points[t[2]] - apex));
    }
    return volume6 / 6;
}

BoundingBox boundingBox(const TriangleMesh& mesh) {
    if (mesh.points.empty()) throw InvalidInput("the mesh has no point");
    BoundingBox box{mesh.points.front(), mesh.points.front()};
    for (const Vec3& p : mesh.points) box.add(p);
    return box;
}

void flipOrientation(TriangleMesh& mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    for (Normal& n : mesh.normals) n = {-n.x, -n.y, -n.z};
}

}  // namespace adaptiso
