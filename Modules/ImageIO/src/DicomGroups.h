#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "DicomFile.h"
#include "DicomPlanes.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// Planes that could be one volume, or the volumes of one 4-D image: of one series, one size, one
/// orientation, one pixel spacing; or the files of a series that can't be read.
struct DicomGroup {
    std::string seriesUid, modality;
    std::string description;  ///< may identify the patient
    std::int64_t columns = 0, rows = 0;
    std::vector<DicomPlane> planes;
    bool isMosaic = false;
    bool isLocalizer = false;  ///< says so itself, or is a survey: few slices in several directions
    bool isSecondary = false;  ///< a screenshot, or colour
    std::string fault;         ///< why its first file can't be read; empty when it can

    /// All planes have a position, an orientation and a pixel spacing.
    bool isPlaced() const;
};

/// In the order of the files: the same input gives the same numbers. Images of several kinds
/// (magnitude and phase) at the same places become groups of their own.
/// \throws FileError when there are more than 1000 groups
std::vector<DicomGroup> groupDicomPlanes(const std::vector<DicomFile>& files);

/// Within 5 degrees.
/// \pre  both are placed
bool areParallelPlanes(const DicomGroup& a, const DicomGroup& b);

/// "axial", "coronal", "sagittal" or "unknown": where the planes' normal mostly points.
std::string_view orientationName(const DicomGroup& group);

/// "24 slices of 512 x 512 voxels, axial orientation, 0.5 x 0.5 mm": no names, no ids.
std::string describeDicomGroup(const DicomGroup& group);

/// The group to read: the one that `series` names by number (from 1) or UID; without it the only
/// volume, with a warning for every image that is left aside.
/// \throws FileError when there is none or more than one, or when a file of the same series does
///         not fit in (a slice would be missing)
std::size_t chooseDicomGroup(const std::filesystem::path& input,
                             const std::vector<DicomGroup>& groups,
                             const std::optional<std::string>& series,
                             std::vector<Warning>& warnings);

}  // namespace adaptiso::detail
