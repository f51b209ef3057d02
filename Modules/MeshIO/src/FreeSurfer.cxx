// FreeSurfer triangle surface, big endian: FF FF FE, a comment and an empty line, int32 V, T,
// float32 points, int32 triangles, then tags: 2 (int32 useRealRAS), 20 (eight lines of text: the
// geometry of the volume). As FreeSurfer's MRISwriteTriangularSurface, nibabel's
// write_geometry and MNE's write_surface do it.
// Quadrangles, read alone: FF FF FF or FF FF FD, V and F in 24 bits each, points as int16 in
// hundredths of a millimetre or as float32, four numbers of points of 24 bits each.
#include <array>
#include <cmath>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "Faces.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::meshio {
namespace {

constexpr std::string_view kTriangleMagic = "\xFF\xFF\xFE";
constexpr std::string_view kOldQuadMagic = "\xFF\xFF\xFF", kQuadMagic = "\xFF\xFF\xFD";
constexpr std::int32_t kUseRealRasTag = 2;
constexpr std::int32_t kGeometryTag = 20;

/// LPS <-> RAS.
constexpr Vec3 flipped(const Vec3& v) {
    return {-v.x, -v.y, v.z};
}

Vec3 halfSize(const ImageGeometry& volume) {
    const auto half = [&](int axis) { return static_cast<double>(volume.size[axis]) / 2; };
    return {half(0), half(1), half(2)};
}

/// A volume whose tkRAS is `frame` (Ras or Lps) itself: FreeSurfer's conformed volume around the
/// scanner's origin, for Lps turned by half a turn about the z axis.
ImageGeometry neutralVolume(CoordinateFrame frame) {
    ImageGeometry volume = standInVolume();
    if (frame == CoordinateFrame::Lps) {
        const Mat3 halfTurn = Mat3::diagonal(-1, -1, 1);
        volume.originMm = halfTurn * volume.originMm;
        volume.indexToPhysical = halfTurn * volume.indexToPhysical;
    }
    return volume;
}

void encodeRow(std::string_view key, const Vec3& v, ByteSink& sink) {
    sink << key << v.x << " " << v.y << " " << v.z << "\n";
}

void encodeFooter(const ImageGeometry& volume, bool isValid, const std::string& name,
                  ByteSink& sink) {
    sink.bigEndian(kUseRealRasTag);
    sink.bigEndian(std::int32_t{0});
    sink.bigEndian(kGeometryTag);
    sink << (isValid ? "valid = 1  # volume info valid\n" : "valid = 0  # volume info invalid\n");
    sink << "filename = " << (name.empty() ? "unknown" : name) << "\n";
    sink << "volume = " << volume.size[0] << " " << volume.size[1] << " " << volume.size[2] << "\n";
    encodeRow("voxelsize = ", volume.spacingMm(), sink);
    const auto& axes = volume.indexToPhysical.column;
    encodeRow("xras   = ", flipped(normalized(axes[0])), sink);
    encodeRow("yras   = ", flipped(normalized(axes[1])), sink);
    encodeRow("zras   = ", flipped(normalized(axes[2])), sink);
    encodeRow("cras   = ", flipped(volume.toPhysical(halfSize(volume))), sink);
}

/// The text after "key =" of the next line.
ByteSource footerValue(ByteSource& source, std::string_view key) {
    const std::string_view line = source.line();
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos || trimmed(line.substr(0, equals)) != key) {
        damaged("its volume geometry lacks the line '" + std::string(key) + " ='");
    }
    return ByteSource(line.substr(equals + 1));
}

Vec3 footerVec(ByteSource& source, std::string_view key) {
    ByteSource value = footerValue(source, key);
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = value.realWord(key);
    return v;
}

/// The geometry after tag 20; nothing if it says of itself that it is not valid.
std::optional<ImageGeometry> decodeGeometry(ByteSource& source) {
    const bool isValid = footerValue(source, "valid").integerWord("valid") != 0;
    footerValue(source, "filename");
    ImageGeometry volume;
    ByteSource size = footerValue(source, "volume");
    for (std::int64_t& extent : volume.size) extent = size.integerWord("volume");
    const Vec3 spacing = footerVec(source, "voxelsize");
    Mat3& axes = volume.indexToPhysical;
    axes.column[0] = spacing.x * flipped(footerVec(source, "xras"));
    axes.column[1] = spacing.y * flipped(footerVec(source, "yras"));
    axes.column[2] = spacing.z * flipped(footerVec(source, "zras"));
    const Vec3 centre = flipped(footerVec(source, "cras"));
    if (!isValid) return std::nullopt;

    constexpr std::int64_t kMostVoxels = std::int64_t{1} << 20;  // along an axis
    for (const std::int64_t extent : volume.size) {
        if (extent < 1 || extent > kMostVoxels) {
            damaged("its volume has " + std::to_string(extent) + " voxels along an axis");
        }
    }
    volume.originMm = centre - axes * halfSize(volume);
    if (!(volume.voxelVolumeMm3() > 0) || !std::isfinite(volume.voxelVolumeMm3()) ||
        !std::isfinite(squaredNorm(volume.originMm))) {
        damaged("its volume geometry spans no volume");
    }
    return volume;
}

/// Where tags begin in what follows the triangles: 0 where none is found.
std::size_t footerAt(std::string_view rest) {
    constexpr std::string_view kRealRas("\0\0\0\2", 4), kGeometry("\0\0\0\x14valid", 9);
    const std::size_t geometry = rest.find(kGeometry);
    if (geometry == std::string_view::npos) return 0;
    constexpr std::size_t kTagBytes = 2 * sizeof(std::int32_t);
    const bool hasRealRas =
        geometry >= kTagBytes && rest.substr(geometry - kTagBytes).starts_with(kRealRas);
    return geometry - (hasRealRas ? kTagBytes : 0);
}

struct Footer {
    bool usesRealRas = false, hasGeometry = false;
    std::optional<ImageGeometry> volume;
};

/// The tags after the triangles, as FreeSurfer's tags.cpp has them: those behind the geometry hold
/// their length. `source` then is behind them, or where it was if they are no tags.
Footer decodeFooter(ByteSource& source) {
    Footer footer;
    const std::size_t begin = source.position();
    for (ByteSource ahead = source; ahead.left() >= 2 * sizeof(std::int32_t); source = ahead) {
        constexpr std::int32_t kLastTag = 1000;
        const auto tag = ahead.number<std::int32_t>(std::endian::big);
        if (tag == kUseRealRasTag) {
            footer.usesRealRas = ahead.number<std::int32_t>(std::endian::big) != 0;
        } else if (tag == kGeometryTag && ahead.rest().starts_with("valid")) {
            footer.volume = decodeGeometry(ahead);
            footer.hasGeometry = true;
        } else if (tag > kUseRealRasTag && tag <= kLastTag &&
                   ahead.left() >= sizeof(std::uint64_t)) {
            const auto length = ahead.number<std::uint64_t>(std::endian::big);
            if (length > ahead.left()) break;
            ahead.take(length);
        } else {
            break;
        }
    }
    if (!source.atEnd() && !footer.hasGeometry) {
        source.seek(begin);
        footer = {};
    }
    return footer;
}

void encodeFreeSurfer(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    const MeshWriteOptions& options = record.options;
    sink << kTriangleMagic << headerLine(options) << "\n\n";
    sink.bigEndian(static_cast<std::int32_t>(mesh.points.size()));
    sink.bigEndian(static_cast<std::int32_t>(mesh.triangles.size()));
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) sink.bigEndian(static_cast<float>(p[axis]));
    }
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId vertex : t) sink.bigEndian(static_cast<std::int32_t>(vertex));
    }
    const bool isTkRas = options.frame == CoordinateFrame::TkRas;
    const bool isValid = !isTkRas || options.volume.has_value();
    encodeFooter(isTkRas && isValid ? *options.volume
                                    : neutralVolume(isTkRas ? CoordinateFrame::Ras : options.frame),
                 isValid, isTkRas ? options.volumeName : std::string(), sink);
}

std::int64_t number24(ByteSource& source) {
    std::int64_t number = 0;
    for (int byte = 0; byte < 3; ++byte) {
        number = number << 8 | source.number<std::uint8_t>(std::endian::big);
    }
    return number;
}

/// Behind the magic; nothing follows the quadrangles.
MeshFile decodeQuadrangles(ByteSource& source, bool areHundredths, const MeshReadOptions& options) {
    MeshFile file;
    const std::int64_t points = number24(source), quads = number24(source);
    requireRoom("points", points, 3 * (areHundredths ? sizeof(std::int16_t) : sizeof(float)),
                source.left());
    file.mesh.points.resize(points);
    for (Vec3& p : file.mesh.points) {
        for (int axis = 0; axis < 3; ++axis) {
            p[axis] = areHundredths ? source.number<std::int16_t>(std::endian::big) / 100.0
                                    : source.number<float>(std::endian::big);
        }
    }
    const Counted counted{"quadrangles", quads, 4 * 3};
    requireRoom(counted.what, quads, counted.each, source.left());
    Faces faces;
    for (std::int64_t i = 0; i < quads; ++i) {
        std::array<VertexId, 4> corners{};
        for (VertexId& vertex : corners) vertex = number24(source);
        faces.add(corners);
    }
    requireNoMore(counted, source.rest(), file.warnings);
    file.frame = options.inputCoordinates.value_or(CoordinateFrame::TkRas);
    std::move(faces).moveTo(file, options.keepsFaults);
    return file;
}

MeshFile decodeFreeSurfer(std::string_view bytes, const MeshReadOptions& options) {
    ByteSource source(bytes);
    const std::string_view magic = source.take(kTriangleMagic.size());
    if (magic == kOldQuadMagic || magic == kQuadMagic) {
        return decodeQuadrangles(source, magic == kOldQuadMagic, options);
    }
    if (magic != kTriangleMagic) {
        unsupported("it does not begin with FF FF FE", "it is no FreeSurfer surface: get it again");
    }
    MeshFile file;
    FrameMarks marks(options);
    marks.addText(source.line());
    if (source.rest().starts_with('\n')) source.take(1);
    const std::int64_t points = source.number<std::int32_t>(std::endian::big);
    const std::int64_t triangles = source.number<std::int32_t>(std::endian::big);
    requireRoom("points", points, 3 * sizeof(float), source.left());
    file.mesh.points.resize(points);
    for (Vec3& p : file.mesh.points) {
        for (int axis = 0; axis < 3; ++axis) p[axis] = source.number<float>(std::endian::big);
    }
    requireRoom("triangles", triangles, 3 * sizeof(std::int32_t), source.left());
    file.mesh.triangles.resize(triangles);
    for (Triangle& t : file.mesh.triangles) {
        for (VertexId& vertex : t) vertex = source.number<std::int32_t>(std::endian::big);
    }
    const Counted counted{"triangles", triangles, 3 * sizeof(std::int32_t)};
    requireNoMore(counted, source.rest().substr(0, footerAt(source.rest())), file.warnings);
    const Footer footer = decodeFooter(source);
    requireNoMore(counted, source.rest(), file.warnings);
    file.frame =
        marks.frame().value_or(footer.usesRealRas ? CoordinateFrame::Ras : CoordinateFrame::TkRas);
    if (file.frame == CoordinateFrame::TkRas) file.volume = footer.volume;
    return file;
}

bool isFreeSurfer(std::string_view head, std::uint64_t byteCount) {
    return head.starts_with(kTriangleMagic) || head.starts_with(kQuadMagic) ||
           (head.starts_with(kOldQuadMagic) && !isCurv(head, byteCount));
}

}  // namespace

bool isCurv(std::string_view head, std::uint64_t byteCount) {
    constexpr std::uint64_t kHeaderBytes = 15;
    if (!head.starts_with(kOldQuadMagic) || head.size() < kHeaderBytes) return false;
    const auto points = loadAs<std::uint32_t>(head.data() + 3, std::endian::big);
    const auto columns = loadAs<std::uint32_t>(head.data() + 11, std::endian::big);
    return columns == 1 && byteCount == kHeaderBytes + 4 * std::uint64_t{points};
}

extern const Codec kFreeSurferCodec{isFreeSurfer, decodeFreeSurfer, encodeFreeSurfer, false};

}  // namespace adaptiso::meshio
