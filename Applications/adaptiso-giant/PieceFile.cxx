#include "adaptiso-giant/PieceFile.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <unordered_map>

#include "Common/Sha256.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Tiles.h"

namespace adaptiso::giant {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "pieces are little-endian");

constexpr std::string_view kMagic = "ADAPTPC2";
constexpr std::size_t kSumBytes = 64;
constexpr std::uint64_t kLongestHeader = 1 << 16;
constexpr std::size_t kComponentBytes = 32, kBorderBytes = 32, kEdgeBytes = 8, kPointBytes = 24,
                      kNormalBytes = 12, kTriangleBytes = 12;

[[noreturn]] void refusePiece(const std::string& name, const std::string& what) {
    throw FileError(name + ": is damaged (" + what + "); remove it, and run its step again");
}

template <class T>
void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
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

    template <class T>
    T take() {
        T value{};
        std::memcpy(&value, takeBytes(sizeof value).data(), sizeof value);
        return value;
    }
    std::string_view takeBytes(std::size_t count) {
        if (count > bytes_.size() - at_) refusePiece(name_, "truncated");
        const std::string_view taken = bytes_.substr(at_, count);
        at_ += count;
        return taken;
    }
    double takeFinite() {
        const auto value = take<double>();
        if (!std::isfinite(value)) refusePiece(name_, "a number is not finite");
        return value;
    }
    Vec3 takeVector() {
        const double x = takeFinite(), y = takeFinite(), z = takeFinite();
        return {x, y, z};
    }
    std::uint32_t takeNumber(std::int64_t count) {
        const auto number = take<std::uint32_t>();
        if (number >= count) refusePiece(name_, "a number is out of range");
        return number;
    }
    /// \pre the bytes from `begin` up to here are those summed
    void checkSum(std::size_t begin) {
        const std::string_view summed = bytes_.substr(begin, at_ - begin);
        if (takeBytes(kSumBytes) != sha256Of(summed)) refusePiece(name_, "checksum");
    }
    /// The file has room for so many elements.
    std::int64_t countOf(const Json& header, const char* key, std::size_t bytesEach) const {
        const Json* value = header.contains(key) ? &header.at(key) : nullptr;
        if (value == nullptr || !value->is_number_unsigned() ||
            value->get<std::uint64_t>() > (bytes_.size() - at_) / bytesEach) {
            refusePiece(name_, key);
        }
        return value->get<std::int64_t>();
    }

    std::size_t at() const { return at_; }
    std::size_t left() const { return bytes_.size() - at_; }
    const std::string& name() const { return name_; }

private:
    std::string_view bytes_;
    const std::string& name_;
    std::size_t at_ = 0;
};

std::string textOf(const Json& header, const char* key, const std::string& name) {
    if (!header.contains(key) || !header.at(key).is_string()) refusePiece(name, key);
    return header.at(key).get<std::string>();
}

/// How long the first part is, without its sum; \pre `bytes` has the header.
std::size_t summaryBytes(const Json& header, std::size_t headerEnd) {
    const auto count = [&](const char* key) { return header.at(key).get<std::size_t>(); };
    return headerEnd + count("components") * kComponentBytes +
           count("borderVertices") * kBorderBytes + count("borderEdges") * kEdgeBytes;
}

Json takeHeader(PieceReader& reader) {
    if (reader.left() < kMagic.size() || reader.takeBytes(kMagic.size()) != kMagic) {
        refusePiece(reader.name(), "no piece of adaptiso-giant");
    }
    const auto length = reader.take<std::uint64_t>();
    if (length > kLongestHeader) refusePiece(reader.name(), "header");
    Json header = Json::parse(reader.takeBytes(static_cast<std::size_t>(length)), nullptr, false);
    if (!header.is_object()) refusePiece(reader.name(), "header");
    return header;
}

/// \param fileBytes  of the whole file
PieceSummary takeSummary(PieceReader& reader, std::uint64_t fileBytes) {
    const Json header = takeHeader(reader);
    const std::string& name = reader.name();
    PieceSummary summary;
    summary.plan = textOf(header, "plan", name);
    summary.stage = textOf(header, "stage", name);
    summary.id = textOf(header, "id", name);
    summary.inputs = textOf(header, "inputs", name);
    const auto countIn = [&](const char* key, std::size_t bytesEach) {
        if (!header.contains(key) || !header.at(key).is_number_unsigned() ||
            header.at(key).get<std::uint64_t>() > fileBytes / bytesEach) {
            refusePiece(name, key);
        }
        return header.at(key).get<std::int64_t>();
    };
    summary.points = countIn("points", kPointBytes + kNormalBytes);
    summary.triangles = countIn("triangles", kTriangleBytes);
    if (!header.contains("errorBoundMm") || !header.at("errorBoundMm").is_number() ||
        !header.contains("unchanged") || !header.at("unchanged").is_boolean()) {
        refusePiece(name, "header");
    }
    summary.errorBoundMm = header.at("errorBoundMm").get<double>();
    summary.isUnchanged = header.at("unchanged").get<bool>();
    const std::int64_t components = reader.countOf(header, "components", kComponentBytes),
                       border = reader.countOf(header, "borderVertices", kBorderBytes),
                       edges = reader.countOf(header, "borderEdges", kEdgeBytes);
    for (std::int64_t n = 0; n < components; ++n) {
        PieceComponent& component = summary.components.emplace_back();
        component.triangles = reader.take<std::int64_t>();
        component.innerVertices = reader.take<std::int64_t>();
        component.areaMm2 = reader.takeFinite();
        component.volumeMm3 = reader.takeFinite();
        if (component.triangles < 0 || component.triangles > summary.triangles ||
            component.innerVertices < 0 || component.innerVertices > summary.points) {
            refusePiece(name, "a component");
        }
    }
    for (std::int64_t n = 0; n < border; ++n) {
        BorderVertex& vertex = summary.border.emplace_back();
        vertex.vertex = reader.takeNumber(summary.points);
        vertex.component = reader.takeNumber(components);
        vertex.index = reader.takeVector();
    }
    for (std::int64_t n = 0; n < edges; ++n) {
        const std::uint32_t a = reader.takeNumber(border), b = reader.takeNumber(border);
        summary.borderEdges.push_back({a, b});
    }
    reader.checkSum(0);
    return summary;
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
    std::error_code error;
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
    bytes.reserve(header.size() + summary.border.size() * (kBorderBytes + kEdgeBytes) +
                  piece.mesh.points.size() * (kPointBytes + kNormalBytes) +
                  piece.mesh.triangles.size() * kTriangleBytes + 4096);
    put(bytes, std::uint64_t{header.size()});
    bytes += header;
    for (const PieceComponent& c : summary.components) {
        put(bytes, c.triangles);
        put(bytes, c.innerVertices);
        put(bytes, c.areaMm2);
        put(bytes, c.volumeMm3);
    }
    for (const BorderVertex& v : summary.border) {
        put(bytes, v.vertex);
        put(bytes, v.component);
        for (int a = 0; a < 3; ++a) put(bytes, v.index[a]);
    }
    for (const auto& edge : summary.borderEdges) put(bytes, edge);
    putSum(bytes, 0);
    const std::size_t begin = bytes.size();
    for (const Vec3& p : piece.mesh.points) {
        for (int a = 0; a < 3; ++a) put(bytes, p[a]);
    }
    for (const Normal& n : piece.mesh.normals) put(bytes, std::array{n.x, n.y, n.z});
    for (const Triangle& t : piece.mesh.triangles) {
        for (const VertexId v : t) put(bytes, static_cast<std::uint32_t>(v));
    }
    putSum(bytes, begin);
    return bytes;
}

Piece decodePiece(std::string_view bytes, const std::string& name) {
    PieceReader reader(bytes, name);
    Piece piece;
    piece.summary = takeSummary(reader, bytes.size());
    const std::size_t begin = reader.at();
    const auto points = static_cast<std::size_t>(piece.summary.points),
               triangles = static_cast<std::size_t>(piece.summary.triangles);
    if (reader.left() !=
        points * (kPointBytes + kNormalBytes) + triangles * kTriangleBytes + kSumBytes) {
        refusePiece(name, "truncated");
    }
    piece.mesh.points.reserve(points);
    for (std::size_t n = 0; n < points; ++n) piece.mesh.points.push_back(reader.takeVector());
    for (std::size_t n = 0; n < points; ++n) {
        const auto [x, y, z] = reader.take<std::array<float, 3>>();
        if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
            refusePiece(name, "a number is not finite");
        }
        piece.mesh.normals.push_back({x, y, z});
    }
    for (std::size_t n = 0; n < triangles; ++n) {
        const std::int64_t count = piece.summary.points;
        const std::uint32_t a = reader.takeNumber(count), b = reader.takeNumber(count),
                            c = reader.takeNumber(count);
        piece.mesh.triangles.push_back({a, b, c});
    }
    reader.checkSum(begin);
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
    PieceReader headReader(head, name);
    const Json header = takeHeader(headReader);
    for (const char* key : {"components", "borderVertices", "borderEdges"}) {
        if (!header.contains(key) || !header.at(key).is_number_unsigned() ||
            header.at(key).get<std::uint64_t>() > size) {
            refusePiece(name, key);
        }
    }
    const std::uint64_t end = summaryBytes(header, headReader.at()) + kSumBytes;
    if (end > size) refusePiece(name, "truncated");
    const std::string bytes = bytesOf(file, 0, end);
    PieceReader reader(bytes, name);
    return takeSummary(reader, size);
}

}  // namespace adaptiso::giant
