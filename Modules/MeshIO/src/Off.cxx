// OFF: "OFF", "V T 0", V lines "x y z", T lines "3 a b c" from 0; '#' begins a comment. With "COFF"
// points have colours, "x y z r g b a": whole numbers to 255, or with a decimal point, 0 to 1.
// "NOFF", "STOFF", "CNOFF" and "STCNOFF": what follows x y z is passed over.
#include "ByteSource.h"
#include "Codecs.h"
#include "PointColors.h"

namespace adaptiso::meshio {
namespace {

/// Lines without their comments, empty ones left out; keeps the frame that a comment names.
class OffLines {
public:
    OffLines(std::string_view bytes, const MeshReadOptions& options)
        : marks(options), source_(bytes) {}

    ByteSource next(std::string_view what) {
        while (!source_.atEnd()) {
            const std::string_view line = source_.line();
            const std::size_t comment = findComment(line);
            if (comment != std::string_view::npos) marks.addText(line.substr(comment));
            const std::string_view content = trimmed(line.substr(0, comment));
            if (!content.empty()) return ByteSource(content);
        }
        damaged("it ends where " + std::string(what) + " is due");
    }
    std::size_t left() const { return source_.left(); }

    FrameMarks marks;

private:
    ByteSource source_;
};

}  // namespace

void encodeOff(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    const std::vector<Color>* const colors = colorsOf(record.options);
    sink << (colors != nullptr ? "COFF" : "OFF") << "\n# " << headerLine(record.options) << "\n";
    sink << static_cast<std::int64_t>(mesh.points.size()) << " "
         << static_cast<std::int64_t>(mesh.triangles.size()) << " 0\n";
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec3& p = mesh.points[i];
        sink << p.x << " " << p.y << " " << p.z;
        if (colors != nullptr) {
            for (const std::uint8_t shade : (*colors)[i]) sink << " " << std::int64_t{shade};
            sink << " 255";
        }
        sink << "\n";
    }
    for (const Triangle& t : mesh.triangles) {
        sink << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    }
}

MeshFile decodeOff(std::string_view bytes, const MeshReadOptions& options) {
    OffLines lines(bytes, options);
    ByteSource line = lines.next("the word OFF");
    const std::string_view magic = line.word();
    const bool isOff =
        magic.ends_with("OFF") && magic.find_first_not_of("STCNOF") == std::string_view::npos;
    if (!isOff || lowerCase(ByteSource(line.rest()).word()) == "binary") {
        unsupported("it begins with " + printable(std::string(magic) + std::string(line.rest())) +
                        ", must begin with OFF or COFF",
                    "save it as plain OFF text");
    }
    const bool hasColors = magic == "COFF";
    if (trimmed(line.rest()).empty()) line = lines.next("the number of points");
    const std::int64_t points = line.integerWord("the number of points");
    const std::int64_t triangles = line.integerWord("the number of faces");
    requireRoom("points", points, 5, lines.left());    // at least "0 0 0"
    requireRoom("faces", triangles, 7, lines.left());  // at least "3 0 0 0"

    MeshFile file;
    PointColors colors(options.keepsPointArrays && hasColors);
    file.mesh.points.resize(points);
    for (Vec3& p : file.mesh.points) {
        line = lines.next("a point");
        for (int axis = 0; axis < 3; ++axis) p[axis] = line.realWord("a coordinate");
        colors.add(line, ColorScale::Byte);
    }
    file.pointArrays = colors.take(file.mesh.points.size());
    file.mesh.triangles.resize(triangles);
    for (Triangle& t : file.mesh.triangles) {
        line = lines.next("a face");
        const std::int64_t corners = line.integerWord("the number of corners");
        if (corners != 3) refusePolygon(corners);
        for (VertexId& vertex : t) vertex = line.integerWord("a face's vertex");
    }
    file.frame = lines.marks.frame();
    return file;
}

}  // namespace adaptiso::meshio
