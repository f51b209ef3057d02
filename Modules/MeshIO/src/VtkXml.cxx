// VTK XML PolyData (.vtp). Written: appended, base64, zlib, double points, 64-bit headers. Read:
// one piece; text, base64 or raw data, inline or appended, plain or zlib, either byte order.
//
// By hand, not by VTK: vtkXMLPolyDataReader allocates what the file claims and follows offsets and
// block tables unchecked; vtkXMLPolyDataWriter writes names of arrays as they are, so that a quote
// or '<' in one breaks the file.
#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "Bytes.h"
#include "Counts.h"
#include "Faces.h"
#include "VtkFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::meshio {
namespace {

constexpr std::int64_t kMostComponents = 9;  ///< of a tensor

std::int64_t componentsOf(const XmlAttributes& attributes) {
    return toInteger(attributeOr(attributes, "NumberOfComponents", "1"), "a number of components");
}

struct DataArray {
    XmlAttributes attributes;  ///< empty: the file has no such array
    std::string text;          ///< inline data
};

struct Cells {
    std::string_view element, count;  ///< their names
    DataArray corners{}, ends{};
};

/// Collects the arrays that make up the surface, up to the appended data.
class VtpHandler : public XmlHandler {
public:
    explicit VtpHandler(bool keepsArrays) : keepsArrays_(keepsArrays) {}

    void onStart(const std::string& element, const XmlAttributes& attributes) override {
        if (path_.empty()) startFile(element, attributes);
        if (element == "Piece") startPiece(attributes);
        if (element == "PointData") normalsName_ = attributeOr(attributes, "Normals", "");
        if (element == "DataArray" || element == "Array") startArray(attributes);
        if (element == "AppendedData") appended = attributes;
        path_.push_back(element);
    }
    void onEnd(const std::string&) override {
        path_.pop_back();
        if (path_.size() < arrayDepth_) array_ = nullptr;
    }
    void onText(std::string_view text) override {
        // text of elements inside an array (InformationKey) is not its data
        if (array_ != nullptr && path_.size() == arrayDepth_) array_->text.append(text);
    }
    bool isDone() const override { return !appended.empty(); }
    void onRest(std::string_view rest) override { behind = rest; }

    std::string_view behind;  ///< what follows the document
    XmlAttributes file, piece, appended;
    DataArray points, normals, frame, slicerSpace;
    Cells polygons{"Polys", "NumberOfPolys"}, strips{"Strips", "NumberOfStrips"};
    std::deque<DataArray> values;  ///< at points, where they are kept
    std::deque<DataArray> others;  ///< that are not: of points and of cells
    std::vector<bool> areOfCells;  ///< of `others`

private:
    void startFile(const std::string& element, const XmlAttributes& attributes) {
        if (element != "VTKFile") {
            unsupported("its XML is a " + printable(element) + ", must be VTKFile",
                        "it is no file of VTK: get it again");
        }
        const std::string& type = requireAttribute(attributes, "type");
        if (type != "PolyData") {
            unsupported("it is not a PolyData but " + printable(type), std::string(kToPolyData));
        }
        file = attributes;
    }

    void startPiece(const XmlAttributes& attributes) {
        if (!piece.empty()) unsupported("it holds several pieces", "save it as one piece");
        piece = attributes;
    }

    void startArray(const XmlAttributes& attributes) {
        const std::string_view parent = path_.empty() ? std::string_view() : path_.back();
        const std::string name = attributeOr(attributes, "Name", "");
        array_ = nullptr;
        if (parent == "Points") array_ = &points;
        for (Cells* const cells : {&polygons, &strips}) {
            if (parent != cells->element) continue;
            if (name == "connectivity") array_ = &cells->corners;
            if (name == "offsets") array_ = &cells->ends;
        }
        if (parent == "PointData" && !normalsName_.empty() && name == normalsName_) {
            array_ = &normals;
        } else if (parent == "PointData" && keepsArrays_ && mayBeKept(attributes)) {
            array_ = &values.emplace_back();
        } else if (parent == "PointData" || parent == "CellData") {
            array_ = &others.emplace_back();
            areOfCells.push_back(parent == "CellData");
        }
        if (parent == "FieldData" && attributeOr(attributes, "type", "") == "String") {
            if (name == kFrameFieldName) array_ = &frame;
            if (name == kSlicerFieldName) array_ = &slicerSpace;
        }
        if (array_ == nullptr) return;
        *array_ = {attributes, {}};
        arrayDepth_ = path_.size() + 1;
    }

    static bool mayBeKept(const XmlAttributes& attributes) {
        return attributeOr(attributes, "type", "String") != "String" &&
               componentsOf(attributes) <= kMostComponents;
    }

    bool keepsArrays_;
    std::vector<std::string> path_;  ///< the elements around this place
    std::string normalsName_;
    DataArray* array_ = nullptr;
    std::size_t arrayDepth_ = 0;
};

/// "Float64", "UInt8"; empty for strings and bits
std::optional<PixelType> numberTypeOf(const XmlAttributes& attributes) {
    const std::string name = lowerCase(attributeOr(attributes, "type", ""));
    for (int n = 0; n <= static_cast<int>(PixelType::Float64); ++n) {
        const auto type = static_cast<PixelType>(n);
        if (name == toString(type)) return type;
    }
    return std::nullopt;
}

PixelType typeOf(const XmlAttributes& attributes, std::string_view what) {
    const std::string& name = requireAttribute(attributes, "type");
    if (const auto type = numberTypeOf(attributes)) return *type;
    unsupported("its " + std::string(what) + " have the type " + printable(name),
                "save them as Float64 or Int64");
}

/// Gets at the bytes of arrays, however they are kept.
class ArrayReader {
public:
    /// \param fileBytes  of the whole file
    ArrayReader(const VtpHandler& handler, std::string_view appendedData, std::size_t fileBytes)
        : unpacking(fileBytes),
          appendedData_(appendedData),
          appendedIsRaw_(attributeOr(handler.appended, "encoding", "base64") == "raw"),
          order_(attributeOr(handler.file, "byte_order", "LittleEndian") == "BigEndian"
                     ? std::endian::big
                     : std::endian::little),
          wordBytes_(attributeOr(handler.file, "header_type", "UInt32") == "UInt64" ? 8 : 4) {
        const std::string compressor = attributeOr(handler.file, "compressor", "");
        isCompressed_ = !compressor.empty();
        if (isCompressed_ && compressor != "vtkZLibDataCompressor") {
            unsupported("it is compressed by " + printable(compressor),
                        "save it with zlib or without");
        }
    }

    Unpacking unpacking;

    /// Where the appended data end that were read.
    std::size_t appendedEnd() const { return appendedEnd_; }

    /// Numbers of any stored type, `count` of them.
    template <class T>
    std::vector<T> numbers(const DataArray& array, std::int64_t count, std::string_view what) {
        if (array.attributes.empty()) malformed("it has no " + std::string(what));
        if (requireAttribute(array.attributes, "format") == "ascii") {
            return textNumbers<T>(array.text, count, what);
        }
        const PixelType type = typeOf(array.attributes, what);
        return withPixelType(type, [&]<class Stored>(Stored) {
            return binaryNumbers<Stored, T>(array, count, what);
        });
    }

    /// Checks that an array which is not read holds `count` numbers, by what it says of itself.
    void requireCount(const DataArray& array, std::int64_t count) const {
        const auto type = numberTypeOf(array.attributes);
        if (!type || !array.attributes.contains("format")) return;
        std::uint64_t found = 0;
        if (requireAttribute(array.attributes, "format") == "ascii") {
            ByteSource words(array.text);
            while (!words.word().empty()) ++found;
        } else {
            found = countedBytes(array) / bytesPerPixel(*type);
        }
        if (found == static_cast<std::uint64_t>(count)) return;
        damaged("its array " + printable(attributeOr(array.attributes, "Name", "")) + " holds " +
                std::to_string(found) + " values, must hold " + std::to_string(count));
    }

    /// The first string of a string array: characters up to a zero byte.
    std::string firstString(const DataArray& array) {
        constexpr std::int64_t kMostCharacters = 64;
        std::string text;
        if (requireAttribute(array.attributes, "format") == "ascii") {
            ByteSource words(array.text);
            for (std::int64_t i = 0; i < kMostCharacters; ++i) {
                const std::string_view word = words.word();
                if (word.empty() || word == "0") break;
                text += static_cast<char>(toInteger(word, "a character"));
            }
            return text;
        }
        constexpr std::size_t kMostBytes = std::size_t{1} << 16;  // of all strings of the array
        text = blockBytes(array, kMostBytes, "strings");
        return text.substr(0, std::min(text.find('\0'), text.size()));
    }

private:
    template <class T>
    std::vector<T> textNumbers(std::string_view text, std::int64_t count, std::string_view what) {
        requireRoom(what, count, 2, text.size() + 1);  // a digit and a space each
        ByteSource words(text);
        std::vector<T> values(count);
        for (T& value : values) {
            if constexpr (std::is_integral_v<T>) {
                value = words.integerWord(what);
            } else {
                value = words.realWord(what);
            }
        }
        requireNoMoreText({what, count, 1}, words.rest(), unpacking.warnings);
        return values;
    }

    template <class Stored, class T>
    std::vector<T> binaryNumbers(const DataArray& array, std::int64_t count,
                                 std::string_view what) {
        if (std::is_integral_v<T> != std::is_integral_v<Stored>) {
            malformed("its " + std::string(what) + " have the wrong type of number");
        }
        constexpr std::int64_t kBestRatio = 1032;  // of deflate
        const std::size_t mostBytes =
            std::max(array.text.size(), appendedData_.size()) * (isCompressed_ ? kBestRatio : 1);
        requireRoom(what, count, sizeof(Stored), mostBytes);
        const std::size_t due = count * sizeof(Stored);
        unpacking.add(count, std::max(sizeof(T), sizeof(Stored)));
        const std::string bytes = blockBytes(array, due, what);
        if (bytes.size() != due) {
            damaged("its " + std::string(what) + " take " + std::to_string(bytes.size()) +
                    " bytes, must be " + std::to_string(due));
        }
        std::vector<T> values(count);
        for (std::int64_t i = 0; i < count; ++i) {
            values[i] = static_cast<T>(loadAs<Stored>(bytes.data() + i * sizeof(Stored), order_));
        }
        return values;
    }

    /// The unpacked bytes of an array; damage, and nothing unpacked, where they are compressed
    /// and claim to be more than `most`.
    std::string blockBytes(const DataArray& array, std::size_t most, std::string_view what) {
        const bool isAppended = requireAttribute(array.attributes, "format") == "appended";
        const bool isRaw = isAppended && appendedIsRaw_;
        std::string_view data = storedData(array, what);
        std::string bytes =
            isCompressed_ ? unpackedBlocks(data, isRaw, most) : plainBlock(data, isRaw);
        if (isAppended) {
            appendedEnd_ = std::max(appendedEnd_, appendedData_.size() - data.size());
        }
        return bytes;
    }

    /// From where its data begin.
    std::string_view storedData(const DataArray& array, std::string_view what) const {
        if (requireAttribute(array.attributes, "format") != "appended") return trimmed(array.text);
        const std::int64_t offset =
            toInteger(requireAttribute(array.attributes, "offset"), "an offset");
        requireRoom("bytes before its " + std::string(what), offset, 1, appendedData_.size());
        return appendedData_.substr(offset);
    }

    /// Bytes of an array by the words before its data.
    std::uint64_t countedBytes(const DataArray& array) const {
        const bool isRaw =
            appendedIsRaw_ && requireAttribute(array.attributes, "format") == "appended";
        std::string_view data = storedData(array, "values"), ahead = data;
        const std::uint64_t first = headerWord(takeBytes(ahead, wordBytes_, isRaw), 0);
        if (!isCompressed_ || first == 0) return first;
        const std::string header = takeBytes(data, 3 * wordBytes_, isRaw);
        const std::uint64_t last = headerWord(header, 2);
        return last == 0 ? first * headerWord(header, 1)
                         : (first - 1) * headerWord(header, 1) + last;
    }

    /// The first `count` bytes that `data` stands for; moves `data` behind them.
    static std::string takeBytes(std::string_view& data, std::size_t count, bool isRaw) {
        const std::size_t length = isRaw ? count : base64Length(count);
        if (count > data.size() || length > data.size()) damaged("its data is cut off");
        const std::string_view taken = data.substr(0, length);
        data.remove_prefix(length);
        std::string bytes = isRaw ? std::string(taken) : decodeBase64(taken);
        if (bytes.size() < count) damaged("its base64 data is cut off");
        bytes.resize(count);
        return bytes;
    }

    std::uint64_t headerWord(std::string_view header, std::size_t index) const {
        const char* const word = header.data() + index * wordBytes_;
        return wordBytes_ == 8 ? loadAs<std::uint64_t>(word, order_)
                               : loadAs<std::uint32_t>(word, order_);
    }

    /// A word with the number of bytes, then these; both in one run of base64.
    std::string plainBlock(std::string_view& data, bool isRaw) const {
        std::string_view ahead = data;
        const std::uint64_t size = headerWord(takeBytes(ahead, wordBytes_, isRaw), 0);
        if (size > data.size()) damaged("its data is cut off");
        return takeBytes(data, wordBytes_ + size, isRaw).substr(wordBytes_);
    }

    /// Number of blocks, bytes of a block, of the last one (0: full), packed bytes of each; then,
    /// in a second run of base64, the blocks.
    std::string unpackedBlocks(std::string_view& data, bool isRaw, std::size_t most) const {
        std::string_view ahead = data;
        const std::uint64_t blocks = headerWord(takeBytes(ahead, wordBytes_, isRaw), 0);
        if (blocks > data.size() / wordBytes_) damaged("its table of blocks is cut off");
        const std::string header = takeBytes(data, (3 + blocks) * wordBytes_, isRaw);
        std::uint64_t packedBytes = 0;
        for (std::size_t block = 0; block < blocks; ++block) {
            const std::uint64_t packed = headerWord(header, 3 + block);
            if (packed > data.size() - packedBytes) damaged("its data is cut off");
            packedBytes += packed;
        }
        const std::string packed = takeBytes(data, packedBytes, isRaw);
        std::string bytes;
        std::size_t begin = 0;
        for (std::size_t block = 0; block < blocks; ++block) {
            const std::uint64_t last = headerWord(header, 2);
            const std::uint64_t size =
                block + 1 == blocks && last != 0 ? last : headerWord(header, 1);
            if (size > most - bytes.size()) {
                damaged("its blocks of compressed data unpack to more than " +
                        std::to_string(most) + " bytes, as many as it counts");
            }
            const std::uint64_t length = headerWord(header, 3 + block);
            bytes += inflated(std::string_view(packed).substr(begin, length), size);
            begin += length;
        }
        return bytes;
    }

    std::string_view appendedData_;
    std::size_t appendedEnd_ = 0;
    bool appendedIsRaw_;
    std::endian order_;
    std::size_t wordBytes_;
    bool isCompressed_ = false;
};

/// Bytes behind the '_' of the AppendedData element that begins at `position`.
std::string_view findAppendedData(std::string_view bytes, std::size_t position) {
    const std::size_t end = bytes.find('>', position);
    const std::size_t mark = end == std::string_view::npos ? end : bytes.find('_', end);
    if (mark == std::string_view::npos) damaged("its appended data does not begin with '_'");
    return bytes.substr(mark + 1);
}

/// What follows the document that ends behind its appended data; empty where it does not end.
std::string_view behindAppended(std::string_view appendedData, std::size_t dataEnd) {
    std::string_view rest = appendedData.substr(dataEnd);
    for (const std::string_view mark : {"</AppendedData", "</VTKFile", ">"}) {
        const std::size_t at = rest.find(mark);
        if (at == std::string_view::npos) return {};
        rest = rest.substr(at + mark.size());
    }
    rest = trimmed(rest);
    constexpr std::string_view kBegin = "<!--", kEnd = "-->";
    while (rest.starts_with(kBegin)) {
        const std::size_t end = rest.find(kEnd, kBegin.size());
        if (end == std::string_view::npos) break;
        rest = trimmed(rest.substr(end + kEnd.size()));
    }
    return rest;
}

std::int64_t pieceCount(const VtpHandler& handler, std::string_view name) {
    return toInteger(requireAttribute(handler.piece, name), name);
}

std::int64_t countOr0(const VtpHandler& handler, std::string_view name) {
    return toInteger(attributeOr(handler.piece, name, "0"), name);
}

/// Calls f(corners) for each cell.
template <class F>
void forEachCell(const Cells& cells, std::int64_t count, ArrayReader& reader, const F& f) {
    const auto ends = reader.numbers<std::int64_t>(cells.ends, count, "polygon offsets");
    std::int64_t begin = 0;
    for (const std::int64_t end : ends) {
        if (end < begin) damaged("its polygon offsets do not grow");
        begin = end;
    }
    const auto corners = reader.numbers<VertexId>(cells.corners, begin, "polygons");
    begin = 0;
    for (const std::int64_t end : ends) {
        f(std::span(corners).subspan(begin, end - begin));
        begin = end;
    }
}

Faces decodeFaces(const VtpHandler& handler, ArrayReader& reader) {
    Faces faces;
    const std::int64_t polygons = pieceCount(handler, handler.polygons.count);
    forEachCell(handler.polygons, polygons, reader,
                [&](std::span<const VertexId> corners) { faces.add(corners); });
    const std::int64_t strips = countOr0(handler, handler.strips.count);
    if (strips == 0) return faces;
    forEachCell(handler.strips, strips, reader,
                [&](std::span<const VertexId> corners) { faces.addStrip(corners); });
    return faces;
}

/// Arrays of places need not say their components; where they do, these are x, y and z.
void requireComponents(const DataArray& stored, std::string_view what) {
    const std::string found = attributeOr(stored.attributes, "NumberOfComponents", "3");
    if (toInteger(found, "a number of components") == 3) return;
    malformed("its " + std::string(what) + " have " + printable(found) +
              " components (NumberOfComponents), must have 3");
}

/// \return  nothing for an array without components
std::optional<PointArray> decodePointArray(const DataArray& stored, std::int64_t points,
                                           ArrayReader& reader) {
    const XmlAttributes& attributes = stored.attributes;
    const std::int64_t components = componentsOf(attributes);
    if (components < 1) return std::nullopt;
    const PixelType type = typeOf(attributes, "values");
    std::string name = storedName(attributeOr(attributes, "Name", ""));
    if (isReal(type)) {
        return PointArray{std::move(name),
                          reader.numbers<double>(stored, components * points, "values"),
                          static_cast<int>(components)};
    }
    return wholeArray(std::move(name), type, components,
                      reader.numbers<std::int64_t>(stored, components * points, "values"));
}

/// Numbers as appended data holds them: a table of the lengths of packed blocks, then the blocks,
/// each in a run of base64.
class PackedBlocks {
public:
    template <class T>
    void add(T number) {
        appendLittleEndian(number, block_);
        if (block_.size() == kBlockBytes) pack();
    }

    std::string finish() {
        const std::uint64_t last = block_.size();
        if (last > 0) pack();
        std::string table;
        for (const std::uint64_t word : {std::uint64_t{lengths_.size()}, kBlockBytes, last}) {
            appendLittleEndian(word, table);
        }
        for (const std::uint64_t length : lengths_) appendLittleEndian(length, table);
        return encodeBase64(table) + encodeBase64(packed_);
    }

private:
    static constexpr std::uint64_t kBlockBytes = std::uint64_t{1} << 15;  // as VTK

    void pack() {
        const std::string packed = deflated(block_);
        lengths_.push_back(packed.size());
        packed_ += packed;
        block_.clear();
    }

    std::string block_, packed_;
    std::vector<std::uint64_t> lengths_;
};

class VtpEncoder {
public:
    void encode(const MeshRecord& record, ByteSink& sink) {
        const TriangleMesh& mesh = record.mesh;
        elements_ =
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\" "
            "compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n<FieldData>\n";
        for (const auto& [name, text] : fieldsOf(record.options)) addText(name, text);
        const std::string_view space = slicerName(record.options.frame);
        if (record.options.saysFrame && !space.empty()) addText(kSlicerFieldName, space);
        elements_ += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(mesh.points.size()) +
                     "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                     "NumberOfPolys=\"" +
                     std::to_string(mesh.triangles.size()) + "\">\n";
        addPointData(mesh, record.options.pointArrays);
        addCellData(record.options.cellArrays);
        elements_ += "<Points>\n";
        addArray("Points", mesh.points, 3);
        elements_ += "</Points>\n<Polys>\n";
        addTriangles(mesh.triangles);
        elements_ += "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"base64\">\n_";
        sink << elements_ << data_ << "\n</AppendedData>\n</VTKFile>\n";
    }

private:
    void addPointData(const TriangleMesh& mesh, const std::vector<PointArray>& arrays) {
        const std::vector<std::string> names = arrayNames(arrays);
        beginData("PointData", names, !mesh.normals.empty());
        if (!mesh.normals.empty()) addArray(kNormalsName, mesh.normals, 3);
        for (std::size_t i = 0; i < arrays.size(); ++i) {
            const auto add = [&]<class Row>(const std::vector<Row>& rows) {
                addArray(names[i], rows, rowComponents<Row>(arrays[i].components));
            };
            std::visit(add, arrays[i].values);
        }
        elements_ += "</PointData>\n";
    }

    void addCellData(const std::vector<CellArray>& arrays) {
        const std::vector<std::string> names = arrayNames(arrays);
        beginData("CellData", names, false);
        for (std::size_t i = 0; i < arrays.size(); ++i) {
            std::visit([&](const auto& values) { addArray(names[i], values, 1); },
                       arrays[i].values);
        }
        elements_ += "</CellData>\n";
    }

    void addTriangles(const std::vector<Triangle>& triangles) {
        addArray("connectivity", triangles, 1);
        addElement("DataArray", numberType<VertexId>().inXml, "offsets", "");
        PackedBlocks blocks;
        for (std::size_t i = 1; i <= triangles.size(); ++i) {
            blocks.add(static_cast<VertexId>(3 * i));
        }
        data_ += blocks.finish();
    }

    /// The first of the arrays is the active one.
    void beginData(const std::string& element, const std::vector<std::string>& names,
                   bool hasNormals) {
        elements_ += "<" + element;
        if (!names.empty()) elements_ += " Scalars=\"" + inXml(names[0]) + "\"";
        if (hasNormals) elements_ += " Normals=\"" + std::string(kNormalsName) + "\"";
        elements_ += ">\n";
    }

    template <class Row>
    void addArray(std::string_view name, const std::vector<Row>& rows, int components) {
        addElement("DataArray", numberType<NumberOf<Row>>().inXml, name,
                   components == 1 ? std::string()
                                   : " NumberOfComponents=\"" + std::to_string(components) + "\"");
        PackedBlocks blocks;
        forEachNumber(rows, [&](auto number) { blocks.add(number); });
        data_ += blocks.finish();
    }

    void addText(std::string_view name, std::string_view text) {
        addElement("Array", "String", name, " NumberOfTuples=\"1\"");
        PackedBlocks blocks;
        for (const char c : text) blocks.add(c);
        blocks.add('\0');
        data_ += blocks.finish();
    }

    /// An array whose data come next.
    void addElement(std::string_view element, std::string_view type, std::string_view name,
                    const std::string& size) {
        elements_ += "<" + std::string(element) + " type=\"" + std::string(type) + "\" Name=\"" +
                     inXml(name) + "\"" + size + " format=\"appended\" offset=\"" +
                     std::to_string(data_.size()) + "\"/>\n";
    }

    static std::string inXml(std::string_view name) {
        return escapedMarkup(toUtf8(storedName(name)));
    }

    std::string elements_, data_;
};

void encodeVtkXml(const MeshRecord& record, ByteSink& sink) {
    VtpEncoder().encode(record, sink);
}

/// Arrays that are not read are as many as the points or the cells too.
void passOver(const VtpHandler& handler, const ArrayReader& reader, bool keepsArrays,
              MeshFile& file) {
    constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max(), kMostCells = kMost / 16,
                          kMostValues = kMost / 4;
    std::int64_t cells = 0;
    for (const char* const kind :
         {"NumberOfVerts", "NumberOfLines", "NumberOfPolys", "NumberOfStrips"}) {
        const std::int64_t count = countOr0(handler, kind);
        requireRoom(kind, count, 1, kMostCells);
        cells += count;
    }
    const std::int64_t points = pieceCount(handler, "NumberOfPoints");
    for (std::size_t n = 0; n < handler.others.size(); ++n) {
        const DataArray& array = handler.others[n];
        const std::int64_t components = componentsOf(array.attributes),
                           each = handler.areOfCells[n] ? cells : points;
        requireRoom("components", components, std::max<std::int64_t>(each, 1), kMostValues);
        reader.requireCount(array, components * each);
        if (!keepsArrays) continue;
        file.arraysLeftOut.push_back(storedName(attributeOr(array.attributes, "Name", "")));
    }
}

MeshFile decodeVtkXml(std::string_view bytes, const MeshReadOptions& options) {
    VtpHandler handler(options.keepsPointArrays);
    const std::size_t end = parseXml(bytes, handler);
    if (handler.piece.empty()) malformed("it has no piece");
    const std::string_view appended =
        handler.isDone() ? findAppendedData(bytes, end) : std::string_view();
    ArrayReader reader(handler, appended,
                       options.storedBytes > 0 ? options.storedBytes : bytes.size());
    MeshFile file;
    const std::int64_t points = pieceCount(handler, "NumberOfPoints");
    requireRoom("points", points, 1, 1032 * bytes.size());  // so that 3 * points can't overflow
    requireComponents(handler.points, "points");
    const auto coordinates = reader.numbers<double>(handler.points, 3 * points, "points");
    for (std::int64_t i = 0; i < points; ++i) {
        file.mesh.points.push_back(
            {coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]});
    }
    if (!handler.normals.attributes.empty()) {
        requireComponents(handler.normals, "normals");
        const auto normals = reader.numbers<double>(handler.normals, 3 * points, "normals");
        for (std::int64_t i = 0; i < points; ++i) {
            file.mesh.normals.push_back(
                storedNormal({normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]}));
        }
    }
    for (const DataArray& stored : handler.values) {
        if (auto array = decodePointArray(stored, points, reader)) {
            file.pointArrays.push_back(std::move(*array));
        }
    }
    passOver(handler, reader, options.keepsPointArrays, file);
    Faces faces = decodeFaces(handler, reader);
    FrameMarks marks(options);
    for (const DataArray* const field : {&handler.frame, &handler.slicerSpace}) {
        if (field->attributes.empty()) continue;
        addField(requireAttribute(field->attributes, "Name"), reader.firstString(*field), marks);
    }
    file.frame = marks.frame();
    requireNoMore(
        {"triangles", faces.count(), std::ssize(bytes)},
        handler.isDone() ? behindAppended(appended, reader.appendedEnd()) : handler.behind,
        reader.unpacking.warnings);
    file.warnings = std::move(reader.unpacking.warnings);
    std::move(faces).moveTo(
        file, options.keepsFaults,
        countOr0(handler, "NumberOfVerts") + countOr0(handler, "NumberOfLines"));
    return file;
}

bool isVtkXml(std::string_view head, std::uint64_t /*byteCount*/) {
    return xmlRoot(head) == "VTKFile";
}

}  // namespace

extern const Codec kVtkXmlCodec{isVtkXml, decodeVtkXml, encodeVtkXml};

}  // namespace adaptiso::meshio
