#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <string>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "NrrdHeader.h"
#include "Readers.h"
#include "Samples.h"
#include "adaptiso/Core/TextLines.h"

// The header is read here: ITK 5.2.1 flips the wrong axis for left-anterior-superior, takes unknown
// spaces as LPS and opens any file a header names. So are the samples, once and in place: ITK
// copies them, leaves memory uninitialised where they are short, and wraps numbers of text that
// their type can't hold.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

enum class NrrdEncoding { Raw, Gzip, Text };

NrrdEncoding encodingOf(const fs::path& file, const NrrdHeader& header) {
    const std::string encoding = lowerCase(header.require(file, "encoding"));
    if (encoding == "raw") return NrrdEncoding::Raw;
    if (encoding == "gzip" || encoding == "gz") return NrrdEncoding::Gzip;
    if (encoding == "ascii" || encoding == "text" || encoding == "txt") return NrrdEncoding::Text;
    // ITK as Debian packages it is built without bzip2
    refuse(file, fmt::format("unsupported NRRD encoding '{}'", printable(encoding)),
           "save it with encoding raw or gzip");
}

std::endian byteOrderOf(const fs::path& file, const NrrdHeader& header, PixelType type) {
    if (bytesPerPixel(type) == 1) return std::endian::native;
    const std::string endian = lowerCase(header.require(file, "endian"));
    if (endian == "little") return std::endian::little;
    if (endian == "big") return std::endian::big;
    refuse(file, fmt::format("its NRRD header is damaged: endian '{}'", printable(endian)),
           "it must be little or big");
}

/// At least 0; or -1 for the last bytes of the data, where those are binary.
std::int64_t parseSkip(const fs::path& file, const NrrdHeader& header, std::string_view field,
                       std::int64_t least) {
    std::string name(field);
    std::erase(name, ' ');
    const auto text = header.find(name);
    if (!text) return 0;
    const auto skip = parseInteger(*text);
    if (!skip || *skip < least) {
        refuse(file, fmt::format("its NRRD header is damaged: {} '{}'", field, printable(*text)),
               least == 0 ? "it must be at least 0"
                          : "it must be at least 0, or -1 for data at the file's end");
    }
    return *skip;
}

DataPlace placeOf(const fs::path& file, const NrrdHeader& header, NrrdEncoding encoding) {
    const auto dataFile = header.find("datafile");
    DataPlace place{file, dataFile ? requireDataFile(file, *dataFile) : file};
    if (encoding == NrrdEncoding::Gzip) place.encoding = ByteSource::Encoding::Deflate;
    if (!dataFile) place.begin = header.byteCount;
    place.lines = static_cast<std::uint64_t>(parseSkip(file, header, "line skip", 0));
    const std::int64_t bytes =
        parseSkip(file, header, "byte skip", encoding == NrrdEncoding::Text ? 0 : -1);
    place.countsFromEnd = bytes == -1;
    place.bytes = static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0));
    place.skipName = "byte skip";
    place.gzipField = "encoding: gzip";
    return place;
}

}  // namespace

bool looksLikeNrrd(std::string_view head) {
    return withoutByteOrderMark(head).starts_with("NRRD");
}

ReadVolume readNrrd(const fs::path& file, const ReadOptions& options) {
    const NrrdHeader header = readNrrdHeader(file);
    const NrrdAxes axes = axesOf(file, header);
    SampleLayout layout{pixelTypeOf(file, header)};
    layout.volumeCount = axes.volumeCount;
    requireImageBytes(file, axes.size, layout.stored);
    layout.volume = chooseVolume(
        file, axes.volumeCount, options,
        fmt::format("is 4-D: it holds {} {}", axes.volumeCount, volumesNameOf(header)));
    layout.isInterleaved = axes.volumeAxis == 0U;
    std::vector<Warning> warnings;
    const ImageGeometry geometry = geometryOf(file, header, axes, options.space, warnings);
    requireUsableGeometry(file, geometry);

    const NrrdEncoding encoding = encodingOf(file, header);
    const DataPlace place = placeOf(file, header, encoding);
    if (encoding == NrrdEncoding::Text) {
        if (axes.volumeAxis) {
            refuse(file, "has 4 dimensions and its data are text",
                   "save it with encoding raw or gzip");
        }
        Volume volume = readingData(place, [&] {
            ByteSource source = openData(place, 0, ImageExtent::of(layout, axes.size));
            return readNrrdText(place.file, source, layout.stored, geometry, warnings);
        });
        return {std::move(volume), "NRRD", std::move(warnings)};
    }
    layout.byteOrder = byteOrderOf(file, header, layout.stored);
    PlacedVolume read = readPlaced(place, layout, geometry);
    checkTail(place, read.tail, layout, axes.size, warnings);
    return {std::move(read.volume), "NRRD", std::move(warnings)};
}

}  // namespace adaptiso::detail
