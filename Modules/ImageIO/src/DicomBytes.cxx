#include "DicomBytes.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <utility>

#include "FileFault.h"
#include "HeaderText.h"

namespace adaptiso::detail {

namespace {

constexpr std::size_t kWindowBytes = std::size_t{1} << 16;

}  // namespace

DicomBytes::DicomBytes(std::filesystem::path file)
    : file_(std::move(file)), size_(requireRegularFile(file_)) {
    stream_.rdbuf()->pubsetbuf(nullptr, 0);  // the window is the buffer
    stream_.open(file_, std::ios::binary);
    if (!stream_) refuse(file_, "can't be opened for reading", "check its permissions");
}

void DicomBytes::read(std::uint64_t position, void* out, std::size_t byteCount) {
    if (position > size_ || byteCount > size_ - position) {
        refuse(file_, "truncated: it ends before its data do", "get the whole file again");
    }
    if (byteCount == 0) return;
    const bool isWithin =
        position >= windowStart_ && position + byteCount <= windowStart_ + window_.size();
    if (!isWithin && byteCount > kWindowBytes) {
        stream_.clear();
        stream_.seekg(static_cast<std::streamoff>(position));
        stream_.read(static_cast<char*>(out), static_cast<std::streamsize>(byteCount));
        if (stream_.gcount() != static_cast<std::streamsize>(byteCount)) {
            refuse(file_, "can't be read", "check the disk");
        }
        return;
    }
    if (!isWithin) moveWindow(position);
    if (windowStart_ + window_.size() < position + byteCount) {
        refuse(file_, "can't be read", "check the disk");
    }
    std::copy_n(window_.data() + (position - windowStart_), byteCount, static_cast<char*>(out));
}

void DicomBytes::moveWindow(std::uint64_t position) {
    window_.resize(std::min<std::uint64_t>(kWindowBytes, size_ - position));
    windowStart_ = position;
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(position));
    stream_.read(window_.data(), static_cast<std::streamsize>(window_.size()));
    window_.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream_.gcount())));
}

void DicomBytes::inflateFrom(std::uint64_t from) {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 29;  // 1 s to inflate
    struct End {
        void operator()(z_stream* stream) const {
            inflateEnd(stream);
            delete stream;
        }
    };
    std::unique_ptr<z_stream, End> zlib(new z_stream{});
    if (inflateInit2(zlib.get(), -MAX_WBITS) != Z_OK) throw std::bad_alloc();

    std::string inflated, in(kWindowBytes, '\0'), out(kWindowBytes * 4, '\0');
    int state = Z_OK;
    while (state == Z_OK) {
        if (zlib->avail_in == 0) {
            const std::uint64_t count = std::min<std::uint64_t>(in.size(), size_ - from);
            if (count == 0) break;
            read(from, in.data(), count);
            from += count;
            zlib->next_in = reinterpret_cast<Bytef*>(in.data());
            zlib->avail_in = static_cast<uInt>(count);
        }
        zlib->next_out = reinterpret_cast<Bytef*>(out.data());
        zlib->avail_out = static_cast<uInt>(out.size());
        state = inflate(zlib.get(), Z_NO_FLUSH);
        const std::size_t made = out.size() - zlib->avail_out;
        if (made > kMostBytes - inflated.size()) {
            refuse(file_, "its deflated data set inflates to more than 512 MiB",
                   "save it uncompressed, e.g. with gdcmconv --raw");
        }
        inflated.append(out, 0, made);
    }
    if (state != Z_STREAM_END) {
        refuse(file_, "truncated or damaged DICOM file: its deflated data set can't be inflated",
               "get the whole file again");
    }
    size_ = inflated.size();
    window_ = std::move(inflated);
    windowStart_ = 0;
}

namespace {

struct WantedValue {
    DicomTag tag;
    DicomValueKind kind = DicomValueKind::Text;
};

constexpr std::array kWantedValues = {
    WantedValue{tag::kMediaStorageSopClass},
    WantedValue{tag::kTransferSyntax},
    WantedValue{tag::kReferencedFileId},
    WantedValue{tag::kImageType},
    WantedValue{tag::kSopClass},
    WantedValue{tag::kSopInstance, DicomValueKind::Digest},
    WantedValue{tag::kAcquisitionTime},
    WantedValue{tag::kContentTime},
    WantedValue{tag::kModality},
    WantedValue{tag::kFrameType},
    WantedValue{tag::kComplexImageComponent},
    WantedValue{tag::kPatientName, DicomValueKind::Digest},
    WantedValue{tag::kPatientId, DicomValueKind::Digest},
    WantedValue{tag::kPatientBirthDate, DicomValueKind::Digest},
    WantedValue{tag::kEchoTime},
    WantedValue{tag::kEchoNumbers},
    WantedValue{tag::kSpacingBetweenSlices},
    WantedValue{tag::kTriggerTime},
    WantedValue{tag::kConvolutionKernel},
    WantedValue{tag::kEffectiveEchoTime, DicomValueKind::Float64},
    WantedValue{tag::kDiffusionBValue, DicomValueKind::Float64},
    WantedValue{tag::kGradientOrientation, DicomValueKind::Float64},
    WantedValue{tag::kStudyInstanceUid, DicomValueKind::Digest},
    WantedValue{tag::kSeriesInstanceUid},
    WantedValue{tag::kSeriesNumber},
    WantedValue{tag::kAcquisitionNumber},
    WantedValue{tag::kInstanceNumber},
    WantedValue{tag::kImagePosition},
    WantedValue{tag::kImageOrientation},
    WantedValue{tag::kFrameOfReferenceUid, DicomValueKind::Digest},
    WantedValue{tag::kTemporalPosition},
    WantedValue{tag::kNumberOfTemporalPositions},
    WantedValue{tag::kImagesInAcquisition},
    WantedValue{tag::kTemporalPositionIndex, DicomValueKind::UInt32},
    WantedValue{tag::kTriggerDelay, DicomValueKind::Float64},
    WantedValue{tag::kDimensionIndexValues, DicomValueKind::UInt32},
    WantedValue{tag::kConcatenationUid, DicomValueKind::Digest},
    WantedValue{tag::kInConcatenationNumber, DicomValueKind::UInt16},
    WantedValue{tag::kInConcatenationTotal, DicomValueKind::UInt16},
    WantedValue{tag::kSamplesPerPixel, DicomValueKind::UInt16},
    WantedValue{tag::kPhotometric},
    WantedValue{tag::kNumberOfFrames},
    WantedValue{tag::kRows, DicomValueKind::UInt16},
    WantedValue{tag::kColumns, DicomValueKind::UInt16},
    WantedValue{tag::kPixelSpacing},
    WantedValue{tag::kBitsAllocated, DicomValueKind::UInt16},
    WantedValue{tag::kBitsStored, DicomValueKind::UInt16},
    WantedValue{tag::kHighBit, DicomValueKind::UInt16},
    WantedValue{tag::kPixelRepresentation, DicomValueKind::UInt16},
    WantedValue{tag::kRescaleIntercept},
    WantedValue{tag::kRescaleSlope},
    WantedValue{tag::kRescaleType},
    WantedValue{tag::kNumberOfSlices, DicomValueKind::UInt16},
    WantedValue{tag::kUnits},
    WantedValue{tag::kSegmentNumber, DicomValueKind::UInt16},
    WantedValue{tag::kSegmentLabel},
    WantedValue{tag::kReferencedSegmentNumber, DicomValueKind::UInt16}};

constexpr std::array kWantedSequences = {tag::kDirectoryRecordSequence,
                                         tag::kModalityLutSequence,
                                         tag::kPlanePositionSequence,
                                         tag::kPlaneOrientationSequence,
                                         tag::kPixelMeasuresSequence,
                                         tag::kPixelValueTransformationSequence,
                                         tag::kFrameContentSequence,
                                         tag::kMrEchoSequence,
                                         tag::kMrDiffusionSequence,
                                         tag::kGradientDirectionSequence,
                                         tag::kCardiacSequence,
                                         tag::kMrFrameTypeSequence,
                                         tag::kCtFrameTypeSequence,
                                         tag::kSegmentSequence,
                                         tag::kSegmentIdentificationSequence,
                                         tag::kSharedFunctionalGroups,
                                         tag::kPerFrameFunctionalGroups};

template <class T>
std::string decimalText(std::string_view bytes, std::endian order) {
    std::string text;
    for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
        text += fmt::format("{}{}", at ? "\\" : "", HeaderBytes(bytes, order).at<T>(at));
    }
    return text;
}

/// Empty of an empty value; padding does not count.
std::string digestOf(std::string_view value) {
    value = trimmed(value.substr(0, value.find('\0')));
    return value.empty() ? "" : fmt::format("{:x}", std::hash<std::string_view>()(value));
}

}  // namespace

std::optional<DicomValueKind> wantedDicomValue(DicomTag tag) {
    const auto it = std::ranges::find(kWantedValues, tag, &WantedValue::tag);
    return it == kWantedValues.end() ? std::nullopt : std::optional(it->kind);
}

bool isWantedDicomSequence(DicomTag tag) {
    return std::ranges::find(kWantedSequences, tag) != kWantedSequences.end();
}

std::string dicomText(std::string value, DicomValueKind kind, std::endian order) {
    switch (kind) {
        case DicomValueKind::Text:
            return value;
        case DicomValueKind::UInt16:
            return decimalText<std::uint16_t>(value, order);
        case DicomValueKind::UInt32:
            return decimalText<std::uint32_t>(value, order);
        case DicomValueKind::Float64:
            return decimalText<double>(value, order);
        case DicomValueKind::Digest:
            return digestOf(value);
    }
    return {};
}

}  // namespace adaptiso::detail
