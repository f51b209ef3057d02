// GIFTI 1.0 (www.nitrc.org/projects/gifti): POINTSET float32 and TRIANGLE int32, both
// GZipBase64Binary. No third array for normals: Connectome Workbench takes surface files of
// exactly two (SurfaceFile::validateDataArraysAfterReading).
//
// Debian's libgiftiio allocates what a header claims before it looks at the data, so it is not
// for files from outside; expat and zlib, which it rests on too, are used directly.
#include <cmath>
#include <vector>

#include "ByteSource.h"
#include "Codecs.h"
#include "Packing.h"
#include "Xml.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/FrameTransform.h"

namespace adaptiso::meshio {
namespace {

constexpr std::string_view kScannerSpace = "NIFTI_XFORM_SCANNER_ANAT";
constexpr std::string_view kUnknownSpace = "NIFTI_XFORM_UNKNOWN";
constexpr std::string_view kFrameKey = "CoordinateFrame";

void encodeMatrixRow(const AffineTransform& transform, int row, ByteSink& sink) {
    for (const Vec3& column : transform.linear.column) sink << column[row] << " ";
    sink << transform.offset[row] << "\n";
}

/// From the frame of the points to scanner RAS, as NIFTI-style tools expect to find it.
void encodeCoordinateSystem(const MeshWriteOptions& options, ByteSink& sink) {
    const bool isRas = options.frame == CoordinateFrame::Ras;
    const AffineTransform toRas = isRas ? AffineTransform{}
                                        : lpsToFrame(CoordinateFrame::Ras, std::nullopt) *
                                              inverse(lpsToFrame(options.frame, options.volume));
    sink << "<CoordinateSystemTransformMatrix>\n<DataSpace><![CDATA["
         << (isRas ? kScannerSpace : kUnknownSpace)
         << "]]></DataSpace>\n<TransformedSpace><![CDATA[" << kScannerSpace
         << "]]></TransformedSpace>\n<MatrixData>\n";
    for (int row = 0; row < 3; ++row) encodeMatrixRow(toRas, row, sink);
    sink << "0 0 0 1\n</MatrixData>\n</CoordinateSystemTransformMatrix>\n";
}

template <class T>
void appendLittleEndian(T value, std::string& bytes) {
    if (std::endian::native == std::endian::big) value = swappedBytes(value);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void beginArray(std::string_view intent, std::string_view type, std::size_t rows, ByteSink& sink) {
    sink << "<DataArray Intent=\"" << intent << "\" DataType=\"" << type
         << "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\""
         << static_cast<std::int64_t>(rows)
         << "\" Dim1=\"3\" Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\""
            " ExternalFileName=\"\" ExternalFileOffset=\"\">\n<MetaData/>\n";
}

void endArray(const std::string& bytes, ByteSink& sink) {
    sink << "<Data>" << encodeBase64(deflated(bytes)) << "</Data>\n</DataArray>\n";
}

struct DataArray {
    XmlAttributes attributes;
    std::string text;
};

/// Collects the POINTSET, the TRIANGLE array and what the file says of its frame.
class GiftiHandler : public XmlHandler {
public:
    void onStart(const std::string& element, const XmlAttributes& attributes) override {
        if (depth_++ == 0 && element != "GIFTI") {
            damaged("its XML is a " + printable(element) + ", must be GIFTI");
        }
        text_ = nullptr;
        if (element == "DataArray") {
            array_ = nullptr;
            const std::string& intent = requireAttribute(attributes, "Intent");
            if (intent == "NIFTI_INTENT_POINTSET") array_ = &points;
            if (intent == "NIFTI_INTENT_TRIANGLE") array_ = &triangles;
            if (array_ != nullptr) {
                if (!array_->attributes.empty()) {
                    unsupported("it holds several surfaces", "save each to its own file");
                }
                array_->attributes = attributes;
            }
        } else if (element == "Data" && array_ != nullptr) {
            text_ = &array_->text;
        } else if (element == "Name") {
            name_.clear();
            text_ = &name_;
        } else if (element == "Value" && trimmed(name_) == kFrameKey) {
            text_ = &frameName;
        } else if (element == "DataSpace" && array_ == &points) {
            text_ = &dataSpace;
        }
    }
    void onEnd(const std::string& element) override {
        --depth_;
        text_ = nullptr;
        if (element == "DataArray") array_ = nullptr;
    }
    void onText(std::string_view text) override {
        if (text_ != nullptr) text_->append(text);
    }

    DataArray points, triangles;
    std::string frameName, dataSpace;

private:
    int depth_ = 0;
    DataArray* array_ = nullptr;   ///< the wanted array around this place
    std::string* text_ = nullptr;  ///< where text at this place goes
    std::string name_;
};

/// Rows of an array that must be N x 3.
std::int64_t rowsOf(const XmlAttributes& attributes, std::string_view what) {
    const std::int64_t rows = toInteger(requireAttribute(attributes, "Dim0"), "Dim0");
    if (attributeOr(attributes, "Dimensionality", "2") != "2" ||
        attributeOr(attributes, "Dim1", "3") != "3") {
        damaged("its " + std::string(what) + " are not an array of N x 3");
    }
    return rows;
}

/// The numbers of an N x 3 array, row by row.
template <class Stored, class T>
std::vector<T> decodeNumbers(const DataArray& array, std::string_view what) {
    const XmlAttributes& attributes = array.attributes;
    const std::int64_t rows = rowsOf(attributes, what);
    const std::string& encoding = requireAttribute(attributes, "Encoding");
    std::vector<T> numbers;
    if (encoding == "ASCII") {
        requireRoom(what, rows, 5, array.text.size());  // at least "0 0 0"
        ByteSource words(array.text);
        for (std::int64_t i = 0; i < 3 * rows; ++i) {
            numbers.push_back(static_cast<T>(std::is_integral_v<T>
                                                 ? static_cast<T>(words.integerWord(what))
                                                 : static_cast<T>(words.realWord(what))));
        }
        return numbers;
    }
    const bool isPacked = encoding == "GZipBase64Binary";
    if (!isPacked && encoding != "Base64Binary") {
        unsupported("its " + std::string(what) + " have the encoding " + printable(encoding),
                    "save it with GZipBase64Binary");
    }
    constexpr std::int64_t kRowBytes = 3 * sizeof(Stored);
    constexpr std::int64_t kBestRatio = 1032;  // of deflate
    const std::string stored = decodeBase64(array.text);
    requireRoom(what, rows, kRowBytes, isPacked ? kBestRatio * stored.size() : stored.size());
    if (isPacked) requirePlausibleSize(stored.size(), rows * kRowBytes);
    const std::string bytes = isPacked ? inflated(stored, rows * kRowBytes) : stored;
    const bool isBig = attributeOr(attributes, "Endian", "LittleEndian") == "BigEndian";
    numbers.reserve(3 * rows);
    for (std::int64_t i = 0; i < 3 * rows; ++i) {
        numbers.push_back(loadAs<Stored>(bytes.data() + i * sizeof(Stored),
                                         isBig ? std::endian::big : std::endian::little));
    }
    return numbers;
}

/// decodeNumbers() whatever the array's order; calls place(row, column, number).
template <class Stored, class T, class Place>
void decodeArray(const DataArray& array, std::string_view what, const Place& place) {
    const std::vector<T> numbers = decodeNumbers<Stored, T>(array, what);
    const std::size_t rows = numbers.size() / 3;
    const bool byColumns =
        attributeOr(array.attributes, "ArrayIndexingOrder", "RowMajorOrder") == "ColumnMajorOrder";
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            place(row, static_cast<int>(column),
                  numbers[byColumns ? column * rows + row : 3 * row + column]);
        }
    }
}

void requireType(const DataArray& array, std::string_view type, std::string_view what) {
    if (array.attributes.empty()) damaged("it has no " + std::string(what));
    const std::string& found = requireAttribute(array.attributes, "DataType");
    if (found != type) {
        unsupported("its " + std::string(what) + " are " + printable(found),
                    "save them as " + std::string(type));
    }
}

}  // namespace

void encodeGifti(const MeshRecord& record, ByteSink& sink) {
    const TriangleMesh& mesh = record.mesh;
    sink << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n"
            "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n<MetaData>\n<MD><Name><![CDATA["
         << kFrameKey << "]]></Name><Value><![CDATA[" << toString(record.options.frame)
         << "]]></Value></MD>\n</MetaData>\n<LabelTable/>\n";

    std::string bytes;
    bytes.reserve(mesh.points.size() * 3 * sizeof(float));
    for (const Vec3& p : mesh.points) {
        for (int axis = 0; axis < 3; ++axis) appendLittleEndian(static_cast<float>(p[axis]), bytes);
    }
    beginArray("NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", mesh.points.size(), sink);
    encodeCoordinateSystem(record.options, sink);
    endArray(bytes, sink);

    bytes.clear();
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId vertex : t)
            appendLittleEndian(static_cast<std::int32_t>(vertex), bytes);
    }
    beginArray("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", mesh.triangles.size(), sink);
    endArray(bytes, sink);
    sink << "</GIFTI>\n";
}

MeshFile decodeGifti(std::string_view bytes) {
    GiftiHandler found;
    parseXml(bytes, found);
    requireType(found.points, "NIFTI_TYPE_FLOAT32", "points");
    requireType(found.triangles, "NIFTI_TYPE_INT32", "triangles");

    MeshFile file;
    decodeArray<float, double>(found.points, "points", [&](std::size_t row, int axis, double x) {
        if (axis == 0) file.mesh.points.emplace_back();
        file.mesh.points[row][axis] = x;
    });
    decodeArray<std::int32_t, VertexId>(found.triangles, "triangles",
                                        [&](std::size_t row, int corner, VertexId vertex) {
                                            if (corner == 0) file.mesh.triangles.emplace_back();
                                            file.mesh.triangles[row][corner] = vertex;
                                        });
    file.frame = parseCoordinateFrame(trimmed(found.frameName));
    if (!file.frame && trimmed(found.dataSpace) == kScannerSpace) file.frame = CoordinateFrame::Ras;
    return file;
}

}  // namespace adaptiso::meshio
