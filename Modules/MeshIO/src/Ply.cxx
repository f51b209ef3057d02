// PLY 1.0. Written: binary little endian, double coordinates, float normals, int vertex indices;
// other values of vertices as double, colours as uchar red, green, blue, whole numbers as uchar or
// int where they fit.
// Read: text and binary of either byte order, any property types, other elements passed over. In
// text, what a line holds beyond its row is passed over (old VCGLIB wrote more numbers than its
// header names); rows may also be broken over lines, or share one.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Bytes.h"
#include "Codecs.h"
#include "Counts.h"
#include "Faces.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::meshio {
namespace {

constexpr std::string_view kStrips = "tristrips";
constexpr std::int64_t kMostRows = std::int64_t{1} << 40;  // beyond what memory holds

enum class Encoding { Text, LittleEndian, BigEndian };

struct Property {
    std::string name;
    PixelType type{};
    bool isList = false;
    PixelType countType{};
};

struct Element {
    std::string name;
    std::int64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding{};
    std::vector<Element> elements;
    FrameMarks marks;
};

PixelType parseScalar(std::string_view name) {
    struct Entry {
        std::string_view name, otherName;
        PixelType type;
    };
    static constexpr std::array<Entry, 8> kEntries{{{"char", "int8", PixelType::Int8},
                                                    {"uchar", "uint8", PixelType::UInt8},
                                                    {"short", "int16", PixelType::Int16},
                                                    {"ushort", "uint16", PixelType::UInt16},
                                                    {"int", "int32", PixelType::Int32},
                                                    {"uint", "uint32", PixelType::UInt32},
                                                    {"float", "float32", PixelType::Float32},
                                                    {"double", "float64", PixelType::Float64}}};
    for (const Entry& entry : kEntries) {
        if (name == entry.name || name == entry.otherName) return entry.type;
    }
    unsupported("a property has the unknown type " + printable(name),
                "save it again with int, float or double");
}

Encoding parseEncoding(std::string_view word) {
    if (word == "ascii") return Encoding::Text;
    if (word == "binary_little_endian") return Encoding::LittleEndian;
    if (word == "binary_big_endian") return Encoding::BigEndian;
    malformed("its encoding is " + printable(word) +
              ", must be ascii, binary_little_endian or binary_big_endian");
}

Property parseProperty(ByteSource& line) {
    Property property;
    const std::string_view type = line.requireWord("a property's type");
    property.isList = type == "list";
    if (property.isList) {
        property.countType = parseScalar(line.requireWord("a list's count type"));
        property.type = parseScalar(line.requireWord("a list's type"));
    } else {
        property.type = parseScalar(type);
    }
    property.name = line.requireWord("a property's name");
    return property;
}

/// The next line of a header. Where lines end in a carriage return alone, data that begin with a
/// line feed follow the last.
std::string_view nextHeaderLine(ByteSource& source, bool isCarriageReturnAlone) {
    const std::size_t begin = source.position();
    const std::string_view line = source.line();
    if (isCarriageReturnAlone) source.seek(std::min(begin + line.size() + 1, source.position()));
    return line;
}

/// Refuses what a reader would take for the other of two.
void requireNew(std::set<std::string>& names, const std::string& name, std::string_view what) {
    if (names.insert(name).second) return;
    malformed("its header has the " + std::string(what) + " " + printable(name) + " twice");
}

Header parseHeader(ByteSource& source, const MeshReadOptions& options) {
    Header header{{}, {}, FrameMarks(options)};
    const std::string_view bytes = source.rest();
    const std::size_t end = std::min(bytes.find_first_of("\r\n"), bytes.size());
    const bool isOldMac =
        bytes.substr(end).starts_with('\r') && !bytes.substr(end).starts_with("\r\n");
    if (lowerCase(trimmed(nextHeaderLine(source, isOldMac))) != "ply") {
        unsupported("its first line is not 'ply'", "it is no PLY file: get it again");
    }
    bool hasFormat = false;
    std::set<std::string> elements, properties;
    while (!source.atEnd()) {
        const std::string_view text = nextHeaderLine(source, isOldMac);
        ByteSource line(text);
        const std::string kind = lowerCase(line.word());
        if (kind == "format") {
            if (hasFormat) malformed("its header says twice how it is encoded");
            header.encoding = parseEncoding(line.requireWord("the encoding"));
            hasFormat = true;
        } else if (kind == "comment") {
            header.marks.addText(text);
        } else if (kind == "element") {
            Element element;
            element.name = line.requireWord("an element's name");
            element.count = line.integerWord("an element's count");
            requireNew(elements, element.name, "element");
            properties.clear();
            header.elements.push_back(std::move(element));
        } else if (kind == "property") {
            if (header.elements.empty()) malformed("a property stands before any element");
            Property property = parseProperty(line);
            requireNew(properties, property.name, "property");
            header.elements.back().properties.push_back(std::move(property));
        } else if (kind == "end_header") {
            if (!hasFormat) malformed("its header does not say how it is encoded");
            return header;
        }
    }
    damaged("its header does not end");
}

/// Reads one value after the other, whatever their type and encoding.
class ValueReader {
public:
    /// \param rows  of all elements
    ValueReader(ByteSource& source, Encoding encoding, std::uint64_t rows)
        : source_(source),
          encoding_(encoding),
          areRowsLines_(encoding == Encoding::Text && lineCount(source.rest()) >= rows),
          order_(encoding == Encoding::BigEndian ? std::endian::big : std::endian::little) {}

    /// Before each row.
    void beginRow() {
        if (areRowsLines_ && !isFirst_) source_.line();
        isFirst_ = false;
    }

    double real(PixelType type) {
        return encoding_ == Encoding::Text ? source_.realWord("a value")
                                           : source_.number<double>(type, order_);
    }

    std::int64_t integer(PixelType type) {
        if (isReal(type)) {
            const double value = real(type);
            constexpr double kExact = 9007199254740992;  // 2^53
            if (!(std::abs(value) <= kExact) || value != std::floor(value)) {
                malformed("an index or a count is " + formatShort(value));
            }
            return static_cast<std::int64_t>(value);
        }
        return encoding_ == Encoding::Text ? source_.integerWord("an index or a count")
                                           : source_.number<std::int64_t>(type, order_);
    }

    /// Least bytes that one value takes: a digit and a space in text.
    std::int64_t leastBytes(PixelType type) const {
        return encoding_ == Encoding::Text ? 2 : static_cast<std::int64_t>(bytesPerPixel(type));
    }

    /// What one value counts for: its bytes; in text 1.
    std::int64_t sizeOf(PixelType type) const {
        return encoding_ == Encoding::Text ? 1 : static_cast<std::int64_t>(bytesPerPixel(type));
    }

    /// Rows of this size up to the file's end.
    std::int64_t rowsLeft(std::int64_t rowSize) const {
        if (encoding_ != Encoding::Text) {
            return static_cast<std::int64_t>(source_.left()) / rowSize;
        }
        ByteSource after = source_;
        if (!isFirst_) after.line();
        return areRowsLines_ ? static_cast<std::int64_t>(lineCount(after.rest())) : 0;
    }

    void requireNoMoreRows(const Counted& counted, std::vector<Warning>& warnings) {
        if (areRowsLines_ && !isFirst_) source_.line();
        if (encoding_ == Encoding::Text) {
            requireNoMoreText(counted, source_.rest(), warnings);
        } else {
            requireNoMore(counted, source_.rest(), warnings);
        }
    }

private:
    /// Lines that are not blank.
    static std::uint64_t lineCount(std::string_view text) {
        ByteSource lines(text);
        std::uint64_t count = 0;
        while (!lines.atEnd()) count += !trimmed(lines.line()).empty();
        return count;
    }

    ByteSource& source_;
    Encoding encoding_;
    bool areRowsLines_, isFirst_ = true;
    std::endian order_;
};

void skipProperty(const Property& property, ValueReader& values) {
    std::int64_t count = 1;
    if (property.isList) count = values.integer(property.countType);
    for (std::int64_t i = 0; i < count; ++i) values.real(property.type);
}

void requireElementRoom(const Element& element, const ValueReader& values, std::size_t left) {
    std::int64_t least = 0;
    for (const Property& property : element.properties) {
        least += values.leastBytes(property.isList ? property.countType : property.type);
    }
    if (least == 0) malformed("its element " + printable(element.name) + " has no property");
    requireRoom(printable(element.name), element.count, least,
                left + 1);  // the last value needs no space
}

/// Rows of an element, lists as those of triangles.
Counted countedRows(const Element& element, const ValueReader& values) {
    Counted counted{element.name, element.count, 0};
    for (const Property& property : element.properties) {
        const std::int64_t each = values.sizeOf(property.type);
        counted.each += property.isList ? values.sizeOf(property.countType) + 3 * each : each;
    }
    if (element.name == "face") counted.what = "faces";
    if (element.name == "vertex") counted.what = "vertices";
    return counted;
}

/// Where the values of a vertex go: its place, its normal, a colour, arrays of their own.
class VertexRow {
public:
    VertexRow(const Element& element, bool keepsArrays) : properties_(element.properties) {
        for (const Property& property : properties_) slots_.push_back(slotOf(property));
        const auto has = [&](std::size_t first) {
            return found_[first] && found_[first + 1] && found_[first + 2];
        };
        if (!has(0)) malformed("its vertices lack x, y or z");
        hasNormals_ = has(3);
        hasColors_ = keepsArrays && has(6);
        if (!keepsArrays) return;
        for (std::size_t p = 0; p < slots_.size(); ++p) {
            const bool isArray = slots_[p] == kNowhere || (slots_[p] >= 6 && !hasColors_);
            if (!isArray || properties_[p].isList) continue;
            slots_[p] = kArrays + arrays_.size();
            PointArray& array = arrays_.emplace_back();
            array.name = storedName(properties_[p].name);
            if (!isReal(properties_[p].type)) array.values = std::vector<std::int64_t>();
        }
    }

    void read(ValueReader& values, TriangleMesh& mesh) {
        std::array<double, kNowhere> row{};
        values.beginRow();
        for (std::size_t p = 0; p < slots_.size(); ++p) {
            if (slots_[p] < kNowhere) {
                row[slots_[p]] = values.real(properties_[p].type);
            } else if (slots_[p] == kNowhere) {
                skipProperty(properties_[p], values);
            } else {
                readInto(arrays_[slots_[p] - kArrays], properties_[p].type, values);
            }
        }
        mesh.points.push_back({row[0], row[1], row[2]});
        if (hasNormals_) mesh.normals.push_back(storedNormal({row[3], row[4], row[5]}));
        if (hasColors_) colors_.push_back({shade(row[6]), shade(row[7]), shade(row[8])});
    }

    /// The arrays, once all vertices are read.
    std::vector<PointArray> take() {
        if (hasColors_) arrays_.insert(arrays_.begin(), PointArray{"RGB", std::move(colors_)});
        return std::move(arrays_);
    }

private:
    static constexpr std::size_t kNowhere = 9, kArrays = 10;

    std::size_t slotOf(const Property& property) {
        static constexpr std::array<std::string_view, kNowhere> kNames{
            "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
        std::size_t slot = 0;
        while (slot < kNowhere && (property.isList || property.name != kNames[slot])) ++slot;
        if (slot >= 6 && property.type != PixelType::UInt8) return kNowhere;
        if (slot < kNowhere) found_[slot] = true;
        return slot;
    }

    static std::uint8_t shade(double value) {
        return value >= 0 && value <= 255 ? static_cast<std::uint8_t>(value) : std::uint8_t{0};
    }

    static void readInto(PointArray& array, PixelType type, ValueReader& values) {
        if (auto* const numbers = std::get_if<std::vector<double>>(&array.values)) {
            numbers->push_back(values.real(type));
        } else {
            std::get<std::vector<std::int64_t>>(array.values).push_back(values.integer(type));
        }
    }

    const std::vector<Property>& properties_;
    std::vector<std::size_t> slots_;  ///< of each property
    std::array<bool, kNowhere> found_{};
    bool hasNormals_ = false, hasColors_ = false;
    std::vector<Color> colors_;
    std::vector<PointArray> arrays_;
};

void readVertices(const Element& element, bool keepsArrays, ValueReader& values, MeshFile& file) {
    VertexRow row(element, keepsArrays);
    file.mesh.points.reserve(element.count);
    for (std::int64_t i = 0; i < element.count; ++i) row.read(values, file.mesh);
    for (PointArray& array : row.take()) file.pointArrays.push_back(std::move(array));
    for (const Property& property : element.properties) {
        if (!keepsArrays || !property.isList) continue;
        file.arraysLeftOut.push_back(storedName(property.name));
    }
}

bool isCorners(const Property& property) {
    return property.isList &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// One strip, or several with -1 between them.
void addStrips(std::span<const VertexId> corners, Faces& faces) {
    for (auto begin = corners.begin(); begin != corners.end();) {
        const auto end = std::find(begin, corners.end(), -1);
        if (begin != end) faces.addStrip({begin, end});
        begin = end == corners.end() ? end : end + 1;
    }
}

void readFaces(const Element& element, ValueReader& values, Faces& faces) {
    const bool areStrips = element.name == kStrips;
    faces.reserve(areStrips ? 0 : static_cast<std::size_t>(element.count));
    std::vector<VertexId> corners;
    for (std::int64_t i = 0; i < element.count; ++i) {
        bool found = false;
        corners.clear();
        values.beginRow();
        for (const Property& property : element.properties) {
            if (!isCorners(property) || found) {
                skipProperty(property, values);
                continue;
            }
            for (auto left = values.integer(property.countType); left > 0; --left) {
                corners.push_back(values.integer(property.type));
            }
            found = true;
        }
        if (!found) malformed("its faces have no list vertex_indices");
        areStrips ? addStrips(corners, faces) : faces.add(corners);
    }
}

/// A property to write: one component of an array.
struct Column {
    std::string name;
    PixelType type;
    const PointArray* array;
    std::size_t component;
};

/// The smallest type that holds whole numbers; double where none does.
PixelType typeFor(const std::vector<std::int64_t>& values) {
    if (values.empty()) return PixelType::UInt8;
    const auto [least, most] = std::ranges::minmax(values);
    if (least >= 0 && most <= 255) return PixelType::UInt8;
    constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
    return least >= -kMost && most <= kMost ? PixelType::Int32 : PixelType::Float64;
}

std::string_view nameOf(PixelType type) {
    return type == PixelType::UInt8 ? "uchar" : type == PixelType::Int32 ? "int" : "double";
}

/// A word, and not one that is taken.
std::string propertyName(const std::string& name, TakenNames& taken) {
    std::string word = name.empty() ? "values" : name;
    for (char& c : word) {
        if (c <= ' ' || c > '~') c = '_';
    }
    return taken.unused(std::move(word));
}

std::vector<Column> columnsOf(const std::vector<PointArray>& arrays) {
    TakenNames taken({"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"});
    std::vector<Column> columns;
    bool hasColors = false;
    for (const PointArray& array : arrays) {
        const bool areColors = std::holds_alternative<std::vector<Color>>(array.values);
        const auto* const whole = std::get_if<std::vector<std::int64_t>>(&array.values);
        const PixelType type = areColors ? PixelType::UInt8
                               : whole   ? typeFor(*whole)
                                         : PixelType::Float64;
        const auto components = static_cast<std::size_t>(areColors ? 3 : array.components);
        for (std::size_t c = 0; c < components; ++c) {
            static constexpr std::array<const char*, 3> kShades{"red", "green", "blue"};
            std::string name = array.name;
            if (areColors) {
                name = hasColors ? name + "_" + kShades[c] : kShades[c];
            } else if (components > 1) {
                name += "_" + std::to_string(c);
            }
            const bool isOwn = areColors && !hasColors;
            columns.push_back({isOwn ? name : propertyName(name, taken), type, &array, c});
        }
        hasColors = hasColors || areColors;
    }
    return columns;
}

void encodeValue(const Column& column, std::size_t point, ByteSink& sink) {
    const PointArray& array = *column.array;
    if (const auto* const colors = std::get_if<std::vector<Color>>(&array.values)) {
        sink.littleEndian((*colors)[point][column.component]);
        return;
    }
    const std::size_t at = point * static_cast<std::size_t>(array.components) + column.component;
    if (const auto* const numbers = std::get_if<std::vector<double>>(&array.values)) {
        sink.littleEndian((*numbers)[at]);
        return;
    }
    const std::int64_t value = std::get<std::vector<std::int64_t>>(array.values)[at];
    if (column.type == PixelType::UInt8) sink.littleEndian(static_cast<std::uint8_t>(value));
    if (column.type == PixelType::Int32) sink.littleEndian(static_cast<std::int32_t>(value));
    if (column.type == PixelType::Float64) sink.littleEndian(static_cast<double>(value));
}

void encodeHeader(const MeshWriteOptions& options, std::int64_t points, bool hasNormals,
                  const std::vector<Column>& columns, std::int64_t triangles, ByteSink& sink) {
    sink << "ply\nformat binary_little_endian 1.0\ncomment " << slicerHeaderLine(options)
         << "\nelement vertex " << points
         << "\nproperty double x\nproperty double y\nproperty double z\n";
    if (hasNormals) sink << "property float nx\nproperty float ny\nproperty float nz\n";
    for (const Column& column : columns) {
        sink << "property " << nameOf(column.type) << " " << column.name << "\n";
    }
    sink << "element face " << triangles
         << "\nproperty list uchar int vertex_indices\nend_header\n";
}

void encodePoint(const Vec3& point, ByteSink& sink) {
    for (int axis = 0; axis < 3; ++axis) sink.littleEndian(point[axis]);
}

void encodeNormal(const Normal& normal, ByteSink& sink) {
    for (const float n : {normal.x, normal.y, normal.z}) sink.littleEndian(n);
}

void encodeTriangle(const Triangle& triangle, ByteSink& sink) {
    sink.littleEndian(std::uint8_t{3});
    for (const VertexId vertex : triangle) sink.littleEndian(static_cast<std::int32_t>(vertex));
}

void encodePly(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    const std::vector<Column> columns = columnsOf(record.options.pointArrays);
    encodeHeader(record.options, std::ssize(mesh.points), !mesh.normals.empty(), columns,
                 std::ssize(mesh.triangles), sink);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        encodePoint(mesh.points[i], sink);
        if (!mesh.normals.empty()) encodeNormal(mesh.normals[i], sink);
        for (const Column& column : columns) encodeValue(column, i, sink);
    }
    for (const Triangle& triangle : mesh.triangles) encodeTriangle(triangle, sink);
}

MeshFile decodePly(std::string_view bytes, const MeshReadOptions& options) {
    ByteSource source(bytes);
    Header header = parseHeader(source, options);
    if (header.elements.empty()) malformed("its header names no element");
    Element& last = header.elements.back();
    const bool isOpenEnded = last.name == "face" && isUnset(last.count);
    std::uint64_t rows = 0;
    for (const Element& element : header.elements) {
        if (isOpenEnded && &element == &last) break;
        rows += static_cast<std::uint64_t>(std::clamp<std::int64_t>(element.count, 0, kMostRows));
    }
    ValueReader values(source, header.encoding, rows);
    MeshFile file;
    Faces faces;
    file.frame = header.marks.frame();
    Counted counted;
    for (Element& element : header.elements) {
        if (isOpenEnded && &element == &last) {
            Counted rowsThere = countedRows(last, values);
            const std::int64_t there = rowsThere.each > 0 ? values.rowsLeft(rowsThere.each) : 0;
            if (there > 0) setToThere(rowsThere, there, file.warnings);
            element.count = rowsThere.count;
        }
        if (element.count == 0) continue;
        requireElementRoom(element, values, source.left());
        counted = countedRows(element, values);
        if (element.name == "vertex") {
            readVertices(element, options.keepsPointArrays, values, file);
        } else if (element.name == "face" || element.name == kStrips) {
            readFaces(element, values, faces);
            for (const Property& property : element.properties) {
                if (!options.keepsPointArrays || isCorners(property)) continue;
                file.arraysLeftOut.push_back(storedName(property.name));
            }
        } else {
            for (std::int64_t i = 0; i < element.count; ++i) {
                values.beginRow();
                for (const Property& property : element.properties) skipProperty(property, values);
            }
        }
    }
    if (counted.count > 0) values.requireNoMoreRows(counted, file.warnings);
    std::move(faces).moveTo(file, options.keepsFaults);
    return file;
}

bool isPly(std::string_view head, std::uint64_t /*byteCount*/) {
    const std::string_view text = trimmed(head);
    return lowerCase(text.substr(0, text.find_first_of(" \t\r\n"))) == "ply";
}

}  // namespace

extern const Codec kPlyCodec{isPly, decodePly, encodePly};

}  // namespace adaptiso::meshio

namespace adaptiso {

struct PlyStream::Impl {
    Impl(const std::filesystem::path& to, std::ofstream&& opened, std::int64_t points,
         std::int64_t triangles, bool withNormals)
        : path(to),
          file(std::move(opened)),
          sink(file),
          pointsLeft(points),
          trianglesLeft(triangles),
          hasNormals(withNormals) {}

    std::filesystem::path path;
    std::ofstream file;
    ByteSink sink;
    std::int64_t pointsLeft, trianglesLeft;
    bool hasNormals;
};

PlyStream::PlyStream(const std::filesystem::path& path, const MeshWriteOptions& options,
                     std::int64_t points, std::int64_t triangles, bool hasNormals) {
    const std::int64_t most = findMeshFormat("a.ply").maxElements;
    if (points > most || triangles > most) {
        throw InvalidInput("PLY files hold at most " + std::to_string(most) +
                           " points and triangles, the mesh has " +
                           std::to_string(std::max(points, triangles)));
    }
    std::ofstream file(path, std::ios::binary);
    if (!file) throw FileError(path.string() + ": can't be written");
    impl_ = std::make_unique<Impl>(path, std::move(file), points, triangles, hasNormals);
    meshio::encodeHeader(options, points, hasNormals, {}, triangles, impl_->sink);
}

PlyStream::~PlyStream() = default;

void PlyStream::addPoint(const Vec3& point, const Normal& normal) {
    --impl_->pointsLeft;
    meshio::encodePoint(point, impl_->sink);
    if (impl_->hasNormals) meshio::encodeNormal(normal, impl_->sink);
}

void PlyStream::addTriangle(const Triangle& triangle) {
    --impl_->trianglesLeft;
    meshio::encodeTriangle(triangle, impl_->sink);
}

void PlyStream::finish() {
    if (impl_->pointsLeft != 0 || impl_->trianglesLeft != 0) {
        throw InternalError("PlyStream: not what was announced was written");
    }
    impl_->sink.finish();
    impl_->file.close();
    if (!impl_->file)
        throw FileError(impl_->path.string() + ": can't be written; the disk is full");
}

}  // namespace adaptiso
