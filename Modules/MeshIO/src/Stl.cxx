// STL. Binary: 80 bytes of header, uint32 count, 50 bytes a triangle (float32 normal, three
// corners, uint16 attribute), little endian. Text ("solid ...") is read, not written.
#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "ByteSource.h"
#include "Codecs.h"

namespace adaptiso::meshio {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;

using Corner = std::array<float, 3>;

struct CornerHash {
    std::size_t operator()(const Corner& corner) const {
        std::uint64_t hash = 0;
        for (const float c : corner) {
            hash = (hash ^ std::bit_cast<std::uint32_t>(c)) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
        return hash;
    }
};

/// Gives corners with equal coordinates one vertex, numbered by first use.
class VertexMerger {
public:
    explicit VertexMerger(TriangleMesh& mesh) : mesh_(mesh) {}

    VertexId vertexOf(Corner corner) {
        for (float& c : corner) c += 0.0f;  // -0 becomes +0: equal numbers, equal bits
        const auto next = static_cast<VertexId>(mesh_.points.size());
        const auto [entry, isNew] = vertices_.try_emplace(corner, next);
        if (isNew) mesh_.points.push_back({corner[0], corner[1], corner[2]});
        return entry->second;
    }

private:
    TriangleMesh& mesh_;
    std::unordered_map<Corner, VertexId, CornerHash> vertices_;
};

void encodeVec(const Vec3& v, ByteSink& sink) {
    for (int axis = 0; axis < 3; ++axis) sink.littleEndian(static_cast<float>(v[axis]));
}

MeshFile decodeBinary(ByteSource source) {
    MeshFile file;
    file.frame = findFrameMarker(source.take(kHeaderBytes));
    const std::int64_t count = source.number<std::uint32_t>(std::endian::little);
    requireRoom("triangles", count, kTriangleBytes, source.left());
    file.mesh.triangles.resize(count);
    VertexMerger merger(file.mesh);
    for (Triangle& triangle : file.mesh.triangles) {
        ByteSource record(source.take(kTriangleBytes));
        record.take(3 * sizeof(float));  // the normal follows from the corners
        for (VertexId& vertex : triangle) {
            Corner corner;
            for (float& c : corner) c = record.number<float>(std::endian::little);
            vertex = merger.vertexOf(corner);
        }
    }
    return file;
}

MeshFile decodeText(ByteSource source) {
    MeshFile file;
    file.frame = findFrameMarker(source.line());
    VertexMerger merger(file.mesh);
    Triangle triangle{};
    int corners = 0;
    for (std::string_view word = source.word(); !word.empty(); word = source.word()) {
        if (lowerCase(word) == "vertex") {
            if (corners == 3) refusePolygon(4);
            Corner corner;
            for (float& c : corner) {
                c = toFloat(source.realWord("a coordinate"), "a coordinate");
            }
            triangle[corners++] = merger.vertexOf(corner);
        } else if (lowerCase(word) == "endloop") {
            if (corners != 3) damaged("a facet has " + std::to_string(corners) + " corners");
            file.mesh.triangles.push_back(triangle);
            corners = 0;
        }
    }
    if (corners != 0) damaged("it ends inside a facet");
    return file;
}

bool looksBinary(std::string_view bytes) {
    if (!bytes.starts_with("solid")) return true;
    if (bytes.size() < kHeaderBytes + 4) return false;
    const auto count = loadAs<std::uint32_t>(bytes.data() + kHeaderBytes, std::endian::little);
    return bytes.size() == kHeaderBytes + 4 + kTriangleBytes * std::uint64_t{count};
}

}  // namespace

void encodeStl(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    std::string header = headerLine(record.options.frame);
    header.resize(kHeaderBytes, ' ');
    sink << header;
    sink.littleEndian(static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        encodeVec(normalized(areaVector2(a, b, c)), sink);
        for (const Vec3& corner : {a, b, c}) encodeVec(corner, sink);
        sink.littleEndian(std::uint16_t{0});
    }
}

MeshFile decodeStl(std::string_view bytes) {
    return looksBinary(bytes) ? decodeBinary(ByteSource(bytes)) : decodeText(ByteSource(bytes));
}

}  // namespace adaptiso::meshio
