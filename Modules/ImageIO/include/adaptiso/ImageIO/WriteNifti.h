#pragma once

#include <filesystem>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// Writes an image as gzip-compressed NIfTI, its geometry as sform (scanner, mm): NIfTI-1 where its
/// float32 and int16 hold the geometry exactly, else NIfTI-2. readVolume() gives the same volume.
///
/// \param file  ends in ".nii.gz", as readers of other programs expect
/// \throws FileError  it can't be written
/// The same volume gives the same bytes.
void writeNifti(const VolumeView& volume, const std::filesystem::path& file);

}  // namespace adaptiso
