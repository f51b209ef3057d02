#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "DicomFile.h"
#include "DicomGroups.h"
#include "DicomPlanes.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

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
