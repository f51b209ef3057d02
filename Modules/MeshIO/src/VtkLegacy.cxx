// VTK legacy PolyData (.vtk). Written: binary (big endian), double points; version 4.2, which old
// programs read too, unless the surface needs the 64-bit cells of 5.1. Read: text and binary,
// versions 1 to 5.1.
//
// By hand, not by vtkPolyDataReader: that one allocates what the file claims and walks cell lists
// unchecked. What is written has the very bytes of vtkPolyDataWriter.
#include <charconv>
#include <limits>
#include <span>
#include <vector>

#include "Bytes.h"
#include "Counts.h"
#include "Faces.h"
#include "VtkFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Surplus.h"

namespace adaptiso::meshio {
namespace {

PixelType parseType(std::string_view word) {
    struct Entry {
        std::string_view name;
        PixelType type;
    };
    static constexpr Entry kEntries[] = {
        {"float", PixelType::Float32},      {"double", PixelType::Float64},
        {"int", PixelType::Int32},          {"unsigned_int", PixelType::UInt32},
        {"vtktypeint64", PixelType::Int64}, {"vtktypeuint64", PixelType::UInt64},
        {"vtkidtype", PixelType::Int32},  // as VTK writes ids before version 5
        {"long", PixelType::Int64},         {"unsigned_long", PixelType::UInt64},
        {"short", PixelType::Int16},        {"unsigned_short", PixelType::UInt16},
        {"char", PixelType::Int8},          {"signed_char", PixelType::Int8},
        {"unsigned_char", PixelType::UInt8}};
    for (const Entry& entry : kEntries) {
        if (lowerCase(word) == entry.name) return entry.type;
    }
    unsupported("it holds numbers of the type " + printable(word), "save it without them");
}

/// Walks through the sections of a file; keeps the surface and passes over the rest.
class LegacyDecoder {
public:
    LegacyDecoder(std::string_view bytes, const MeshReadOptions& options)
        : source_(bytes),
          keepsArrays_(options.keepsPointArrays),
          keepsFaults_(options.keepsFaults),
          marks_(options),
          fieldMarks_(options) {}

    MeshFile decode() {
        decodeHead();
        while (decodeSection()) {
        }
        requireNoMoreSections();
        // 3D Slicer names the frame in the header, and takes fields of the file it read along
        file_.frame = marks_.frame() ? marks_.frame() : fieldMarks_.frame();
        std::move(faces_).moveTo(file_, keepsFaults_, lines_);
        return std::move(file_);
    }

private:
    void decodeHead() {
        constexpr std::string_view kMagic = "# vtk DataFile Version ";
        const std::string_view first = source_.line();
        if (!first.starts_with(kMagic)) {
            unsupported("it does not begin with '# vtk DataFile Version'",
                        "it is no file of VTK: get it again");
        }
        hasOffsets_ = toReal(trimmed(first.substr(kMagic.size())), "the version") >= 5;
        marks_.addText(source_.line());
        const std::string encoding = lowerCase(trimmed(source_.line()));
        if (encoding != "ascii" && encoding != "binary") {
            malformed("its third line is " + printable(encoding) + ", must be ASCII or BINARY");
        }
        isBinary_ = encoding == "binary";
        const bool hasDataset = lowerCase(source_.word()) == "dataset";
        const std::string_view dataset = source_.word();
        if (!hasDataset || lowerCase(dataset) != "polydata") {
            unsupported("it is not a PolyData but " + printable(dataset), std::string(kToPolyData));
        }
    }

    /// False at the end, and at what is no section, or one of unknown length.
    bool decodeSection() {
        const std::size_t begin = source_.position();
        const std::string section = lowerCase(source_.word());
        ByteSource line(source_.line());
        if (section == "points") {
            decodePoints(line);
        } else if (section == "polygons") {
            decodePolygons(line);
        } else if (section == "vertices" || section == "lines") {
            forEachCell(readCells(line), [&](std::span<const std::int64_t>) { ++lines_; });
        } else if (section == "triangle_strips") {
            requireFirst(faces_.count() == polygons_, "TRIANGLE_STRIPS");
            forEachCell(readCells(line),
                        [&](std::span<const std::int64_t> corners) { faces_.addStrip(corners); });
        } else if (section == "point_data" || section == "cell_data") {
            tuples_ = line.integerWord("the number of tuples");
            isPointData_ = section == "point_data";
            isCellData_ = !isPointData_;
            requireOneEach(tuples_);
        } else if (section == "normals") {
            decodeNormals(line);
        } else if (const std::int64_t components = componentsOf(section); components > 0) {
            const std::string_view name = line.requireWord("a name");
            decodeArray(name, tuples_, components, parseType(line.requireWord("a type")));
        } else if (section == "texture_coordinates") {
            const std::string_view name = line.requireWord("a name");
            const std::int64_t dimensions = line.integerWord("components");
            decodeArray(name, tuples_, dimensions, parseType(line.requireWord("a type")));
        } else if (section == "scalars") {
            decodeScalars(line);
        } else if (section == "color_scalars") {
            const std::string_view name = line.requireWord("a name");
            decodeColors(name, line.integerWord("components"));
        } else if (section == "lookup_table") {
            line.requireWord("a name");
            skipNumbers(line.integerWord("the size of a table"), 4, PixelType::UInt8);
        } else if (section == "field") {
            decodeField(line);
        } else if (section == "metadata") {
            skipMetadata();
        } else {
            source_.seek(begin);
            return false;
        }
        return true;
    }

    /// Of sections that name an array and its type; 0 for others.
    static std::int64_t componentsOf(std::string_view section) {
        constexpr std::pair<std::string_view, std::int64_t> kSections[] = {
            {"vectors", 3},    {"tensors", 9},      {"tensors6", 6},
            {"global_ids", 1}, {"pedigree_ids", 1}, {"edge_flags", 1}};
        for (const auto& [name, components] : kSections) {
            if (section == name) return components;
        }
        return 0;
    }

    void requireNoMoreSections() {
        const std::string_view rest = trimmed(source_.rest());
        const std::size_t word = std::min(rest.find_first_of(" \t\r\n"), rest.size());
        const bool isSection = word > 3 && rest.substr(0, word).find_first_not_of(
                                               "ABCDEFGHIJKLMNOPQRSTUVWXYZ_") == rest.npos;
        if (!isBinary_ || isSection) {
            requireNoMoreText(last_, rest, file_.warnings);
            return;
        }
        requireNoMore(last_, rest, file_.warnings);
        if (std::ssize(rest) >= last_.each && !areZeros(rest)) {
            malformed("it holds " + std::to_string(rest.size()) + " bytes behind its " +
                      std::string(last_.what) + " that are no section of VTK's");
        }
    }

    /// Refuses values that are not as many as the points, or the cells.
    void requireOneEach(std::int64_t tuples) const {
        const std::int64_t there =
            isPointData_ ? std::ssize(file_.mesh.points) : lines_ + faces_.count();
        if (tuples == there) return;
        const std::string what = isPointData_ ? " points" : " cells";
        damaged("it has values for " + std::to_string(tuples) + what + ", and " +
                std::to_string(there) + what);
    }

    /// Calls f(corners) for each cell of a list as readCells() has it.
    template <class F>
    static void forEachCell(std::span<const std::int64_t> cells, const F& f) {
        while (!cells.empty()) {
            if (cells[0] < 0) damaged("a cell has less than 0 corners");
            const auto corners = static_cast<std::uint64_t>(cells[0]);
            if (corners >= cells.size()) damaged("its list of cells breaks off");
            f(cells.subspan(1, corners));
            cells = cells.subspan(1 + corners);
        }
    }

    /// Refuses a second section of a surface.
    static void requireFirst(bool isFirst, std::string_view section) {
        if (isFirst) return;
        unsupported("it has two sections " + std::string(section),
                    "are two files joined? give each by itself");
    }

    void decodePoints(ByteSource& line) {
        requireFirst(file_.mesh.points.empty(), "POINTS");
        const std::int64_t count = line.integerWord("the number of points");
        const auto values = readVectors(count, parseType(line.requireWord("a type")), "points");
        file_.mesh.points = values;
    }

    void decodeNormals(ByteSource& line) {
        line.requireWord("a name");
        const auto values = readVectors(tuples_, parseType(line.requireWord("a type")), "normals");
        if (!isPointData_) return;
        file_.mesh.normals.clear();
        for (const Vec3& value : values) file_.mesh.normals.push_back(storedNormal(value));
    }

    void decodePolygons(ByteSource& line) {
        requireFirst(polygons_ == 0, "POLYGONS");
        ByteSource counts = line;
        const std::int64_t count = counts.integerWord("the number of polygons");
        forEachCell(readCells(line), [&](std::span<const std::int64_t> corners) {
            faces_.add(corners);
            ++polygons_;
        });
        last_ = {"polygons", count - (hasOffsets_ ? 1 : 0),
                 4 * (isBinary_ ? std::int64_t{sizeof(std::int32_t)} : 1)};
        const std::int64_t there = polygons_ + (hasOffsets_ && count > 0 ? 1 : 0);
        if (there != count) {
            damaged("it counts " + std::to_string(count) + " polygons, and its list has " +
                    std::to_string(there));
        }
    }

    /// Cells as a list of: number of corners, corners.
    std::vector<std::int64_t> readCells(ByteSource& line) {
        const std::int64_t first = line.integerWord("the number of cells");
        const std::int64_t second = line.integerWord("the size of the cells");
        return hasOffsets_ ? readOffsetCells(first, second)
                           : readIntegers(second, PixelType::Int32, "cells");
    }

    std::vector<std::int64_t> readOffsetCells(std::int64_t offsetCount, std::int64_t cornerCount) {
        const auto offsets = readNamedIntegers("offsets", offsetCount);
        const auto corners = readNamedIntegers("connectivity", cornerCount);
        if (!offsets.empty() && (offsets.front() != 0 || offsets.back() != cornerCount)) {
            damaged("its cells' offsets lead from " + std::to_string(offsets.front()) + " to " +
                    std::to_string(offsets.back()) + ", must be from 0 to " +
                    std::to_string(cornerCount));
        }
        std::vector<std::int64_t> cells;
        for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
            const std::int64_t begin = offsets[i], end = offsets[i + 1];
            if (begin < 0 || begin > end || end > cornerCount) damaged("a cell's offset is wrong");
            cells.push_back(end - begin);
            cells.insert(cells.end(), corners.begin() + begin, corners.begin() + end);
        }
        return cells;
    }

    std::vector<std::int64_t> readNamedIntegers(std::string_view name, std::int64_t count) {
        if (lowerCase(source_.word()) != name) malformed("its cells lack " + std::string(name));
        ByteSource line(source_.line());
        return readIntegers(count, parseType(line.requireWord("a type")), name);
    }

    void decodeScalars(ByteSource& line) {
        const std::string_view name = line.requireWord("a name");
        const PixelType type = parseType(line.requireWord("a type"));
        const std::string_view components = line.word();
        if (lowerCase(source_.word()) != "lookup_table")
            malformed("its scalars lack a lookup table");
        source_.line();
        decodeArray(name, tuples_, components.empty() ? 1 : toInteger(components, "components"),
                    type);
    }

    /// Colours, as bytes; in text as parts of 1. With a fourth component, which is passed over.
    void decodeColors(std::string_view name, std::int64_t components) {
        if (!isKept(tuples_, components) || components < 3) {
            passOver(name);
            skipNumbers(tuples_, components, PixelType::UInt8);
            return;
        }
        requireNumbers(tuples_, components, PixelType::UInt8, "colours");
        std::vector<Color> colors(tuples_);
        for (Color& color : colors) {
            for (std::int64_t c = 0; c < components; ++c) {
                const double value = isBinary_ ? source_.number<std::uint8_t>(std::endian::big)
                                               : 255 * source_.realWord("a colour");
                if (c < 3) color[c] = value >= 0 && value <= 255 ? std::uint8_t(value + 0.5) : 0;
            }
        }
        file_.pointArrays.push_back({arrayName(name), std::move(colors)});
    }

    /// Blanks and the like are %20 in the names of arrays.
    static std::string arrayName(std::string_view word) {
        std::string name;
        for (std::size_t i = 0; i < word.size(); ++i) {
            int code = 0;
            const char* const digits = word.data() + i + 1;
            if (word[i] == '%' && i + 2 < word.size() &&
                std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2 && code > 0) {
                name += static_cast<char>(code);
                i += 2;
            } else {
                name += word[i];
            }
        }
        return storedName(name);
    }

    /// Values of points, as many as there are, and not more components than a tensor has.
    bool isKept(std::int64_t tuples, std::int64_t components) const {
        constexpr std::int64_t kMostComponents = 9;
        return keepsArrays_ && isPointData_ && tuples == std::ssize(file_.mesh.points) &&
               components >= 1 && components <= kMostComponents;
    }

    void passOver(std::string_view name) {
        if (!keepsArrays_ || !(isPointData_ || isCellData_)) return;
        file_.arraysLeftOut.push_back(arrayName(name));
    }

    void decodeArray(std::string_view name, std::int64_t tuples, std::int64_t components,
                     PixelType type) {
        if (!isKept(tuples, components)) {
            passOver(name);
            skipNumbers(tuples, components, type);
            return;
        }
        requireNumbers(tuples, components, type, "values");
        const auto count = static_cast<std::size_t>(tuples * components);
        if (isReal(type)) {
            std::vector<double> numbers(count);
            for (double& number : numbers) number = realNumber(type);
            file_.pointArrays.push_back(
                {arrayName(name), std::move(numbers), static_cast<int>(components)});
        } else {
            file_.pointArrays.push_back(wholeArray(arrayName(name), type, components,
                                                   wholeNumbers(count, type, "a whole number")));
        }
    }

    void decodeField(ByteSource& line) {
        line.requireWord("a name");
        const std::int64_t arrays = line.integerWord("the number of arrays");
        for (std::int64_t i = 0; i < arrays; ++i) {
            std::string_view name = source_.requireWord("a field array");
            if (lowerCase(name) == "metadata") {
                source_.line();
                skipMetadata();
                name = source_.requireWord("a field array");
            }
            ByteSource array(source_.line());
            const std::int64_t components = array.integerWord("components");
            const std::int64_t tuples = array.integerWord("tuples");
            const std::string_view type = array.requireWord("a type");
            if (lowerCase(type) == "string") {
                const std::string text = takeStrings(tuples, components);
                passOver(name);
                if (!marks_.frame()) addField(name, text, fieldMarks_);
            } else {
                if ((isPointData_ || isCellData_) && tuples > 0) requireOneEach(tuples);
                decodeArray(name, tuples, components, parseType(type));
            }
        }
    }

    /// Passes over strings: a line each in text, coded as arrayName(); in binary files, the two
    /// highest bits of the first byte tell how many bytes hold the length: 3: 1, 2: 2, 1: 4, 0: 8
    /// (vtkDataWriter). \return the first
    std::string takeStrings(std::int64_t tuples, std::int64_t components) {
        std::string first;
        requireRoom("components", components, 1, source_.left());
        if (components == 0) return first;
        requireRoom("strings", tuples, components, source_.left());
        for (std::int64_t i = 0; i < tuples * components; ++i) {
            if (!isBinary_) {
                const std::string_view line = source_.line();
                if (i == 0) first = arrayName(trimmed(line));
                continue;
            }
            const auto head = source_.number<std::uint8_t>(std::endian::big);
            std::uint64_t length = head & 0x3F;
            for (int more = (1 << (3 - head / 64)) - 1; more > 0; --more) {
                length = length << 8 | source_.number<std::uint8_t>(std::endian::big);
            }
            const std::string_view text = source_.take(length);
            if (i == 0) first = storedName(text);
        }
        return first;
    }

    void skipMetadata() {
        while (!source_.atEnd() && !trimmed(source_.line()).empty()) {
        }
    }

    void requireNumbers(std::int64_t tuples, std::int64_t components, PixelType type,
                        std::string_view what) {
        requireRoom("components", components, 1, source_.left());
        const std::int64_t each =
            isBinary_ ? static_cast<std::int64_t>(bytesPerPixel(type)) : 2;  // a digit and a space
        if (components <= 0) return;
        requireRoom(what, tuples, components * each, source_.left() + 1);
        last_ = {what, tuples, components * (isBinary_ ? each : 1)};
    }

    void skipNumbers(std::int64_t tuples, std::int64_t components, PixelType type) {
        requireNumbers(tuples, components, type, "tuples");
        if (isBinary_) {
            source_.take(components == 0 ? 0
                                         : tuples * components *
                                               static_cast<std::int64_t>(bytesPerPixel(type)));
            return;
        }
        for (std::int64_t i = 0; components > 0 && i < tuples * components; ++i) {
            source_.requireWord("a number");
        }
    }

    double realNumber(PixelType type) {
        return isBinary_ ? source_.number<double>(type, std::endian::big)
                         : source_.realWord("a number");
    }

    std::vector<Vec3> readVectors(std::int64_t count, PixelType type, std::string_view what) {
        requireNumbers(count, 3, type, what);
        std::vector<Vec3> vectors(count);
        for (Vec3& v : vectors) {
            for (int axis = 0; axis < 3; ++axis) v[axis] = realNumber(type);
        }
        return vectors;
    }

    std::vector<std::int64_t> readIntegers(std::int64_t count, PixelType type,
                                           std::string_view what) {
        requireNumbers(count, 1, type, what);
        if (isBinary_ && isReal(type)) malformed("its cells are not whole numbers");
        return wholeNumbers(static_cast<std::size_t>(count), type, what);
    }

    std::vector<std::int64_t> wholeNumbers(std::size_t count, PixelType type,
                                           std::string_view what) {
        std::vector<std::int64_t> numbers(count);
        for (std::int64_t& number : numbers) {
            number = isBinary_ ? source_.number<std::int64_t>(type, std::endian::big)
                               : source_.integerWord(what);
        }
        return numbers;
    }

    ByteSource source_;
    MeshFile file_;
    Counted last_{"sections", 0, 1};  ///< the numbers before this place
    Faces faces_;
    bool keepsArrays_, keepsFaults_;
    FrameMarks marks_, fieldMarks_;  ///< of the header, and of field data
    bool isBinary_ = false;
    bool hasOffsets_ = false;                ///< cells as offsets and connectivity (version 5)
    bool isPointData_ = false;               ///< the attributes at this place are of points
    bool isCellData_ = false;                ///< or of cells
    std::int64_t polygons_ = 0, lines_ = 0;  ///< lines and vertices, which are cells too
    std::int64_t tuples_ = 0;                ///< tuples of each attribute array at this place
};

/// A name as one word: what could end it is "%20", in hexadecimal digits.
std::string wordOf(std::string_view name) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string word;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (c > ' ' && c <= '~' && c != '"' && c != '%') {
            word += c;
        } else {
            word += {'%', kDigits[byte / 16], kDigits[byte % 16]};
        }
    }
    return word;
}

template <class Row>
void encodeNumbers(const std::vector<Row>& rows, ByteSink& sink) {
    forEachNumber(rows, [&](auto number) { sink.bigEndian(number); });
    sink << "\n";
}

void encodeFields(const MeshWriteOptions& options, ByteSink& sink) {
    const auto fields = fieldsOf(options);
    sink << "FIELD FieldData " << std::int64_t{std::ssize(fields)} << "\n";
    for (const auto& [name, text] : fields) {
        constexpr unsigned kShort = 0xC0;  // a length below 64 follows in this byte
        sink << name << " 1 1 string\n";
        sink.bigEndian(static_cast<std::uint8_t>(kShort | text.size()));
        sink << text << "\n";
    }
}

void encodeCells(const std::vector<Triangle>& triangles, bool are32Bits, ByteSink& sink) {
    const std::int64_t count = std::ssize(triangles);
    if (!are32Bits) {
        sink << "POLYGONS " << count + 1 << " " << 3 * count << "\nOFFSETS vtktypeint64\n";
        for (std::int64_t i = 0; i <= count; ++i) sink.bigEndian(3 * i);
        sink << "\nCONNECTIVITY vtktypeint64\n";
        return encodeNumbers(triangles, sink);
    }
    sink << "POLYGONS " << count << " " << 4 * count << "\n";
    for (const Triangle& triangle : triangles) {
        sink.bigEndian(std::int32_t{3});
        for (const VertexId v : triangle) sink.bigEndian(static_cast<std::int32_t>(v));
    }
    sink << "\n";
}

/// The active array.
void encodeScalars(const std::string& name, const PointArray& array, ByteSink& sink) {
    const auto encode = [&]<class Row>(const std::vector<Row>& rows) {
        if constexpr (std::is_same_v<Row, Color>) {
            sink << "COLOR_SCALARS " << wordOf(name) << " 3\n";
        } else {
            sink << "SCALARS " << wordOf(name) << " " << numberType<Row>().inLegacy;
            if (array.components > 1) sink << " " << std::int64_t{array.components};
            sink << "\nLOOKUP_TABLE default\n";
        }
        encodeNumbers(rows, sink);
    };
    std::visit(encode, array.values);
}

void encodePointData(const MeshRecord& record, ByteSink& sink) {
    const std::vector<Normal>& normals = record.mesh.normals;
    const std::vector<PointArray>& arrays = record.options.pointArrays;
    if (arrays.empty() && normals.empty()) return;
    const std::int64_t points = std::ssize(record.mesh.points);
    const std::vector<std::string> names = arrayNames(arrays);
    sink << "POINT_DATA " << points << "\n";
    if (!arrays.empty()) encodeScalars(names[0], arrays[0], sink);
    if (!normals.empty()) {
        sink << "NORMALS " << kNormalsName << " float\n";
        encodeNumbers(normals, sink);
    }
    if (arrays.size() < 2) return;
    sink << "FIELD FieldData " << std::int64_t{std::ssize(arrays) - 1} << "\n";
    for (std::size_t i = 1; i < arrays.size(); ++i) {
        const auto encode = [&]<class Row>(const std::vector<Row>& rows) {
            sink << wordOf(names[i]) << " "
                 << std::int64_t{rowComponents<Row>(arrays[i].components)} << " " << points << " "
                 << numberType<NumberOf<Row>>().inLegacy << "\n";
            encodeNumbers(rows, sink);
        };
        std::visit(encode, arrays[i].values);
    }
}

void encodeVtkLegacy(const MeshRecord& record, ByteSink& sink) {
    constexpr std::size_t kMost32BitTriangles = std::numeric_limits<std::int32_t>::max() / 4;
    const TriangleMesh& mesh = record.mesh;
    const bool fits32Bits =
        mesh.triangles.size() <= kMost32BitTriangles && mesh.points.size() <= kMost32BitTriangles;
    sink << "# vtk DataFile Version " << (fits32Bits ? "4.2" : "5.1") << "\n"
         << slicerHeaderLine(record.options) << "\nBINARY\nDATASET POLYDATA\n";
    encodeFields(record.options, sink);
    sink << "POINTS " << std::int64_t{std::ssize(mesh.points)} << " double\n";
    encodeNumbers(mesh.points, sink);
    encodeCells(mesh.triangles, fits32Bits, sink);
    encodePointData(record, sink);
}

MeshFile decodeVtkLegacy(std::string_view bytes, const MeshReadOptions& options) {
    return LegacyDecoder(bytes, options).decode();
}

bool isVtkLegacy(std::string_view head, std::uint64_t /*byteCount*/) {
    return trimmed(head).starts_with("# vtk DataFile");
}

}  // namespace

extern const Codec kVtkLegacyCodec{isVtkLegacy, decodeVtkLegacy, encodeVtkLegacy};

}  // namespace adaptiso::meshio
