#include "adaptiso-giant/PieceFile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "Common/Sha256.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Tiles.h"

namespace adaptiso::giant {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "pieces are little-endian");

constexpr std::string_view kMagic = "ADAPTPC2";
constexpr std::size_t kSumBytes = 64;
constexpr std::uint64_t kLongestHeader = 1 << 16;
static_assert(sizeof(PieceComponent) == 32 && sizeof(BorderVertex) == 32 && sizeof(Vec3) == 24 &&
              sizeof(Normal) == 12);  // no gaps between what is written

[[noreturn]] void refusePiece(const std::string& name, const std::string& what) {
    throw FileError(name + ": is damaged (" + what + "); remove it, and run its step again");
}

/// Appends rows as memory has them.
template <class Row>
void put(std::string& bytes, const std::vector<Row>& rows) {
    static_assert(std::is_trivially_copyable_v<Row>);
    bytes.append(reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(Row));
}

/// Appends the SHA-256 of the bytes from `begin` on.
void putSum(std::string& bytes, std::size_t begin) {
    bytes += sha256Of(std::string_view(bytes).substr(begin));
}

Json headerOf(const PieceSummary& summary) {
    return {{"plan", summary.plan},
            {"stage", summary.stage},
            {"id", summary.id},
            {"inputs", summary.inputs},
            {"errorBoundMm", summary.errorBoundMm},
            {"unchanged", summary.isUnchanged},
            {"points", summary.points},
            {"triangles", summary.triangles},
            {"components", summary.components.size()},
            {"borderVertices", summary.border.size()},
            {"borderEdges", summary.borderEdges.size()}};
}

/// Reads bytes in order; nothing lies beyond their end.
class PieceReader {
public:
    PieceReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    /// Rows as memory has them. \pre  checked: there is room for them
    template <class Row>
    std::vector<Row> take(std::uint64_t count) {
        std::vector<Row> rows(static_cast<std::size_t>(count));
        const std::string_view bytes = takeBytes(rows.size() * sizeof(Row));
        if (!bytes.empty()) std::memcpy(rows.data(), bytes.data(), bytes.size());
        return rows;
    }
    std::string_view takeBytes(std::size_t count) {
        if (count > bytes_.size() - at_) refusePiece(name_, "truncated");
        const std::string_view taken = bytes_.substr(at_, count);
        at_ += count;
        return taken;
    }
    void requireFinite(double sum) const {
        if (!std::isfinite(sum)) refusePiece(name_, "a number is not finite");
    }
    void requireBelow(std::uint64_t number, std::uint64_t count) const {
        if (number >= count) refusePiece(name_, "a number is out of range");
    }
    /// \pre the bytes from `begin` up to here are those summed
    void checkSum(std::size_t begin) {
        const std::string_view summed = bytes_.substr(begin, at_ - begin);
        if (takeBytes(kSumBytes) != sha256Of(summed)) refusePiece(name_, "checksum");
    }

    std::size_t at() const { return at_; }
    std::size_t left() const { return bytes_.size() - at_; }
    const std::string& name() const { return name_; }

private:
    std::string_view bytes_;
    const std::string& name_;
    std::size_t at_ = 0;
};

/// Numbers of rows behind the header, by kind.
struct Counts {
    std::uint64_t components, border, edges, points, triangles;

    std::uint64_t summaryBytes() const {
        return components * sizeof(PieceComponent) + border * sizeof(BorderVertex) +
               edges * sizeof(std::array<std::uint32_t, 2>);
    }
    std::uint64_t meshBytes() const {
        return points * (sizeof(Vec3) + sizeof(Normal)) +
               triangles * sizeof(std::array<std::uint32_t, 3>);
    }
};

/// \param fileBytes  of the whole file, which has room for all that the header counts
Counts takeHeader(PieceReader& reader, std::uint64_t fileBytes, PieceSummary& summary) {
    const std::string& name = reader.name();
    if (reader.left() < kMagic.size() || reader.takeBytes(kMagic.size()) != kMagic) {
        refusePiece(name, "no piece of adaptiso-giant");
    }
    const auto length = reader.take<std::uint64_t>(1).front();
    if (length > kLongestHeader) refusePiece(name, "header");
    try {
        const auto header = parseJson<Json>(reader.takeBytes(static_cast<std::size_t>(length)));
        const auto count = [&](const char* key) {
            const auto value = header.at(key).get_ref<const Json::number_unsigned_t&>();
            if (value > fileBytes) refusePiece(name, key);
            return value;
        };
        header.at("plan").get_to(summary.plan);
        header.at("stage").get_to(summary.stage);
        header.at("id").get_to(summary.id);
        header.at("inputs").get_to(summary.inputs);
        header.at("errorBoundMm").get_to(summary.errorBoundMm);
        header.at("unchanged").get_to(summary.isUnchanged);
        const Counts counts{count("components"), count("borderVertices"), count("borderEdges"),
                            count("points"), count("triangles")};
        if (reader.at() + counts.summaryBytes() + counts.meshBytes() + 2 * kSumBytes != fileBytes) {
            refusePiece(name, "truncated");
        }
        summary.points = static_cast<std::int64_t>(counts.points);
        summary.triangles = static_cast<std::int64_t>(counts.triangles);
        return counts;
    } catch (const Json::exception&) {
        refusePiece(name, "header");
    }
}

void takeSummary(PieceReader& reader, const Counts& counts, PieceSummary& summary) {
    summary.components = reader.take<PieceComponent>(counts.components);
    summary.border = reader.take<BorderVertex>(counts.border);
    summary.borderEdges = reader.take<std::array<std::uint32_t, 2>>(counts.edges);
    reader.checkSum(0);
    for (const PieceComponent& component : summary.components) {
        reader.requireFinite(component.areaMm2 + component.volumeMm3);
        reader.requireBelow(static_cast<std::uint64_t>(component.triangles), counts.triangles + 1);
        reader.requireBelow(static_cast<std::uint64_t>(component.innerVertices), counts.points + 1);
    }
    for (const BorderVertex& vertex : summary.border) {
        reader.requireBelow(vertex.vertex, counts.points);
        reader.requireBelow(vertex.component, counts.components);
        reader.requireFinite(vertex.index.x + vertex.index.y + vertex.index.z);
    }
    for (const auto& [a, b] : summary.borderEdges) {
        reader.requireBelow(std::max(a, b), counts.border);
    }
}

std::string bytesOf(const std::filesystem::path& file, std::uint64_t begin, std::uint64_t count) {
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(static_cast<std::size_t>(count), '\0');
    stream.seekg(static_cast<std::streamoff>(begin));
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream) throw FileError(file.string() + ": can't be read; run its step again");
    return bytes;
}

std::uint64_t sizeOf(const std::filesystem::path& file) {
    requireIn(file, file.parent_path());
    std::error_code error;  // also for pipes and devices
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) throw FileError(file.string() + ": is not there; run its step");
    return size;
}

}  // namespace

void summarize(const TriangleMesh& mesh, const ImageGeometry& geometry, PieceSummary& summary) {
    const TriangleMesh physical = physicalMesh(mesh, geometry);
    const Vec3 middle = geometry.toPhysical({0.5 * static_cast<double>(geometry.size[0]),
                                             0.5 * static_cast<double>(geometry.size[1]),
                                             0.5 * static_cast<double>(geometry.size[2])});
    const ComponentLabels labels = labelComponents(mesh);
    summary.points = std::ssize(mesh.points);
    summary.triangles = std::ssize(mesh.triangles);
    summary.components.assign(static_cast<std::size_t>(labels.count), {});
    for (const Triangle& t : physical.triangles) {
        PieceComponent& component = summary.components[labels.ofVertex[t[0]]];
        const Vec3 a = physical.points[t[0]] - middle, b = physical.points[t[1]] - middle,
                   c = physical.points[t[2]] - middle;
        ++component.triangles;
        component.areaMm2 += 0.5 * norm(areaVector2(a, b, c));
        component.volumeMm3 += dot(a, cross(b, c)) / 6;
    }
    for (const std::int64_t label : labels.ofVertex) ++summary.components[label].innerVertices;
    const BorderEdges border = borderOf(mesh);
    std::unordered_map<VertexId, std::uint32_t> place;
    for (const VertexId v : border.vertices) {
        place[v] = static_cast<std::uint32_t>(summary.border.size());
        summary.border.push_back({static_cast<std::uint32_t>(v),
                                  static_cast<std::uint32_t>(labels.ofVertex[v]), mesh.points[v]});
        --summary.components[labels.ofVertex[v]].innerVertices;
    }
    for (const auto& [a, b] : border.edges) summary.borderEdges.push_back({place[a], place[b]});
}

std::string encodePiece(const Piece& piece) {
    const PieceSummary& summary = piece.summary;
    const std::string header = headerOf(summary).dump();
    std::string bytes(kMagic);
    std::vector<std::array<std::uint32_t, 3>> corners;
    corners.reserve(piece.mesh.triangles.size());
    for (const auto& [a, b, c] : piece.mesh.triangles) {
        corners.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                           static_cast<std::uint32_t>(c)});
    }
    put(bytes, std::vector<std::uint64_t>{header.size()});
    bytes += header;
    put(bytes, summary.components);
    put(bytes, summary.border);
    put(bytes, summary.borderEdges);
    putSum(bytes, 0);
    const std::size_t begin = bytes.size();
    put(bytes, piece.mesh.points);
    put(bytes, piece.mesh.normals);
    put(bytes, corners);
    putSum(bytes, begin);
    return bytes;
}

Piece decodePiece(std::string_view bytes, const std::string& name) {
    PieceReader reader(bytes, name);
    Piece piece;
    const Counts counts = takeHeader(reader, bytes.size(), piece.summary);
    takeSummary(reader, counts, piece.summary);
    const std::size_t begin = reader.at();
    TriangleMesh& mesh = piece.mesh;
    mesh.points = reader.take<Vec3>(counts.points);
    mesh.normals = reader.take<Normal>(counts.points);
    for (const auto& [a, b, c] : reader.take<std::array<std::uint32_t, 3>>(counts.triangles)) {
        reader.requireBelow(std::max({a, b, c}), counts.points);
        mesh.triangles.push_back({a, b, c});
    }
    reader.checkSum(begin);
    for (const Vec3& p : mesh.points) reader.requireFinite(p.x + p.y + p.z);
    for (const Normal& n : mesh.normals) reader.requireFinite(n.x + n.y + n.z);
    return piece;
}

Piece readPiece(const std::filesystem::path& file) {
    return decodePiece(bytesOf(file, 0, sizeOf(file)), file.string());
}

PieceSummary readPieceSummary(const std::filesystem::path& file) {
    const std::uint64_t size = sizeOf(file);
    const std::string name = file.string();
    constexpr std::size_t kBegin = 16;
    if (size < kBegin) refusePiece(name, "truncated");
    std::uint64_t length = 0;
    const std::string begin = bytesOf(file, 0, kBegin);
    std::memcpy(&length, begin.data() + kMagic.size(), sizeof length);
    if (length > kLongestHeader || length > size - kBegin) refusePiece(name, "header");
    const std::string head = bytesOf(file, 0, kBegin + length);
    PieceSummary summary;
    PieceReader headReader(head, name);
    const Counts counts = takeHeader(headReader, size, summary);
    const std::string rows = bytesOf(file, 0, headReader.at() + counts.summaryBytes() + kSumBytes);
    PieceReader reader(rows, name);
    takeHeader(reader, size, summary);
    takeSummary(reader, counts, summary);
    return summary;
}

}  // namespace adaptiso::giant
