#pragma once

// Arrays of numbers in XML, for GIFTI surfaces and GIFTI data.

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "Bytes.h"
#include "Counts.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::meshio {

inline constexpr std::string_view kGiftiHead =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<!DOCTYPE GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\">\n";

inline constexpr std::string_view kExternalFile = "ExternalFileBinary";

using GiftiMetadata = std::vector<std::pair<std::string, std::string>>;

/// A CoordinateSystemTransformMatrix.
struct GiftiSpace {
    std::string dataSpace, transformedSpace, matrix;
};

/// A DataArray as the file has it.
struct GiftiArray {
    XmlAttributes attributes{};
    std::string text{};
    bool isExternal = false;  ///< `text` is the bytes of the file that loadExternal() read
    GiftiMetadata metadata{};
    std::vector<GiftiSpace> spaces{};
};

/// The content of a file; names and values of metadata are trimmed.
struct GiftiFile {
    std::vector<GiftiArray> arrays;
    std::vector<std::pair<XmlAttributes, std::string>> labels;  ///< with their names
    GiftiMetadata metadata;
    std::string_view behind{};  ///< what follows the document
    std::string count{};        ///< NumberOfDataArrays; may be empty
    std::vector<Warning> warnings;
};

/// \throws FileError  it is no GIFTI file, or counts other arrays than it holds
GiftiFile parseGifti(std::string_view bytes);

/// Reads the data of an array that lie in a file of their own (ExternalFileBinary, as SPM writes):
/// a plain file in `folder`, nowhere else. Other arrays stay as they are. \throws FileError
void loadExternal(GiftiArray& array, const std::filesystem::path& folder);

/// Rows and columns of an array of one or two dimensions.
struct GiftiShape {
    std::int64_t rows = 0, columns = 1;
};

GiftiShape shapeOf(const XmlAttributes& attributes, std::string_view what);

/// True if the encoding packs numbers, false for base64 alone. \throws FileError  otherwise
bool isPackedGifti(const std::string& encoding, std::string_view what);

/// The numbers of an array in the order in which they are stored.
template <class Stored, class T>
std::vector<T> decodeGiftiNumbers(const GiftiArray& array, const GiftiShape& shape,
                                  std::string_view what, Unpacking& unpacking) {
    const std::string& encoding = requireAttribute(array.attributes, "Encoding");
    if (encoding == kExternalFile && !array.isExternal) {
        const std::string file = attributeOr(array.attributes, "ExternalFileName", "");
        unsupported("its " + std::string(what) + " lie in another file, " + printable(file) + " (" +
                        std::string(kExternalFile) + ")",
                    "save it as GZipBase64Binary, all in one file");
    }
    requireRoom("columns", shape.columns, 1, array.text.size());  // so that no product overflows
    const std::int64_t columns = shape.columns;
    std::vector<T> numbers;
    if (columns == 0) return numbers;
    if (encoding == "ASCII") {
        requireRoom(what, shape.rows, 2 * columns - 1, array.text.size());  // "0 0 0"
        ByteSource words(array.text);
        for (std::int64_t i = 0; i < shape.rows * columns; ++i) {
            if constexpr (std::is_integral_v<Stored>) {
                numbers.push_back(static_cast<T>(words.integerWord(what)));
            } else {
                numbers.push_back(static_cast<T>(words.realWord(what)));
            }
        }
        requireNoMoreText({what, shape.rows, columns}, words.rest(), unpacking.warnings);
        return numbers;
    }
    const bool isPacked = !array.isExternal && isPackedGifti(encoding, what);
    const auto rowBytes = columns * static_cast<std::int64_t>(sizeof(Stored));
    constexpr std::int64_t kBestRatio = 1032;  // of deflate
    const std::string stored = array.isExternal ? array.text : decodeBase64(array.text);
    requireRoom(what, shape.rows, rowBytes, isPacked ? kBestRatio * stored.size() : stored.size());
    unpacking.add(shape.rows * columns, sizeof(T));
    const auto due = static_cast<std::size_t>(shape.rows * rowBytes);
    const std::string bytes = isPacked ? inflated(stored, due) : stored;
    // other arrays may follow in a file of their own
    if (!array.isExternal) {
        requireNoMore({what, shape.rows, rowBytes}, std::string_view(bytes).substr(due),
                      unpacking.warnings);
    }
    const bool isBig = attributeOr(array.attributes, "Endian", "LittleEndian") == "BigEndian";
    const std::int64_t count = shape.rows * columns;
    numbers.reserve(count);
    for (std::int64_t i = 0; i < count; ++i) {
        numbers.push_back(static_cast<T>(loadAs<Stored>(
            bytes.data() + i * sizeof(Stored), isBig ? std::endian::big : std::endian::little)));
    }
    return numbers;
}

/// decodeGiftiNumbers() row by row, whatever the array's order.
template <class Stored, class T>
std::vector<T> decodeGiftiRows(const GiftiArray& array, const GiftiShape& shape,
                               std::string_view what, Unpacking& unpacking) {
    std::vector<T> numbers = decodeGiftiNumbers<Stored, T>(array, shape, what, unpacking);
    const bool byColumns =
        attributeOr(array.attributes, "ArrayIndexingOrder", "RowMajorOrder") == "ColumnMajorOrder";
    if (!byColumns || shape.columns == 1) return numbers;
    std::vector<T> rows(numbers.size());
    for (std::int64_t row = 0; row < shape.rows; ++row) {
        for (std::int64_t column = 0; column < shape.columns; ++column) {
            rows[row * shape.columns + column] = numbers[column * shape.rows + row];
        }
    }
    return rows;
}

/// The element's start, up to where its metadata stand. One dimension where there is one column.
void beginGiftiArray(std::string_view intent, std::string_view type, const GiftiShape& shape,
                     ByteSink& sink);
/// Its data, packed, and its end.
void endGiftiArray(const std::string& bytes, ByteSink& sink);

/// Refuses an array that is missing or holds numbers of another type than "NIFTI_TYPE_...".
void requireGiftiType(const GiftiArray& array, std::string_view type, std::string_view what);

}  // namespace adaptiso::meshio
