#include "DicomCodecs.h"

#include <fmt/core.h>

#include <optional>

#include "FileFault.h"
#include "GdcmDecoder.h"
#include "HeaderText.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;
using namespace std::string_view_literals;

namespace {

constexpr auto kJpegStart = "\xff\xd8\xff"sv;
constexpr auto kJpeg2000Start = "\xff\x4f\xff\x51"sv;
constexpr auto kJp2Start = "\0\0\0\x0cjP  "sv;

[[noreturn]] void refuseCompressed(const fs::path& file, std::string_view what) {
    refuse(file, fmt::format("{}: its pixel data can't be decoded", what), "get the file again");
}

enum class Segment { Whole, Damaged, TooLong };

/// Bytes that runs and copies give, as far as they go.
std::uint64_t unpackedLength(std::string_view in) {
    std::uint64_t length = 0;
    for (std::size_t at = 0; at < in.size();) {
        const auto control = static_cast<unsigned char>(in[at++]);
        if (control == 128) continue;
        length += control > 128 ? 257U - control : control + 1U;
        at += control > 128 ? 1 : control + 1U;
    }
    return length;
}

/// One segment: runs and copies (PS3.5, G.3.1) of exactly `count` bytes, put `stride` bytes apart.
/// \return Damaged when the segment ends early, TooLong when it goes on for `rowBytes` and more
Segment unpackRle(std::string_view in, std::byte* out, std::uint64_t count, std::size_t stride,
                  std::uint64_t rowBytes) {
    std::uint64_t done = 0;
    std::size_t at = 0;
    while (done < count) {
        if (at >= in.size()) return Segment::Damaged;
        const auto control = static_cast<unsigned char>(in[at++]);
        if (control == 128) continue;
        const bool isRun = control > 128;
        const std::size_t length = isRun ? 257U - control : control + 1U;
        if (length > count - done || (isRun ? 1 : length) > in.size() - at) return Segment::Damaged;
        for (std::size_t n = 0; n < length; ++n) {
            out[(done + n) * stride] = static_cast<std::byte>(in[isRun ? at : at + n]);
        }
        at += isRun ? 1 : length;
        done += length;
    }
    in.remove_prefix(at);
    const bool isPadding = in.find_first_not_of('\0') == std::string_view::npos;
    return isPadding || unpackedLength(in) < rowBytes ? Segment::Whole : Segment::TooLong;
}

/// JPEG and JPEG-LS: the frame header (ISO 10918-1, B.2.2; ISO 14495-1, C.2.2), once the scan that
/// it announces has been found to begin. GDCM writes to stderr when it does not.
std::optional<Codestream> findJpegHeader(std::string_view stream) {
    const HeaderBytes bytes(stream, std::endian::big);
    std::optional<Codestream> found;
    constexpr std::size_t kFrameHeaderBytes = 10;
    constexpr std::uint8_t kFill = 0xFF, kScan = 0xDA, kJpegLsFrame = 0xF7;
    for (std::size_t at = 2; at + kFrameHeaderBytes <= stream.size();) {
        if (bytes.at<std::uint8_t>(at) != 0xFF) return std::nullopt;
        const auto marker = bytes.at<std::uint8_t>(at + 1);
        if (marker == kScan) return found;
        if (marker == kFill) {
            ++at;
            continue;
        }
        const bool isTable = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
        if ((marker >= 0xC0 && marker <= 0xCF && !isTable) || marker == kJpegLsFrame) {
            found =
                Codestream{bytes.at<std::uint16_t>(at + 7), bytes.at<std::uint16_t>(at + 5),
                           bytes.at<std::uint8_t>(at + 9), bytes.at<std::uint8_t>(at + 4), false};
        }
        at += 2 + bytes.at<std::uint16_t>(at + 2);
    }
    return std::nullopt;
}

/// JPEG 2000: the SIZ segment (ISO 15444-1, A.5.1), which comes first.
std::optional<Codestream> findJpeg2000Header(std::string_view stream) {
    constexpr std::size_t kHeaderBytes = 43;
    if (!stream.starts_with(kJpeg2000Start) || stream.size() < kHeaderBytes) return std::nullopt;
    const HeaderBytes bytes(stream, std::endian::big);
    const auto depth = bytes.at<std::uint8_t>(42);
    return Codestream{std::int64_t{bytes.at<std::uint32_t>(8)} - bytes.at<std::uint32_t>(16),
                      std::int64_t{bytes.at<std::uint32_t>(12)} - bytes.at<std::uint32_t>(20),
                      bytes.at<std::uint16_t>(40), (depth & 0x7F) + 1, (depth & 0x80) != 0};
}

/// Widens GDCM's output from the codestream's word width to that of `format`.
void widen(const std::vector<std::byte>& decoded, bool isSigned, std::size_t wordBytes,
           std::vector<std::byte>& samples) {
    const std::size_t count = decoded.size();
    samples.assign(count * wordBytes, std::byte{0});
    for (std::size_t n = 0; n < count; ++n) {
        const bool isNegative = isSigned && (decoded[n] & std::byte{0x80}) != std::byte{0};
        samples[n * wordBytes] = decoded[n];
        for (std::size_t b = 1; isNegative && b < wordBytes; ++b) {
            samples[n * wordBytes + b] = std::byte{0xFF};
        }
    }
}

}  // namespace

bool beginsDicomCodestream(std::string_view head, DicomCodec codec) {
    if (codec == DicomCodec::Jpeg) return head.starts_with(kJpegStart);
    return codec == DicomCodec::Jpeg2000 &&
           (head.starts_with(kJpeg2000Start) || head.starts_with(kJp2Start.substr(0, 4)));
}

void decodeDicomRle(const fs::path& file, std::string_view stream, const DicomPixelFormat& format,
                    std::vector<std::byte>& samples) {
    constexpr std::size_t kHeaderBytes = 64;
    constexpr const char* kDamaged = "its RLE segments are damaged";
    if (stream.size() < kHeaderBytes) refuseCompressed(file, kDamaged);
    const HeaderBytes header(stream, std::endian::little);
    const std::size_t segments = bytesPerPixel(format.stored);
    if (header.at<std::uint32_t>(0) != segments) refuseCompressed(file, kDamaged);
    const std::uint64_t count = format.frameBytes() / segments;
    samples.resize(format.frameBytes());
    for (std::size_t s = 0; s < segments; ++s) {
        const std::uint64_t begin = header.at<std::uint32_t>(4 + 4 * s);
        const std::uint64_t end =
            s + 1 < segments ? header.at<std::uint32_t>(8 + 4 * s) : stream.size();
        const bool isInside = begin >= kHeaderBytes && begin < end && end <= stream.size();
        if (!isInside) refuseCompressed(file, kDamaged);
        // the most significant bytes come first; samples are little endian here
        const Segment segment =
            unpackRle(stream.substr(begin, end - begin), samples.data() + (segments - 1 - s), count,
                      segments, static_cast<std::uint64_t>(format.columns));
        if (segment == Segment::Damaged) refuseCompressed(file, kDamaged);
        if (segment == Segment::TooLong) {
            refuse(file,
                   fmt::format("its RLE data hold more pixels than its header describes ({} x {})",
                               format.columns, format.rows),
                   "correct Rows, Columns or NumberOfFrames, or get the file again");
        }
    }
}

void decodeDicomJpeg(const fs::path& file, std::string stream, DicomCodec codec,
                     const std::string& transferSyntax, const DicomPixelFormat& format,
                     std::vector<std::byte>& samples) {
    if (codec == DicomCodec::Jpeg2000 && stream.starts_with(kJp2Start)) {
        stream.erase(0, std::min(stream.find(kJpeg2000Start), stream.size()));
    }
    const bool isJpeg = codec == DicomCodec::Jpeg && stream.starts_with(kJpegStart);
    const auto found = isJpeg ? findJpegHeader(stream) : findJpeg2000Header(stream);
    if (!found) refuseCompressed(file, "its compressed pixel data are damaged");
    const std::size_t wordBytes = bytesPerPixel(format.stored);
    const bool agrees = found->columns == format.columns && found->rows == format.rows &&
                        found->components == 1 && found->precision >= 1 && found->precision <= 16 &&
                        found->wordBytes() <= wordBytes;
    if (!agrees) {
        refuse(file,
               fmt::format("its compressed pixel data are of another size than its header says "
                           "({} x {} pixels of {} components and {} bits, header: {} x {} of 1 and "
                           "{})",
                           found->columns, found->rows, found->components, found->precision,
                           format.columns, format.rows, format.bitsStored),
               "get the file again");
    }
    if (found->wordBytes() == wordBytes) {
        samples.resize(format.frameBytes());
        decodeWithGdcm(file, stream, transferSyntax, *found, samples);
        return;
    }
    std::vector<std::byte> narrow(format.frameBytes() / wordBytes * found->wordBytes());
    decodeWithGdcm(file, stream, transferSyntax, *found, narrow);
    if (found->wordBytes() == 1) {
        widen(narrow, found->isSigned, wordBytes, samples);
        return;
    }
    refuse(file, "unsupported pixel bits: 16-bit codestream of 32-bit samples",
           "save it uncompressed, e.g. with gdcmconv --raw");
}

}  // namespace adaptiso::detail
