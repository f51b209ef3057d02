#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "DicomFile.h"
#include "DicomPlanes.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// Planes that could be one volume, or the volumes of one 4-D image: of one patient, study, frame
/// of reference and series, one size, one orientation, one pixel spacing; one segment of a
/// segmentation; or the files of a series that can't be read.
struct DicomGroup {
    std::string seriesUid, modality;
    std::string patient, study, frameOfReference;  ///< digests
    std::string description;                       ///< may identify the patient
    std::int64_t columns = 0, rows = 0;
    std::vector<DicomPlane> planes;
    bool isMosaic = false;
    bool isLocalizer = false;  ///< says so itself, or is a survey: few slices in several directions
    bool isSecondary = false;  ///< a screenshot, or colour
    bool isScreenshot = false;  ///< isSecondary, and no header says where it lies
    bool isSegmentation = false;
    std::optional<std::int64_t> segment;  ///< its number in the file
    std::string segmentLabel;             ///< ASCII
    /// Positions of a segmentation's frames, of all its segments. Slices between them without a
    /// frame are empty.
    std::vector<Vec3> framePositions;
    std::string fault;  ///< why its first file can't be read; empty when it can
    std::vector<Warning> warnings;
    /// Values that differ between the groups, by DICOM keyword: ImageType,
    /// ConvolutionKernel, SeriesNumber, ...; Patient, Study and FrameOfReference are numbered.
    std::vector<std::pair<std::string, std::string>> details;

    /// All planes have a position, an orientation and a pixel spacing.
    bool isPlaced() const;
};

/// In the order of the files: the same input gives the same numbers. Images of several kinds
/// (magnitude and phase) or kernels at the same places become groups of their own. Slices that each
/// have a UID of their own become one group, with a warning, where nothing else tells them apart:
/// of the series, where study, frame of reference and series number agree; of the study or frame of
/// reference, where the series agrees.
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
/// volume, with a warning for every image that is left aside. Segmentations are left aside
/// where there is an image.
/// \throws FileError when there is none or more than one, or when a file of the same series does
///         not fit in (a slice would be missing)
std::size_t chooseDicomGroup(const std::filesystem::path& input,
                             const std::vector<DicomGroup>& groups,
                             const std::optional<std::string>& series,
                             std::vector<Warning>& warnings);

/// The planes' indices, by place along their normal: those at one place (1e-3 mm) together.
/// \pre  all planes have a position and one common orientation
std::vector<std::vector<std::size_t>> dicomPlaces(const std::vector<DicomPlane>& planes);

struct DicomVolumes {
    /// One plane a place each; ordered by what tells them apart. None: the planes repeat in no
    /// order that a header explains.
    std::vector<std::vector<DicomPlane>> volumes;
    std::string_view kind;  ///< "echoes", "time points", ...; empty for a single volume
};

/// Tells the volumes of a 4-D series apart where several planes lie at every place: by the one
/// attribute that does, by all of them, by times of acquisition, or by the images' numbers where
/// these are those of whole passes. None where two of these tell them apart differently.
/// \pre  as dicomPlaces
DicomVolumes splitDicomVolumes(const std::vector<DicomPlane>& planes);

}  // namespace adaptiso::detail
