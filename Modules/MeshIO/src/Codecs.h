#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Bytes.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {

/// Input of an encoder: a mesh already in `options.frame`, checked by writeMesh().
struct MeshRecord {
    const TriangleMesh& mesh;
    const MeshWriteOptions& options;
};

/// One of several meshes of a file, in its frame.
struct MeshPart {
    std::string name;  ///< UTF-8 without control characters
    std::optional<Color> color;
    const TriangleMesh* mesh;
};

/// How a format is recognised, read and written: one at the end of each format's .cxx, all in the
/// table of Formats.cxx.
struct Codec {
    /// By a file's first kMeshHeadBytes bytes, all of a shorter file; unpacked.
    bool (*recognizes)(std::string_view head, std::uint64_t byteCount);
    /// Throws FileError without the file's name. What it returns is checked by decodeMesh()
    /// (indices, finite numbers, normals one per point), which also scales normals to unit length.
    MeshFile (*decode)(std::string_view bytes, const MeshReadOptions& options);
    void (*encode)(const MeshRecord& record, ByteSink& sink);
    /// Else any bytes may begin it, also those of a byte order mark; such formats are looked for
    /// first.
    bool isText = true;
    /// Null in formats of one mesh. Arrays in `options` are of a single part.
    void (*encodeParts)(std::span<const MeshPart> parts, const MeshWriteOptions& options,
                        ByteSink& sink) = nullptr;
};

/// The first line that is neither empty nor a comment.
std::string_view firstLine(std::string_view text);
/// True for words of digits and what else numbers are written with.
bool isNumber(std::string_view word);
/// FF FF FF begins both FreeSurfer's surfaces of quadrangles and its values at points (curv).
bool isCurv(std::string_view head, std::uint64_t byteCount);

/// "model-bem.fif" and "outer_skin" of "model-bem.fif:outer_skin"; else the path and an empty text.
std::pair<std::filesystem::path, std::string> fiffPart(const std::filesystem::path& path);

/// The writer and, if options.saysFrame, the frame, on one line:
/// "adaptiso surface, CoordinateFrame: RAS mm".
std::string headerLine(const MeshWriteOptions& options);
/// The same with 3D Slicer's mark, in formats that Slicer reads: "..., SPACE=RAS".
std::string slicerHeaderLine(const MeshWriteOptions& options);

/// Collects the marks of a file's frame. Contradicting marks are refused; no mark is
/// looked at where options.inputCoordinates states the frame.
class FrameMarks {
public:
    explicit FrameMarks(const MeshReadOptions& options)
        : isStated_(options.inputCoordinates.has_value()), frame_(options.inputCoordinates) {}

    void add(std::optional<CoordinateFrame> frame);
    /// Our mark and 3D Slicer's in a header line or comment.
    void addText(std::string_view text);
    const std::optional<CoordinateFrame>& frame() const { return frame_; }
    bool isStated() const { return isStated_; }

private:
    bool isStated_;
    std::optional<CoordinateFrame> frame_;
};

/// A name from a file as messages and other files can have it: control characters are '?', and it
/// is cut at 200 bytes.
std::string storedName(std::string_view name);

/// Names that a file holds once each.
class TakenNames {
public:
    explicit TakenNames(std::set<std::string> taken) : taken_(std::move(taken)) {}

    /// `name`, or with up to three '_' behind it, or with "_1", "_2", ...; it is taken from now on.
    /// Cost: n log n for n names, whatever they are.
    std::string unused(std::string name);

private:
    std::set<std::string> taken_;
    std::map<std::string, std::size_t> numbers_;  ///< the last one behind a name
};

/// A normal as a file has it, whatever its length. Damage where float can't hold it.
Normal storedNormal(const Vec3& v);

/// Refuses images, surfaces of formats that are not read, and what findForeignContent() knows; says
/// what reads or converts them. \param head        the first kMeshHeadBytes bytes, unpacked \param
/// byteCount   of the file, unpacked \param isInflated  the file is gzip \throws FileError "<what
/// is wrong>; <what to do>"
void refuseOtherContent(std::string_view head, std::uint64_t byteCount,
                        const std::filesystem::path& path, bool isInflated);

/// Full shade of a number without a decimal point: OBJ's 1, OFF's 255.
enum class ColorScale { One, Byte };

/// Collects colours that follow the coordinates of points in lines of text.
class PointColors {
public:
    /// \param areWanted  else nothing is read
    explicit PointColors(bool areWanted) : areWanted_(areWanted) {}

    /// Reads the next three words, for each point in turn. Other words: the point has no colour.
    void add(ByteSource& line, ColorScale scale);

    /// "RGB" where each point has one; else nothing.
    std::vector<PointArray> take(std::size_t points);

private:
    bool areWanted_;
    std::vector<Color> colors_;
};

/// The colours to write in a format that holds no other arrays; may be null.
const std::vector<Color>* colorsOf(const MeshWriteOptions& options);

}  // namespace adaptiso::meshio
