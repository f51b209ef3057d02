// STL. Binary: 80 bytes of header, uint32 count, 50 bytes a triangle (float32 normal, three
// corners, uint16 count of attribute bytes, which follow it), little endian. Programs put a colour
// in place of that count (VisCAM, SolidView, Materialise Magics). Text ("solid ...") is read, not
// written.
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "adaptiso/Core/Surplus.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::meshio {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;

/// The bits of a corner's three float coordinates: equal where the coordinates are equal numbers.
using Corner = std::array<std::uint32_t, 3>;

std::uint32_t coordinateBits(float c) {
    return std::bit_cast<std::uint32_t>(c + 0.0f);  // -0 becomes +0: equal numbers, equal bits
}

/// The mesh of triangles given as three corners each: corners with equal coordinates become one
/// vertex, numbered by first use. By sorting: there are files that make any fixed hash slow.
TriangleMesh welded(const std::vector<Corner>& corners) {
    struct Use {
        Corner corner;
        std::int64_t number;
        bool operator<(const Use& other) const {
            return corner != other.corner ? corner < other.corner : number < other.number;
        }
    };
    std::vector<Use> uses;
    uses.reserve(corners.size());
    for (const Corner& corner : corners) {
        uses.push_back({corner, static_cast<std::int64_t>(uses.size())});
    }
    std::sort(uses.begin(), uses.end());
    std::vector<std::int64_t> firstUse(corners.size());
    for (std::size_t i = 0; i < uses.size(); ++i) {
        const bool isFirst = i == 0 || uses[i].corner != uses[i - 1].corner;
        firstUse[uses[i].number] = isFirst ? uses[i].number : firstUse[uses[i - 1].number];
    }

    TriangleMesh mesh;
    mesh.triangles.resize(corners.size() / 3);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const std::size_t first = firstUse[i];
        VertexId& vertex = mesh.triangles[i / 3][i % 3];
        if (first == i) {
            vertex = static_cast<VertexId>(mesh.points.size());
            const auto coordinate = [&](int axis) {
                return std::bit_cast<float>(corners[i][axis]);
            };
            mesh.points.push_back({coordinate(0), coordinate(1), coordinate(2)});
        } else {
            vertex = mesh.triangles[first / 3][first % 3];
        }
    }
    return mesh;
}

/// The point as the file keeps it: the normal follows from what readers see.
Vec3 rounded(const Vec3& p) {
    // volatile: GCC 12 at -O2 drops vectorized double -> float -> double conversions
    const volatile float x = static_cast<float>(p.x), y = static_cast<float>(p.y),
                         z = static_cast<float>(p.z);
    return {x, y, z};
}

void encodeVec(const Vec3& v, ByteSink& sink) {
    for (int axis = 0; axis < 3; ++axis) sink.littleEndian(static_cast<float>(v[axis]));
}

std::uint16_t attributeOf(std::string_view record) {
    return loadAs<std::uint16_t>(record.data() + kTriangleBytes - sizeof(std::uint16_t),
                                 std::endian::little);
}

/// True if each triangle is followed by as many bytes as its attribute counts: such records end
/// where the file does, or before it.
bool haveAttributeBytes(ByteSource source, std::int64_t count) {
    const std::size_t all = source.left();
    if (all <= kTriangleBytes * static_cast<std::size_t>(count)) return false;
    for (std::int64_t i = 0; i < count; ++i) {
        if (source.left() < kTriangleBytes) return false;
        const std::size_t more = attributeOf(source.take(kTriangleBytes));
        if (source.left() < more) return false;
        source.take(more);
    }
    const bool isLonger = all - source.left() > kTriangleBytes * static_cast<std::size_t>(count);
    return isLonger && source.left() < kTriangleBytes;
}

/// True if the bytes are headers, each with the triangles that it counts.
bool areWholeFiles(ByteSource source) {
    while (source.left() >= kHeaderBytes + sizeof(std::uint32_t)) {
        source.take(kHeaderBytes);
        const auto count = source.number<std::uint32_t>(std::endian::little);
        if (count == 0 || source.left() / kTriangleBytes < count) return false;
        source.take(kTriangleBytes * std::size_t{count});
    }
    return source.atEnd();
}

MeshFile decodeBinary(ByteSource source, FrameMarks marks) {
    MeshFile file;
    marks.addText(source.take(kHeaderBytes));
    file.frame = marks.frame();
    Counted triangles{"triangles", source.number<std::uint32_t>(std::endian::little),
                      kTriangleBytes};
    const auto there = static_cast<std::int64_t>(source.left() / kTriangleBytes);
    if (isUnset(triangles.count) && there > 0 && !areZeros(source.rest())) {
        setToThere(triangles, there, file.warnings);
    }
    requireRoom(triangles.what, triangles.count, kTriangleBytes, source.left());
    const bool hasMore = haveAttributeBytes(source, triangles.count);
    std::int64_t attributes = 0;
    std::vector<Corner> corners(static_cast<std::size_t>(3 * triangles.count));
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const std::string_view bytes = source.take(kTriangleBytes);
        ByteSource record(bytes);
        record.take(3 * sizeof(float));  // the normal follows from the corners
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::uint32_t& bits : corners[i + k]) {
                bits = coordinateBits(record.number<float>(std::endian::little));
            }
        }
        if (attributeOf(bytes) != 0) ++attributes;
        if (hasMore) source.take(attributeOf(bytes));
    }
    const std::string_view rest = source.rest();
    constexpr std::size_t kBegin = kHeaderBytes + sizeof(std::uint32_t);
    const bool isHeaderAndTriangles =
        rest.size() >= kBegin && (rest.size() - kBegin) % kTriangleBytes == 0;
    if ((isHeaderAndTriangles && !areZeros(rest)) ||
        (!rest.empty() && areWholeFiles(ByteSource(rest))))
        refuseSecondFile(triangles, "STL");
    requireNoMore(triangles, rest, file.warnings);
    if (attributes > 0) {
        file.warnings.push_back({"attributes-left-out",
                                 std::to_string(attributes) + " triangles have " +
                                     (hasMore ? "bytes of attributes behind them"
                                              : "a colour or a number of their own (attribute)") +
                                     ", which were left out"});
    }
    file.mesh = welded(corners);
    return file;
}

constexpr std::int64_t kTextNumbers = 12;  // of a triangle

bool beginsSolid(std::string_view text) {
    return lowerCase(trimmed(text.substr(0, kHeaderBytes))).starts_with("solid");
}

/// \param firstTriangles  of the solids with triangles until now, as MeshFile has them
void beginSolid(std::vector<std::int64_t>& firstTriangles, std::int64_t triangles) {
    if (firstTriangles.empty() && triangles > 0) firstTriangles.push_back(0);
    if (firstTriangles.empty() || firstTriangles.back() != triangles) {
        firstTriangles.push_back(triangles);
    }
}

MeshFile decodeText(ByteSource source, FrameMarks marks) {
    MeshFile file;
    std::vector<Corner> corners;
    std::size_t loop = 0;  // corners of the facet at this place
    bool isOpen = false;   // inside a solid
    for (std::string word = lowerCase(source.word()); !word.empty();
         word = lowerCase(source.word())) {
        if (word == "solid" || word == "endsolid") {
            isOpen = word == "solid";
            if (isOpen) beginSolid(file.solids, std::ssize(corners) / 3);
            const std::size_t begin = source.position();
            std::string_view name = source.line();
            if (const std::size_t facet = lowerCase(name).find("facet normal");
                facet != std::string::npos) {  // all in one line
                name = name.substr(0, facet);
                source.seek(begin + facet);
            }
            marks.addText(name);
            if (isOpen || beginsSolid(source.rest())) continue;
            requireNoMoreText({"triangles", std::ssize(corners) / 3, kTextNumbers}, source.rest(),
                              file.warnings);
            break;
        } else if (word == "vertex") {
            if (loop++ == 3) {
                unsupported("a facet has more than 3 corners", "save it as PLY or OBJ");
            }
            for (std::uint32_t& bits : corners.emplace_back()) {
                bits = coordinateBits(toFloat(source.realWord("a coordinate"), "a coordinate"));
            }
        } else if (word == "endloop") {
            if (loop != 3) malformed("a facet has " + std::to_string(loop) + " corners");
            loop = 0;
        }
    }
    if (loop != 0) damaged("it ends inside a facet");
    if (isOpen) {
        unsupported("it ends without the word 'endsolid'",
                    "it may be cut off: get it again, or add that line at its end if it is whole");
    }
    if (!file.solids.empty() && file.solids.back() == std::ssize(corners) / 3) {
        file.solids.pop_back();  // without triangles
    }
    if (file.solids.size() > 1) {
        file.warnings.push_back(
            {"several-solids", "it holds " + std::to_string(file.solids.size()) +
                                   " solids, read as one surface; adaptiso-check looks at each by "
                                   "itself where all are closed"});
    } else {
        file.solids.clear();
    }
    file.frame = marks.frame();
    file.mesh = welded(corners);
    return file;
}

/// Programs write binary files with headers that begin with "solid", and text that begins with
/// "SOLID" or a blank line: recognised by the size, and by zero bytes, which no text has.
bool looksBinary(std::string_view bytes) {
    if (bytes.size() >= kHeaderBytes + 4) {
        const auto count = loadAs<std::uint32_t>(bytes.data() + kHeaderBytes, std::endian::little);
        if (bytes.size() == kHeaderBytes + 4 + kTriangleBytes * std::uint64_t{count}) return true;
    }
    constexpr std::size_t kLook = 1024;
    const std::string head = lowerCase(trimmed(withoutByteOrderMark(bytes.substr(0, kLook))));
    return !head.starts_with("solid") || head.find('\0') != std::string::npos;
}

void encodeStl(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    std::string header = slicerHeaderLine(record.options);
    header.resize(kHeaderBytes, ' ');
    sink << header;
    sink.littleEndian(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = rounded(mesh.points[t[0]]), b = rounded(mesh.points[t[1]]),
                   c = rounded(mesh.points[t[2]]);
        encodeVec(normalized(areaVector2(a, b, c)), sink);
        for (const Vec3& corner : {a, b, c}) encodeVec(corner, sink);
        sink.littleEndian(std::uint16_t{0});
    }
}

MeshFile decodeStl(std::string_view bytes, const MeshReadOptions& options) {
    const FrameMarks marks(options);
    return looksBinary(bytes) ? decodeBinary(ByteSource(bytes), marks)
                              : decodeText(ByteSource(withoutByteOrderMark(bytes)), marks);
}

bool isStl(std::string_view head, std::uint64_t byteCount) {
    constexpr std::size_t kBegin = kHeaderBytes + sizeof(std::uint32_t);
    if (head.size() >= kBegin) {
        const auto count = loadAs<std::uint32_t>(head.data() + kHeaderBytes, std::endian::little);
        if (count > 0 && byteCount == kBegin + kTriangleBytes * std::uint64_t{count}) return true;
    }
    const std::string text = lowerCase(trimmed(withoutByteOrderMark(head)));
    return text.starts_with("solid") && text.find("facet") != std::string::npos &&
           text.find('\0') == std::string::npos;
}

}  // namespace

extern const Codec kStlCodec{isStl, decodeStl, encodeStl, false};

}  // namespace adaptiso::meshio
