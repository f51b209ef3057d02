// FIFF's block BEM (310) with the coordinate frame and, for every surface, a block BEM_SURF (311).

#include "Fiff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/FiffSurfaces.h"

namespace adaptiso::meshio::fiff {

namespace {

constexpr std::uint32_t kVoid = 0, kInt = 3, kFloat = 4, kString = 10, kIdStruct = 31,
                        kDigPointStruct = 33, kTransformStruct = 35, kMatrix = 0x40000000;
constexpr std::size_t kIdBytes = 20, kTransformBytes = 104;
constexpr std::int32_t kVersion = (1 << 16) | 4;
constexpr auto kBig = std::endian::big;

void requireType(const Tag& tag, std::uint32_t type, std::size_t bytes) {
    if (tag.type == type && tag.data.size() >= bytes) return;
    damaged("its tag " + std::to_string(tag.kind) + " is of type " + std::to_string(tag.type) +
            " and " + std::to_string(tag.data.size()) + " bytes, must be of type " +
            std::to_string(type) + " and " + std::to_string(bytes) + " bytes or more");
}

/// The number of rows of a matrix with three columns whose elements take four bytes.
std::size_t rowsOf(const Tag& tag, std::uint32_t element) {
    constexpr std::size_t kTail = 3 * sizeof(std::int32_t), kRow = 12;
    requireType(tag, kMatrix | element, kTail);
    const char* const tail = tag.data.data() + tag.data.size() - kTail;
    const auto columns = loadAs<std::int32_t>(tail, kBig);
    const auto rows = loadAs<std::int32_t>(tail + 4, kBig);
    const auto dimensions = loadAs<std::int32_t>(tail + 8, kBig);
    const std::size_t bytes = tag.data.size() - kTail;
    if (dimensions != 2 || columns != 3 || rows < 0 || bytes % kRow != 0 ||
        static_cast<std::size_t>(rows) != bytes / kRow) {
        damaged("its tag " + std::to_string(tag.kind) + " is no matrix with three columns");
    }
    return bytes / kRow;
}

}  // namespace

const Tag* Content::find(std::size_t block, std::int32_t kind) const {
    for (const Tag& tag : tags) {
        if (tag.block == block && tag.kind == kind) return &tag;
    }
    return nullptr;
}

Content decode(std::string_view bytes) {
    ByteSource source(bytes);
    Content content;
    content.blocks.push_back({});
    std::size_t block = 0;
    bool isLast = false;
    while (!isLast && !source.atEnd()) {
        Tag tag;
        tag.kind = source.number<std::int32_t>(kBig);
        tag.type = source.number<std::uint32_t>(kBig);
        const auto size = source.number<std::int32_t>(kBig);
        const auto next = source.number<std::int32_t>(kBig);
        if (content.tags.empty() && (tag.kind != kFileId || tag.type != kIdStruct)) {
            damaged("it does not begin with the tag of a FIFF file");
        }
        requireRoom("bytes of a tag", size, 1, source.left());
        tag.data = source.take(size);
        isLast = next == -1;
        if (next > 0) {
            if (static_cast<std::size_t>(next) < source.position()) {
                unsupported("its tags are not in their order", "save it again with MNE");
            }
            if (static_cast<std::size_t>(next) > bytes.size()) damaged("a tag leads past its end");
            source.seek(next);
        }
        if (tag.kind == kBlockStart) {
            content.blocks.push_back({toInt(tag), block});
            block = content.blocks.size() - 1;
        }
        tag.block = block;
        content.tags.push_back(tag);
        if (tag.kind == kBlockEnd) {
            if (block == 0) damaged("a block ends that did not begin");
            block = content.blocks[block].parent;
        }
    }
    if (content.tags.empty()) damaged("it is empty");
    content.behind = source.rest();
    return content;
}

std::int32_t toInt(const Tag& tag) {
    requireType(tag, kInt, sizeof(std::int32_t));
    return loadAs<std::int32_t>(tag.data.data(), kBig);
}

float toReal(const Tag& tag) {
    requireType(tag, kFloat, sizeof(float));
    return loadAs<float>(tag.data.data(), kBig);
}

std::vector<Vec3> toVectors(const Tag& tag) {
    std::vector<Vec3> rows(rowsOf(tag, kFloat));
    const char* at = tag.data.data();
    for (Vec3& row : rows) {
        for (int axis = 0; axis < 3; ++axis, at += sizeof(float))
            row[axis] = loadAs<float>(at, kBig);
    }
    return rows;
}

std::vector<std::array<std::int32_t, 3>> toTriples(const Tag& tag) {
    std::vector<std::array<std::int32_t, 3>> rows(rowsOf(tag, kInt));
    const char* at = tag.data.data();
    for (auto& row : rows) {
        for (std::int32_t& value : row) {
            value = loadAs<std::int32_t>(at, kBig);
            at += sizeof(value);
        }
    }
    return rows;
}

std::vector<std::int32_t> toInts(const Tag& tag) {
    requireType(tag, kInt, 0);
    std::vector<std::int32_t> values(tag.data.size() / sizeof(std::int32_t));
    const char* at = tag.data.data();
    for (std::int32_t& value : values) {
        value = loadAs<std::int32_t>(at, kBig);
        at += sizeof(value);
    }
    return values;
}

AffineTransform toTransform(const Tag& tag) {
    requireType(tag, kTransformStruct, kTransformBytes);
    AffineTransform transform;
    const char* at = tag.data.data() + 2 * sizeof(std::int32_t);
    const auto next = [&] {
        const auto value = loadAs<float>(at, kBig);
        at += sizeof(value);
        return double{value};
    };
    for (int row = 0; row < 3; ++row) {
        for (Vec3& column : transform.linear.column) column[row] = next();
    }
    for (int axis = 0; axis < 3; ++axis) transform.offset[axis] = next();
    return transform;
}

DigitizedPoint toPoint(const Tag& tag) {
    constexpr std::size_t kBytes = 20;
    requireType(tag, kDigPointStruct, kBytes);
    const char* const bytes = tag.data.data();
    DigitizedPoint point{
        loadAs<std::int32_t>(bytes, kBig), loadAs<std::int32_t>(bytes + 4, kBig), {}};
    for (int axis = 0; axis < 3; ++axis) {
        point.metres[axis] = loadAs<float>(bytes + 8 + 4 * axis, kBig);
    }
    return point;
}

Channel toChannel(const Tag& tag) {
    // scan and logical number, kind, range, calibration, coil, place and axes, unit and its power,
    // name
    constexpr std::size_t kBytes = 96, kKindAt = 8, kPlaceAt = 24, kNameAt = 80;
    if (tag.data.size() < kBytes)
        damaged("a channel has " + std::to_string(tag.data.size()) + " bytes, must have 96");
    Channel channel{loadAs<std::int32_t>(tag.data.data() + kKindAt, kBig), {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        channel.metres[static_cast<int>(axis)] =
            loadAs<float>(tag.data.data() + kPlaceAt + 4 * axis, kBig);
    }
    channel.name = tag.data.substr(kNameAt, kBytes - kNameAt);
    channel.name = channel.name.substr(0, channel.name.find('\0'));
    return channel;
}

Writer::Writer(ByteSink& sink) : sink_(sink) {
    header(kFileId, kIdStruct, kIdBytes);
    sink_.bigEndian(kVersion);
    for (int n = 0; n < 4; ++n) sink_.bigEndian(std::int32_t{0});  // machine and time
    put(kDirectoryPointer, -1);
    put(kFreeList, -1);
}

void Writer::header(std::int32_t kind, std::uint32_t type, std::size_t bytes, std::int32_t next) {
    sink_.bigEndian(kind);
    sink_.bigEndian(type);
    sink_.bigEndian(static_cast<std::int32_t>(bytes));
    sink_.bigEndian(next);
}

void Writer::put(std::int32_t kind, std::int32_t value) {
    header(kind, kInt, sizeof(value));
    sink_.bigEndian(value);
}

void Writer::put(std::int32_t kind, float value) {
    header(kind, kFloat, sizeof(value));
    sink_.bigEndian(value);
}

void Writer::put(std::int32_t kind, std::string_view text) {
    header(kind, kString, text.size());
    sink_ << text;
}

void Writer::put(std::int32_t kind, std::span<const std::int32_t> values) {
    header(kind, kInt, sizeof(std::int32_t) * values.size());
    for (const std::int32_t value : values) sink_.bigEndian(value);
}

void Writer::put(std::int32_t kind, std::span<const Vec3> rows) {
    header(kind, kMatrix | kFloat, 12 * rows.size() + 12);
    for (const Vec3& row : rows) {
        for (int axis = 0; axis < 3; ++axis) sink_.bigEndian(static_cast<float>(row[axis]));
    }
    for (const std::size_t n : {std::size_t{3}, rows.size(), std::size_t{2}}) {
        sink_.bigEndian(static_cast<std::int32_t>(n));
    }
}

void Writer::put(std::int32_t kind, std::span<const std::array<std::int32_t, 3>> rows) {
    header(kind, kMatrix | kInt, 12 * rows.size() + 12);
    for (const auto& row : rows) {
        for (const std::int32_t value : row) sink_.bigEndian(value);
    }
    for (const std::size_t n : {std::size_t{3}, rows.size(), std::size_t{2}}) {
        sink_.bigEndian(static_cast<std::int32_t>(n));
    }
}

void Writer::putPoint(std::int32_t pointKind, std::int32_t number, const Vec3& metres) {
    header(kDigPoint, kDigPointStruct, 20);
    sink_.bigEndian(pointKind);
    sink_.bigEndian(number);
    for (int axis = 0; axis < 3; ++axis) sink_.bigEndian(static_cast<float>(metres[axis]));
}

void Writer::putTransform(std::int32_t from, std::int32_t to, const AffineTransform& metres) {
    header(kCoordTrans, kTransformStruct, kTransformBytes);
    sink_.bigEndian(from);
    sink_.bigEndian(to);
    for (const AffineTransform& transform : {metres, inverse(metres)}) {
        for (int row = 0; row < 3; ++row) {
            for (const Vec3& column : transform.linear.column) {
                sink_.bigEndian(static_cast<float>(column[row]));
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            sink_.bigEndian(static_cast<float>(transform.offset[axis]));
        }
    }
}

void Writer::finish() {
    header(kNop, kVoid, 0, -1);
}

}  // namespace adaptiso::meshio::fiff

namespace adaptiso {

using namespace meshio;

namespace {

/// Bytes of a matrix with three columns are counted in 31 bits.
constexpr std::size_t kMostRows = std::numeric_limits<std::int32_t>::max() / 12 - 1;

template <class Surface>
void requireCountable(std::span<const Surface> surfaces, const std::string& file) {
    if (surfaces.empty()) throw InvalidInput(file + ": there is no surface to write");
    for (const Surface& surface : surfaces) {
        const std::size_t most =
            std::max(surface.mesh.points.size(), surface.mesh.triangles.size());
        if (most > kMostRows) {
            throw InvalidInput(file + ": FIFF files hold at most " + std::to_string(kMostRows) +
                               " points and triangles, a surface has " + std::to_string(most));
        }
    }
}

/// Numbered from 1.
std::vector<std::array<std::int32_t, 3>> trianglesOf(const TriangleMesh& mesh) {
    std::vector<std::array<std::int32_t, 3>> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        triangles.push_back({static_cast<std::int32_t>(a + 1), static_cast<std::int32_t>(b + 1),
                             static_cast<std::int32_t>(c + 1)});
    }
    return triangles;
}

std::vector<Vec3> normalsOf(const TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    for (const Normal& normal : mesh.normals) normals.push_back(toVec3(normal));
    return normals;
}

void encodeSurface(const FiffSurface& surface, fiff::Writer& writer) {
    const TriangleMesh& mesh = surface.mesh;
    writer.begin(fiff::kBemSurface);
    writer.put(fiff::kSigma, static_cast<float>(surface.conductivity));
    writer.put(fiff::kSurfaceId, surface.id);
    writer.put(fiff::kMneCoordFrame, fiff::kFrameMri);
    writer.put(fiff::kNodeCount, static_cast<std::int32_t>(mesh.points.size()));
    writer.put(fiff::kTriangleCount, static_cast<std::int32_t>(mesh.triangles.size()));
    writer.put(fiff::kNodes, mesh.points);
    writer.put(fiff::kTriangles, trianglesOf(mesh));
    if (!mesh.normals.empty()) writer.put(fiff::kNormals, normalsOf(mesh));
    writer.end(fiff::kBemSurface);
}

void encodeSources(const FiffSources& sources, fiff::Writer& writer) {
    const TriangleMesh& mesh = sources.mesh;
    constexpr std::int32_t kSurfaceType = 1, kVolumeType = 2;
    writer.begin(fiff::kMneSources);
    writer.put(fiff::kSourceType, sources.grid ? kVolumeType : kSurfaceType);
    if (!sources.grid) writer.put(fiff::kSourceId, sources.id);
    writer.put(fiff::kMneCoordFrame, fiff::kFrameMri);
    writer.put(fiff::kSourcePointCount, static_cast<std::int32_t>(mesh.points.size()));
    writer.put(fiff::kSourcePoints, mesh.points);
    writer.put(fiff::kSourceNormals, normalsOf(mesh));
    std::vector<std::int32_t> selection(mesh.points.size());
    for (const std::int64_t point : sources.used) selection[point] = 1;
    writer.put(fiff::kSourceSelection, selection);
    writer.put(fiff::kSourcesUsed, static_cast<std::int32_t>(sources.used.size()));
    if (!mesh.triangles.empty()) {
        writer.put(fiff::kSourceTriangleCount, static_cast<std::int32_t>(mesh.triangles.size()));
        writer.put(fiff::kSourceTriangles, trianglesOf(mesh));
    }
    if (sources.grid) {
        const FiffSources::Grid& grid = *sources.grid;
        writer.putTransform(fiff::kFrameMriVoxel, fiff::kFrameMri, grid.toMri);
        writer.put(fiff::kSourceGridSize, grid.size);
        writer.begin(fiff::kMneParentMri);
        writer.putTransform(fiff::kFrameMri, fiff::kFrameRas, grid.mriToRas);
        writer.putTransform(fiff::kFrameMriVoxel, fiff::kFrameMri, grid.imageToMri);
        writer.put(fiff::kMriWidth, grid.imageSize[0]);
        writer.put(fiff::kMriHeight, grid.imageSize[1]);
        writer.put(fiff::kMriDepth, grid.imageSize[2]);
        writer.end(fiff::kMneParentMri);
    }
    writer.end(fiff::kMneSources);
}

const fiff::Tag& require(const fiff::Content& content, std::size_t block, std::int32_t kind,
                         const char* what) {
    const fiff::Tag* const tag = content.find(block, kind);
    if (tag == nullptr) damaged(std::string("a surface lacks its ") + what);
    return *tag;
}

void requireMriFrame(const fiff::Content& content, std::size_t block) {
    const fiff::Tag* frame = content.find(block, fiff::kMneCoordFrame);
    if (frame == nullptr) frame = content.find(block, fiff::kBemCoordFrame);
    if (frame == nullptr) {
        frame = content.find(content.blocks[block].parent, fiff::kBemCoordFrame);
    }
    if (frame == nullptr || fiff::toInt(*frame) == fiff::kFrameMri) return;
    unsupported("a surface is in FIFF's coordinate frame " + std::to_string(fiff::toInt(*frame)),
                "it must be in MRI coordinates (5)");
}

void requireCount(const fiff::Content& content, std::size_t block, std::int32_t kind,
                  std::size_t there, const char* what) {
    const fiff::Tag* const tag = content.find(block, kind);
    if (tag == nullptr || static_cast<std::size_t>(fiff::toInt(*tag)) == there) return;
    damaged("a surface counts " + std::to_string(fiff::toInt(*tag)) + " " + what + " and has " +
            std::to_string(there));
}

/// Finite points, or normals.
std::vector<Vec3> pointsIn(const fiff::Content& content, std::size_t block, std::int32_t kind) {
    std::vector<Vec3> points = fiff::toVectors(require(content, block, kind, "points"));
    for (const Vec3& point : points) {
        if (!std::isfinite(squaredNorm(point))) damaged("a point is not finite");
    }
    return points;
}

void takeTriangles(const fiff::Tag& tag, TriangleMesh& mesh) {
    const auto points = static_cast<VertexId>(mesh.points.size());
    for (const auto& row : fiff::toTriples(tag)) {
        Triangle triangle;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            triangle[corner] = VertexId{row[corner]} - 1;
            if (triangle[corner] < 0 || triangle[corner] >= points) {
                damaged("a triangle names the point " + std::to_string(row[corner]) + " of " +
                        std::to_string(points));
            }
        }
        mesh.triangles.push_back(triangle);
    }
}

FiffSurface decodeSurface(const fiff::Content& content, std::size_t block) {
    FiffSurface surface;
    if (const fiff::Tag* id = content.find(block, fiff::kSurfaceId)) surface.id = fiff::toInt(*id);
    if (const fiff::Tag* sigma = content.find(block, fiff::kSigma)) {
        surface.conductivity = fiff::toReal(*sigma);
        if (!std::isfinite(surface.conductivity)) damaged("a conductivity is not finite");
    }
    requireMriFrame(content, block);
    surface.mesh.points = pointsIn(content, block, fiff::kNodes);
    takeTriangles(require(content, block, fiff::kTriangles, "triangles"), surface.mesh);
    requireCount(content, block, fiff::kNodeCount, surface.mesh.points.size(), "points");
    requireCount(content, block, fiff::kTriangleCount, surface.mesh.triangles.size(), "triangles");
    return surface;
}

FiffSources decodeSources(const fiff::Content& content, std::size_t block) {
    FiffSources sources;
    TriangleMesh& mesh = sources.mesh;
    requireMriFrame(content, block);
    mesh.points = pointsIn(content, block, fiff::kSourcePoints);
    for (const Vec3& normal : pointsIn(content, block, fiff::kSourceNormals)) {
        mesh.normals.push_back(toNormal(normal));
    }
    const fiff::Tag& selection = require(content, block, fiff::kSourceSelection, "selection");
    const std::vector<std::int32_t> isUsed = fiff::toInts(selection);
    for (std::size_t n = 0; n < isUsed.size(); ++n) {
        if (isUsed[n] != 0) sources.used.push_back(static_cast<std::int64_t>(n));
    }
    requireCount(content, block, fiff::kSourcePointCount, mesh.points.size(), "points");
    requireCount(content, block, fiff::kSourcePointCount, isUsed.size(), "selected points");
    requireCount(content, block, fiff::kSourcesUsed, sources.used.size(), "sources");
    if (const fiff::Tag* const triangles = content.find(block, fiff::kSourceTriangles)) {
        takeTriangles(*triangles, mesh);
    }
    requireCount(content, block, fiff::kSourceTriangleCount, mesh.triangles.size(), "triangles");
    if (const fiff::Tag* const id = content.find(block, fiff::kSourceId)) {
        sources.id = fiff::toInt(*id);
        return sources;
    }
    std::size_t parent = block + 1;
    while (parent < content.blocks.size() && content.blocks[parent].kind != fiff::kMneParentMri) {
        ++parent;
    }
    const std::vector<std::int32_t> size =
        fiff::toInts(require(content, block, fiff::kSourceGridSize, "grid"));
    std::vector<AffineTransform> moves;
    for (const fiff::Tag& tag : content.tags) {
        if (tag.kind != fiff::kCoordTrans || (tag.block != block && tag.block != parent)) continue;
        moves.push_back(fiff::toTransform(tag));
    }
    if (size.size() != 3 || moves.size() != 3) damaged("a grid lacks its size or a transform");
    FiffSources::Grid& grid = sources.grid.emplace();
    std::ranges::copy(size, grid.size.begin());
    grid.toMri = moves[0];
    grid.mriToRas = moves[1];
    grid.imageToMri = moves[2];
    grid.imageSize = {fiff::toInt(require(content, parent, fiff::kMriWidth, "image's width")),
                      fiff::toInt(require(content, parent, fiff::kMriHeight, "image's height")),
                      fiff::toInt(require(content, parent, fiff::kMriDepth, "image's depth"))};
    return sources;
}

}  // namespace

void writeFiffSurfaces(std::span<const FiffSurface> surfaces, const std::filesystem::path& path) {
    requireCountable(surfaces, path.string());
    writeBytes(path, [&](ByteSink& sink) {
        fiff::Writer writer(sink);
        writer.begin(fiff::kBem);
        writer.put(fiff::kBemCoordFrame, fiff::kFrameMri);
        for (const FiffSurface& surface : surfaces) encodeSurface(surface, writer);
        writer.end(fiff::kBem);
        writer.finish();
    });
}

void writeFiffSources(std::span<const FiffSources> sources, const std::filesystem::path& path) {
    requireCountable(sources, path.string());
    writeBytes(path, [&](ByteSink& sink) {
        fiff::Writer writer(sink);
        writer.begin(fiff::kMne);
        for (const FiffSources& space : sources) encodeSources(space, writer);
        writer.end(fiff::kMne);
        writer.finish();
    });
}

void writeFiffHeadToMri(const AffineTransform& metres, const std::filesystem::path& path) {
    writeBytes(path, [&](ByteSink& sink) {
        fiff::Writer writer(sink);
        writer.putTransform(fiff::kFrameHead, fiff::kFrameMri, metres);
        writer.finish();
    });
}

namespace {

std::vector<FiffSurface> surfacesIn(const fiff::Content& content) {
    std::vector<FiffSurface> surfaces;
    for (std::size_t block = 1; block < content.blocks.size(); ++block) {
        if (content.blocks[block].kind == fiff::kBemSurface) {
            surfaces.push_back(decodeSurface(content, block));
        }
    }
    if (surfaces.empty()) unsupported("it holds no surface", "give a file of surfaces");
    return surfaces;
}

}  // namespace

std::vector<FiffSurface> decodeFiffSurfaces(std::string_view bytes, std::string_view name) {
    return meshio::naming(name, [&] { return surfacesIn(fiff::decode(bytes)); });
}

namespace {

std::string nameOf(const FiffSurface& surface) {
    switch (surface.id) {
        case 1:
            return "inner_skull";
        case 3:
            return "outer_skull";
        case 4:
            return "outer_skin";
        default:
            return "surface-" + std::to_string(surface.id);
    }
}

/// Names of surfaces in their order; a name's second one is "outer_skin-2".
std::vector<std::string> namesOf(const std::vector<FiffSurface>& surfaces) {
    std::vector<std::string> names;
    std::map<std::string, int> count;
    for (const FiffSurface& surface : surfaces) {
        const std::string name = nameOf(surface);
        const int n = ++count[name];
        names.push_back(n == 1 ? name : name + "-" + std::to_string(n));
    }
    return names;
}

/// A file's surfaces, inside out as FIFF's numbers grow.
std::vector<FiffSurface> insideOut(std::vector<FiffSurface> surfaces) {
    std::ranges::stable_sort(surfaces, {}, &FiffSurface::id);
    return surfaces;
}

}  // namespace

namespace meshio {

std::pair<std::filesystem::path, std::string> fiffPart(const std::filesystem::path& path) {
    const std::string text = path.string();
    const std::size_t colon = text.rfind(".fif:");
    std::error_code error;
    if (colon == std::string::npos || std::filesystem::exists(path, error)) return {path, ""};
    return {text.substr(0, colon + 4), text.substr(colon + 5)};
}

namespace {

bool isFiff(std::string_view head, std::uint64_t /*byteCount*/) {
    return head.starts_with(fiff::kMagic);
}

MeshFile decodeFiff(std::string_view bytes, const MeshReadOptions& options) {
    constexpr double kMmPerM = 1000;
    const fiff::Content content = fiff::decode(bytes);
    std::vector<FiffSurface> surfaces = insideOut(surfacesIn(content));
    const std::vector<std::string> names = namesOf(surfaces);
    const std::string list = joined(names);
    if (!options.part.empty()) {
        const auto at = std::ranges::find(names, options.part) - names.begin();
        if (at == std::ssize(names)) {
            unsupported("it holds no surface " + printable(options.part) + " but " + list,
                        "name one");
        }
        surfaces = {surfaces[static_cast<std::size_t>(at)]};
    }
    if (surfaces.size() > 1) {
        unsupported("it holds " + std::to_string(surfaces.size()) + " surfaces",
                    "name one behind a colon, as in model.fif:" + names.back() + " (" + list + ")");
    }
    MeshFile file;
    const auto tags = static_cast<std::int64_t>(content.tags.size());
    requireNoMore({"tags", tags, static_cast<std::int64_t>(bytes.size())}, content.behind,
                  file.warnings);
    file.mesh = std::move(surfaces.front().mesh);
    for (Vec3& point : file.mesh.points) point = kMmPerM * point;
    file.frame = options.inputCoordinates.value_or(CoordinateFrame::TkRas);
    return file;
}

}  // namespace

extern const Codec kFiffCodec{isFiff, decodeFiff, nullptr, false};

}  // namespace meshio

std::vector<std::filesystem::path> surfacePaths(const std::filesystem::path& path) {
    if (lowerCase(path.extension().string()) != ".fif") return {path};
    std::vector<std::string> names;
    try {
        names = namesOf(insideOut(readFiffSurfaces(path)));
    } catch (const FileError&) {
        return {path};  // who reads it says what is wrong
    }
    if (names.size() < 2) return {path};
    std::vector<std::filesystem::path> paths;
    for (const std::string& name : names) paths.emplace_back(path.string() + ":" + name);
    return paths;
}

std::vector<FiffSources> readFiffSources(const std::filesystem::path& path) {
    const std::string bytes = readBytes(path);
    return meshio::naming(path.string(), [&] {
        const fiff::Content content = fiff::decode(bytes);
        std::vector<FiffSources> spaces;
        for (std::size_t block = 1; block < content.blocks.size(); ++block) {
            if (content.blocks[block].kind != fiff::kMneSources) continue;
            spaces.push_back(decodeSources(content, block));
        }
        return spaces;
    });
}

AffineTransform readFiffHeadToMri(const std::filesystem::path& path) {
    const std::string bytes = readBytes(path);
    return meshio::naming(path.string(), [&] {
        return fiff::toTransform(require(fiff::decode(bytes), 0, fiff::kCoordTrans, "transform"));
    });
}

std::vector<FiffSurface> readFiffSurfaces(const std::filesystem::path& path) {
    return decodeFiffSurfaces(readBytes(path), path.string());
}

}  // namespace adaptiso
