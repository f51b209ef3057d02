#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {

/// Images of a DICOM input that belong together: of one series, size, orientation and kind.
struct DicomSeries {
    std::int64_t number = 0;  ///< from 1: ReadOptions::series
    std::string uid;          ///< SeriesInstanceUID. Identifies the patient: show when asked only
    std::string description;  ///< SeriesDescription, ASCII. May identify the patient: likewise
    std::string modality;     ///< "CT", "MR", ...
    std::string orientation;  ///< "axial", "coronal", "sagittal", "unknown"
    std::int64_t columns = 0, rows = 0;
    std::int64_t slices = 0;   ///< of one volume; of a series that can't be read: its images
    std::int64_t volumes = 1;  ///< more than 1: 4-D; 0: can't be separated
    Vec3 spacingMm;            ///< between columns, rows, slices; 0: unknown
    bool isLocalizer = false;
    std::optional<std::int64_t> segment;  ///< of a segmentation: its number in the file
    std::string segmentLabel;             ///< ASCII
    /// Values that differ between the groups, by DICOM keyword: ImageType, SeriesNumber,
    /// ConvolutionKernel, EchoTime, DiffusionBValue, AcquisitionNumber, FrameType; Patient, Study
    /// and FrameOfReference are numbered from 1. Identifies no patient.
    std::vector<std::pair<std::string, std::string>> details;
    std::string fault;  ///< why it can't be read (a file's name may be in it); empty: it can
    std::vector<Warning> warnings;  ///< those of reading it

    bool isReadable() const { return fault.empty(); }
};

struct DicomFault {
    std::filesystem::path file;  ///< its name may identify the patient
    std::string fault;
};

struct DicomListing {
    std::vector<DicomSeries> series;
    std::size_t otherFiles = 0;       ///< DICOM files that hold no image: reports, plans, ...
    std::vector<Warning> warnings;    ///< of entries that were left out
    std::vector<DicomFault> damaged;  ///< files that can't be understood
};

/// Says what a DICOM folder, file or DICOMDIR holds. Reads headers alone; decodes nothing.
///
/// The numbers are those that ReadOptions::series takes, for an input without damaged files; one
/// with damaged files is not read at all.
/// \throws FileError when the input is no DICOM, or holds no image
DicomListing listSeries(const std::filesystem::path& input);

}  // namespace adaptiso
