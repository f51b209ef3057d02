// GIFTI 1.0 (www.nitrc.org/projects/gifti): POINTSET float32 and TRIANGLE int32, both
// GZipBase64Binary. No third array for normals: Connectome Workbench takes surface files of
// exactly two (SurfaceFile::validateDataArraysAfterReading).
//
// FreeSurfer's surfaces are in tkRAS unless DataSpace is the scanner's, and say the volume in
// metadata VolGeom... of the points (utils/gifti.cpp: MRISwriteGIFTISurface, mrisReadGIFTIdanum).
//
// Debian's libgiftiio allocates what a header claims before it looks at the data, so it is not
// for files from outside; expat and zlib, which it rests on too, are used directly.
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "Codecs.h"
#include "GiftiArrays.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso::meshio {
namespace {

constexpr std::string_view kScannerSpace = "NIFTI_XFORM_SCANNER_ANAT";
constexpr std::string_view kUnknownSpace = "NIFTI_XFORM_UNKNOWN";
constexpr std::string_view kFrameKey = "CoordinateFrame";
constexpr std::string_view kVolumeKey = "VolGeom";
constexpr std::string_view kProgramKey = "ProgramProvenance";  ///< of Connectome Workbench

constexpr AffineTransform kFlip{Mat3::diagonal(-1, -1, 1), {}};  ///< LPS <-> RAS

AffineTransform toRas(CoordinateFrame frame, const std::optional<ImageGeometry>& volume) {
    return kFlip * inverse(lpsToFrame(frame, volume));
}

/// Metadata of the points: the volume whose tkRAS they are in, with all that FreeSurfer needs.
void encodeVolume(const MeshWriteOptions& options, ByteSink& sink) {
    if (!options.saysFrame || options.frame != CoordinateFrame::TkRas || !options.volume) {
        sink << "<MetaData/>\n";
        return;
    }
    const ImageGeometry& volume = *options.volume;
    const auto begin = [&](std::string_view key) -> ByteSink& {
        return sink << "<MD><Name><![CDATA[" << kVolumeKey << key << "]]></Name><Value><![CDATA[";
    };
    constexpr std::string_view kEnd = "]]></Value></MD>\n";
    const auto encodeVec = [&](const std::string& key, const Vec3& lps) {
        const Vec3 ras = kFlip(lps);
        begin(key + "_R") << ras.x << kEnd;
        begin(key + "_A") << ras.y << kEnd;
        begin(key + "_S") << ras.z << kEnd;
    };
    sink << "<MetaData>\n";
    begin("Fname") << (options.volumeName.empty() ? "unknown" : options.volumeName) << kEnd;
    begin("Width") << volume.size[0] << kEnd;
    begin("Height") << volume.size[1] << kEnd;
    begin("Depth") << volume.size[2] << kEnd;
    const Vec3 spacing = volume.spacingMm();
    begin("Xsize") << spacing.x << kEnd;
    begin("Ysize") << spacing.y << kEnd;
    begin("Zsize") << spacing.z << kEnd;
    const auto& axes = volume.indexToPhysical.column;
    encodeVec("X", normalized(axes[0]));
    encodeVec("Y", normalized(axes[1]));
    encodeVec("Z", normalized(axes[2]));
    const auto half = [&](int axis) { return static_cast<double>(volume.size[axis]) / 2; };
    encodeVec("C", volume.toPhysical({half(0), half(1), half(2)}));
    sink << "</MetaData>\n";
}

void encodeMatrixRow(const AffineTransform& transform, int row, ByteSink& sink) {
    for (const Vec3& column : transform.linear.column) sink << column[row] << " ";
    sink << transform.offset[row] << "\n";
}

/// From the frame of the points to scanner RAS, as NIFTI-style tools expect to find it; nothing
/// where that is not known.
void encodeCoordinateSystem(const MeshWriteOptions& options, ByteSink& sink) {
    const bool isRas = options.frame == CoordinateFrame::Ras;
    if (!options.saysFrame || (needsVolume(options.frame) && !options.volume)) return;
    const AffineTransform matrix = toRas(options.frame, options.volume);
    sink << "<CoordinateSystemTransformMatrix>\n<DataSpace><![CDATA["
         << (isRas ? kScannerSpace : kUnknownSpace)
         << "]]></DataSpace>\n<TransformedSpace><![CDATA[" << kScannerSpace
         << "]]></TransformedSpace>\n<MatrixData>\n";
    for (int row = 0; row < 3; ++row) encodeMatrixRow(matrix, row, sink);
    sink << "0 0 0 1\n</MatrixData>\n</CoordinateSystemTransformMatrix>\n";
}

using Metadata = std::map<std::string, std::string, std::less<>>;

/// The surface of a file, and what it says of its frame.
struct GiftiSurface {
    GiftiArray points, triangles;
    Metadata metadata;  ///< of the file and of the points
    std::vector<std::string> otherIntents;
};

GiftiSurface surfaceOf(GiftiFile&& file) {
    GiftiSurface surface;
    for (GiftiArray& array : file.arrays) {
        const std::string& intent = requireAttribute(array.attributes, "Intent");
        GiftiArray* const kept = intent == "NIFTI_INTENT_POINTSET"   ? &surface.points
                                 : intent == "NIFTI_INTENT_TRIANGLE" ? &surface.triangles
                                                                     : nullptr;
        if (kept == nullptr) {
            surface.otherIntents.push_back(storedName(intent));
            continue;
        }
        if (!kept->attributes.empty()) {
            unsupported("it holds several surfaces", "save each to its own file");
        }
        *kept = std::move(array);
    }
    for (const GiftiMetadata* const list : {&file.metadata, &surface.points.metadata}) {
        for (const auto& [key, value] : *list) surface.metadata[key] = value;
    }
    return surface;
}

/// The volume in VolGeom; empty if incomplete or sheared. Where the volume lies depends on its axes
/// and centre alone: without a size it is FreeSurfer's, 256 voxels of 1 mm, and without axes they
/// are those of FreeSurfer's volumes, as niivue and fMRIPrep have it.
std::optional<ImageGeometry> volumeOf(const Metadata& metadata) {
    const auto number = [&](std::string_view key, double otherwise) {
        const auto found = metadata.find(std::string(kVolumeKey).append(key));
        return found == metadata.end() ? otherwise : toReal(trimmed(found->second), found->first);
    };
    const auto vector = [&](const std::string& key, const Vec3& otherwise) {
        const Vec3 lps = kFlip(otherwise);
        return kFlip(
            {number(key + "_R", lps.x), number(key + "_A", lps.y), number(key + "_S", lps.z)});
    };
    const double missing = std::nan("");
    ImageGeometry volume = standInVolume();
    const Vec3 centre = vector("C", {missing, missing, missing});
    const std::array<std::string_view, 3> extents{"Width", "Height", "Depth"},
        steps{"Xsize", "Ysize", "Zsize"}, axes{"X", "Y", "Z"};
    Vec3 half;
    for (std::size_t a = 0; a < 3; ++a) {
        const double extent = number(extents[a], 256), step = number(steps[a], 1);
        constexpr double kMostVoxels = 1 << 20;  // along an axis
        if (!(extent >= 1 && extent <= kMostVoxels)) return std::nullopt;
        volume.size[a] = static_cast<std::int64_t>(extent);
        half[static_cast<int>(a)] = static_cast<double>(volume.size[a]) / 2;
        Vec3& axis = volume.indexToPhysical.column[a];
        axis = step * vector(std::string(axes[a]), axis);
    }
    volume.originMm = centre - volume.indexToPhysical * half;
    const bool isThere = volume.voxelVolumeMm3() > 0 && std::isfinite(volume.voxelVolumeMm3()) &&
                         std::isfinite(squaredNorm(volume.originMm)) && hasRightAngles(volume);
    return isThere ? std::optional(volume) : std::nullopt;
}

AffineTransform matrixOf(const GiftiSpace& space) {
    ByteSource numbers(space.matrix);
    AffineTransform matrix;
    for (int row = 0; row < 3; ++row) {
        for (Vec3& column : matrix.linear.column) column[row] = numbers.realWord("its matrix");
        matrix.offset[row] = numbers.realWord("its matrix");
    }
    const double size = determinant(matrix.linear);
    if (!std::isfinite(size) || size == 0 || !std::isfinite(squaredNorm(matrix.offset))) {
        damaged("its matrix to scanner space can't be inverted");
    }
    return matrix;
}

/// One of the spaces whose axes point right, anterior and superior: the scanner's, or an atlas's.
bool isWorld(std::string_view space) {
    return space.starts_with("NIFTI_XFORM_") && space != kUnknownSpace;
}

/// Equal to FreeSurfer's digits: to a tenth of a millimetre in a head.
bool areAlike(const AffineTransform& a, const AffineTransform& b) {
    constexpr double kHeadMm = 200, kSlackMm = 0.1;
    double apart = norm(a.offset - b.offset);
    for (std::size_t i = 0; i < 3; ++i) {
        apart = std::max(apart, kHeadMm * norm(a.linear.column[i] - b.linear.column[i]));
    }
    return apart <= kSlackMm;
}

/// Finds the frame of the points, and what leads from it to scanner space.
void place(const GiftiSurface& found, const MeshReadOptions& options, MeshFile& file) {
    const auto value = [&](std::string_view key) {
        const auto entry = found.metadata.find(key);
        return entry == found.metadata.end() ? std::string_view() : trimmed(entry->second);
    };
    FrameMarks marks(options);
    marks.add(parseCoordinateFrame(value(kFrameKey)));
    std::optional<AffineTransform> toScanner;
    for (const GiftiSpace& space : found.points.spaces) {
        if (isWorld(trimmed(space.dataSpace))) {
            marks.add(CoordinateFrame::Ras);
        } else if (trimmed(space.transformedSpace) == kScannerSpace && !marks.isStated()) {
            toScanner = matrixOf(space);
        }
    }
    file.frame = marks.frame();
    const auto first = found.metadata.lower_bound(kVolumeKey);
    const bool hasVolume = first != found.metadata.end() && first->first.starts_with(kVolumeKey);
    if (file.frame == CoordinateFrame::TkRas && hasVolume) {
        file.volume = volumeOf(found.metadata);
    } else if (file.frame == CoordinateFrame::Voxel && toScanner) {
        const AffineTransform toLps = kFlip * *toScanner;
        file.volume = ImageGeometry{{}, toLps.offset, toLps.linear};
    }
    if (file.frame) return;
    if (!hasVolume) {
        if (!toScanner) return;
        file.mesh = transformed(file.mesh, *toScanner);
        file.frame = CoordinateFrame::Ras;
        return;
    }
    if (value(kProgramKey).starts_with("Workbench")) return;
    const std::optional<ImageGeometry> volume = volumeOf(found.metadata);
    if (volume && toScanner && !areAlike(*toScanner, toRas(CoordinateFrame::TkRas, volume))) return;
    file.frame = CoordinateFrame::TkRas;
    file.volume = volume;
}

/// The numbers of an array that must be N x 3, row by row.
template <class Stored, class T>
std::vector<T> decodeTriples(const GiftiArray& array, std::string_view what, Unpacking& unpacking) {
    XmlAttributes attributes = array.attributes;
    attributes.try_emplace("Dimensionality", "2");
    attributes.try_emplace("Dim1", "3");
    const GiftiShape shape = shapeOf(attributes, what);
    if (shape.columns != 3) malformed("its " + std::string(what) + " are not an array of N x 3");
    return decodeGiftiRows<Stored, T>(array, shape, what, unpacking);
}

/// Checks the end of files that the arrays have of their own, or share.
/// \pre numbers of four bytes each
void requireNoMoreExternal(const GiftiSurface& found, std::size_t coordinates, std::size_t corners,
                           std::vector<Warning>& warnings) {
    const auto fileOf = [](const GiftiArray& array) {
        return array.isExternal ? attributeOr(array.attributes, "ExternalFileName", "") : "";
    };
    const auto check = [&](const GiftiArray& array, const char* what, std::size_t numbers,
                           const GiftiArray& other) {
        const bool isFirst =
            fileOf(array) == fileOf(other) && array.text.size() > other.text.size();
        if (!array.isExternal || isFirst) return;
        requireNoMore({what, static_cast<std::int64_t>(numbers / 3), 3 * sizeof(float)},
                      std::string_view(array.text).substr(sizeof(float) * numbers), warnings);
    };
    check(found.points, "points", coordinates, found.triangles);
    check(found.triangles, "triangles", corners, found.points);
}

void encodeGifti(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    sink << kGiftiHead << "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n";
    if (record.options.saysFrame) {
        sink << "<MetaData>\n<MD><Name><![CDATA[" << kFrameKey << "]]></Name><Value><![CDATA["
             << toString(record.options.frame) << "]]></Value></MD>\n</MetaData>\n";
    } else {
        sink << "<MetaData/>\n";
    }
    sink << "<LabelTable/>\n";

    std::string bytes;
    bytes.reserve(mesh.points.size() * 3 * sizeof(float));
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) appendLittleEndian(static_cast<float>(p[axis]), bytes);
    }
    beginGiftiArray("NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", {std::ssize(mesh.points), 3},
                    sink);
    encodeVolume(record.options, sink);
    encodeCoordinateSystem(record.options, sink);
    endGiftiArray(bytes, sink);

    bytes.clear();
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId vertex : t)
            appendLittleEndian(static_cast<std::int32_t>(vertex), bytes);
    }
    beginGiftiArray("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", {std::ssize(mesh.triangles), 3},
                    sink);
    sink << "<MetaData/>\n";
    endGiftiArray(bytes, sink);
    sink << "</GIFTI>\n";
}

MeshFile decodeGifti(std::string_view bytes, const MeshReadOptions& options) {
    Unpacking unpacking(options.storedBytes > 0 ? options.storedBytes : bytes.size());
    GiftiFile content = parseGifti(bytes);
    unpacking.warnings = std::move(content.warnings);
    requireNoMore({"arrays", std::ssize(content.arrays), std::ssize(bytes)}, content.behind,
                  unpacking.warnings);
    const bool hasOthers = content.arrays.size() > 2;
    GiftiSurface found = surfaceOf(std::move(content));
    if (found.points.attributes.empty() || found.triangles.attributes.empty()) {
        const bool hasPoints = !found.points.attributes.empty();
        const bool isEmpty = found.otherIntents.empty();
        unsupported(
            "it holds " + std::string(hasPoints ? "points but no triangles"
                                      : isEmpty ? "no data"
                                                : "values at points (" + found.otherIntents.back() +
                                                      "), no surface"),
            "give the surface with its points and triangles (.surf.gii)");
    }
    loadExternal(found.points, options.folder);
    loadExternal(found.triangles, options.folder);
    requireGiftiType(found.points, "NIFTI_TYPE_FLOAT32", "points");
    requireGiftiType(found.triangles, "NIFTI_TYPE_INT32", "triangles");

    MeshFile file;
    const auto points = decodeTriples<float, double>(found.points, "points", unpacking);
    for (std::size_t i = 0; i < points.size(); i += 3) {
        file.mesh.points.push_back({points[i], points[i + 1], points[i + 2]});
    }
    const auto corners =
        decodeTriples<std::int32_t, VertexId>(found.triangles, "triangles", unpacking);
    if (!hasOthers) requireNoMoreExternal(found, points.size(), corners.size(), unpacking.warnings);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        file.mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
    place(found, options, file);
    if (options.keepsPointArrays) file.arraysLeftOut = std::move(found.otherIntents);
    file.warnings = std::move(unpacking.warnings);
    return file;
}

bool isGifti(std::string_view head, std::uint64_t /*byteCount*/) {
    return xmlRoot(head) == "GIFTI";
}

}  // namespace

extern const Codec kGiftiCodec{isGifti, decodeGifti, encodeGifti};

}  // namespace adaptiso::meshio
