#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace adaptiso::detail {

/// (group << 16) | element
using DicomTag = std::uint32_t;

namespace tag {
inline constexpr DicomTag kMediaStorageSopClass = 0x00020002;
inline constexpr DicomTag kTransferSyntax = 0x00020010;
inline constexpr DicomTag kDirectoryRecordSequence = 0x00041220;
inline constexpr DicomTag kReferencedFileId = 0x00041500;
inline constexpr DicomTag kImageType = 0x00080008;
inline constexpr DicomTag kSopClass = 0x00080016;
inline constexpr DicomTag kSopInstance = 0x00080018;
inline constexpr DicomTag kAcquisitionTime = 0x00080032;
inline constexpr DicomTag kContentTime = 0x00080033;
inline constexpr DicomTag kModality = 0x00080060;
inline constexpr DicomTag kSeriesDescription = 0x0008103E;
inline constexpr DicomTag kFrameType = 0x00089007;
inline constexpr DicomTag kComplexImageComponent = 0x00089208;
inline constexpr DicomTag kPatientName = 0x00100010;
inline constexpr DicomTag kPatientId = 0x00100020;
inline constexpr DicomTag kPatientBirthDate = 0x00100030;
inline constexpr DicomTag kEchoTime = 0x00180081;
inline constexpr DicomTag kEchoNumbers = 0x00180086;
inline constexpr DicomTag kSpacingBetweenSlices = 0x00180088;
inline constexpr DicomTag kTriggerTime = 0x00181060;
inline constexpr DicomTag kConvolutionKernel = 0x00181210;
inline constexpr DicomTag kGradientDirectionSequence = 0x00189076;
inline constexpr DicomTag kEffectiveEchoTime = 0x00189082;
inline constexpr DicomTag kDiffusionBValue = 0x00189087;
inline constexpr DicomTag kGradientOrientation = 0x00189089;
inline constexpr DicomTag kMrEchoSequence = 0x00189114;
inline constexpr DicomTag kMrDiffusionSequence = 0x00189117;
inline constexpr DicomTag kCardiacSequence = 0x00189118;
inline constexpr DicomTag kMrFrameTypeSequence = 0x00189226;
inline constexpr DicomTag kCtFrameTypeSequence = 0x00189329;
inline constexpr DicomTag kStudyInstanceUid = 0x0020000D;
inline constexpr DicomTag kSeriesInstanceUid = 0x0020000E;
inline constexpr DicomTag kSeriesNumber = 0x00200011;
inline constexpr DicomTag kAcquisitionNumber = 0x00200012;
inline constexpr DicomTag kInstanceNumber = 0x00200013;
inline constexpr DicomTag kImagePosition = 0x00200032;
inline constexpr DicomTag kImageOrientation = 0x00200037;
inline constexpr DicomTag kFrameOfReferenceUid = 0x00200052;
inline constexpr DicomTag kTemporalPosition = 0x00200100;
inline constexpr DicomTag kNumberOfTemporalPositions = 0x00200105;
inline constexpr DicomTag kImagesInAcquisition = 0x00201002;
inline constexpr DicomTag kFrameContentSequence = 0x00209111;
inline constexpr DicomTag kPlanePositionSequence = 0x00209113;
inline constexpr DicomTag kPlaneOrientationSequence = 0x00209116;
inline constexpr DicomTag kTemporalPositionIndex = 0x00209128;
inline constexpr DicomTag kTriggerDelay = 0x00209153;
inline constexpr DicomTag kDimensionIndexValues = 0x00209157;
inline constexpr DicomTag kConcatenationUid = 0x00209161;
inline constexpr DicomTag kInConcatenationNumber = 0x00209162;
inline constexpr DicomTag kInConcatenationTotal = 0x00209163;
inline constexpr DicomTag kSamplesPerPixel = 0x00280002;
inline constexpr DicomTag kPhotometric = 0x00280004;
inline constexpr DicomTag kNumberOfFrames = 0x00280008;
inline constexpr DicomTag kRows = 0x00280010;
inline constexpr DicomTag kColumns = 0x00280011;
inline constexpr DicomTag kPixelSpacing = 0x00280030;
inline constexpr DicomTag kBitsAllocated = 0x00280100;
inline constexpr DicomTag kBitsStored = 0x00280101;
inline constexpr DicomTag kHighBit = 0x00280102;
inline constexpr DicomTag kPixelRepresentation = 0x00280103;
inline constexpr DicomTag kRescaleIntercept = 0x00281052;
inline constexpr DicomTag kRescaleSlope = 0x00281053;
inline constexpr DicomTag kRescaleType = 0x00281054;
inline constexpr DicomTag kModalityLutSequence = 0x00283000;
inline constexpr DicomTag kPixelMeasuresSequence = 0x00289110;
inline constexpr DicomTag kPixelValueTransformationSequence = 0x00289145;
inline constexpr DicomTag kNumberOfSlices = 0x00540081;  ///< of PET
inline constexpr DicomTag kUnits = 0x00541001;           ///< of PET
inline constexpr DicomTag kSegmentSequence = 0x00620002;
inline constexpr DicomTag kSegmentNumber = 0x00620004;
inline constexpr DicomTag kSegmentLabel = 0x00620005;
inline constexpr DicomTag kSegmentIdentificationSequence = 0x0062000A;
inline constexpr DicomTag kReferencedSegmentNumber = 0x0062000B;
inline constexpr DicomTag kSharedFunctionalGroups = 0x52009229;
inline constexpr DicomTag kPerFrameFunctionalGroups = 0x52009230;
inline constexpr DicomTag kOverlayBitPosition = 0x60000102;  ///< and groups 6002, 6004, ...
inline constexpr DicomTag kExtendedOffsetTable = 0x7FE00001;
inline constexpr DicomTag kFloatPixelData = 0x7FE00008;
inline constexpr DicomTag kDoublePixelData = 0x7FE00009;
inline constexpr DicomTag kPixelData = 0x7FE00010;
}  // namespace tag

/// The elements of a data set that this module needs. What identifies the patient, the study or a
/// file is kept as a digest, good for comparing alone.
struct DicomDataset {
    /// Values of text as they stand in the file, binary numbers as decimal text ("1\2.5"),
    /// digests as hexadecimal text.
    std::map<DicomTag, std::string> values;
    std::map<DicomTag, std::vector<DicomDataset>> sequences;

    /// Text without padding; nothing when absent or empty.
    std::optional<std::string_view> text(DicomTag tag) const;
    /// Numbers, cut at backslashes. Empty when absent or empty.
    /// \throws FileError when one is no finite number
    std::vector<double> numbers(const std::filesystem::path& file, DicomTag tag) const;
    /// The same; empty when one is no finite number.
    std::vector<double> numbersIfAny(DicomTag tag) const;
    std::optional<std::int64_t> integer(DicomTag tag) const;
    /// The first item of a sequence, or nullptr.
    const DicomDataset* item(DicomTag sequence) const;
};

/// ASCII as it is, all else as '?': what character set it is in is not looked at.
std::string plainDicomText(std::string_view text);

/// Place of the pixels, in DicomBytes' positions.
struct DicomPixelData {
    bool isEncapsulated = false;
    bool isWords = false;      ///< value representation OW: big endian swaps pairs of bytes
    std::uint64_t offset = 0;  ///< of native pixel data
    std::uint64_t byteCount = 0;
    struct Fragment {
        std::uint64_t offset, byteCount;
    };
    std::vector<Fragment> fragments;  ///< without the offset table
    /// Where each frame's first fragment begins, counted in bytes from the first fragment's item;
    /// empty when the file does not say.
    std::vector<std::uint64_t> frameOffsets;
};

struct DicomHeader {
    DicomDataset dataset;
    std::string transferSyntax;
    std::string mediaStorage;  ///< SOP class, also from the file meta group; empty when absent
    bool isBigEndian = false;
    std::optional<std::uint64_t> deflatedFrom;  ///< where the deflated data set begins
    std::optional<DicomPixelData> pixelData;    ///< at top level: an icon's pixels do not count
    std::uint64_t bytesBehind = 0;              ///< the data set, without padding by zeros
    bool hasFloatPixelData = false;
    bool hasOverlayInPixels = false;  ///< the bits above HighBit hold an overlay
    std::string siemensCsa;           ///< of a mosaic: the CSA image header, else empty
    std::string seriesDescription;    ///< only when asked for
};

/// Walks through all elements of a DICOM file, with or without the 128-byte preamble, and checks
/// that every length stays inside the file. GDCM, whose asserts end the process, never sees a
/// header.
///
/// \param keepsDescription  also keep the series' description, which may identify the patient
/// \throws FileError when the file is truncated or its structure is damaged
DicomHeader readDicomHeader(const std::filesystem::path& file, bool keepsDescription = false);

}  // namespace adaptiso::detail
