#include "adaptiso/MeshIO/MeshFile.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "Bytes.h"
#include "Codecs.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/Surplus.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Scene.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso {
namespace {

/// The fault of `mesh`'s normals, or an empty text.
std::string findNormalsFault(const TriangleMesh& mesh) {
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.points.size()) {
        return "it has " + std::to_string(mesh.normals.size()) + " normals for " +
               std::to_string(mesh.points.size()) + " points, must be one each or none";
    }
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        if (!std::isfinite(squaredNorm(toVec3(mesh.normals[i])))) {
            return "the normal of point " + std::to_string(i) + " is not finite";
        }
    }
    return {};
}

/// The fault of `mesh`, or an empty text. Coordinates must be in [-limit, limit].
std::string findFault(const TriangleMesh& mesh, double limit) {
    if (mesh.triangles.empty()) return "it has no triangle";
    const auto points = static_cast<VertexId>(mesh.points.size());
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!(std::abs(mesh.points[i][axis]) <= limit)) {
                return "coordinate " + std::to_string(axis) + " of point " + std::to_string(i) +
                       " is " + formatShort(mesh.points[i][axis]) +
                       ", must be finite and within single precision";
            }
        }
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const VertexId vertex : mesh.triangles[t]) {
            if (vertex < 0 || vertex >= points) {
                return "triangle " + std::to_string(t) + " uses point " + std::to_string(vertex) +
                       ", must be 0 to " + std::to_string(points - 1);
            }
        }
    }
    return findNormalsFault(mesh);
}

[[noreturn]] void refuseEmpty(const TriangleMesh& mesh) {
    const std::string points = std::to_string(mesh.points.size());
    meshio::unsupported(mesh.triangles.empty() ? "it holds " + points + " points and no triangle"
                                               : "it holds no point",
                        "give a surface of triangles");
}

/// Requirements even for a mesh that may be broken.
void requireSomething(TriangleMesh& mesh) {
    if (mesh.triangles.empty() || mesh.points.empty()) refuseEmpty(mesh);
    if (!findNormalsFault(mesh).empty()) mesh.normals.clear();
}

/// Arrays are read by the count of points that the file names.
void requireOneEach(const MeshFile& file) {
    for (const PointArray& array : file.pointArrays) {
        if (array.points() == file.mesh.points.size()) continue;
        meshio::damaged("its array " + printable(array.name) + " has values for " +
                        std::to_string(array.points()) + " points, not " +
                        std::to_string(file.mesh.points.size()));
    }
}

constexpr double kFloatMax = std::numeric_limits<float>::max();

void requireNeutralName(const std::string& name) {
    for (const char c : name) {
        if (c <= ' ' || c > '~' || c == '/' || c == '\\' || c == '=') {
            throw InvalidInput("the volume name " + printable(name) +
                               " must be a file name of printable ASCII without folder, space "
                               "or '='");
        }
    }
}

void requireOneEach(const std::string& array, std::size_t values, std::size_t count,
                    const std::string& what, const std::string& file) {
    if (values == count) return;
    throw InvalidInput(file + ": the array " + printable(array) + " has " + std::to_string(values) +
                       " values for " + std::to_string(count) + " " + what + ", must be one each");
}

void requireArrays(const MeshWriteOptions& options, const TriangleMesh& mesh,
                   const MeshFormat& format, const std::string& file) {
    const bool areColors =
        options.pointArrays.size() == 1 &&
        std::holds_alternative<std::vector<Color>>(options.pointArrays.front().values);
    const bool fits = (options.pointArrays.empty() || format.holdsPointArrays ||
                       (areColors && format.holdsColors)) &&
                      (options.cellArrays.empty() || format.holdsCellArrays);
    if (!fits) {
        throw InvalidInput(file + ": " + std::string(format.name) + " files hold no values at " +
                           (options.cellArrays.empty() ? "points" : "triangles") + "; write .vtp");
    }
    for (const PointArray& array : options.pointArrays) {
        requireOneEach(array.name, array.points(), mesh.points.size(), "points", file);
    }
    for (const CellArray& array : options.cellArrays) {
        requireOneEach(array.name, array.cells(), mesh.triangles.size(), "triangles", file);
    }
}

void requireWritable(const TriangleMesh& mesh, const MeshFormat& format,
                     const MeshWriteOptions& options, const std::string& file) {
    const std::string fault = findFault(mesh, kFloatMax);
    if (!fault.empty()) throw InvalidInput(file + ": the mesh is bad: " + fault);
    const std::size_t most = std::max(mesh.points.size(), mesh.triangles.size());
    if (most > static_cast<std::uint64_t>(format.maxElements)) {
        throw InvalidInput(file + ": " + std::string(format.name) + " files hold at most " +
                           std::to_string(format.maxElements) +
                           " points and triangles, the mesh has " + std::to_string(most));
    }
    if (options.frame == CoordinateFrame::Voxel && !format.holdsVoxelFrame) {
        throw InvalidInput(file + ": " + std::string(format.name) +
                           " files hold mm, not voxel indices; write RAS, LPS or tkRAS");
    }
    requireNeutralName(options.volumeName);
    requireArrays(options, mesh, format, file);
}

TriangleMesh movedTo(const MeshWriteOptions& options, const TriangleMesh& mesh,
                     const std::string& file) {
    if (options.isInFrame) return mesh;
    try {
        return toFrame(mesh, options.frame, options.volume);
    } catch (const InvalidInput& error) {
        throw InvalidInput(file + ": " + error.what());
    }
}

/// Scales normals that are not of unit length; the others keep their very bits.
void scaleToUnitLength(std::vector<Normal>& normals) {
    constexpr double kFloatSlack = 1e-6;  // of the squared length of a unit vector kept as float
    for (Normal& normal : normals) {
        const Vec3 v = toVec3(normal);
        if (std::abs(squaredNorm(v) - 1) > kFloatSlack) normal = toNormal(v);
    }
}

/// ", meshes/*.stl" of a folder that holds such files, by the extension of most of them.
std::string filesToGive(const std::filesystem::path& folder) {
    std::map<std::string, int, std::less<>> extensions;
    std::error_code error;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
         at.increment(error)) {
        std::error_code unknown;
        if (at->is_regular_file(unknown)) ++extensions[at->path().extension().string()];
    }
    std::string_view most;
    int files = 0;
    for (const MeshFormat& format : meshFormats()) {
        for (const std::string_view extension : format.extensions) {
            const auto found = extensions.find(extension);
            if (found == extensions.end() || found->second <= files) continue;
            files = found->second;
            most = extension;
        }
    }
    return files == 0 ? "; of images adaptiso-mesh makes surfaces"
                      : ", " + (folder / ("*" + std::string(most))).string();
}

constexpr std::string_view kGzipMagic = "\x1F\x8B";

/// By content, else by name. \throws FileError  neither says it
const MeshFormat& formatOf(std::string_view bytes, std::string_view name, bool isPacked) {
    const std::string_view head = bytes.substr(0, kMeshHeadBytes);
    if (const MeshFormat* const found = recognizeMeshFormat(head, bytes.size())) return *found;
    const std::filesystem::path path(name);
    meshio::naming(name, [&] { meshio::refuseOtherContent(head, bytes.size(), path, isPacked); });
    try {
        return findMeshFormat(isPacked ? path.parent_path() / path.stem() : path);
    } catch (const InvalidInput& error) {
        throw FileError(std::string(error.what()) +
                        "; its content is of none of these formats either");
    }
}

}  // namespace

namespace meshio {

std::string headerLine(const MeshWriteOptions& options) {
    const std::string line = "adaptiso surface";
    return options.saysFrame ? line + ", " + frameMarker(options.frame) : line;
}

std::string slicerHeaderLine(const MeshWriteOptions& options) {
    const std::string mark = options.saysFrame ? slicerMarker(options.frame) : std::string();
    return headerLine(options) + (mark.empty() ? "" : ", " + mark);
}

void FrameMarks::add(std::optional<CoordinateFrame> frame) {
    if (isStated_ || !frame) return;
    if (frame_ && *frame_ != *frame) {
        unsupported("it says two coordinate frames, " + std::string(toString(*frame_)) + " and " +
                        std::string(toString(*frame)),
                    "state the right one by --input-coordinates (input_coordinates in Python)");
    }
    frame_ = frame;
}

void FrameMarks::addText(std::string_view text) {
    add(findFrameMarker(text));
    for (const CoordinateFrame frame : {CoordinateFrame::Ras, CoordinateFrame::Lps}) {
        if (text.find(slicerMarker(frame)) != std::string_view::npos) add(frame);
    }
}

std::string storedName(std::string_view name) {
    constexpr std::size_t kLongest = 200;
    std::string stored(name.substr(0, kLongest));
    for (char& c : stored) {
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    }
    return stored;
}

std::string TakenNames::unused(std::string name) {
    const std::string first = name;
    for (int tries = 0; tries < 4; ++tries, name += '_') {
        if (taken_.insert(name).second) return name;
    }
    std::size_t& number = numbers_[first];
    do {
        name = first + "_" + std::to_string(++number);
    } while (!taken_.insert(name).second);
    return name;
}

Normal storedNormal(const Vec3& v) {
    return {toFloat(v.x, "a normal"), toFloat(v.y, "a normal"), toFloat(v.z, "a normal")};
}

}  // namespace meshio

void writeMesh(const TriangleMesh& mesh, const std::filesystem::path& path,
               const MeshWriteOptions& options) {
    const MeshFormat& format = findMeshFormat(path);
    requireWritable(mesh, format, options, path.string());
    const TriangleMesh moved = movedTo(options, mesh, path.string());
    requireWritable(moved, format, options, path.string());

    writeBytes(path, [&](ByteSink& sink) { format.codec->encode({moved, options}, sink); });
}

bool holdsScene(const MeshFormat& format) {
    return format.codec->encodeParts != nullptr;
}

void writeScene(std::vector<ScenePart> parts, const std::filesystem::path& path,
                const MeshWriteOptions& options) {
    const MeshFormat& format = findMeshFormat(path);
    if (!holdsScene(format)) {
        TriangleMesh whole;
        for (const auto& [name, color, mesh] : parts) {
            const auto first = static_cast<VertexId>(whole.points.size());
            whole.points.insert(whole.points.end(), mesh.points.begin(), mesh.points.end());
            for (const Triangle& t : mesh.triangles) {
                whole.triangles.push_back({first + t[0], first + t[1], first + t[2]});
            }
        }
        return writeMesh(whole, path, options);
    }
    std::vector<meshio::MeshPart> encoded;
    for (ScenePart& part : parts) {
        requireWritable(part.mesh, format, options, path.string());
        part.mesh = movedTo(options, part.mesh, path.string());
        requireWritable(part.mesh, format, options, path.string());
        std::string name = meshio::storedName(toUtf8(part.name));
        while (!isUtf8(name)) name.pop_back();  // cut within a character
        encoded.push_back({std::move(name), part.color, &part.mesh});
    }
    writeBytes(path, [&](ByteSink& sink) { format.codec->encodeParts(encoded, options, sink); });
}

MeshFile decodeMesh(std::string_view bytes, const MeshFormat& format, std::string_view name,
                    const MeshReadOptions& options) {
    return meshio::naming(name, [&] {
        MeshReadOptions own = options;
        if (own.part.empty()) own.part = meshio::fiffPart(name).second;
        MeshFile file =
            format.codec->decode(format.codec->isText ? withoutByteOrderMark(bytes) : bytes, own);
        file.format = &format;
        if (options.keepsFaults) {
            requireSomething(file.mesh);
        } else {
            if (file.mesh.triangles.empty()) refuseEmpty(file.mesh);
            const std::string fault = findFault(file.mesh, std::numeric_limits<double>::max());
            if (!fault.empty()) meshio::unsupported(fault, "repair the mesh or get the file again");
        }
        requireOneEach(file);
        scaleToUnitLength(file.mesh.normals);
        return file;
    });
}

MeshFile decodeMesh(std::string_view bytes, std::string_view name, const MeshReadOptions& options) {
    const bool isPacked = bytes.starts_with(kGzipMagic);
    const std::size_t storedBytes = bytes.size();
    std::string_view behind;
    const std::string unpacked = meshio::naming(name, [&] {
        if (!isPacked) return std::string();
        const std::string head = meshio::gunzipped(bytes, kMeshHeadBytes);
        if (!recognizeMeshFormat(head, 0)) meshio::refuseOtherContent(head, 0, name, true);
        return meshio::gunzipped(bytes, std::string().max_size(), &behind);
    });
    if (isPacked) bytes = unpacked;
    MeshReadOptions unpackedOptions = options;
    if (isPacked) unpackedOptions.storedBytes = storedBytes;
    MeshFile file = decodeMesh(bytes, formatOf(bytes, name, isPacked), name, unpackedOptions);
    if (!areZeros(behind)) {
        file.warnings.push_back({"trailing-bytes",
                                 "something that is no compressed data follows the compressed "
                                 "surface; it was left out"});
    }
    return file;
}

MeshFile readMesh(const std::filesystem::path& path, const MeshReadOptions& options) {
    const std::string name = path.string();
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
        throw FileError(name + ": this is a folder, not a surface; give the files in it" +
                        filesToGive(path));
    }
    // images may be large: the head is enough
    const std::filesystem::path file = meshio::fiffPart(path).first;
    const std::string head = meshio::readBytes(file, kMeshHeadBytes);
    const std::uint64_t byteCount = std::filesystem::file_size(file, error);
    if (!head.starts_with(kGzipMagic) && !recognizeMeshFormat(head, byteCount)) {
        meshio::naming(name, [&] { meshio::refuseOtherContent(head, byteCount, file, false); });
        const auto foreign = findForeignContent(file);  // zeros, whatever their length
        if (foreign) throw FileError(name + ": " + foreign->fault + "; " + foreign->remedy);
    }
    MeshReadOptions beside = options;
    beside.folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    return decodeMesh(meshio::readBytes(file), name, beside);
}

}  // namespace adaptiso
