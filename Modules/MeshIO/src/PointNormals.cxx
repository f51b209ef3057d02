#include "adaptiso/MeshIO/PointNormals.h"

namespace adaptiso {

std::vector<Normal> areaWeightedNormals(const TriangleMesh& mesh) {
    std::vector<Vec3> sums(mesh.points.size());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 area = areaVector2(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
        for (const VertexId vertex : t) sums[vertex] += area;
    }
    std::vector<Normal> normals;
    normals.reserve(sums.size());
    for (const Vec3& sum : sums) normals.push_back(toNormal(sum));
    return normals;
}

}  // namespace adaptiso
