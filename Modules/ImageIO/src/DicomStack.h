#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "DicomFile.h"
#include "DicomGroups.h"
#include "DicomPlanes.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// A slice made of two neighbours: (1 - weight) * slice `before` + weight * slice `before` + 1.
struct SliceBlend {
    std::size_t before = 0;
    double weight = 0;
};

/// One volume's planes in their order along the normal, and where they lie together.
struct DicomStack {
    std::vector<DicomPlane> planes;
    ImageGeometry geometry;
    /// Recipe for each of the geometry's slices where the planes are uneven; else empty, and the
    /// planes are the slices.
    std::vector<SliceBlend> blends;
    /// The slice that each plane is, where slices without a plane are empty (0); else empty.
    std::vector<std::size_t> slices;
    std::vector<Warning> warnings;
};

/// \throws FileError unless all planes of the group have a position, an orientation and a spacing
void requirePlacedPlanes(const std::vector<DicomFile>& files, const DicomGroup& group);

/// Places a segment's frames on the even steps of its file's frames; slices without a frame are
/// empty (PS3.3, A.51). The step is SpacingBetweenSlices where it fits the frames' positions, else
/// the least distance between two frames.
/// \throws FileError unless all frames lie on such steps, within 0.05 mm
DicomStack stackSegmentFrames(const std::filesystem::path& input, const DicomGroup& group,
                              std::vector<DicomPlane> planes);

/// Sorts a volume's planes and checks that they lie evenly on a line, within 0.05 mm. The step from
/// one to the next is kept as it is: tilt becomes shear.
///
/// \param planes          two or more, no two at one place
/// \param resamplesSlices  uneven planes are blended linearly onto even steps of their usual
///                        distance along the line through their positions
/// \throws FileError when planes lie beside the line, or unevenly and are not to be resampled
DicomStack stackDicomPlanes(const std::filesystem::path& input, const DicomGroup& group,
                            std::vector<DicomPlane> planes, bool resamplesSlices);

/// Compares what the slices of one volume say their values mean.
///
/// \throws FileError  some are MONOCHROME1 and some MONOCHROME2, they are of several units
///         (RescaleType, Units), or some are rescaled while others do not say
/// A warning is added where some hold signed samples and some unsigned ones, each read as it says.
void requireAgreement(const std::filesystem::path& input, const std::vector<DicomFile>& files,
                      const std::vector<DicomPlane>& planes, std::vector<Warning>& warnings);

/// \throws FileError  a part of a concatenation, a multi-frame image in several files, is missing
void requireWholeConcatenation(const std::filesystem::path& input,
                               const std::vector<DicomFile>& files,
                               const std::vector<DicomPlane>& planes);

/// Warns where headers count more than there is: slices of PET (NumberOfSlices), images of an
/// acquisition, time points. Images of other series count where they name the same number.
/// \param slices  of the one volume
void warnOfFewer(const std::vector<DicomFile>& files, const DicomGroup& group, std::size_t slices,
                 std::vector<Warning>& warnings);

}  // namespace adaptiso::detail
