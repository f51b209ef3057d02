#include "DataPlace.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "adaptiso/Core/ForeignContent.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Surplus.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::detail {

namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedy =
    "correct the header's size, type or number of volumes, or cut the file to one image";

/// "2 more images of that size", "1 more slice, or row of each slice", "half as much again or more"
std::string amountOf(std::uint64_t extra, const ImageExtent& extent) {
    const std::uint64_t images = extra / extent.whole;
    if (extra % extent.whole == 0) {
        return fmt::format("{} more image{} of that size", images, images > 1 ? "s" : "");
    }
    struct Unit {
        std::uint64_t bytes;
        const char *one, *many;
    };
    std::string text;
    std::uint64_t fewest = extra;  // of a cube, slices and rows are alike
    for (const Unit& unit : {Unit{extent.piece, "slice", "slices"},
                             {extent.row, "row of each slice", "rows of each slice"},
                             {extent.column, "column of each slice", "columns of each slice"}}) {
        const std::uint64_t count = extra / unit.bytes;
        if (extra % unit.bytes != 0 || count > fewest) continue;
        const char* const name = count > 1 ? unit.many : unit.one;
        text = count < fewest || text.empty() ? fmt::format("{} more {}", count, name)
                                              : text + ", or " + name;
        fewest = count;
    }
    if (!text.empty()) return text;
    return extra >= extent.whole / 2 ? "half as much again or more"
                                     : "more than a slice, row or column too few leaves over";
}

/// Where samples are the last bytes: a header of any length may be before them in a file of their
/// own, but no part of the image.
void checkBytesBefore(const DataPlace& place, std::uint64_t byteCount, const ImageExtent& extent) {
    if (byteCount == 0) return;
    if (!place.isDetached()) {
        refuse(place.file,
               fmt::format("holds {} bytes between its header and the image, which are the file's "
                           "last bytes ({} -1)",
                           byteCount, place.skipName),
               fmt::format("leave {} out, or remove those bytes", place.skipName));
    }
    constexpr std::uint64_t kBlock = 512;  // headers are shorter, or a few of these
    const bool mayBeHeader = byteCount < kBlock || byteCount % kBlock == 0;
    const bool isRows = byteCount % extent.row == 0 || byteCount % extent.column == 0;
    const bool isMore =
        byteCount >= extent.whole || byteCount % extent.piece == 0 || (isRows && !mayBeHeader);
    if (!isMore) return;
    refuse(place.file,
           fmt::format("holds {} bytes before the image that its header describes, which is the "
                       "file's end: {}",
                       byteCount, amountOf(byteCount, extent)),
           fmt::format("{}; if they are a header before it, set {} to {}", kRemedy, place.skipName,
                       byteCount));
}

/// The kind of image file that begins so: "a NIfTI file"; empty for others.
std::string_view imageKindOf(std::string_view head) {
    if (niftiSamplesAt(head)) return "a NIfTI file";
    if (mghSamplesAt(head)) return "an MGH file";
    if (looksLikeNrrd(head)) return "a NRRD file";
    if (looksLikeMetaImage(head)) return "a MetaImage file";
    if (looksLikeDicom(head)) return "a DICOM file";
    return head.starts_with("\x1f\x8b\x08") ? "a gzip file" : "";
}

/// \param behind  what follows the samples, perhaps behind padding with zeros
void refuseJoined(const DataPlace& place, std::string_view behind) {
    constexpr std::size_t kZeros = 3;  // that a big-endian header may begin with
    const std::size_t first = std::min(behind.find_first_not_of('\0'), behind.size());
    std::string_view kind = imageKindOf(behind);
    for (std::size_t zeros = 0; kind.empty() && zeros <= std::min(first, kZeros); ++zeros) {
        kind = imageKindOf(behind.substr(first - zeros));
    }
    if (kind.empty()) return;
    refuse(
        place.file,
        fmt::format("holds {} behind the image that its header describes: two files joined?", kind),
        "split them, and give one");
}

using Reopen = std::function<ByteSource()>;

/// The first `most` bytes, or all.
std::string headOf(ByteSource source, std::size_t most) {
    std::string head(most, '\0');
    head.resize(source.readSome(head.data(), head.size()));
    return head;
}

/// An image file that another header takes for its data.
struct OtherImage {
    std::string_view format;
    std::optional<std::uint64_t> samplesAt;  ///< empty where it holds none, or not at one place
    bool isPacked = false;                   ///< they are compressed there
};

/// Content of NRRD and MetaImage. \param last  the line of the header's end begins with it; may be
/// empty
OtherImage textImage(std::string_view format, std::string_view head, std::string_view last) {
    OtherImage image{format, {}};
    TextLines lines(head, LineEnds::OfFirst);
    while (const auto whole = lines.next()) {
        const std::string line = lowerCase(trimmed(*whole));
        const bool isDetached = line.starts_with("data file:") || line.starts_with("datafile:");
        if (isDetached) return image;
        image.isPacked = image.isPacked || line.starts_with("encoding: gz") ||
                         (line.starts_with("compresseddata") && line.ends_with("true"));
        if (last.empty() ? !line.empty() : !line.starts_with(last)) continue;
        if (last.empty() || line.ends_with("local")) image.samplesAt = lines.position();
        return image;
    }
    return image;
}

/// True if the 12 bytes `before` are the header of plain DICOM pixel data of that length.
bool beginsPixelData(std::string_view before, std::uint64_t byteCount) {
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        const HeaderBytes bytes(before, order);
        const auto isTag = [&](std::size_t at) {
            return bytes.at<std::uint16_t>(at) == 0x7fe0 && bytes.at<std::uint16_t>(at + 2) == 0x10;
        };
        constexpr std::uint32_t kEncapsulated = 0xffffffff;
        const auto length = bytes.at<std::uint32_t>(8);
        const bool isExplicit = isTag(0) && before[4] == 'O';
        const bool isImplicit = isTag(4) && before[8] != 'O';  // lengths are even
        if ((isExplicit || isImplicit) && length != kEncapsulated && length >= byteCount)
            return true;
    }
    return false;
}

/// \param at  where samples are to be read: DICOM's are known by what is before them
std::optional<OtherImage> otherImage(std::string_view head, std::uint64_t at,
                                     std::uint64_t byteCount, const Reopen& reopen) {
    if (looksLikeNrrd(head)) return textImage("NRRD", head, "");
    if (looksLikeMetaImage(head)) return textImage("MetaImage", head, "elementdatafile");
    if (const auto offset = niftiSamplesAt(head)) {
        return OtherImage{"NIfTI", *offset > 0 ? offset : std::nullopt};
    }
    if (const auto offset = mghSamplesAt(head)) return OtherImage{"MGH", offset};
    constexpr std::size_t kPreamble = 128, kElementHead = 12;
    if (head.substr(std::min(head.size(), kPreamble)).starts_with("DICM")) {
        OtherImage dicom{"DICOM", {}};
        if (at < kPreamble) return dicom;
        ByteSource source = reopen();
        source.skip(at - kElementHead);
        const std::string before = headOf(std::move(source), kElementHead);
        const bool isThere = before.size() == kElementHead;
        if (isThere && beginsPixelData(before, byteCount)) dicom.samplesAt = at;
        return dicom;
    }
    return std::nullopt;
}

/// \param reopen  the data from their first byte on
/// \param at      where the samples, or the compressed data that hold them, begin among them
void requireEntrance(const DataPlace& place, const Reopen& reopen, std::uint64_t at, bool isPacked,
                     std::uint64_t byteCount, const ImageExtent& extent) {
    constexpr std::size_t kHeadBytes = std::size_t{1} << 16;
    const auto other = otherImage(headOf(reopen(), kHeadBytes), at, byteCount, reopen);
    if (!other) return;
    const bool isKnown = other->samplesAt && other->isPacked == isPacked;
    if (isKnown && at >= *other->samplesAt && (at - *other->samplesAt) % extent.piece == 0) return;
    const std::string name = displayName(place.file.filename());
    std::string fault = place.isDetached() ? fmt::format("its data file '{}' is a", name)
                                           : std::string("the data behind its header are a");
    fault += fmt::format("{} {} file", other->format == "MGH" ? "n" : "", other->format);
    std::string remedy = place.isDetached() ? fmt::format("give {} itself", name)
                                            : std::string("save that file by itself");
    if (isKnown && !isPacked) {
        fault += fmt::format(", whose voxels begin at byte {}, not {}", *other->samplesAt, at);
        remedy += fmt::format(", or set {} to {}", place.skipName, *other->samplesAt);
    } else {
        fault += ", which would be read as voxels";
    }
    refuse(place.header, fault, remedy);
}

/// Looks for what a transfer in text mode leaves in the first `byteCount` bytes.
bool looksTurned(ByteSource source, std::uint64_t byteCount, int fewestLines) {
    constexpr int kFewestSequences = 4;
    bool hasBareLf = false, isUtf8 = true;
    std::uint64_t lines = 0, sequences = 0;
    int due = 0;  // bytes of a UTF-8 sequence
    unsigned char last = 0;
    std::string piece(std::size_t{1} << 16, '\0');
    for (std::uint64_t left = byteCount; left > 0 && !(hasBareLf && !isUtf8);) {
        const std::size_t got = source.readSome(
            piece.data(), static_cast<std::size_t>(std::min<std::uint64_t>(left, piece.size())));
        if (got == 0) break;
        left -= got;
        for (std::size_t n = 0; n < got; ++n) {
            const auto byte = static_cast<unsigned char>(piece[n]);
            if (byte == '\n') {
                ++lines;
                hasBareLf = hasBareLf || last != '\r';
            }
            if (due > 0 || byte >= 0x80) {
                const bool continues = (byte & 0xc0) == 0x80;
                isUtf8 = isUtf8 && (due > 0) == continues && byte < 0xf5;
                if (due > 0) {
                    --due;
                } else {
                    due = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : 1;
                    ++sequences;
                }
            }
            last = byte;
        }
    }
    return (!hasBareLf && lines >= static_cast<std::uint64_t>(fewestLines)) ||
           (isUtf8 && sequences >= kFewestSequences);
}

std::uint64_t bytesOfAll(const DataPlace& place, const SampleLayout& layout, const Index3& size) {
    return requireProduct(place.header, requireImageBytes(place.header, size, layout.stored),
                          static_cast<std::uint64_t>(layout.volumeCount));
}

[[noreturn]] void refuseTurned(const DataPlace& place) {
    refuse(place.file,
           "its voxels are displaced: a transfer in text mode has put bytes between them",
           "transfer the file again in binary mode");
}

}  // namespace

ImageExtent ImageExtent::of(const SampleLayout& layout, const Index3& size) {
    const std::uint64_t slice =
        static_cast<std::uint64_t>(size[0] * size[1]) * bytesPerPixel(layout.stored);
    const auto slices = static_cast<std::uint64_t>(size[2] * layout.volumeCount);
    return {slice, slice * static_cast<std::uint64_t>(size[2]),
            slices * slice / static_cast<std::uint64_t>(size[1]),
            slices * slice / static_cast<std::uint64_t>(size[0])};
}

bool isMoreImage(std::uint64_t extraBytes, const ImageExtent& extent) {
    return isMoreData(extraBytes, extent.piece, extent.whole) ||
           extraBytes >= std::min({extent.piece, extent.row, extent.column});
}

bool isMoreBorder(std::uint64_t zeroBytes, std::uint64_t end, const ImageExtent& extent) {
    constexpr std::uint64_t kBlock = 512;
    if (zeroBytes == 0 || zeroBytes >= extent.whole / 2) return false;
    if (zeroBytes < kBlock && end % kBlock == 0) return false;
    return zeroBytes % extent.row == 0 || zeroBytes % extent.column == 0;
}

ByteSource openData(const DataPlace& place, std::uint64_t byteCount, const ImageExtent& extent) {
    using Encoding = ByteSource::Encoding;
    const Reopen reopenFile = [&] { return ByteSource(place.file, place.begin, Encoding::Raw); };
    ByteSource plain = reopenFile();
    for (std::uint64_t line = 0; line < place.lines; ++line) plain.skipLine();
    const std::uint64_t streamAt = plain.position();
    const bool isDeflated = place.encoding == Encoding::Deflate;
    const bool isChecked = !place.skipName.empty();
    if (isDeflated && isChecked) {
        requireEntrance(place, reopenFile, streamAt - place.begin, true, byteCount, extent);
    }
    const Reopen reopen = [&] { return ByteSource(place.file, streamAt, place.encoding); };

    ByteSource source = reopen();
    std::uint64_t at = place.bytes;
    if (place.countsFromEnd) {
        source.requireRoomFor(byteCount);
        const std::uint64_t all = reopen().readTail(byteCount + extent.whole).byteCount;
        at = all - std::min(all, byteCount);  // reading reports the missing bytes
        checkBytesBefore(place, at, extent);
    }
    const std::uint64_t before = isDeflated ? 0 : streamAt - place.begin;
    if (isChecked) {
        requireEntrance(place, isDeflated ? reopen : reopenFile, before + at, false, byteCount,
                        extent);
    }
    source.requireRoomFor(at);
    source.skip(at);
    if (place.countsFromEnd && at > 0) {
        // a header of unknown length is before them: one line may be chance
        constexpr int kFewestLines = 4;
        ByteSource again = reopen();
        again.skip(at);
        if (looksTurned(std::move(again), byteCount, kFewestLines)) refuseTurned(place);
    }
    return source;
}

PlacedVolume readPlaced(const DataPlace& place, const SampleLayout& layout,
                        const ImageGeometry& geometry) {
    const std::uint64_t byteCount = bytesOfAll(place, layout, geometry.size);
    return readingData(place, [&] {
        ByteSource source = openData(place, byteCount, ImageExtent::of(layout, geometry.size));
        Volume volume = readSamples(place.header, source, layout, geometry);
        return PlacedVolume{std::move(volume), source.readTail(byteCount + 1)};
    });
}

void requireBinaryTransfer(const DataPlace& place, const SampleLayout& layout, const Index3& size) {
    const std::uint64_t byteCount = bytesOfAll(place, layout, size);
    ByteSource source = openData(place, byteCount, ImageExtent::of(layout, size));
    if (looksTurned(std::move(source), byteCount, 1)) refuseTurned(place);
}

void refuseForeignData(const DataPlace& place) {
    if (!place.isDetached()) return;
    const std::string name = displayName(place.file.filename());
    // what these hold may lie at a place that the header knows
    const bool isEntered = place.bytes > 0 || place.lines > 0 || place.countsFromEnd;
    const auto check = [&](const std::optional<ForeignContent>& content, bool isGzip) {
        if (!content || (content->kind == ForeignKind::Other && isEntered)) return;
        const bool saysSo = isGzip && !place.gzipField.empty();
        refuse(place.header, fmt::format("its data file '{}' {}", name, content->fault),
               saysSo ? fmt::format("say so in the header: {}", place.gzipField) : content->remedy);
    };
    const auto plain = [&] { return ByteSource(place.file, 0, ByteSource::Encoding::Raw); };
    const std::string head = headOf(plain(), kForeignHeadBytes);
    const bool isGzip = head.starts_with("\x1f\x8b");
    if (!isGzip || place.encoding == ByteSource::Encoding::Raw) {
        if (looksLikeDicom(head) && !isEntered) {  // without its magic
            refuse(place.header, fmt::format("its data file '{}' is a DICOM file", name),
                   fmt::format("give {} itself", name));
        }
        check(foreignContentOf(head, place.file), isGzip);
        return;
    }
    std::string inflated;
    try {
        ByteSource source(place.file, 0, ByteSource::Encoding::Deflate);
        inflated = headOf(std::move(source), kForeignHeadBytes);
    } catch (const FileError&) {
        return;  // damaged, which reading has found too
    }
    check(foreignContentOf(inflated, place.file, true), false);
}

void checkTail(const DataPlace& place, const ByteTail& tail, const SampleLayout& layout,
               const Index3& size, std::vector<Warning>& warnings) {
    if (tail.hasSecondStream) {
        refuse(place.file, "holds more compressed data behind the image that its header describes",
               kRemedy);
    }
    const ImageExtent extent = ImageExtent::of(layout, size);
    const bool isChosenPart = !place.skipName.empty() && place.bytes >= extent.piece;
    if (!isChosenPart) {
        refuseJoined(place, tail.head);
        refuseJoined(place, tail.stray);
    }
    if (tail.hasStray) {
        warnings.push_back({"trailing-bytes",
                            "something that is no compressed data follows the compressed image; "
                            "it was left out"});
    }
    if (tail.byteCount == 0) return;
    refuseForeignData(place);
    requireBinaryTransfer(place, layout, size);
    const std::uint64_t end =
        place.begin + place.bytes + bytesOfAll(place, layout, size) + tail.byteCount;
    const bool isMore = tail.isZeros ? isMoreBorder(tail.byteCount, end, extent)
                                     : isMoreImage(tail.byteCount, extent);
    const bool mayBeHeader = place.isDetached() && place.bytes == 0 && !tail.isZeros;
    const std::string hint = mayBeHeader
                                 ? fmt::format("; if they are a header before it, set {} to {}",
                                               place.skipName, tail.byteCount)
                                 : "";
    if (isMore && !isChosenPart) {
        refuse(place.file,
               fmt::format("holds {} bytes behind the image that its header describes: {}",
                           tail.byteCount, amountOf(tail.byteCount, extent)),
               kRemedy + hint);
    }
    warnings.push_back(
        {"trailing-bytes",
         fmt::format("{} bytes{} follow the image that its header describes; they were left out{}",
                     tail.byteCount, tail.isZeros ? ", all 0," : "", hint)});
}

namespace {

/// MetaIO's and NRRD's other forms: "LIST 2", "slice%03d.raw 1 20 1".
bool isListOrPattern(std::string_view name) {
    if (name == "LIST" || name.starts_with("LIST ") || name.starts_with("LIST\t")) return true;
    for (std::size_t at = name.find('%'); at != name.npos; at = name.find('%', at + 1)) {
        const std::size_t letter = name.find_first_not_of("0123456789.+-#", at + 1);
        if (letter != name.npos && std::string_view("diuxX").find(name[letter]) != name.npos) {
            return true;
        }
    }
    return false;
}

}  // namespace

fs::path requireDataFile(const fs::path& headerFile, std::string_view name) {
    const fs::path relative(name);
    if (!name.empty() && !staysBelow(relative)) {
        refuse(headerFile,
               fmt::format("names a data file outside its own folder ('{}')", printable(name)),
               "put the data file beside the header and name it there");
    }
    if (name.empty() || name.find('\0') != std::string_view::npos) {
        refuse(headerFile, fmt::format("its data file '{}' is no plain file name", printable(name)),
               "repair the header");
    }
    fs::path data = headerFile.parent_path() / relative;
    std::error_code error;
    if (isListOrPattern(name) && !fs::exists(data, error)) {
        refuse(headerFile, "its data are a list or pattern of slice files",
               "join the slices into one data file");
    }
    requireRegularFile(data);
    if (fs::equivalent(data, headerFile, error)) {
        refuse(headerFile, "names itself as its data file", "repair the header");
    }
    requireOwnFolder(headerFile, data);
    return data;
}

void requireOwnFolder(const fs::path& headerFile, const fs::path& dataFile) {
    if (liesBeside(dataFile, headerFile)) return;
    refuse(headerFile,
           fmt::format("its data file '{}' is a link to outside the header's own folder",
                       printable(dataFile.filename().native())),
           "put the data file itself beside the header");
}

}  // namespace adaptiso::detail
