#include "DicomElements.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>

#include "HeaderBytes.h"
#include "HeaderText.h"

namespace adaptiso::detail {
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
