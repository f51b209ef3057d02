// OpenMEEG .tri: "- V", V lines "x y z nx ny nz", "- T T T", T lines "i j k" from 0. Normals are
// part of the format: a reader given three numbers a line takes garbage for the rest.

#include "Bytes.h"
#include "Codecs.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {

namespace {

void requireDash(ByteSource& source, std::string_view what) {
    const std::string_view dash = source.requireWord("'-'");
    if (dash != "-" && what == "points" &&
        dash.find_first_not_of("0123456789") == std::string_view::npos) {
        unsupported(
            "it begins with a number, as FreeSurfer's .tri does, not with '-' as OpenMEEG's",
            "convert it, e.g. with mris_convert");
    }
    if (dash != "-") {
        malformed("the number of " + std::string(what) + " follows " + printable(dash) +
                  ", must follow '-'");
    }
}

}  // namespace

void encodeOpenMeeg(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    const std::vector<Normal> normals =
        mesh.normals.empty() ? areaWeightedNormals(mesh) : mesh.normals;
    sink << "- " << static_cast<std::int64_t>(mesh.points.size()) << "\n";
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec3& p = mesh.points[i];
        const Normal& n = normals[i];
        sink << p.x << " " << p.y << " " << p.z << " " << double{n.x} << " " << double{n.y} << " "
             << double{n.z} << "\n";
    }
    const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
    sink << "- " << triangles << " " << triangles << " " << triangles << "\n";
    for (const Triangle& t : mesh.triangles) {
        sink << t[0] << " " << t[1] << " " << t[2] << "\n";
    }
}

MeshFile decodeOpenMeeg(std::string_view bytes) {
    ByteSource source(bytes);
    MeshFile file;
    requireDash(source, "points");
    const std::int64_t points = source.integerWord("the number of points");
    requireRoom("points", points, 12, source.left());  // at least "0 0 0 0 0 0\n"
    file.mesh.points.resize(points);
    file.mesh.normals.resize(points);
    for (std::int64_t i = 0; i < points; ++i) {
        Vec3 normal;
        for (int axis = 0; axis < 3; ++axis) {
            file.mesh.points[i][axis] = source.realWord("a coordinate");
        }
        for (int axis = 0; axis < 3; ++axis) normal[axis] = source.realWord("a normal");
        file.mesh.normals[i] = storedNormal(normal);
    }
    requireDash(source, "triangles");
    const std::int64_t triangles = source.integerWord("the number of triangles");
    for (int repeat = 0; repeat < 2; ++repeat) {
        if (source.integerWord("the number of triangles") != triangles) {
            malformed("the three numbers of triangles differ");
        }
    }
    requireRoom("triangles", triangles, 6, source.left());  // at least "\n0 0 0"
    file.mesh.triangles.resize(triangles);
    for (Triangle& t : file.mesh.triangles) {
        for (VertexId& vertex : t) vertex = source.integerWord("a triangle's vertex");
    }
    return file;
}

}  // namespace adaptiso::meshio

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
