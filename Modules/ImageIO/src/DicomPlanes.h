#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "DicomFile.h"
#include "adaptiso/Core/Geometry.h"

namespace adaptiso::detail {

/// Criterion that separates the volumes of one series where several images lie at one place.
enum class DicomLabel { Echo, TimePoint, CardiacPhase, Diffusion, Acquisition };
inline constexpr std::size_t kDicomLabels = 5;

/// Position of one slice from its header; missing values stay empty. A file is one plane, an
/// enhanced multi-frame file a plane for each frame, a Siemens mosaic one for each tile.
struct DicomPlane {
    std::size_t file = 0;
    std::int64_t frame = 0;
    std::int64_t firstColumn = 0, firstRow = 0;  ///< of a mosaic's tile within the frame
    std::optional<Vec3> position;                ///< centre of the first voxel, LPS mm
    std::optional<Vec3> alongRow, alongColumn;   ///< unit vectors
    std::optional<double> columnStepMm, rowStepMm;
    std::optional<double> sliceStepMm;  ///< of a multi-frame file; only segmentations need it
    double slope = 1, intercept = 0;
    bool hasRescale = false;  ///< the header says so, be it by 1 and 0
    std::string rescaleType;  ///< "HU", ...; empty when absent

    std::string imageType;  ///< ImageType or FrameType, with the complex component (phase, ...)
    std::string kernel;     ///< ConvolutionKernel
    std::optional<std::int64_t> segment;  ///< of a segmentation's frame
    std::array<std::vector<double>, kDicomLabels> labels;
    std::vector<double> time;   ///< of acquisition, else of content, s of the day
    std::vector<double> order;  ///< instance number, frame
};

/// All planes of a file, of one size.
struct DicomFilePlanes {
    std::int64_t columns = 0, rows = 0;
    bool isMosaic = false;
    std::vector<DicomPlane> planes;
};

/// \throws FileError when the header contradicts itself, when frames have no place of their own, or
///         values go through a lookup table
DicomFilePlanes dicomPlanes(const DicomFile& dicom, const DicomPixelFormat& format);

bool isSiemensMosaic(const DicomHeader& header);

/// Cuts `whole`, the plane of a mosaic as its header has it, into the tiles' planes.
/// \throws FileError when the header does not say how many tiles there are and how they stack
DicomFilePlanes mosaicPlanes(const DicomFile& dicom, const DicomPixelFormat& format,
                             const DicomPlane& whole);

}  // namespace adaptiso::detail
