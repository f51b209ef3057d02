// .tri. OpenMEEG's: "- V", V lines "x y z nx ny nz", "- T T T", T lines "i j k" from 0. Normals are
// part of the format: a reader given three numbers a line takes garbage for the rest.

#include <cmath>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {

namespace {

constexpr double kMostCorner = 1e15;

void requireDash(ByteSource& source, std::string_view what) {
    const std::string_view dash = source.requireWord("'-'");
    if (dash != "-") {
        malformed("the number of " + std::string(what) + " follows " + printable(dash) +
                  ", must follow '-'");
    }
}

bool beginsWithNumber(std::string_view bytes) {
    const std::string_view text = trimmed(bytes);
    return !text.empty() && text.front() >= '0' && text.front() <= '9';
}

/// Lines of numbers, as many on each as on the first; one more than triples take is the line's own.
class NumberLines {
public:
    NumberLines(ByteSource& source, const char* what) : source_(source), what_(what) {
        ByteSource line(source.line());
        count_ = line.integerWord(what);
        requireRoom(what, count_, 6, source.left());  // at least "0 0 0\n"
    }

    std::int64_t count() const { return count_; }

    /// The first three.
    Vec3 next() {
        const std::string_view text = source_.line();
        ByteSource line(text);
        std::vector<double> numbers;
        while (!trimmed(text.substr(text.size() - line.left())).empty()) {
            numbers.push_back(line.realWord(what_));
        }
        if (perLine_ == 0) perLine_ = numbers.size();
        const std::size_t first = numbers.size() % 3 == 1 ? 1 : 0;
        if (numbers.size() != perLine_ || numbers.size() < 3) {
            malformed(std::string("a line of ") + what_ + " has " + std::to_string(numbers.size()) +
                      " numbers");
        }
        return {numbers[first], numbers[first + 1], numbers[first + 2]};
    }

private:
    ByteSource& source_;
    const char* what_;
    std::int64_t count_ = 0;
    std::size_t perLine_ = 0;
};

/// FreeSurfer's .tri, which MNE's tools write too: the number of points, a line "[i] x y z
/// [normal]" each, the number of triangles, a line "[i] a b c ..." each, from 1.
MeshFile decodeFreeSurferTri(std::string_view bytes) {
    ByteSource source(bytes);
    MeshFile file;
    NumberLines points(source, "points");
    for (std::int64_t n = 0; n < points.count(); ++n) file.mesh.points.push_back(points.next());
    NumberLines triangles(source, "triangles");
    for (std::int64_t n = 0; n < triangles.count(); ++n) {
        const Vec3 corners = triangles.next();
        Triangle& t = file.mesh.triangles.emplace_back();
        for (int corner = 0; corner < 3; ++corner) {
            const double number = corners[corner];
            if (!(number >= 1 && number < kMostCorner && number == std::floor(number))) {
                malformed("a triangle names no point");
            }
            t[corner] = static_cast<VertexId>(corners[corner]) - 1;
        }
    }
    requireNoMoreText({"triangles", triangles.count(), 3}, source.rest(), file.warnings);
    return file;
}

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

MeshFile decodeTri(std::string_view bytes) {
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
    requireNoMoreText({"triangles", triangles, 3}, source.rest(), file.warnings);
    return file;
}

/// Neither says a frame.
MeshFile decodeOpenMeeg(std::string_view bytes, const MeshReadOptions& options) {
    MeshFile file = beginsWithNumber(bytes) ? decodeFreeSurferTri(bytes) : decodeTri(bytes);
    file.frame = options.inputCoordinates;
    return file;
}

bool isOpenMeeg(std::string_view head, std::uint64_t /*byteCount*/) {
    ByteSource source(head);
    const bool hasDash = source.word() == "-";
    const std::string_view count = source.word();
    return hasDash && !count.empty() &&
           count.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

extern const Codec kOpenMeegCodec{isOpenMeeg, decodeOpenMeeg, encodeOpenMeeg};

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
