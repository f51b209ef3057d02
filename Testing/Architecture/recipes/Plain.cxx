// A mesh format for recipes.py: counts, points and triangles in lines of text.
#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"

namespace adaptiso::meshio {
namespace {

bool isPlain(std::string_view head, std::uint64_t /*byteCount*/) {
    return firstLine(head).starts_with("plain mesh");
}

MeshFile decodePlain(std::string_view bytes, const MeshReadOptions& options) {
    ByteSource source(bytes);
    FrameMarks marks(options);
    marks.addText(source.line());
    MeshFile file;
    const std::int64_t points = source.integerWord("the number of points");
    const std::int64_t triangles = source.integerWord("the number of triangles");
    requireRoom("points", points, 6, source.left());  // "0 0 0\n"
    requireRoom("triangles", triangles, 6, source.left());
    file.mesh.points.resize(points);
    for (Vec3& p : file.mesh.points) {
        for (int axis = 0; axis < 3; ++axis) p[axis] = source.realWord("a coordinate");
    }
    file.mesh.triangles.resize(triangles);
    for (Triangle& t : file.mesh.triangles) {
        for (VertexId& vertex : t) vertex = source.integerWord("a triangle's vertex");
    }
    requireNoMoreText({"triangles", triangles, 3}, source.rest(), file.warnings);
    file.frame = marks.frame();
    return file;
}

void encodePlain(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    sink << "plain mesh, " << headerLine(record.options) << "\n";
    sink << static_cast<std::int64_t>(mesh.points.size()) << " "
         << static_cast<std::int64_t>(mesh.triangles.size()) << "\n";
    for (const Vec3& p : mesh.points) sink << p.x << " " << p.y << " " << p.z << "\n";
    for (const Triangle& t : mesh.triangles) sink << t[0] << " " << t[1] << " " << t[2] << "\n";
}

}  // namespace

extern const Codec kPlainCodec{isPlain, decodePlain, encodePlain};

}  // namespace adaptiso::meshio
