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
inline constexpr DicomTag kTransferSyntax = 0x00020010;
inline constexpr DicomTag kImageType = 0x00080008;
inline constexpr DicomTag kSopClass = 0x00080016;
inline constexpr DicomTag kSeriesInstanceUid = 0x0020000E;
inline constexpr DicomTag kImagePosition = 0x00200032;
inline constexpr DicomTag kImageOrientation = 0x00200037;
inline constexpr DicomTag kPlanePositionSequence = 0x00209113;
inline constexpr DicomTag kPlaneOrientationSequence = 0x00209116;
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
inline constexpr DicomTag kModalityLutSequence = 0x00283000;
inline constexpr DicomTag kPixelMeasuresSequence = 0x00289110;
inline constexpr DicomTag kPixelValueTransformationSequence = 0x00289145;
inline constexpr DicomTag kSharedFunctionalGroups = 0x52009229;
inline constexpr DicomTag kPerFrameFunctionalGroups = 0x52009230;
inline constexpr DicomTag kPixelData = 0x7FE00010;
}  // namespace tag

/// The elements of a data set that this module needs; names, ids and dates are never kept.
struct DicomDataset {
    std::map<DicomTag, std::string> values;
    std::map<DicomTag, std::vector<DicomDataset>> sequences;

    /// Text without padding; nothing when absent or empty.
    std::optional<std::string_view> text(DicomTag tag) const;
    /// Numbers of a decimal string (DS), cut at backslashes. Empty when absent or empty.
    /// \throws FileError when one is no finite number
    std::vector<double> numbers(const std::filesystem::path& file, DicomTag tag) const;
    /// The first item of a sequence, or nullptr.
    const DicomDataset* item(DicomTag sequence) const;
};

struct DicomPixelData {
    bool isEncapsulated = false;
    std::uint64_t byteCount = 0;
    struct Fragment {
        std::uint64_t offset, byteCount;
    };
    std::vector<Fragment> fragments;  ///< without the offset table
};

struct DicomHeader {
    DicomDataset dataset;
    std::string transferSyntax;
    std::string mediaStorage;  ///< SOP class, also from the file meta group; empty when absent
    bool isBigEndian = false;
    std::optional<DicomPixelData> pixelData;  ///< at top level: an icon's pixels do not count

    std::optional<std::uint16_t> unsignedShort(DicomTag tag) const;
};

/// Walks through all elements of a DICOM file, with or without the 128-byte preamble, and checks
/// that every length stays inside the file, so that GDCM (whose asserts end the process) is only
/// given files that hold together.
///
/// \throws FileError when the file is truncated or its structure is damaged
DicomHeader readDicomHeader(const std::filesystem::path& file);

}  // namespace adaptiso::detail
