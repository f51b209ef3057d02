// Wavefront OBJ: "v x y z", "vn x y z", "f a//a b//b c//c ...", numbered from 1. As many
// programs have it, "v x y z r g b" is a point with a colour, 0 to 1. Groups, materials and texture
// coordinates are passed over when read; a '\\' at the end of a point or face joins the next line.
// OFF: "OFF", "V F 0", V lines "x y z", F lines "n a b c ..." from 0; '#' begins a comment. With
// "COFF" points have colours, "x y z r g b a": whole numbers to 255, or with a decimal point, 0
// to 1. "NOFF", "STOFF", "CNOFF" and "STCNOFF": what follows x y z is passed over.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "Faces.h"

namespace adaptiso::meshio {

namespace {

std::optional<std::uint8_t> shadeOf(std::string_view word, ColorScale scale) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        return {};
    const bool isPart =
        scale == ColorScale::One || word.find_first_of(".eE") != std::string_view::npos;
    constexpr double kFull = 255;
    return static_cast<std::uint8_t>(
        std::lround(std::clamp(isPart ? kFull * value : value, 0.0, kFull)));
}

}  // namespace

void PointColors::add(ByteSource& line, ColorScale scale) {
    if (!areWanted_) return;
    Color color;
    for (std::uint8_t& shade : color) {
        const std::optional<std::uint8_t> read = shadeOf(line.word(), scale);
        if (!read) {
            areWanted_ = false;  // one without a colour: none has
            return;
        }
        shade = *read;
    }
    colors_.push_back(color);
}

std::vector<PointArray> PointColors::take(std::size_t points) {
    if (!areWanted_ || points == 0 || colors_.size() != points) return {};
    return {PointArray{"RGB", std::move(colors_)}};
}

const std::vector<Color>* colorsOf(const MeshWriteOptions& options) {
    if (options.pointArrays.empty()) return nullptr;
    return std::get_if<std::vector<Color>>(&options.pointArrays.front().values);
}

namespace {

constexpr std::int64_t kNone = -1;

Vec3 readVec(ByteSource& line, std::string_view what) {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) v[axis] = line.realWord(what);
    return v;
}

/// From a number in a face (from 1, or negative: back from the last) to an index from 0.
std::int64_t resolved(std::string_view word, std::size_t count, std::string_view what) {
    const std::int64_t number = toInteger(word, what);
    if (number >= 0) return number - 1;  // 0 is invalid: -1 is refused below or by decodeMesh()
    return static_cast<std::int64_t>(count) + number;
}

class ObjDecoder {
public:
    explicit ObjDecoder(const MeshReadOptions& options)
        : keepsFaults_(options.keepsFaults), colors_(options.keepsPointArrays), marks_(options) {}

    void decodeLine(std::string_view text) {
        ByteSource line(text.substr(0, findComment(text)));
        const std::string_view kind = line.word();
        if (kind == "v") {
            beginPoint();
            mesh_.points.push_back(readVec(line, "a coordinate"));
            colors_.add(line, ColorScale::One);
        } else if (kind == "vn") {
            normals_.push_back(storedNormal(readVec(line, "a normal")));
        } else if (kind == "f") {
            decodeFace(line);
        } else if (trimmed(text).starts_with('#')) {
            marks_.addText(text);
        }
    }

    MeshFile finish() && {
        // OBJ counts nothing, but numbers go on through a file, and begin anew in the next
        if (isAmongPoints_ && beginsWithFaces_) noteBlock();
        if (blocks_ > 1 && usedBlocks_ < blocks_ && !beginsWithFaces_) {
            unsupported(
                "it holds points behind its faces, and the faces that follow them number none "
                "of them",
                "are two files joined? give each by itself");
        }
        if (blocks_ > 1 && largestUsed_ < largestBlock_) {
            unsupported(
                "it holds points behind its faces, and no face numbers them from where the "
                "points before end",
                "are two files joined? give each by itself");
        }
        finishNormals();
        MeshFile file{std::move(mesh_), marks_.frame(), std::nullopt};
        file.pointArrays = colors_.take(file.mesh.points.size());
        std::move(faces_).moveTo(file, keepsFaults_);
        return file;
    }

private:
    void finishNormals() {
        if (isNumberedAlike()) {
            mesh_.normals = std::move(normals_);
            return;
        }
        const bool eachHasOne =
            oneNormalEach_ && !normals_.empty() && normalOf_.size() == mesh_.points.size();
        for (std::size_t i = 0; eachHasOne && i < normalOf_.size(); ++i) {
            if (normalOf_[i] == kNone) return;
        }
        if (!eachHasOne) return;
        for (const std::int64_t n : normalOf_) mesh_.normals.push_back(normals_[n]);
    }

    /// One normal for each vertex, under the same number: then vertices that no face uses have
    /// theirs too.
    bool isNumberedAlike() const {
        if (!oneNormalEach_ || normalOf_.empty() || normals_.size() != mesh_.points.size()) {
            return false;
        }
        for (std::size_t i = 0; i < normalOf_.size(); ++i) {
            if (normalOf_[i] != kNone && normalOf_[i] != static_cast<std::int64_t>(i)) return false;
        }
        return true;
    }

    void decodeFace(ByteSource& line) {
        corners_.clear();
        for (std::string_view word = line.word(); !word.empty(); word = line.word()) {
            corners_.push_back(decodeCorner(word));
        }
        if (corners_.empty()) malformed("a face has no corners");
        faces_.add(corners_);
        if (isAmongPoints_) noteBlock();
        if (mesh_.points.empty()) beginsWithFaces_ = true;
        isAmongPoints_ = false;
        const VertexId largest = *std::ranges::max_element(corners_);
        largestUsed_ = std::max(largestUsed_, largest);
        if (!isBlockUsed_ && largest >= blockBegin_) {
            isBlockUsed_ = true;
            ++usedBlocks_;
        }
    }

    void beginPoint() {
        if (!isAmongPoints_) blockBegin_ = std::ssize(mesh_.points);
        isAmongPoints_ = true;
    }

    /// Of points with faces behind them: those at the end may be landmarks.
    void noteBlock() {
        ++blocks_;
        isBlockUsed_ = false;
        largestBlock_ = std::max(largestBlock_, std::ssize(mesh_.points) - blockBegin_);
    }

    /// "v", "v/vt", "v//vn" or "v/vt/vn"; "v/", "v//" and "v/vt/" have no normal.
    VertexId decodeCorner(std::string_view word) {
        const std::size_t first = word.find('/');
        const VertexId vertex =
            resolved(word.substr(0, first), mesh_.points.size(), "a face's vertex");
        const std::size_t second =
            first == std::string_view::npos ? first : word.find('/', first + 1);
        if (second == std::string_view::npos || second + 1 == word.size()) {
            oneNormalEach_ = false;
        } else {
            noteNormal(vertex, resolved(word.substr(second + 1), normals_.size(), "a normal"));
        }
        return vertex;
    }

    void noteNormal(VertexId vertex, std::int64_t normal) {
        const auto count = static_cast<std::int64_t>(normals_.size());
        if (normal < 0 || normal >= count) malformed("a face uses a normal that is not there");
        if (vertex < 0 || vertex >= static_cast<std::int64_t>(mesh_.points.size())) return;
        if (normalOf_.size() < mesh_.points.size()) normalOf_.resize(mesh_.points.size(), kNone);
        std::int64_t& noted = normalOf_[vertex];
        if (noted != kNone && !(normals_[noted] == normals_[normal])) oneNormalEach_ = false;
        noted = normal;
    }

    bool keepsFaults_;
    TriangleMesh mesh_;  ///< without triangles
    Faces faces_;
    std::vector<VertexId> corners_;  ///< of a face
    PointColors colors_;
    FrameMarks marks_;
    std::vector<Normal> normals_;         ///< as listed in the file
    std::vector<std::int64_t> normalOf_;  ///< of each vertex; kNone where no face gave one yet
    bool oneNormalEach_ = true;
    bool isAmongPoints_ = false;  ///< no face since the last point
    bool beginsWithFaces_ = false;
    bool isBlockUsed_ = true;                                      ///< by the faces behind it
    std::int64_t blocks_ = 0, usedBlocks_ = 0, largestBlock_ = 0;  ///< of points between faces
    std::int64_t blockBegin_ = 0;
    VertexId largestUsed_ = -1;
};

void encodeObj(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    sink << "# " << slicerHeaderLine(record.options) << "\n";
    const std::vector<Color>* const colors = colorsOf(record.options);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec3& p = mesh.points[i];
        sink << "v " << p.x << " " << p.y << " " << p.z;
        if (colors != nullptr) {
            for (const std::uint8_t shade : (*colors)[i]) sink << " " << shade / 255.0;
        }
        sink << "\n";
    }
    for (const Normal& n : mesh.normals) {
        sink << "vn " << double{n.x} << " " << double{n.y} << " " << double{n.z} << "\n";
    }
    for (const Triangle& t : mesh.triangles) {
        sink << "f";
        for (const VertexId vertex : t) {
            sink << " " << vertex + 1;
            if (!mesh.normals.empty()) sink << "//" << vertex + 1;
        }
        sink << "\n";
    }
}

MeshFile decodeObj(std::string_view bytes, const MeshReadOptions& options) {
    ByteSource source(bytes);
    ObjDecoder decoder(options);
    while (!source.atEnd()) {
        const std::string_view line = source.line(), content = trimmed(line);
        const bool isJoined =
            content.ends_with('\\') && (content.starts_with('v') || content.starts_with('f'));
        if (!isJoined) {
            decoder.decodeLine(line);
            continue;
        }
        std::string joined(line);
        while (trimmed(joined).ends_with('\\')) {
            joined.resize(joined.rfind('\\'));
            joined.append(" ").append(source.line());
        }
        decoder.decodeLine(joined);
    }
    return std::move(decoder).finish();
}

/// Lines of Wavefront's keywords up to a point.
bool isObj(std::string_view head, std::uint64_t /*byteCount*/) {
    constexpr std::string_view kOthers[] = {"mtllib", "usemtl", "o", "g", "s", "vt", "vn", "vp"};
    ByteSource source(head);
    while (!source.atEnd()) {
        ByteSource line(source.line());
        const std::string_view word = line.word();
        if (word.empty() || word.starts_with('#') || std::ranges::count(kOthers, word)) continue;
        return word == "v" && isNumber(line.word()) && isNumber(line.word()) &&
               isNumber(line.word());
    }
    return false;
}

}  // namespace

extern const Codec kObjCodec{isObj, decodeObj, encodeObj};

namespace {

/// Lines without their comments, empty ones left out; keeps the frame that a comment names.
class OffLines {
public:
    OffLines(std::string_view bytes, const MeshReadOptions& options)
        : marks(options), source_(bytes) {}

    ByteSource next(std::string_view what) {
        while (!source_.atEnd()) {
            const std::string_view line = source_.line();
            const std::size_t comment = findComment(line);
            if (comment != std::string_view::npos) marks.addText(line.substr(comment));
            const std::string_view content = trimmed(line.substr(0, comment));
            if (!content.empty()) return ByteSource(content);
        }
        damaged("it ends where " + std::string(what) + " is due");
    }
    std::size_t left() const { return source_.left(); }

    /// From the next line that is not empty on.
    std::string_view rest() {
        for (ByteSource ahead = source_; !ahead.atEnd(); source_ = ahead) {
            const std::string_view line = ahead.line();
            if (!trimmed(line.substr(0, findComment(line))).empty()) break;
        }
        return source_.rest();
    }

    /// Lines that are not empty.
    std::int64_t countLeft() const {
        std::int64_t count = 0;
        for (OffLines lines = *this; !lines.rest().empty(); lines.source_.line()) ++count;
        return count;
    }

    FrameMarks marks;

private:
    ByteSource source_;
};

void encodeOff(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    const std::vector<Color>* const colors = colorsOf(record.options);
    sink << (colors != nullptr ? "COFF" : "OFF") << "\n# " << headerLine(record.options) << "\n";
    sink << static_cast<std::int64_t>(mesh.points.size()) << " "
         << static_cast<std::int64_t>(mesh.triangles.size()) << " 0\n";
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec3& p = mesh.points[i];
        sink << p.x << " " << p.y << " " << p.z;
        if (colors != nullptr) {
            for (const std::uint8_t shade : (*colors)[i]) sink << " " << std::int64_t{shade};
            sink << " 255";
        }
        sink << "\n";
    }
    for (const Triangle& t : mesh.triangles) {
        sink << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    }
}

MeshFile decodeOff(std::string_view bytes, const MeshReadOptions& options) {
    OffLines lines(bytes, options);
    ByteSource line = lines.next("the word OFF");
    const std::string_view magic = line.word();
    const bool isOff =
        magic.ends_with("OFF") && magic.find_first_not_of("STCNOF") == std::string_view::npos;
    if (!isOff || lowerCase(ByteSource(line.rest()).word()) == "binary") {
        unsupported("it begins with " + printable(std::string(magic) + std::string(line.rest())) +
                        ", must begin with OFF or COFF",
                    "save it as plain OFF text");
    }
    const bool hasColors = magic == "COFF";
    if (trimmed(line.rest()).empty()) line = lines.next("the number of points");
    const std::int64_t points = line.integerWord("the number of points");
    const std::int64_t triangles = line.integerWord("the number of faces");
    requireRoom("points", points, 5, lines.left());  // at least "0 0 0"
    Counted faces{"faces", triangles, 4};
    if (!isUnset(triangles)) requireRoom("faces", triangles, 7, lines.left());  // "3 0 0 0"

    MeshFile file;
    PointColors colors(options.keepsPointArrays && hasColors);
    file.mesh.points.resize(points);
    for (Vec3& p : file.mesh.points) {
        line = lines.next("a point");
        for (int axis = 0; axis < 3; ++axis) p[axis] = line.realWord("a coordinate");
        colors.add(line, ColorScale::Byte);
    }
    file.pointArrays = colors.take(file.mesh.points.size());
    if (const std::int64_t there = isUnset(faces.count) ? lines.countLeft() : 0; there > 0) {
        setToThere(faces, there, file.warnings);
    }
    requireRoom(faces.what, faces.count, 7, lines.left());
    Faces polygons;
    polygons.reserve(static_cast<std::size_t>(faces.count));
    std::vector<VertexId> corners;
    for (std::int64_t i = 0; i < faces.count; ++i) {
        line = lines.next("a face");
        corners.clear();
        for (auto left = line.integerWord("the number of corners"); left > 0; --left) {
            corners.push_back(line.integerWord("a face's vertex"));
        }
        polygons.add(corners);
    }
    std::move(polygons).moveTo(file, options.keepsFaults);
    requireNoMoreText(faces, lines.rest(), file.warnings);
    file.frame = lines.marks.frame();
    return file;
}

bool isOff(std::string_view head, std::uint64_t /*byteCount*/) {
    const std::string_view line = firstLine(head);
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    return word.ends_with("OFF") && word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

}  // namespace

extern const Codec kOffCodec{isOff, decodeOff, encodeOff};

}  // namespace adaptiso::meshio
