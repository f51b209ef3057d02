// PLY 1.0. Written: binary little endian, double coordinates, float normals, int vertex indices.
// Read: text and binary of either byte order, any property types, other elements passed over.
#include <array>
#include <vector>

#include "ByteSource.h"
#include "Codecs.h"

namespace adaptiso::meshio {
namespace {

enum class Scalar { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };
enum class Encoding { Text, LittleEndian, BigEndian };

struct Property {
    std::string name;
    Scalar type{};
    bool isList = false;
    Scalar countType{};
};

struct Element {
    std::string name;
    std::int64_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding{};
    std::vector<Element> elements;
    std::optional<CoordinateFrame> frame;
};

Scalar parseScalar(std::string_view name) {
    struct Entry {
        std::string_view name, otherName;
        Scalar type;
    };
    static constexpr std::array<Entry, 8> kEntries{{{"char", "int8", Scalar::Int8},
                                                    {"uchar", "uint8", Scalar::UInt8},
                                                    {"short", "int16", Scalar::Int16},
                                                    {"ushort", "uint16", Scalar::UInt16},
                                                    {"int", "int32", Scalar::Int32},
                                                    {"uint", "uint32", Scalar::UInt32},
                                                    {"float", "float32", Scalar::Float32},
                                                    {"double", "float64", Scalar::Float64}}};
    for (const Entry& entry : kEntries) {
        if (name == entry.name || name == entry.otherName) return entry.type;
    }
    damaged("a property has the unknown type " + printable(name));
}

std::int64_t bytesOf(Scalar type) {
    switch (type) {
        case Scalar::Int8:
        case Scalar::UInt8:
            return 1;
        case Scalar::Int16:
        case Scalar::UInt16:
            return 2;
        case Scalar::Int32:
        case Scalar::UInt32:
        case Scalar::Float32:
            return 4;
        case Scalar::Float64:
            return 8;
    }
    return 0;
}

Encoding parseEncoding(std::string_view word) {
    if (word == "ascii") return Encoding::Text;
    if (word == "binary_little_endian") return Encoding::LittleEndian;
    if (word == "binary_big_endian") return Encoding::BigEndian;
    damaged("its encoding is " + printable(word) +
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

Header parseHeader(ByteSource& source) {
    Header header;
    if (source.line() != "ply") damaged("its first line is not 'ply'");
    bool hasFormat = false;
    while (!source.atEnd()) {
        const std::string_view text = source.line();
        ByteSource line(text);
        const std::string_view kind = line.word();
        if (kind == "format") {
            header.encoding = parseEncoding(line.requireWord("the encoding"));
            hasFormat = true;
        } else if (kind == "comment") {
            if (!header.frame) header.frame = findFrameMarker(text);
        } else if (kind == "element") {
            Element element;
            element.name = line.requireWord("an element's name");
            element.count = line.integerWord("an element's count");
            header.elements.push_back(std::move(element));
        } else if (kind == "property") {
            if (header.elements.empty()) damaged("a property stands before any element");
            header.elements.back().properties.push_back(parseProperty(line));
        } else if (kind == "end_header") {
            if (!hasFormat) damaged("its header does not say how it is encoded");
            return header;
        }
    }
    damaged("its header does not end");
}

/// Reads one value after the other, whatever their type and encoding.
class ValueReader {
public:
    ValueReader(ByteSource& source, Encoding encoding)
        : source_(source),
          encoding_(encoding),
          order_(encoding == Encoding::BigEndian ? std::endian::big : std::endian::little) {}

    double real(Scalar type) {
        if (encoding_ == Encoding::Text) return source_.realWord("a value");
        switch (type) {
            case Scalar::Float32:
                return source_.number<float>(order_);
            case Scalar::Float64:
                return source_.number<double>(order_);
            default:
                return static_cast<double>(binaryInteger(type));
        }
    }

    std::int64_t integer(Scalar type) {
        if (type == Scalar::Float32 || type == Scalar::Float64) {
            damaged("a vertex index or a count has a floating-point type");
        }
        return encoding_ == Encoding::Text ? source_.integerWord("an index or a count")
                                           : binaryInteger(type);
    }

    /// Least bytes that one value takes: a digit and a space in text.
    std::int64_t leastBytes(Scalar type) const {
        return encoding_ == Encoding::Text ? 2 : bytesOf(type);
    }

private:
    std::int64_t binaryInteger(Scalar type) {
        switch (type) {
            case Scalar::Int8:
                return source_.number<std::int8_t>(order_);
            case Scalar::UInt8:
                return source_.number<std::uint8_t>(order_);
            case Scalar::Int16:
                return source_.number<std::int16_t>(order_);
            case Scalar::UInt16:
                return source_.number<std::uint16_t>(order_);
            case Scalar::Int32:
                return source_.number<std::int32_t>(order_);
            default:
                return source_.number<std::uint32_t>(order_);
        }
    }

    ByteSource& source_;
    Encoding encoding_;
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
    if (least == 0) damaged("its element " + printable(element.name) + " has no property");
    requireRoom(printable(element.name), element.count, least,
                left + 1);  // the last value needs no space
}

void readVertices(const Element& element, ValueReader& values, TriangleMesh& mesh) {
    static constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
    std::array<bool, 6> found{};
    std::vector<std::size_t> slots;  // of each property: where it goes, 6 where nowhere
    for (const Property& property : element.properties) {
        std::size_t slot = 0;
        while (slot < 6 && (property.isList || property.name != kNames[slot])) ++slot;
        if (slot < 6) found[slot] = true;
        slots.push_back(slot);
    }
    if (!found[0] || !found[1] || !found[2]) damaged("its vertices lack x, y or z");
    const bool hasNormals = found[3] && found[4] && found[5];
    mesh.points.resize(element.count);
    if (hasNormals) mesh.normals.resize(element.count);
    for (std::int64_t i = 0; i < element.count; ++i) {
        std::array<double, 7> row{};
        for (std::size_t p = 0; p < slots.size(); ++p) {
            if (slots[p] == 6) {
                skipProperty(element.properties[p], values);
            } else {
                row[slots[p]] = values.real(element.properties[p].type);
            }
        }
        mesh.points[i] = {row[0], row[1], row[2]};
        if (hasNormals) mesh.normals[i] = storedNormal({row[3], row[4], row[5]});
    }
}

void readFaces(const Element& element, ValueReader& values, TriangleMesh& mesh) {
    mesh.triangles.resize(element.count);
    for (Triangle& triangle : mesh.triangles) {
        bool found = false;
        for (const Property& property : element.properties) {
            const bool isVertices = property.isList && (property.name == "vertex_indices" ||
                                                        property.name == "vertex_index");
            if (!isVertices) {
                skipProperty(property, values);
                continue;
            }
            const std::int64_t corners = values.integer(property.countType);
            if (corners != 3) refusePolygon(corners);
            for (VertexId& vertex : triangle) vertex = values.integer(property.type);
            found = true;
        }
        if (!found) damaged("its faces have no list vertex_indices");
    }
}

}  // namespace

void encodePly(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    sink << "ply\nformat binary_little_endian 1.0\ncomment " << headerLine(record.options.frame)
         << "\nelement vertex " << static_cast<std::int64_t>(mesh.points.size())
         << "\nproperty double x\nproperty double y\nproperty double z\n";
    if (!mesh.normals.empty()) sink << "property float nx\nproperty float ny\nproperty float nz\n";
    sink << "element face " << static_cast<std::int64_t>(mesh.triangles.size())
         << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) sink.littleEndian(mesh.points[i][axis]);
        if (mesh.normals.empty()) continue;
        for (const float n : {mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z}) {
            sink.littleEndian(n);
        }
    }
    for (const Triangle& triangle : mesh.triangles) {
        sink.littleEndian(std::uint8_t{3});
        for (const VertexId vertex : triangle) {
            sink.littleEndian(static_cast<std::int32_t>(vertex));
        }
    }
}

MeshFile decodePly(std::string_view bytes) {
    ByteSource source(bytes);
    const Header header = parseHeader(source);
    ValueReader values(source, header.encoding);
    MeshFile file;
    file.frame = header.frame;
    for (const Element& element : header.elements) {
        if (element.count == 0) continue;
        requireElementRoom(element, values, source.left());
        if (element.name == "vertex") {
            readVertices(element, values, file.mesh);
        } else if (element.name == "face") {
            readFaces(element, values, file.mesh);
        } else {
            for (std::int64_t i = 0; i < element.count; ++i) {
                for (const Property& property : element.properties) skipProperty(property, values);
            }
        }
    }
    return file;
}

}  // namespace adaptiso::meshio
