#include <fmt/core.h>

#include <bit>
#include <optional>
#include <string>

#include "DataFile.h"
#include "Fence.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "ItkDecoder.h"
#include "NrrdHeader.h"
#include "Readers.h"
#include "Samples.h"

// The header is read here: ITK 5.2.1 flips the wrong axis for left-anterior-superior, takes unknown
// spaces as LPS and opens any file a header names. So are raw and gzip samples, once and in place:
// ITK copies them, and leaves memory uninitialised where they are short. Text goes to ITK, behind
// the fence, once all of its numbers are known to be there.
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

void requireAsciiNumbers(const fs::path& file, ByteSource& source, std::int64_t count) {
    std::vector<char> piece(std::size_t{1} << 16);
    std::int64_t found = 0;
    bool inNumber = false;
    while (const std::size_t got = source.readSome(piece.data(), piece.size())) {
        for (std::size_t i = 0; i < got; ++i) {
            const bool isBlank =
                piece[i] == ' ' || piece[i] == ',' || (piece[i] >= '\t' && piece[i] <= '\r');
            found += !isBlank && !inNumber;
            inNumber = !isBlank;
        }
    }
    if (found < count) {
        refuse(file, fmt::format("truncated: its data hold {} of {} numbers", found, count),
               "get the whole file");
    }
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

ReadVolume readText(const fs::path& file, ByteSource& source, PixelType type, const NrrdAxes& axes,
                    const ImageGeometry& geometry, const ReadOptions& options,
                    std::vector<std::string> warnings) {
    if (axes.volumeAxis) {
        refuse(file, "has 4 dimensions and its data are text", "save it with encoding raw or gzip");
    }
    requireAsciiNumbers(file, source, geometry.voxelCount());
    const auto decode = [&] {
        return ReadVolume{decodeNrrdWithItk(file, type, geometry), "NRRD", warnings};
    };
    return options.fence ? readBehindFence(file, fenceLimitsFor(file), decode) : decode();
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
    std::vector<std::string> warnings;
    const ImageGeometry geometry = geometryOf(file, header, axes, warnings);
    requireUsableGeometry(file, geometry);

    const NrrdEncoding encoding = encodingOf(file, header);
    const Skip skip = skipOf(file, header, encoding);
    const auto detached = header.find("datafile");
    const fs::path dataFile = detached ? requireDataFile(file, *detached) : file;
    ByteSource source =
        openData(dataFile, detached ? 0 : header.byteCount, encoding, skip,
                 requireProduct(file, volumeBytes, static_cast<std::uint64_t>(axes.volumeCount)));
    if (encoding == NrrdEncoding::Text) {
        return readText(file, source, layout.stored, axes, geometry, options, std::move(warnings));
    }
    layout.byteOrder = byteOrderOf(file, header, layout.stored);
    return {readSamples(file, source, layout, geometry, options), "NRRD", std::move(warnings)};
}

}  // namespace adaptiso::detail
