#include "DicomPixels.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <string_view>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Samples.h"
#include "adaptiso/Core/Surplus.h"

// DICOM PS3.5, chapter 8 and annex A.4: how pixels are stored, and how compressed ones are cut.
namespace adaptiso::detail {
namespace {

constexpr const char* kSaveUncompressed = "save it uncompressed, e.g. with gdcmconv --raw";
constexpr const char* kGetAgain = "get the file again";

struct TransferSyntax {
    std::string_view uid;
    DicomCodec codec;
};
constexpr std::array kTransferSyntaxes = {
    TransferSyntax{"1.2.840.10008.1.2", DicomCodec::None},       // implicit little endian
    TransferSyntax{"1.2.840.10008.1.2.1", DicomCodec::None},     // explicit little endian
    TransferSyntax{"1.2.840.10008.1.2.1.99", DicomCodec::None},  // deflated
    TransferSyntax{"1.2.840.10008.1.2.2", DicomCodec::None},     // explicit big endian
    TransferSyntax{"1.2.840.10008.1.2.5", DicomCodec::Rle},
    TransferSyntax{"1.2.840.10008.1.2.4.50", DicomCodec::Jpeg},      // baseline
    TransferSyntax{"1.2.840.10008.1.2.4.51", DicomCodec::Jpeg},      // extended
    TransferSyntax{"1.2.840.10008.1.2.4.57", DicomCodec::Jpeg},      // lossless
    TransferSyntax{"1.2.840.10008.1.2.4.70", DicomCodec::Jpeg},      // lossless, first order
    TransferSyntax{"1.2.840.10008.1.2.4.80", DicomCodec::Jpeg},      // JPEG-LS lossless
    TransferSyntax{"1.2.840.10008.1.2.4.81", DicomCodec::Jpeg},      // JPEG-LS near lossless
    TransferSyntax{"1.2.840.10008.1.2.4.90", DicomCodec::Jpeg2000},  // lossless
    TransferSyntax{"1.2.840.10008.1.2.4.91", DicomCodec::Jpeg2000}};

DicomCodec codecOf(const DicomFile& dicom) {
    const std::string_view uid = dicom.header.transferSyntax;
    for (const TransferSyntax& known : kTransferSyntaxes) {
        if (known.uid == uid) return known.codec;
    }
    constexpr std::string_view kJpegFamily = "1.2.840.10008.1.2.4.";
    const std::string_view member =
        uid.starts_with(kJpegFamily) ? uid.substr(kJpegFamily.size()) : "";
    const std::string_view name = member.starts_with("10")   ? "MPEG or HEVC video"
                                  : member.starts_with("11") ? "JPEG XL"
                                  : member.starts_with("20") ? "HTJ2K"
                                  : member.starts_with("9")  ? "JPEG 2000, part 2, or JPIP"
                                  : uid.starts_with("1.2.840.10008.1.2.8") ? "deflated frames"
                                                                           : "not known here";
    refuse(dicom.path, fmt::format("unsupported transfer syntax of its pixel data ({})", name),
           "export it uncompressed (Explicit VR Little Endian) from where it comes");
}

void requireGrey(const DicomFile& dicom) {
    const DicomDataset& set = dicom.header.dataset;
    const auto photometric = set.text(tag::kPhotometric).value_or("");
    const auto components = set.integer(tag::kSamplesPerPixel);
    if (!components) {
        refuse(dicom.path, "damaged DICOM header: SamplesPerPixel is missing", kGetAgain);
    }
    if (*components != 1 || (photometric != "MONOCHROME1" && photometric != "MONOCHROME2")) {
        refuse(dicom.path,
               fmt::format("its pixels are colour or of an unknown kind ({} samples per "
                           "pixel, photometric interpretation '{}')",
                           *components, printable(photometric)),
               "give a scalar grey image");
    }
}

PixelType storedType(int bits, bool isSigned) {
    return bits == 8    ? (isSigned ? PixelType::Int8 : PixelType::UInt8)
           : bits == 16 ? (isSigned ? PixelType::Int16 : PixelType::UInt16)
                        : (isSigned ? PixelType::Int32 : PixelType::UInt32);
}

/// Takes off what is no part of the samples (PS3.5, 8.1.1): moves the high bit to its place, clears
/// what is above, or extends the sign there.
/// \return whether there was something else above than zeros or the sign
template <class Word>
bool normalizeWords(std::byte* bytes, std::uint64_t count, const DicomPixelFormat& format) {
    constexpr int kBits = 8 * sizeof(Word);
    if (format.bitsStored == kBits) return false;
    const int shift = format.highBit + 1 - format.bitsStored;
    const auto mask = static_cast<Word>((Word{1} << format.bitsStored) - 1);
    const auto unused = static_cast<Word>(~mask);
    const auto signBit = static_cast<Word>(Word{1} << (format.bitsStored - 1));
    bool hasStrayBits = false;
    for (std::uint64_t n = 0; n < count; ++n) {
        Word word;
        std::memcpy(&word, bytes + n * sizeof(Word), sizeof(Word));
        word = static_cast<Word>(word >> shift);
        const auto above = static_cast<Word>(word & unused);
        const bool isNegative = format.isSigned() && (word & signBit) != 0;
        const auto extended = static_cast<Word>(isNegative ? word | unused : word & mask);
        if (shift == 0 && above != 0 && word != extended) hasStrayBits = true;
        std::memcpy(bytes + n * sizeof(Word), &extended, sizeof(Word));
    }
    return hasStrayBits;
}

bool normalize(std::vector<std::byte>& samples, const DicomPixelFormat& format) {
    const std::uint64_t count = samples.size() / bytesPerPixel(format.stored);
    switch (bytesPerPixel(format.stored)) {
        case 1:
            return normalizeWords<std::uint8_t>(samples.data(), count, format);
        case 2:
            return normalizeWords<std::uint16_t>(samples.data(), count, format);
        default:
            return normalizeWords<std::uint32_t>(samples.data(), count, format);
    }
}

}  // namespace

DicomPixelFormat dicomPixelFormat(const DicomFile& dicom) {
    const std::filesystem::path& path = dicom.path;
    const DicomHeader& header = dicom.header;
    const DicomDataset& set = header.dataset;
    const auto need = [&](DicomTag tag, std::string_view name) {
        const auto value = set.integer(tag);
        if (!value) {
            refuse(path, fmt::format("damaged DICOM header: {} is missing", name), kGetAgain);
        }
        return static_cast<int>(*value);
    };
    if (!header.pixelData && header.hasFloatPixelData) {
        refuse(path, "its pixels are floating-point numbers (Float Pixel Data)",
               "convert it to integers with a rescale slope");
    }
    if (!header.pixelData) {
        refuse(path, "holds no image (no pixel data)", "give an image file or a DICOM folder");
    }
    requireGrey(dicom);
    DicomPixelFormat format;
    format.rows = need(tag::kRows, "Rows");
    format.columns = need(tag::kColumns, "Columns");
    if (format.rows < 1 || format.columns < 1) {
        refuse(path,
               fmt::format("damaged DICOM header: image size {} x {} (Rows, Columns)", format.rows,
                           format.columns),
               kGetAgain);
    }
    const int bits = need(tag::kBitsAllocated, "BitsAllocated");
    format.bitsStored = need(tag::kBitsStored, "BitsStored");
    format.highBit = static_cast<int>(set.integer(tag::kHighBit).value_or(format.bitsStored - 1));
    format.isPacked = bits == 1;
    if ((bits != 1 && bits != 8 && bits != 16 && bits != 32) || format.bitsStored < 1 ||
        format.bitsStored > bits || format.highBit >= bits ||
        format.highBit < format.bitsStored - 1) {
        refuse(path,
               fmt::format("unsupported pixel bits: {} allocated, {} stored, high bit {}", bits,
                           format.bitsStored, format.highBit),
               "convert it to 8 or 16 bits");
    }
    const bool isSigned = need(tag::kPixelRepresentation, "PixelRepresentation") == 1;
    format.stored = storedType(bits == 1 ? 8 : bits, isSigned && bits > 1);
    if (set.text(tag::kNumberOfFrames)) {
        const auto frames = set.integer(tag::kNumberOfFrames);
        if (!frames || *frames < 1 || *frames > 1'000'000) {
            refuse(path, "damaged DICOM header: NumberOfFrames is not a positive number",
                   kGetAgain);
        }
        format.frames = *frames;
    }
    return format;
}

DicomFrames::DicomFrames(const DicomFile& dicom, const DicomPixelFormat& format)
    : dicom_(dicom), format_(format), codec_(codecOf(dicom)), bytes_(dicom.path) {
    if ((codec_ != DicomCodec::None) != dicom.header.pixelData->isEncapsulated) {
        refuse(dicom.path, "damaged: its pixel data are not as its transfer syntax says",
               kGetAgain);
    }
    if (format.isPacked && dicom.header.isBigEndian) {
        refuse(dicom.path, "unsupported pixel bits: 1 a pixel, big endian",
               "save it as little endian, e.g. with gdcmconv --explicit");
    }
    if (codec_ == DicomCodec::None) {
        openNative();
    } else {
        openEncapsulated();
    }
}

void DicomFrames::openNative() {
    const std::uint64_t needed =
        format_.nativeBytes(format_.framePixels() * static_cast<std::uint64_t>(format_.frames));
    const std::uint64_t there = dicom_.header.pixelData->byteCount;
    if (there < needed) {
        refuse(dicom_.path,
               fmt::format("truncated: its pixel data hold {} of {} bytes", there, needed),
               "get the whole file");
    }
    const std::uint64_t extra = there - needed;
    if (extra <= needed % 2) return;  // lengths are even (PS3.5, 8.1.1)
    hasPadding_ = true;
    if (format_.isPacked && format_.framePixels() % 8 != 0) {
        refuse(
            dicom_.path,
            fmt::format("its 1-bit pixel data hold {} bytes, {} frames take {}: each may be padded",
                        there, format_.frames, needed),
            "convert it with segimage2itkimage (dcmqi)");
    }
    const auto columns = static_cast<std::uint64_t>(format_.columns);
    const auto rows = static_cast<std::uint64_t>(format_.rows);
    const auto frames = static_cast<std::uint64_t>(format_.frames);
    const std::uint64_t frame = format_.nativeBytes(format_.framePixels());
    const ImageExtent extent{frame, frame, format_.nativeBytes(columns * frames),
                             format_.nativeBytes(rows * frames)};
    constexpr std::uint64_t kUnaligned = 1;  // a data element ends at no block's end
    const bool isMore =
        isZeros(dicom_.header.pixelData->offset + needed, extra)
            ? isMoreBorder(extra, kUnaligned, extent)
            : isMoreData(extra, format_.nativeBytes(columns), frame) || isMoreImage(extra, extent);
    if (!isMore) return;
    refuse(
        dicom_.path,
        fmt::format("its pixel data hold {} bytes, its header describes {} ({} x {} pixels of {} "
                    "bits, {} frame{})",
                    there, needed, format_.columns, format_.rows,
                    format_.isPacked ? 1 : 8 * bytesPerPixel(format_.stored), format_.frames,
                    format_.frames > 1 ? "s" : ""),
        "correct Rows, Columns, BitsAllocated or NumberOfFrames, or get the file again");
}

/// Padding: no more than kMostPadding zeros.
bool DicomFrames::isZeros(std::uint64_t position, std::uint64_t byteCount) {
    if (byteCount > kMostPadding) return false;
    inflateOnce();
    std::string bytes(byteCount, '\0');
    bytes_.read(position, bytes.data(), bytes.size());
    return areZeros(bytes);
}

/// Positions are those of the inflated data set where it is deflated.
void DicomFrames::inflateOnce() {
    if (!dicom_.header.deflatedFrom || isInflated_) return;
    bytes_.inflateFrom(*dicom_.header.deflatedFrom);
    isInflated_ = true;
}

void DicomFrames::openEncapsulated() {
    if (format_.isPacked) {
        refuse(dicom_.path, "unsupported pixel bits: 1 a pixel, compressed",
               "export it uncompressed (Explicit VR Little Endian) from where it comes");
    }
    if (format_.highBit != format_.bitsStored - 1) {
        refuse(dicom_.path,
               fmt::format("unsupported pixel bits: compressed with high bit {} for {} bits stored",
                           format_.highBit, format_.bitsStored),
               kSaveUncompressed);
    }
    if (codec_ == DicomCodec::Rle) requireRoomInRuns();
    if (format_.frames == 1) requireOneFrame();
    frameBegins_ = firstFragments();
    if (std::ssize(frameBegins_) != format_.frames) {
        refuse(dicom_.path,
               fmt::format(
                   "its compressed pixel data are damaged: {} frames, of which {} are found "
                   "among {} fragments",
                   format_.frames, frameBegins_.size(), dicom_.header.pixelData->fragments.size()),
               kGetAgain);
    }
    frameBegins_.push_back(dicom_.header.pixelData->fragments.size());
}

/// An image is refused here, before there is memory for it, that its data can't possibly give.
void DicomFrames::requireRoomInRuns() const {
    constexpr std::uint64_t kMostOfAByte = 64;  // a run of 128 takes two bytes (PS3.5, G.3.1)
    const std::uint64_t needed = format_.frameBytes() * static_cast<std::uint64_t>(format_.frames);
    const std::uint64_t there = dicom_.header.pixelData->byteCount;
    if (needed / kMostOfAByte > there) {
        refuse(dicom_.path,
               fmt::format("truncated: {} bytes of RLE data can't hold {} bytes of pixels", there,
                           needed),
               "get the whole file");
    }
}

/// One fragment a frame, or all fragments for one frame; else as the offset table says (PS3.5,
/// A.4); without a table, where a fragment begins a codestream.
std::vector<std::size_t> DicomFrames::firstFragments() {
    const DicomPixelData& pixels = *dicom_.header.pixelData;
    const auto& fragments = pixels.fragments;
    std::vector<std::size_t> begins;
    if (fragments.empty()) return begins;
    if (format_.frames == 1) return {0};
    const bool isOneEach = std::ssize(fragments) == format_.frames;
    const std::set<std::uint64_t> table(pixels.frameOffsets.begin(), pixels.frameOffsets.end());
    for (std::size_t n = 0; n < fragments.size(); ++n) {
        const bool isFirst = isOneEach ? true
                             : !table.empty()
                                 ? table.contains(fragments[n].offset - fragments.front().offset)
                                 : beginsCodestream(fragments[n]);
        if (isFirst) begins.push_back(n);
    }
    if (!begins.empty() && begins.front() != 0) begins.clear();
    return begins;
}

/// The fragments of one frame are one codestream: where another begins, the header has too few.
void DicomFrames::requireOneFrame() {
    const auto& fragments = dicom_.header.pixelData->fragments;
    if (fragments.size() < 2) return;
    const auto begins = [&](const DicomPixelData::Fragment& fragment) {
        return codec_ == DicomCodec::Rle ? beginsRle(fragment) : beginsCodestream(fragment);
    };
    const auto frames = std::ranges::count_if(fragments, begins);
    if (frames <= 1) return;
    refuse(dicom_.path,
           fmt::format("its pixel data hold {} compressed frames, its header describes 1", frames),
           "correct NumberOfFrames, or get the file again");
}

/// An RLE header (PS3.5, G.5): as many segments as a pixel has bytes, the first behind the header.
bool DicomFrames::beginsRle(const DicomPixelData::Fragment& fragment) {
    constexpr std::uint64_t kHeaderBytes = 64;
    if (fragment.byteCount < kHeaderBytes) return false;
    std::string head(8, '\0');
    bytes_.read(fragment.offset, head.data(), head.size());
    const HeaderBytes bytes(head, std::endian::little);
    return bytes.at<std::uint32_t>(0) == bytesPerPixel(format_.stored) &&
           bytes.at<std::uint32_t>(4) == kHeaderBytes;
}

bool DicomFrames::beginsCodestream(const DicomPixelData::Fragment& fragment) {
    std::string head(std::min<std::uint64_t>(fragment.byteCount, 4), '\0');
    bytes_.read(fragment.offset, head.data(), head.size());
    return beginsDicomCodestream(head, codec_);
}

std::string DicomFrames::codestreamOf(std::int64_t frame) {
    const auto& fragments = dicom_.header.pixelData->fragments;
    const auto at = static_cast<std::size_t>(frame);
    std::string stream;
    for (std::size_t n = frameBegins_[at]; n < frameBegins_[at + 1]; ++n) {
        const std::size_t used = stream.size();
        stream.resize(used + fragments[n].byteCount);
        bytes_.read(fragments[n].offset, stream.data() + used, fragments[n].byteCount);
    }
    return stream;
}

void DicomFrames::readPacked(std::int64_t frame, std::vector<std::byte>& samples) {
    inflateOnce();
    samples.resize(format_.frameBytes());
    const std::uint64_t first = static_cast<std::uint64_t>(frame) * samples.size();
    std::vector<std::byte> packed((first + samples.size() + 7) / 8 - first / 8);
    bytes_.read(dicom_.header.pixelData->offset + first / 8, packed.data(), packed.size());
    for (std::uint64_t n = 0; n < samples.size(); ++n) {
        const std::uint64_t bit = first % 8 + n;
        samples[n] = packed[bit / 8] >> (bit % 8) & std::byte{1};
    }
}

void DicomFrames::read(std::int64_t frame, std::vector<std::byte>& samples) {
    if (format_.isPacked) {
        readPacked(frame, samples);
    } else if (codec_ == DicomCodec::None) {
        const DicomHeader& header = dicom_.header;
        inflateOnce();
        samples.resize(format_.frameBytes());
        bytes_.read(header.pixelData->offset + static_cast<std::uint64_t>(frame) * samples.size(),
                    samples.data(), samples.size());
        if (header.isBigEndian) {
            const std::size_t wordBytes = header.pixelData->isWords ? 2 : 1;
            swapBytes(samples.data(), samples.size(),
                      std::max(wordBytes, bytesPerPixel(format_.stored)));
        }
    } else if (codec_ == DicomCodec::Rle) {
        decodeDicomRle(dicom_.path, codestreamOf(frame), format_, samples);
    } else {
        decodeDicomJpeg(dicom_.path, codestreamOf(frame), codec_, dicom_.header.transferSyntax,
                        format_, samples);
    }
    hasStrayBits_ |= normalize(samples, format_) && !dicom_.header.hasOverlayInPixels;
}

}  // namespace adaptiso::detail
