#include <fmt/core.h>

#include <bit>
#include <optional>
#include <string>

#include "DataFile.h"
#include "DataTail.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "NrrdHeader.h"
#include "NrrdText.h"
#include "Readers.h"
#include "Samples.h"

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

std::uint64_t parseSkip(const fs::path& file, const NrrdHeader& header, std::string_view name,
                        bool mayCountFromEnd, bool& countsFromEnd) {
    const auto text = header.find(name);
    if (!text) return 0;
    const auto skip = parseInteger(*text);
    countsFromEnd = mayCountFromEnd && skip && *skip == -1;
    if (!skip || (*skip < 0 && !countsFromEnd)) {
        refuse(file,
               fmt::format("its NRRD header is damaged: {} '{}'",
                           name == "byteskip" ? "byte skip" : "line skip", printable(*text)),
               mayCountFromEnd ? "it must be at least 0, or -1 for raw data at the file's end"
                               : "it must be at least 0");
    }
    return countsFromEnd ? 0 : static_cast<std::uint64_t>(*skip);
}

/// Samples begin after `lines` lines of the file, then `bytes` bytes of what is decoded; or, for
/// raw data, they are the last bytes of the file.
struct Skip {
    std::uint64_t lines = 0, bytes = 0;
    bool countsFromEnd = false;
};

Skip skipOf(const fs::path& file, const NrrdHeader& header, NrrdEncoding encoding) {
    Skip skip;
    skip.lines = parseSkip(file, header, "lineskip", false, skip.countsFromEnd);
    skip.bytes =
        parseSkip(file, header, "byteskip", encoding == NrrdEncoding::Raw, skip.countsFromEnd);
    return skip;
}

ByteSource openData(const fs::path& dataFile, std::uint64_t begin, NrrdEncoding encoding,
                    const Skip& skip, std::uint64_t allBytes) {
    ByteSource plain(dataFile, begin, ByteSource::Encoding::Raw);
    for (std::uint64_t line = 0; line < skip.lines; ++line) plain.skipLine();
    if (encoding == NrrdEncoding::Gzip) {
        ByteSource inflated(dataFile, plain.position(), ByteSource::Encoding::Deflate);
        inflated.requireRoomFor(skip.bytes);
        inflated.skip(skip.bytes);
        return inflated;
    }
    if (skip.countsFromEnd) {
        plain.skipToLast(allBytes);
    } else {
        plain.skip(skip.bytes);
    }
    return plain;
}

}  // namespace

bool looksLikeNrrd(std::string_view head) {
    return head.starts_with("NRRD");
}

ReadVolume readNrrd(const fs::path& file, const ReadOptions& options) {
    const NrrdHeader header = readNrrdHeader(file);
    const NrrdAxes axes = axesOf(file, header);
    SampleLayout layout{pixelTypeOf(file, header)};
    layout.volumeCount = axes.volumeCount;
    layout.volumeIndex = chooseVolume(file, axes.volumeCount, options);
    layout.isInterleaved = axes.volumeAxis == 0U;
    const std::uint64_t volumeBytes = requireImageBytes(file, axes.size, layout.stored);
    std::vector<Warning> warnings;
    const ImageGeometry geometry = geometryOf(file, header, axes, warnings);
    requireUsableGeometry(file, geometry);

    const NrrdEncoding encoding = encodingOf(file, header);
    const Skip skip = skipOf(file, header, encoding);
    const auto detached = header.find("datafile");
    const fs::path dataFile = detached ? requireDataFile(file, *detached) : file;
    const std::uint64_t begin = detached ? 0 : header.byteCount;
    const std::uint64_t byteCount =
        requireProduct(file, volumeBytes, static_cast<std::uint64_t>(axes.volumeCount));
    const ImageExtent extent = ImageExtent::of(layout, axes.size);
    ByteSource source = openData(dataFile, begin, encoding, skip, byteCount);
    if (encoding == NrrdEncoding::Text) {
        if (axes.volumeAxis) {
            refuse(file, "has 4 dimensions and its data are text",
                   "save it with encoding raw or gzip");
        }
        Volume volume = readNrrdText(dataFile, source, layout.stored, geometry, warnings);
        return {std::move(volume), "NRRD", std::move(warnings)};
    }
    if (skip.countsFromEnd) checkBytesBefore(dataFile, source.position() - begin, extent);
    layout.byteOrder = byteOrderOf(file, header, layout.stored);
    Volume volume = readSamples(file, source, layout, geometry, options);
    checkTail(dataFile, source.readTail(byteCount + 1), extent, skip.bytes >= extent.piece,
              warnings);
    return {std::move(volume), "NRRD", std::move(warnings)};
}

}  // namespace adaptiso::detail
